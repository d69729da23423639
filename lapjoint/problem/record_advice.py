"""The keys with which a CSV file could be read that was refused: found by reading its beginning with other keys."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from itertools import islice, product
from typing import Any

from lapjoint.problem.messages import shown
from lapjoint.problem.record_files import DELIMITERS, UnreadableError, cells_of, columns_of, file_lines, number_in
from lapjoint.problem.record_units import names_a_unit
from lapjoint.problem.samples import Source

_LOOKED_AT = 500
"""Number of lines at the beginning of a file that other keys are tried on: headings of loggers have up to a hundred."""


_LONGEST = 10_000
"""Most characters of a line that other keys are tried on, so that a message takes no time."""


def advice(source: Source) -> str:
    """The end of a message on a file that cannot be read: the fewest keys that make its beginning readable.

    It is empty where none do, or several sets of as few keys, which would give different numbers.
    """
    lines = list(islice(file_lines(source), _LOOKED_AT))
    if any(len(line) > _LONGEST for _, line in lines):
        return ""
    found: list[str] = []
    fewest = 4
    for decimal, delimiter in product(".,", DELIMITERS):
        keys = _keys(source, lines, decimal, delimiter) if decimal != delimiter else {}
        text = " and ".join(", ".join(f"{key} = {shown(value)}" for key, value in keys.items()).rsplit(", ", 1))
        if keys and len(keys) <= fewest and text not in found:
            found, fewest = [*found, text] if len(keys) == fewest else [text], len(keys)
    return f"; {found[0]} would read it" if len(found) == 1 else ""


def _keys(source: Source, lines: list[tuple[int, str]], decimal: str, delimiter: str) -> dict[str, Any]:
    """The keys to change so that the samples in the last of the lines can be read; empty if they cannot be."""
    for numbered in ({}, _numbers_of_columns(source, lines, delimiter)):
        skips = list(_skips(source, lines, decimal, delimiter))
        for skip in sorted(skips, key=lambda skip: skip != source.skip):  # that of the problem first, if it is one
            for own in (source.delimiter, delimiter):  # a delimiter that is found out by default is not named
                changed: dict[str, Any] = {"skip": skip, "decimal": decimal, "delimiter": own, **numbered}
                if own != decimal and _readable(source._replace(**changed), lines):
                    return {key: value for key, value in changed.items() if value != getattr(source, key)}
    return {}


def _numbers_of_columns(source: Source, lines: list[tuple[int, str]], delimiter: str) -> dict[str, int]:
    """Numbers in place of the names of columns, for samples that have no names right above them."""
    rows = [cells_of(line, delimiter) for _, line in lines]
    found: dict[str, int] = {}
    for key in ("column", "time_column"):
        name = getattr(source, key)
        at = [row.index(name) + 1 for row in rows if isinstance(name, str) and name in row]
        found |= {key: at[-1]} if at else {}
    return found


def _readable(source: Source, lines: list[tuple[int, str]]) -> bool:
    try:
        return len(columns_of(source, lines).lines) > 1
    except (UnreadableError, ValueError):
        return False


def _skips(source: Source, lines: list[tuple[int, str]], decimal: str, delimiter: str) -> Iterator[int]:
    """Numbers of lines to leave out, so that the samples in the last lines follow, the likeliest first: above names and
    units, above names, and above the samples."""
    kept = [(i, cells_of(line, delimiter)) for i, line in lines if line.strip() and not source.passes_over(line)]
    first = len(kept)
    while first and len(kept[first - 1][1]) == len(kept[-1][1]) and _samples(kept[first - 1][1], decimal):
        first -= 1
    if len(kept) - first < 2:
        return
    if first > 1 and any(names_a_unit(cell) for cell in kept[first - 1][1]):
        yield kept[first - 2][0] - 1
    if first:
        yield kept[first - 1][0] - 1
    yield kept[first][0] - 1


def _samples(cells: Sequence[str], decimal: str) -> bool:
    """Whether fields are those of a line of samples: numbers, one at least, times of day, and empty ones."""
    numbers = [number_in(cell, decimal) is not None for cell in cells]
    return any(numbers) and all(number or not cell or ":" in cell for number, cell in zip(numbers, cells, strict=True))
