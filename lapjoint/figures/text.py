"""Words in figures: names as they were given, whatever signs are in them, and no wider than the room there is.

Widths are measured in matplotlib's own font, for a W is four times as wide as an l.
"""

from __future__ import annotations

import re
import warnings
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from functools import cache, lru_cache
from typing import Any

SMALL = 7.0
"""Size of the words above axes, of keys and of tick labels, points."""
_MOST_LINES = 4
"""Of a title; the last has an ellipsis where it goes on."""
_DPI, _SPREAD = 100.0, 1.04
"""Where text is measured, and how much wider it can be at another resolution, which rounds each letter's width."""
_BREAKS = "_/-.,:;"
"""After these a word may go on in the next line, where it is too long for one."""


def literal(text: str) -> str:
    """The text for matplotlib to draw as it is: in one line, and no part of it as mathematics."""
    return plain(text).replace("$", r"\$")


def plain(text: str) -> str:
    """The text in one line: a space for every run of white space and signs that cannot be drawn."""
    drawn = "".join(sign if sign.isprintable() or sign == "\u00a0" else "\n" for sign in text)
    return re.sub("\n+", " ", drawn).strip(" ")


def key(name: str) -> str:
    """A name for a key: matplotlib leaves out those that begin with an underscore, so that a thin space goes before."""
    return f"\u200a{name}" if name.startswith("_") else name


@lru_cache(maxsize=4096)
def width_of(text: str, size: float = SMALL) -> float:
    """Width of a line of text, inches; what is between dollar signs is no mathematics here."""
    from matplotlib.font_manager import FontProperties

    with boxes_for_unknown_signs():
        width, _, _ = _renderer().get_text_width_height_descent(text, FontProperties(size=size), ismath=False)
    return _SPREAD * float(width) / _DPI


@cache
def _renderer() -> Any:
    from matplotlib.backends.backend_agg import RendererAgg

    make: Any = RendererAgg
    return make(8, 8, _DPI)


@contextmanager
def boxes_for_unknown_signs() -> Iterator[None]:
    """Signs that the font has not are drawn as boxes, which anyone sees, without a warning on the console."""
    with warnings.catch_warnings():
        warnings.filterwarnings("ignore", message=r"Glyph \d+ .* missing from", category=UserWarning)
        yield


def shortened(text: str, room: float, size: float = SMALL) -> str:
    """The text in one line, with an ellipsis for its middle if it is wider than `room`, inches."""
    text = plain(text)
    if width_of(text, size) <= room:
        return text
    return _longest_cut(text, lambda cut: width_of(cut, size) <= room)


def cut_to(text: str, most: int) -> str:
    """The text in one line, with an ellipsis for its middle if it has more than `most` characters."""
    text = plain(text)
    return text if len(text) <= most else _longest_cut(text, lambda cut: len(cut) <= most)


def _longest_cut(text: str, fits: Callable[[str], bool]) -> str:
    """As many characters from both ends as fit, by bisection; three fifths of them from the start."""
    fewest, most = 1, len(text) - 1
    while fewest < most:
        middle = (fewest + most + 1) // 2
        fewest, most = (middle, most) if fits(_cut(text, middle)) else (fewest, middle - 1)
    return _cut(text, fewest)


def _cut(text: str, kept: int) -> str:
    last = 2 * kept // 5
    return f"{text[: kept - last].rstrip()}…{text[len(text) - last :].lstrip()}"


def apart(names: Sequence[str], shorten: Callable[[str], str]) -> list[str]:
    """The names shortened; where two of them became one, with their numbers before them."""
    short = [shorten(name) for name in names]
    return [
        shorten(f"{i + 1}: {plain(name)}") if short.count(cut) > 1 and "…" in cut else cut
        for i, (name, cut) in enumerate(zip(names, short, strict=True))
    ]


def wrapped(text: str, room: float, size: float = SMALL) -> list[str]:
    """The text in lines no wider than `room`, inches; each of its own lines goes on in a few more at most."""
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
    """What lines are made of, with the spaces before: words; of wide words their parts; of wide parts what fits.

    The parts are those between fixed spaces, else those that end with an underscore, a hyphen and the like.
    """
    pieces = [f" {word}" for word in plain(text).split(" ") if word]
    for between in ("(?=\u00a0)", f"(?<=[{re.escape(_BREAKS)}])"):
        wide = [[piece] if width_of(piece, size) <= room else re.split(between, piece) for piece in pieces]
        pieces = [part.replace("\u00a0", " ") if len(parts) > 1 else part for parts in wide for part in parts if part]
    return [part for piece in pieces for part in _forced(piece, room, size)]


def _forced(piece: str, room: float, size: float) -> list[str]:
    """The piece in parts that fit, broken anywhere."""
    parts = []
    while width_of(piece, size) > room and len(piece) > 1:
        end = max(1, next(n for n in range(1, len(piece) + 1) if width_of(piece[:n], size) > room) - 1)
        parts.append(piece[:end])
        piece = piece[end:]
    return [*parts, piece]
