"""Slips of the pen in a problem file: what was probably meant by a text that is no number, or no TOML."""

from __future__ import annotations

import re

_COMMA = re.compile(r"([+-]?\d+),(\d+(?:[eE][+-]?\d+)?)")
"""A number with a decimal comma."""
_INFINITE = re.compile(r"([+-]?)(?:infinity|infinite|infty|inf|rigid|fixed|∞)", re.IGNORECASE)
"""Words for an infinite stiffness."""
_VALUE = re.compile(r"\s*[\w.\"'-]+\s*=\s*([^#]*?)\s*(?:#.*)?")
"""A line of a file with a key and a value."""
_LIST = re.compile(r"\s*\[\s*([\w.-]+)\s*\]\s*(?:#.*)?")
"""A line of a file with the name of a table."""


def number_meant(text: str) -> str:
    """The end of a message on a text that is no number; empty if nothing is known of it."""
    comma, infinite = _COMMA.fullmatch(text.strip()), _INFINITE.fullmatch(text.strip())
    if comma:
        return f"; a point begins the fraction: {comma[1]}.{comma[2]}"
    if infinite:
        return f"; infinity is written {infinite[1]}inf, without quotes"
    try:
        float(text)
    except ValueError:
        return ""
    return "; leave out the quotes"


def line_meant(text: str, number: int, declared_twice: bool) -> str:
    """The end of a message on a TOML file with a fault in the line of a number, from 1; empty if nothing is known."""
    line = text.splitlines()[number - 1] if 0 < number <= text.count("\n") + 1 else ""
    table = _LIST.fullmatch(line)
    if declared_twice and table:
        return f"; above each entry of a list stands [[{table[1]}]]"
    value = _VALUE.fullmatch(line)
    meant = number_meant(value[1]) if value else ""
    return "" if meant.startswith("; leave") else meant.removesuffix(", without quotes")
