"""Changes of a problem by a form: each takes the tables of a problem and gives others."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

from explore.form import schema_at, word_of, words_of
from lapjoint.problem.override import assign, toml_value
from lapjoint.problem.tables import copied

Tables = dict[str, Any]
Edit = Callable[[Mapping[str, Any]], Tables]
"""A change: it takes the tables of a problem and gives others."""
Change = Callable[[Edit, str], None]
"""Takes a change of a problem, and the path that it changes."""


def typed(tables: Mapping[str, Any], path: str, text: str) -> Tables:
    """The tables with a field as it was typed; an empty field is left out.

    What is no value of TOML stays text, so that the message about it shows what was typed.
    """
    if not text.strip():
        return removed(tables, path)
    part = schema_at(path, tables)
    is_text = part.get("type") == "string" or "enum" in part
    return assigned(tables, path, text.strip() if is_text else toml_value(text))


def assigned(tables: Mapping[str, Any], path: str, value: Any) -> Tables:
    """The tables with a value at a path, or at several."""
    made: Tables = copied(dict(tables))
    assign(made, path, value, path)
    return made


def added(tables: Mapping[str, Any], path: str) -> Tables:
    """The tables with a table more: at the path, or at the end of the list at the path, there like the last one.

    A first table is empty, so that the messages at its fields say what belongs there.
    """
    if schema_at(path, tables).get("type") != "array":
        return assigned(tables, path, _empty(path, tables))
    listed = list(_at(tables, path) or ())
    listed.append(copied(listed[-1]) if listed else _empty(f"{path}.0", tables))
    if isinstance(listed[-1], dict) and listed[-1].get("name"):
        listed[-1]["name"] = _another(str(listed[-1]["name"]), {str(one.get("name")) for one in listed[:-1]})
    return assigned(tables, path, listed)


def removed(tables: Mapping[str, Any], path: str) -> Tables:
    """The tables without what is at a path."""
    made: Tables = copied(dict(tables))
    _take(made, path)
    return made


def changed_kind(tables: Mapping[str, Any], path: str, word: str) -> Tables:
    """The tables with another kind of table at a path, which keeps the fields that both kinds have."""
    part, old = schema_at(path, tables), _at(tables, path)
    tag, kinds = words_of(part)
    kept = old if isinstance(old, dict) else {}
    allowed = kinds.get(word, {}).get("properties", {})
    shared = {key: value for key, value in kept.items() if key in allowed and key != tag}
    return assigned(tables, path, {tag: word} | shared)


def _empty(path: str, tables: Mapping[str, Any]) -> Tables:
    """An empty table for a path, with the word for its kind where there are several."""
    part = schema_at(path, tables)
    tag, kinds = words_of(part)
    return {tag: word_of(part, {})} if kinds else {}


def _at(tables: Any, path: str) -> Any:
    """What is at a path; None if there is nothing."""
    here = tables
    for key in path.split("."):
        if isinstance(here, dict):
            here = here.get(key)
        elif isinstance(here, list) and key.isdecimal() and int(key) < len(here):
            here = here[int(key)]
        else:
            return None
    return here


def _take(tables: Tables, path: str) -> None:
    """Take what is at a path out of the tables, if it is there."""
    above, _, key = path.rpartition(".")
    here = _at(tables, above) if above else tables
    if isinstance(here, dict):
        here.pop(key, None)
    elif isinstance(here, list) and int(key) < len(here):
        del here[int(key)]


def _another(name: str, taken: set[str]) -> str:
    """A name like another one that is not taken."""
    stem = name.rstrip("0123456789")
    return next(f"{stem}{i}" for i in range(1, len(taken) + 2) if f"{stem}{i}" not in taken)
