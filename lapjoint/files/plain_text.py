"""Plain text: a duration in words, and text from files and arguments, made harmless for who would obey a part of it.

A terminal obeys control sequences, and a spreadsheet computes formulas.  Titles and names come from files, which others
may have written.
"""

from __future__ import annotations

import re

_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?")
_FORMULA = re.compile(r"[\s\x00-\x1f]*[=+\-@]|[\t\r]")
"""Beginning of a text that spreadsheets compute: what they skip, then a sign that begins a formula."""


def escaped(text: str) -> str:
    """Text for a terminal: each character that is neither printable nor an end of line is written as its number.

    Parameters
    ----------
    text : str
        Any text, as ``a\\x1b[2Jb``.

    Returns
    -------
    str
        The text with a backslash, a letter and hexadecimal digits for each such character, as ``a\\\\x1b[2Jb``.
    """
    if text.isprintable():
        return text
    return "".join(sign if sign.isprintable() or sign in "\n\u00a0" else _number(sign) for sign in text)


def no_formula(cell: object) -> object:
    """A cell of a table that a spreadsheet does not compute.

    Parameters
    ----------
    cell : object
        Anything; numbers, and texts that are numbers, stay as they are.

    Returns
    -------
    object
        The cell; a text that spreadsheets take for a formula begins with an apostrophe.
    """
    if isinstance(cell, str) and _FORMULA.match(cell) and not _NUMBER.fullmatch(cell) and cell != "-":
        return f"'{cell}"
    return cell


def _number(sign: str) -> str:
    code = ord(sign)
    return f"\\x{code:02x}" if code < 0x100 else f"\\u{code:04x}" if code < 0x10000 else f"\\U{code:08x}"


def duration_text(seconds: float) -> str:
    """A duration for a person.

    Parameters
    ----------
    seconds : float
        s.

    Returns
    -------
    str
        As ``40 s``, ``12 min`` or ``3 h 20 min``.
    """
    if seconds < 100:
        return f"{seconds:.0f} s"
    minutes = round(seconds / 60)
    return f"{minutes} min" if minutes < 100 else f"{minutes // 60} h {minutes % 60} min"
