"""Single values of a problem changed by assignments, as the command line's ``--set`` takes them."""

from __future__ import annotations

import re
import tomllib
from typing import Any

from lapjoint.errors import InputError


def override(tables: dict[str, Any], assignment: str) -> None:
    """Set one value of a problem's tables, in place, as in ``base_motion.angular_frequency=820``.

    An element of a list is given by number from 0 (``stops.0.gap`` or ``stops[0].gap``), a stop also by name
    (``stops.P2.gap``), and all of them by ``*``.  The value is TOML; a bare word is text.

    Parameters
    ----------
    tables : dict
        The tables of a problem; they are changed.
    assignment : str
        Path and value, ``path=value``; numbers in SI units.

    Raises
    ------
    InputError
        If the assignment cannot be read, or names an element that is not there.
    """
    path, equals, value = assignment.partition("=")
    if not equals or not path_keys(path):
        raise InputError(f"--set {assignment}: must be key=value, as in base_motion.angular_frequency=820")
    assign(tables, path, toml_value(value), f"--set {assignment}")


def assign(tables: dict[str, Any], path: str, value: Any, source: str) -> None:
    """Set the value at a path of a problem's tables, in place.

    Parameters
    ----------
    tables : dict
        The tables of a problem; they are changed.
    path : str
        As in `override`.
    value : object
        As a TOML file holds it: a number, text, list or table; numbers in SI units.
    source : str
        What asks for this; messages begin with it.

    Raises
    ------
    InputError
        If the path names an element that is not there.
    """
    _assign(tables, path_keys(path), value, source)


def path_keys(path: str) -> list[str]:
    """The keys of a path, from the outermost to the innermost.

    Parameters
    ----------
    path : str
        As ``stops[0].gap`` or ``stops.0.gap``.

    Returns
    -------
    list of str
        As ``stops``, ``0``, ``gap``.
    """
    return [key for key in re.split(r"[.\[\]]+", path.strip()) if key]


def toml_value(text: str) -> Any:
    """A value given as TOML; what is no TOML value is text.

    Parameters
    ----------
    text : str
        As ``820``, ``[0.01, 0.02]``, ``true`` or ``top``.

    Returns
    -------
    object
        A number, truth value, text, list or table.
    """
    try:
        tables = tomllib.loads(f"value = {text.strip()}")
    except (ValueError, RecursionError):
        return text.strip()
    return tables["value"] if set(tables) == {"value"} else text.strip()


def _assign(here: Any, keys: list[str], value: Any, source: str) -> None:
    key, rest = keys[0], keys[1:]
    if isinstance(here, dict):
        if rest:
            _assign(here.setdefault(key, {}), rest, value, source)
        else:
            here[key] = value
    elif isinstance(here, list):
        for index in _indices(here, key, source):
            if rest:
                _assign(here[index], rest, value, source)
            else:
                here[index] = value
    else:
        raise InputError(f"{source}: {key!r} is below a single value, and cannot be set")


def _indices(items: list[Any], key: str, source: str) -> list[int]:
    if key == "*":
        return list(range(len(items)))
    if key.isdecimal() and int(key) < len(items):
        return [int(key)]
    named = [i for i, item in enumerate(items) if isinstance(item, dict) and item.get("name") == key]
    if not named:
        raise InputError(
            f"{source}: there is no element {key!r}; allowed are 0 to {len(items) - 1}, a name, or *"
            if items
            else f"{source}: there is no element {key!r}; the list is empty"
        )
    return named
