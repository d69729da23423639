"""The problem as a person reads it: every value that is given, with its unit, as tables."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any

from pydantic import BaseModel

from lapjoint.figures.text import hertz
from lapjoint.problem import Problem
from lapjoint.problem.files import problem_tables_json
from validation.report.table_files import Cell, Sheet

_UNIT = re.compile(r", ((?:kg|m|N|Pa|s|rad|Hz)\d?(?:[ /](?:kg|m|N|Pa|s|rad|Hz)\d?)*)(?=[.,;: ])")
"""The unit of a field in its description, as in "Gap when the beams are straight, m; below 0 an interference"."""
_SHOWN = 12
"""Values of a row that a table shows: a record has thousands."""
_DIGEST = 12
"""Digits of the digest of a file that are shown, enough to tell files apart."""
_NOT_SHOWN = ("title", "schema_version")


def problem_sheets(problem: Problem) -> list[Sheet]:
    """Every value of a problem that is given: parts of which there may be several have a table of their own."""
    rows: list[tuple[Cell, ...]] = []
    sheets = []
    remarks = {path: part.remark for path, part in (problem.records | problem.random).items()}
    for key, part in problem_tables_json(problem).items():
        if key in _NOT_SHOWN:
            continue
        models, name = getattr(problem, key), key.replace("_", " ")
        if not isinstance(part, Sequence) or isinstance(part, str):
            rows.append((name, ", ".join(_written(part, models))))
        elif any("file" in one or any(isinstance(value, list | dict) for value in one.values()) for one in part):
            rows += [
                (f"{name} {i + 1}", ", ".join(_written(*of))) for i, of in enumerate(zip(part, models, strict=True))
            ]
        else:
            sheets.append(_sheet(problem, key, part, models))
    rows += [(f"{path}, as it is read", remark) for path, remark in remarks.items()]
    return [Sheet("problem", "Parts of the problem", ("part", "values"), tuple(rows)), *sheets]


def _sheet(problem: Problem, key: str, parts: Sequence[Mapping[str, Any]], models: Sequence[BaseModel]) -> Sheet:
    """Several equal parts, a row for each."""
    keys = list(dict.fromkeys(name for part in parts for name in part if name != "name"))
    names = list(problem.stop_names) if key == "stops" else [str(part.get("name", "")) for part in parts]
    units = {name: unit for model in models for name in keys if (unit := _unit(model, name))}
    heads = [f"{name.replace('_', ' ')}{f' [{units[name]}]' if name in units else ''}" for name in keys]
    rows = tuple(
        (name or str(i + 1), *(_value(part[k], k) if k in part else "–" for k in keys))
        for i, (name, part) in enumerate(zip(names, parts, strict=True))
    )
    title = key.replace("_", " ").capitalize()
    return Sheet(f"problem-{key.replace('_', '-')}", title, ("name", *heads), rows)


def _unit(model: object, key: str) -> str:
    """The unit of a field; empty where it has none."""
    field = type(model).model_fields.get(key) if isinstance(model, BaseModel) else None
    found = _UNIT.search(f"{field.description} ") if field is not None and field.description else None
    return found[1] if found else ""


def _written(part: object, model: object) -> Iterator[str]:
    """The values of a part, as ``length 2.5 m``; a part within it follows its name."""
    if not isinstance(part, Mapping):
        yield _value(part, "")
        return
    for key, value in part.items():
        name, inner = key.replace("_", " "), getattr(model, key, None)
        if isinstance(value, Mapping):
            yield f"{name}: {', '.join(_written(value, inner))}"
        elif isinstance(value, list) and value and all(isinstance(one, Mapping) for one in value):
            models = inner if isinstance(inner, tuple) else (None,) * len(value)
            shown = [f"({', '.join(_written(*of))})" for of in zip(value[:_SHOWN], models, strict=False)]
            yield f"{name}: {', '.join(shown)}{_more(value)}"
        else:
            unit = _unit(model, key)
            yield f"{name} {_value(value, key)}{f' {unit}' if unit else ''}{_besides(value, key)}"


def _besides(value: object, key: str) -> str:
    """A frequency in Hz, beside an angular one."""
    return f" ({hertz(value)} Hz)" if isinstance(value, float) and key.endswith("angular_frequency") else ""


def _value(value: object, key: str) -> str:
    if isinstance(value, list):
        return f"[{', '.join(_value(one, key) for one in value[:_SHOWN])}{_more(value)}]"
    if key == "sha256":
        return f"{str(value)[:_DIGEST]}..."
    return "∞" if value == "inf" else f"{value:.10g}" if isinstance(value, float) else str(value)


def _more(values: Sequence[object]) -> str:
    """What is said of the values that are left out."""
    return f", ... ({len(values)} in all)" if len(values) > _SHOWN else ""
