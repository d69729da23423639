"""Single values of a problem changed by assignments, as the command line's ``--set`` takes them."""

from __future__ import annotations

import re
import tomllib
from functools import lru_cache
from typing import Any

from lapjoint.errors import InputError
from lapjoint.problem.messages import shortened

LONGEST_INDEX = 18
"""Largest number of digits of an index: no list has more elements, and Python refuses to read some thousand digits."""
_PATHS = 256
"""Number of paths whose keys are cached: about the paths of one campaign."""
DEEPEST = 20
"""Largest number of keys of a path; no field of a problem lies deeper than five."""
_OTHER_UNIT = {"frequency": "angular_frequency", "angular_frequency": "frequency"}
"""Keys of which a table has one, since they are one number in two units: setting one takes the other away."""


def override(tables: dict[str, Any], assignment: str) -> None:
    """Set one value of a problem's tables, in place, by an assignment such as ``base_motion.angular_frequency=820``.

    An element of a list is given by its number from 0 (``stops.0.gap`` or ``stops[0].gap``), a stop or a mass also by
    its name (``stops.P2.gap``), and all elements by ``*``. The value is TOML, in SI units; a bare word is text.
    """
    path, equals, value = assignment.partition("=")
    source = f"--set {shortened(assignment)}"
    if not equals or not path_keys(path):
        raise InputError(f"{source}: must be key=value, as in base_motion.angular_frequency=820")
    assign(tables, path, toml_value(value), source)


def assign(tables: dict[str, Any], path: str, value: Any, source: str) -> None:
    """Set the value at a path, as `override` takes it, in place; messages begin with `source`."""
    keys = path_keys(path)
    if len(keys) > DEEPEST:
        raise InputError(f"{source}: is {len(keys)} keys deep; a problem is at most {DEEPEST}")
    _assign(tables, keys, value, source)


def targets(tables: dict[str, Any], path: str, source: str) -> list[tuple[str, Any]]:
    """The single values to which a path leads, each as its own path without ``*`` and names, and the value there, which
    is None where a table lacks the key; messages begin with `source`."""
    found: list[tuple[tuple[str, ...], Any]] = [((), tables)]
    for key in path_keys(path):
        below: list[tuple[tuple[str, ...], Any]] = []
        for keys, part in found:
            if part is None and key == "*":
                continue
            if isinstance(part, dict) or part is None:
                below.append(((*keys, key), (part or {}).get(key)))
            else:
                below += [((*keys, str(i)), part[i]) for i in _indices(part, key, source)]
        found = below
    return [(".".join(keys), value) for keys, value in found]


@lru_cache(maxsize=_PATHS)
def path_keys(path: str) -> tuple[str, ...]:
    """The keys of a path, from the outermost to the innermost: ``stops``, ``0``, ``gap`` of ``stops[0].gap``."""
    return tuple(key for key in re.split(r"[.\[\]]+", path.strip()) if key)


def toml_value(text: str) -> Any:
    """The value of a TOML expression such as ``820`` or ``[0.01, 0.02]``; any other text is taken as text."""
    try:
        tables = tomllib.loads(f"value = {text.strip()}")
    except (ValueError, RecursionError):
        return text.strip()
    return tables["value"] if set(tables) == {"value"} else text.strip()


def _assign(here: Any, keys: tuple[str, ...], value: Any, source: str) -> None:
    """Set the value in all parts to which the keys lead."""
    parts = [here]
    for key in keys[:-1]:
        parts = [below for part in parts for below in _below(part, key, source)]
    for part in parts:
        if isinstance(part, dict):
            part.pop(_OTHER_UNIT.get(keys[-1], ""), None)
            part[keys[-1]] = value
        else:
            for index in _indices(part, keys[-1], source):
                part[index] = value


def _below(part: Any, key: str, source: str) -> list[Any]:
    """The parts to which a key leads; an empty table is added where a table lacks the key."""
    if isinstance(part, dict):
        return [part.setdefault(key, {})]
    return [part[index] for index in _indices(part, key, source)]


def _indices(items: Any, key: str, source: str) -> list[int]:
    """The indices of the elements of a list that a key names."""
    if not isinstance(items, list):
        raise InputError(f"{source}: {shortened(key)!r} is below a single value, and cannot be set")
    if key == "*":
        return list(range(len(items)))
    if key.isdecimal() and len(key) <= LONGEST_INDEX and int(key) < len(items):
        return [int(key)]
    named = [i for i, item in enumerate(items) if isinstance(item, dict) and item.get("name") == key]
    if not named:
        raise InputError(
            f"{source}: there is no element {shortened(key)!r}; allowed are 0 to {len(items) - 1}, a name, or *"
            if items
            else f"{source}: there is no element {shortened(key)!r}; the list is empty"
        )
    return named
