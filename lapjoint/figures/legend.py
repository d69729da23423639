"""Legends that fit above their axes, with any number of entries and any length of their names."""

from __future__ import annotations

from typing import Any

from lapjoint.figures.text import SMALL, apart, literal, shortened, width_of

HANDLE, BETWEEN = 2.0, 1.2
"""Width of the sample of a line, and distance between columns, divided by the size of the text."""
LINE = 1.5 * SMALL / 72.0
"""Height of a line of a legend, inches: 1.5 times the size of its text."""
_EM = SMALL / 72.0
_SAMPLE = (HANDLE + 0.8) * _EM
"""Width of the sample of a line, and of the space after it, inches."""


def legend_that_fits(
    handles: list[Any], labels: list[str], room: float, lines: int
) -> tuple[list[Any], list[str], int]:
    """Handles and shortened labels of a legend, and the number of columns that fit into the width `room`, inches.

    If the entries need more than `lines` lines, and more than two, the last entries are left out.  A last label with an
    empty handle then gives their number.
    """
    room -= 0.8 * _EM  # the legend's own margins
    labels = apart(labels, lambda label: shortened(label, room - _SAMPLE))
    kept = len(labels)
    columns, rows = _columns(labels, room)
    while rows > max(2, lines) and kept > 2:
        kept -= 1
        columns, rows = _columns([*labels[:kept], _more(labels, kept)], room)
    if kept < len(labels):
        handles, labels = [*handles[:kept], _nothing()], [*labels[:kept], _more(labels, kept)]
    return handles, [literal(label) for label in labels], columns


def _nothing() -> Any:
    from matplotlib.lines import Line2D

    return Line2D([], [], linestyle="")


def _more(labels: list[str], kept: int) -> str:
    return f"… {len(labels) - kept} more"


def _columns(labels: list[str], room: float) -> tuple[int, int]:
    """Numbers of columns and rows, with the fewest rows for which columns, filled one after the other, fit side by
    side."""
    widths = [_SAMPLE + width_of(label) for label in labels]
    for rows in range(1, len(widths)):
        columns = -(-len(widths) // rows)
        most, longer = divmod(len(widths), columns)  # the first columns have one row more
        ends = [(i + 1) * most + min(i + 1, longer) for i in range(columns)]
        taken = sum(max(widths[start:end]) for start, end in zip([0, *ends], ends, strict=False))
        if taken + (columns - 1) * BETWEEN * _EM <= room:
            return columns, most + (longer > 0)
    return 1, len(widths)
