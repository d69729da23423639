"""A problem as a form: fields, groups of fields and lists of groups, made from the schema of a problem file.

What the schema gets later appears in the form by itself, with its unit, its description and what is allowed.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import cache
from typing import Any, Literal

import numpy as np

from lapjoint.campaigns.grid import UNITS
from lapjoint.problem.files import json_schema
from lapjoint.problem.messages import shown

Kind = Literal["value", "text", "choice", "flag"]
"""Kinds of fields: a number or a list, as TOML writes it; text; one of several words; yes or no."""
Schema = Mapping[str, Any]
PLAIN = 1e-4, 1e6
"""Sizes between which a number is written without an exponent: within them it is short, and read at a glance."""
_HIDDEN = frozenset({"schema_version", "sha256"})
"""Fields that programs write and people do not."""


@dataclass(frozen=True)
class Field:
    """One value of a problem."""

    path: str
    """Where it is, as ``--set`` takes it: ``stops.0.gap``."""
    label: str
    kind: Kind
    text: str
    """The value as text; empty if the problem does not have it."""
    default: str
    """The value that holds if none is given, as text; empty if there is none."""
    unit: str
    """Unit, or empty."""
    hint: str
    """What the value is."""
    choices: tuple[str, ...] = ()
    """Allowed words of a choice."""
    required: bool = False


@dataclass(frozen=True)
class Group:
    """A table of a problem, or a table that it may have."""

    path: str
    label: str
    hint: str
    parts: tuple[Part, ...]
    """What the table holds; nothing if it is `absent`."""
    absent: bool = False
    """Whether the problem does not have it."""
    removable: bool = False
    """Whether the problem may be without it."""
    tag: str = ""
    """Key of the word that says which kind of table it is; empty if there is one kind."""
    word: str = ""
    """That word."""
    words: tuple[str, ...] = ()
    """Allowed words."""


@dataclass(frozen=True)
class Listing:
    """A list of tables."""

    path: str
    label: str
    hint: str
    items: tuple[Group, ...]


Part = Field | Group | Listing


def form_of(tables: Mapping[str, Any]) -> tuple[Part, ...]:
    """The form of a problem, valid or not, from its tables."""
    return tuple(_parts(_schema(), tables, ""))


def all_parts(parts: Sequence[Part]) -> Iterator[Part]:
    """All parts of a form, those of a group or a list after it."""
    for part in parts:
        yield part
        if not isinstance(part, Field):
            yield from all_parts(part.parts if isinstance(part, Group) else part.items)


def schema_at(path: str, tables: Mapping[str, Any]) -> Schema:
    """The part of the schema that describes what is at a path of a problem; empty for an unknown path."""
    here: Schema = _schema()
    value: Any = tables
    for key in path.split(".") if path else ():
        if key.isdecimal():
            here = resolved(here.get("items", {}))
            value = value[int(key)] if isinstance(value, list) and int(key) < len(value) else {}
        else:
            table = value if isinstance(value, Mapping) else {}
            here, value = resolved(of_kind(here, table).get("properties", {}).get(key, {})), table.get(key)
    return here


@cache
def _schema() -> Schema:
    return json_schema()


def resolved(part: Schema) -> Schema:
    """A part of the schema without references, and without null, as one that may be left out has it."""
    while True:
        several = [one for one in part.get("anyOf", ()) if one.get("type") != "null"]
        if "$ref" in part:
            part = {**_schema()["$defs"][part["$ref"].rsplit("/", 1)[-1]], **_without(part, "$ref")}
        elif len(several) == 1:
            part = {**several[0], **_without(part, "anyOf")}
        else:
            return part


def _without(part: Schema, key: str) -> Schema:
    """What is said of a part beside `key`; its description stands for that of the part."""
    return {name: value for name, value in part.items() if name != key}


def words_of(part: Schema) -> tuple[str, dict[str, Schema]]:
    """The key that says which kind of table a part is, and the kinds by their words; empty if there is one kind."""
    discriminator = part.get("discriminator", {})
    words = {ref: word for word, ref in discriminator.get("mapping", {}).items()}
    kinds = {words[one["$ref"]]: resolved(one) for one in part.get("oneOf", ()) if one.get("$ref") in words}
    return discriminator.get("propertyName", ""), kinds


def word_of(part: Schema, table: Mapping[str, Any]) -> str:
    """The word for the kind of a table: what the table says, the default, or the first kind; empty with one kind."""
    tag, kinds = words_of(part)
    return str(table.get(tag) or (part.get("default") or {}).get(tag) or next(iter(kinds), ""))


def of_kind(part: Schema, table: Mapping[str, Any]) -> Schema:
    """The part of the schema for the kind of a table; that of the first kind if the table says one that is not."""
    _, kinds = words_of(part)
    return kinds.get(word_of(part, table), next(iter(kinds.values()))) if kinds else part


def _parts(part: Schema, table: Mapping[str, Any], path: str) -> Iterator[Part]:
    """The fields, groups and lists of a table."""
    tag, _ = words_of(part)
    own = of_kind(part, table)
    for key, described in own.get("properties", {}).items():
        if key == tag or key in _HIDDEN or "const" in described:
            continue
        below, value = resolved(described), table.get(key)
        where, required = f"{path}.{key}" if path else key, key in own.get("required", ())
        if _is_table(below):
            yield _group(below, value, where, key, required)
        elif below.get("type") == "array" and _is_table(resolved(below.get("items", {}))):
            yield _listing(below, value, where, key)
        else:
            yield _field(below, value, where, key, required)


def _is_table(part: Schema) -> bool:
    return "properties" in part or "discriminator" in part


def _group(part: Schema, value: Any, path: str, label: str, required: bool) -> Group:
    tag, kinds = words_of(part)
    hint = _hint(part)
    if not isinstance(value, Mapping):
        return Group(path, label, hint, (), absent=True, removable=not required)
    parts = tuple(_parts(part, value, path))
    return Group(path, label, hint, parts, False, not required, tag, word_of(part, value), tuple(kinds))


def _listing(part: Schema, value: Any, path: str, label: str) -> Listing:
    item, found = resolved(part["items"]), []
    for i, one in enumerate(value if isinstance(value, Sequence) and not isinstance(value, str) else ()):
        name = one.get("name") if isinstance(one, Mapping) else None
        found.append(_group(item, one, f"{path}.{i}", str(name or f"{label} {i + 1}"), False))
    return Listing(path, label, _hint(part), tuple(found))


def _field(part: Schema, value: Any, path: str, label: str, required: bool) -> Field:
    default = part.get("default")
    words = tuple(str(word) for word in part.get("enum", ()))
    kind: Kind = "value"
    if part.get("type") == "boolean":
        kind = "flag"
    elif words:
        kind = "choice"
    elif part.get("type") == "string":
        kind = "text"
    unit = UNITS.get(label, "")
    written = text_of(value, kind)
    return Field(path, label, kind, written, text_of(default, kind), unit, _hint(part), words, required)


def _hint(part: Schema) -> str:
    return " ".join(str(part.get("description", "")).replace("``", "").split())


def text_of(value: Any, kind: Kind = "value") -> str:
    """A value of a problem as the text of a field: as TOML writes it, text without quotes."""
    if value is None:
        return ""
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, float):
        return number_text(value)
    if isinstance(value, str):
        return value
    if isinstance(value, Sequence):
        return "[" + ", ".join(_item(item) for item in value) + "]"
    return shown(value)


def number_text(value: float) -> str:
    """The shortest text from which the same number is read: without an exponent where its size is usual."""
    if not math.isfinite(value):
        return str(value)
    if value == 0 or PLAIN[0] <= abs(value) < PLAIN[1]:
        return np.format_float_positional(value, trim="-")
    digits, _, power = np.format_float_scientific(value, trim="-").partition("e")
    return f"{digits}e{int(power)}"


def _item(value: Any) -> str:
    """A value within a list, where text has quotes."""
    return shown(value) if isinstance(value, str) else text_of(value)
