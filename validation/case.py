"""What a validation case is: a name, a question, and an answer made of checks, tables and figures."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import Literal

from validation.verdict import Check, Criterion, Verdict

_NARROW = 300.0
"""Width, points, up to which a figure can be read on a narrow screen: that of the screen."""
Level = Literal["quick", "standard", "full"]
Say = Callable[[str], None]
"""Called with one line of progress."""


@dataclass(frozen=True)
class Table:
    """A table of the report."""

    title: str
    columns: tuple[str, ...]
    rows: tuple[tuple[str, ...], ...]
    grouped: bool = False
    """Whether rows that follow each other with the same first cell are shown as a group under that cell."""


@dataclass(frozen=True)
class Drawing:
    """A figure of the report, as an SVG element."""

    title: str
    svg: str
    narrow: str = ""
    """The same for narrow screens, where the figure would be too small to read; empty where it would not."""

    @property
    def scrolls(self) -> bool:
        """Whether the figure is too wide for narrow screens, and has no other drawing for them."""
        width = re.search(r'width="([\d.]+)pt"', self.svg)
        return not self.narrow and width is not None and float(width[1]) > _NARROW


@dataclass(frozen=True)
class CaseResult:
    """The answer of a case."""

    name: str
    title: str
    question: str
    """The question of the case, and the origin of its numbers: a paragraph."""
    checks: tuple[Check, ...] = ()
    criteria: tuple[Criterion, ...] = ()
    tables: tuple[Table, ...] = ()
    drawings: tuple[Drawing, ...] = ()
    notes: tuple[str, ...] = ()
    headline: str = ""
    """The finding of the case in a line, where the verdict alone does not state it."""
    seconds: float = field(default=0.0)
    answer: tuple[Table, ...] = ()
    """What the user of an own problem asked for, by both solvers: tables for the first page."""
    certificate: tuple[Table, ...] = ()
    """How each solver established the answer: tables for the first page."""
    assumed: tuple[str, ...] = ()
    """What this answer assumes beside the assumptions of the model, in sentences."""
    commands: tuple[str, ...] = ()
    """Arguments of ``lapjoint`` that print the answer again, with ``{problem}`` for the problem."""

    @property
    def items(self) -> tuple[Check | Criterion, ...]:
        """Checks and criteria together."""
        return (*self.checks, *self.criteria)

    @property
    def verdict(self) -> Verdict:
        """The worst verdict of checks and criteria: disagreement, then explanation, then agreement."""
        found = {item.verdict for item in self.items}
        for verdict in (Verdict.DISAGREE, Verdict.EXPLAINED):
            if verdict in found:
                return verdict
        return Verdict.AGREE


def number(value: float, digits: int = 6) -> str:
    """A number for a table.

    Parameters
    ----------
    value : float
        In any unit.
    digits : int
        Significant digits.

    Returns
    -------
    str
        Its shortest form with so many digits.
    """
    return f"{value:.{digits}g}"


def table(title: str, columns: Sequence[str], rows: Sequence[Sequence[object]], *, grouped: bool = False) -> Table:
    """A table from anything that can be written.

    Parameters
    ----------
    title : str
        What stands above the table.
    columns : sequence of str
        Heads of the columns, units included.
    rows : sequence of sequence
        Cells, as many in each row as there are columns; floats are written by `number`, all else by ``str``.
    grouped : bool
        Whether rows with the same first cell are shown as a group under that cell.

    Returns
    -------
    Table
        The table, written.
    """
    written = tuple(tuple(number(c) if isinstance(c, float) else str(c) for c in row) for row in rows)
    return Table(title, tuple(columns), written, grouped)
