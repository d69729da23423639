"""The results as plain data: records for ``report.json``, and sheets for the tables."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import Any

from validation.case import CaseResult
from validation.report.table_files import Cell, Sheet
from validation.verdict import Check, Criterion, Estimate, Verdict, source_name

VERDICTS = (Verdict.DISAGREE, Verdict.EXPLAINED, Verdict.AGREE)
"""Verdicts in the order of the report, disagreements first."""


def case_record(result: CaseResult) -> dict[str, Any]:
    """A case for ``report.json``."""
    return {
        "name": result.name,
        "title": result.title,
        "verdict": result.verdict.value,
        "question": result.question,
        "seconds": round(result.seconds, 2),
        "checks": [check_record(check) for check in result.checks],
        "criteria": [criterion_record(criterion) for criterion in result.criteria],
        **{
            part: [{"title": t.title, "columns": t.columns, "rows": t.rows} for t in getattr(result, part)]
            for part in ("answer", "certificate", "tables")
        },
        "notes": list(result.notes),
    }


def check_record(check: Check) -> dict[str, Any]:
    """A check for ``report.json``."""
    return {
        "name": check.name,
        "unit": check.unit,
        "a": _estimate(check.a),
        "b": _estimate(check.b),
        "difference": finite(check.difference),
        "allowed": finite(check.allowed),
        "relative difference": finite(check.relative),
        "largest relative difference required": check.cap,
        "kind of reference": check.reference.value,
        "verdict": check.verdict.value,
        "explanation": check.explanation,
    }


def criterion_record(criterion: Criterion) -> dict[str, Any]:
    """A criterion for ``report.json``."""
    return {
        "name": criterion.name,
        "unit": criterion.unit,
        "value": finite(float(criterion.value)),
        "low": finite(float(criterion.low)),
        "high": finite(float(criterion.high)),
        "reason": criterion.reason,
        "verdict": criterion.verdict.value,
    }


def finite(value: float) -> float | None:
    """A number that JSON knows, or none."""
    return value if math.isfinite(value) else None


def _estimate(estimate: Estimate) -> dict[str, Any]:
    return {
        "value": finite(estimate.value),
        "uncertainty": finite(estimate.uncertainty),
        "kind": estimate.kind.value,
        "how": estimate.how,
        "contributions": {source_name(source): finite(amount) for source, amount in estimate.contributions},
    }


def checks_sheet(result: CaseResult, name: str) -> Sheet:
    """All checks of a case, to the last digit."""
    numbers = ("", ": uncertainty", ": kind", ": how obtained")
    columns = (
        *("quantity", "unit", "verdict"),
        *(f"{side}{what}" for side in ("a", "b") for what in numbers),
        *("difference", "allowed", "difference / allowed", "relative difference", "largest relative difference"),
        *("kind of reference", "explanation"),
    )
    return Sheet(name, f"Checks: {result.title}", columns, tuple(_check_row(check) for check in result.checks))


def _check_row(check: Check) -> tuple[Cell, ...]:
    a, b = ((e.value, e.uncertainty, e.kind.value, e.how) for e in (check.a, check.b))
    judged = (check.difference, check.allowed, check.used, check.relative, check.cap)
    words = (check.reference.value, check.explanation)
    return (check.name, check.unit, check.verdict.value, *a, *b, *judged, *words)


def criteria_sheet(result: CaseResult, name: str) -> Sheet:
    """All criteria of a case."""
    columns = ("criterion", "unit", "verdict", "value", "from", "to", "reason")
    rows = [(c.name, c.unit, c.verdict.value, c.value, c.low, c.high, c.reason) for c in result.criteria]
    return Sheet(name, f"Criteria: {result.title}", columns, tuple(rows))


def counts(result: CaseResult) -> dict[Verdict, int]:
    """Number of comparisons of each verdict, worst first."""
    return {verdict: sum(item.verdict is verdict for item in result.items) for verdict in VERDICTS}


def tightest(result: CaseResult) -> Check | None:
    """The check with the largest difference over allowed, of those that are not explained."""
    judged = [check for check in result.checks if check.verdict is not Verdict.EXPLAINED]
    return max(judged, key=lambda check: -1.0 if math.isnan(check.used) else check.used, default=None)


def summary_sheet(results: Sequence[CaseResult]) -> Sheet:
    """A row for each case: verdict, counts, largest difference over allowed, and run time, s."""
    rows: list[tuple[Cell, ...]] = []
    for result in results:
        worst, found = tightest(result), counts(result)
        used = None if worst is None else worst.used
        rows.append((result.title, result.verdict.value, *(found[v] for v in VERDICTS), used, result.seconds))
    columns = ("case", "verdict", *(v.value for v in VERDICTS), "largest difference / allowed", "seconds")
    return Sheet("summary", "Verdicts of all cases", columns, tuple(rows))


def kinds_sheet(results: Sequence[CaseResult]) -> Sheet:
    """Number of checks of each kind of reference, by verdict; criteria are counted as such."""
    found: dict[str, list[Verdict]] = {}
    for result in results:
        for check in result.checks:
            found.setdefault(check.reference.value, []).append(check.verdict)
        for criterion in result.criteria:
            found.setdefault("criterion (a limit, not a reference)", []).append(criterion.verdict)
    rows: list[tuple[Cell, ...]] = [(kind, *(verdicts.count(v) for v in VERDICTS)) for kind, verdicts in found.items()]
    columns = ("kind of reference", *(v.value for v in VERDICTS))
    return Sheet("kinds", "Comparisons by kind of reference", columns, tuple(rows))


def faults_sheet() -> Sheet:
    """Effect of each fault put into the program, and the check that caught it, by the last complete run."""
    from validation.faults.catalogue import CONTROL
    from validation.faults.record import recorded

    columns = ("fault", "where", "what it does", "result", "caught by", "by", "against")
    faults = [one for one in recorded()[0] if one.fault != CONTROL]
    rows = tuple(
        (
            *(one.fault.name, one.fault.place, one.fault.what, one.seen.result.value),
            f"{one.seen.case.replace('_', '-')}: {one.seen.item}",
            *(one.seen.number, one.seen.bound),
        )
        for one in faults
    )
    return Sheet("faults", "Faults put into the program, and what caught each", columns, rows)
