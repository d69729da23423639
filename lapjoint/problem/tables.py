"""A problem as the tables of its TOML file, and copies of such tables."""

from __future__ import annotations

from typing import Any

from pydantic import BaseModel

from lapjoint.problem.schema import Part

_ALWAYS = ("kind", "shape", "schema_version")  # keys that tell kinds and versions apart are written, default or not


def tables_of(part: BaseModel) -> dict[str, Any]:
    """A problem, or a part of one, as tables without what is None or the default."""
    table: dict[str, Any] = {}
    for name, info in type(part).model_fields.items():
        value = getattr(part, name)
        if value is None or (name not in _ALWAYS and not info.is_required() and value == info.default):
            continue
        table[info.alias or name] = _value(value)
    return table


def _value(value: Any) -> Any:
    if isinstance(value, Part):
        return tables_of(value)
    if isinstance(value, tuple):
        return [_value(item) for item in value]
    return value  # Samples, too: `problem_from_tables` takes them as they are


def copied(value: Any) -> Any:
    """A deep copy of tables and lists; their other values are shared, because they are never changed."""
    if isinstance(value, dict):
        return {key: copied(item) for key, item in value.items()}
    return [copied(item) for item in value] if isinstance(value, list) else value
