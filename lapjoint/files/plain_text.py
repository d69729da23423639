"""Plain text: durations in words, and text from files and arguments made harmless to terminals and spreadsheets.

A terminal obeys control sequences, and a spreadsheet computes formulas.  Titles and names come from files, which others
may have written.
"""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_FORMULA = re.compile(r"[\s\x00-\x1f]*[=+\-@]|[\t\r]")
"""Beginning of a text that spreadsheets compute: signs that they skip, then one that begins a formula."""


def escaped(text: str) -> str:
    """Text for a terminal: characters other than printable ones and ends of lines are written like ``\\x1b``."""
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() or sign in "\n\u00a0" else _number(sign) for sign in text)


def no_formula(cell: object) -> object:
    """A cell of a table that no spreadsheet computes: a text that looks like a formula begins with an apostrophe."""
    if isinstance(cell, str) and _FORMULA.match(cell) and not _NUMBER.fullmatch(cell) and cell != "-":
        return f"'{cell}"
    return cell


def _number(sign: str) -> str:
    code = ord(sign)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def duration_text(seconds: float) -> str:
    """A duration, given in s, as ``40 s``, ``12 min`` or ``3 h 20 min``."""
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
