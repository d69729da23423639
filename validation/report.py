"""The reports: ``report.json`` for programs, and ``report.html``, one page that needs nothing else, for people."""

from __future__ import annotations

import json
import math
import os
import platform
from collections.abc import Sequence
from datetime import UTC, datetime
from importlib.metadata import version
from pathlib import Path
from typing import Any

from validation.case import CaseResult
from validation.quantity import Check, Criterion, Estimate

_PACKAGES = ("lapjoint", "numpy", "scipy", "numba", "scikit-fem", "matplotlib", "meshio", "pydantic")


def write_reports(results: Sequence[CaseResult], level: str, output: Path, seconds: float) -> tuple[Path, Path]:
    """Write both reports into `output`, each in one move, and return their paths."""
    about = {
        "level": level,
        "seconds": round(seconds, 1),
        "date": datetime.now(UTC).isoformat(timespec="seconds"),
        "python": platform.python_version(),
        "versions": {name: version(name) for name in _PACKAGES},
    }
    data = {"about": about, "cases": [_case(result) for result in results]}
    pages = output / "report.html", output / "report.json"
    _replace(pages[0], _page(results, about))
    _replace(pages[1], json.dumps(data, indent=1, allow_nan=False) + "\n")
    return pages


def _replace(path: Path, text: str) -> None:
    draft = path.with_suffix(path.suffix + ".part")
    draft.write_text(text, encoding="utf-8")
    os.replace(draft, path)


def _finite(value: float) -> float | None:
    return value if math.isfinite(value) else None


def _estimate(estimate: Estimate) -> dict[str, Any]:
    return {
        "value": _finite(estimate.value),
        "uncertainty": _finite(estimate.uncertainty),
        "kind": estimate.kind.value,
        "how": estimate.how,
    }


def _check(check: Check) -> dict[str, Any]:
    return {
        "name": check.name,
        "unit": check.unit,
        "a": _estimate(check.a),
        "b": _estimate(check.b),
        "difference": _finite(check.difference),
        "allowed": _finite(check.allowed),
        "relative difference": _finite(check.relative),
        "largest relative difference required": check.cap,
        "verdict": check.verdict.value,
        "explanation": check.explanation,
    }


def _criterion(criterion: Criterion) -> dict[str, Any]:
    return {
        "name": criterion.name,
        "unit": criterion.unit,
        "value": _finite(float(criterion.value)),
        "low": _finite(float(criterion.low)),
        "high": _finite(float(criterion.high)),
        "reason": criterion.reason,
        "verdict": criterion.verdict.value,
    }


def _case(result: CaseResult) -> dict[str, Any]:
    return {
        "name": result.name,
        "title": result.title,
        "verdict": result.verdict.value,
        "question": result.question,
        "seconds": round(result.seconds, 2),
        "checks": [_check(check) for check in result.checks],
        "criteria": [_criterion(criterion) for criterion in result.criteria],
        "tables": [{"title": t.title, "columns": t.columns, "rows": t.rows} for t in result.tables],
        "notes": list(result.notes),
    }


def _page(results: Sequence[CaseResult], about: dict[str, Any]) -> str:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(loader=PackageLoader("validation"), autoescape=True, undefined=StrictUndefined)
    environment.filters["sig"] = lambda value: f"{value:.9g}"
    environment.filters["short"] = lambda value: f"{value:.2g}"
    return environment.get_template("report.html.j2").render(results=results, about=about)
