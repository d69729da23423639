"""Text in figures: names are drawn literally, with any characters, and shortened to the available width.

Widths are measured in matplotlib's font, because a W is four times as wide as an l.
"""

from __future__ import annotations

import math
import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, lru_cache
from typing import Any

SMALL = 7.0
"""Size of titles, legends and tick labels, points."""
_MOST_LINES = 4
"""Largest number of lines of a title; an ellipsis in the last line stands for further text."""
_DPI = 100.0
"""Resolution at which text is measured, dots per inch."""
_WIDER = 1.04
"""Factor by which text may be wider at another resolution, because the width of each letter is rounded to pixels."""
_BREAKS = "_/-.,:;"
"""Characters after which a word that is too long for a line may be broken."""


def literal(text: str) -> str:
    """Text that matplotlib draws literally: on one line, with dollar signs escaped so that no part is mathematics."""
    return plain(text).replace("$", r"\$")


def plain(text: str) -> str:
    """Text on one line, with a space for every run of white space and of characters that cannot be drawn."""
    drawn = "".join(sign if sign.isprintable() or sign == "\u00a0" else "\n" for sign in text)
    return re.sub("\n+", " ", drawn).strip(" ")


def error_text(error: float | None) -> str:
    """A numerical error in two digits; a question mark if no error can be stated, empty if no error was estimated."""
    if not error:
        return "" if error is None else "0"
    return f"{error:.1e}" if error < float("inf") else "?"


def hertz(angular_frequency: float) -> str:
    """An angular frequency, rad/s, in Hz, to four digits."""
    return f"{angular_frequency / (2 * math.pi):.4g}"


def frequency_text(angular_frequency: float) -> str:
    """An angular frequency, rad/s, in both units: ``190 rad/s (30.24 Hz)``."""
    return f"{angular_frequency:g} rad/s ({hertz(angular_frequency)} Hz)"


def legend_label(name: str) -> str:
    """A name with a thin space before a leading underscore: matplotlib leaves such names out of a legend."""
    return f"\u200a{name}" if name.startswith("_") else name


@lru_cache(maxsize=4096)
def width_of(text: str, size: float = SMALL) -> float:
    """The width, inches, of one line of text, drawn literally."""
    from matplotlib.font_manager import FontProperties

    with boxes_for_unknown_signs():
        width, _, _ = _renderer().get_text_width_height_descent(text, FontProperties(size=size), ismath=False)
    return _WIDER * float(width) / _DPI


@cache
def _renderer() -> Any:
    from matplotlib.backends.backend_agg import RendererAgg

    make: Any = RendererAgg
    return make(8, 8, _DPI)


@contextmanager
def boxes_for_unknown_signs() -> Iterator[None]:
    """Silence matplotlib's warning about characters that the font lacks: they are drawn as boxes, which are visible."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph \d+ .* missing from", category=UserWarning)
        yield


def shortened(text: str, room: float, size: float = SMALL) -> str:
    """Text on one line, with an ellipsis for its middle if it is wider than `room`, inches."""
    text = plain(text)
    if width_of(text, size) <= room:
        return text
    return _longest_cut(text, lambda cut: width_of(cut, size) <= room)


def cut_to(text: str, most: int) -> str:
    """Text on one line, with an ellipsis for its middle if it has more than `most` characters."""
    text = plain(text)
    return text if len(text) <= most else _longest_cut(text, lambda cut: len(cut) <= most)


def _longest_cut(text: str, fits: Callable[[str], bool]) -> str:
    """The text with its middle left out so that it just fits, by bisection; three fifths of the rest are from its
    start."""
    fewest, most = 1, len(text) - 1
    while fewest < most:
        middle = (fewest + most + 1) // 2
        fewest, most = (middle, most) if fits(_cut(text, middle)) else (fewest, middle - 1)
    return _cut(text, fewest)


def _cut(text: str, kept: int) -> str:
    last = 2 * kept // 5
    return f"{text[: kept - last].rstrip()}…{text[len(text) - last :].lstrip()}"


def apart(names: Sequence[str], shorten: Callable[[str], str]) -> list[str]:
    """Shorten names so that they remain different: names that would become equal get their numbers before them."""
    short = [shorten(name) for name in names]
    return [
        shorten(f"{i + 1}: {plain(name)}") if short.count(cut) > 1 and "…" in cut else cut
        for i, (name, cut) in enumerate(zip(names, short, strict=True))
    ]


def wrapped(text: str, room: float, size: float = SMALL) -> list[str]:
    """Lines of at most `room`, inches: at most a few for each line of the text, with an ellipsis for the rest."""
    return [line for part in text.splitlines() for line in _first(_filled(part, room, size), room, size)]


def _first(lines: list[str], room: float, size: float) -> list[str]:
    if len(lines) <= _MOST_LINES:
        return lines
    return [*lines[: _MOST_LINES - 1], shortened(" ".join(lines[_MOST_LINES - 1 :]), room, size)]


def _filled(text: str, room: float, size: float) -> list[str]:
    lines: list[str] = []
    line = ""
    for piece in _pieces(text, room, size):
        longer = (line + piece).lstrip()
        if line and width_of(longer.rstrip(), size) > room:
            lines.append(line.rstrip())
            longer = piece.lstrip()
        line = longer
    return [*lines, line.rstrip()] if line.strip() else lines


def _pieces(text: str, room: float, size: float) -> list[str]:
    """The pieces of which lines are composed, each with the space before it: words, or parts of words too wide.

    A word wider than `room`, inches, is split at non-breaking spaces, then after the characters `_BREAKS`, and finally
    anywhere.
    """
    pieces = [f" {word}" for word in plain(text).split(" ") if word]
    for between in ("(?=\u00a0)", f"(?<=[{re.escape(_BREAKS)}])"):
        wide = [[piece] if width_of(piece, size) <= room else re.split(between, piece) for piece in pieces]
        pieces = [part.replace("\u00a0", " ") if len(parts) > 1 else part for parts in wide for part in parts if part]
    return [part for piece in pieces for part in _forced(piece, room, size)]


def _forced(piece: str, room: float, size: float) -> list[str]:
    """The piece, broken at any character into parts that fit into `room`, inches."""
    parts = []
    while width_of(piece, size) > room and len(piece) > 1:
        end = max(1, next(n for n in range(1, len(piece) + 1) if width_of(piece[:n], size) > room) - 1)
        parts.append(piece[:end])
        piece = piece[end:]
    return [*parts, piece]
