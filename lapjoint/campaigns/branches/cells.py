"""Cells of a search for branches: the parts of the search that workers can do at the same time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

from lapjoint.campaigns.branches.search import Part
from lapjoint.campaigns.branches.solve import follow_a_little
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.campaigns.point import PlainSection
from lapjoint.solver import Progress, Solver


@dataclass(frozen=True)
class Found:
    """The result of a part of a search."""

    result: dict[str, Any]
    """The values that `lapjoint.campaigns.branches.solve.solve_start` or `solve_branch` gives."""

    @property
    def message(self) -> str:
        """Why the part has no result; empty where the part has one."""
        return str(self.result.get("message", ""))


@dataclass
class Parts:
    """Independent parts of a search, as cells of a `lapjoint.campaigns.job.CellSolver`.

    While workers solve some parts, further parts are added.
    """

    spec: BranchSpec
    """The question of the search, at all values of the second parameter."""
    parts: Mapping[int, Part]
    """The parts that are not done, by the numbers of their cells.  Each change makes a new mapping, because the old one
    may be on its way to a worker."""
    size: int
    """Number of cells so far."""

    def more(self, parts: Sequence[Part]) -> list[int]:
        """Add parts, and return the numbers of their cells."""
        cells = list(range(self.size, self.size + len(parts)))
        self.parts = {**self.parts, **dict(zip(cells, parts, strict=True))}
        self.size += len(parts)
        return cells

    def done(self, cell: int) -> Part:
        """Remove a part that is done, by the number of its cell, and return the part."""
        part = self.parts[cell]
        self.parts = {other: one for other, one in self.parts.items() if other != cell}
        return part

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Found, None]:
        """Do a part.  See `lapjoint.campaigns.job.CellSolver.answer`."""
        return Found(self.parts[cell].solved(self.spec, progress)), None

    def point(self, fields: Mapping[str, Any]) -> Found:
        """The result of a part that is given up.  See `lapjoint.campaigns.job.CellSolver.point`."""
        return Found({"starts": [], "points": [], **fields})

    def rehearse(self, solver: Solver) -> None:
        """Compile the functions that workers need.  See `lapjoint.campaigns.job.Rehearses.rehearse`."""
        first = next(iter(self.parts.values()))
        spec = self.spec.at(first.value)
        if first.start is None:
            period_map = range_of(spec).resolution(spec.first).map(spec.first)
            period_map.march(period_map.initial(), 2)
        else:
            follow_a_little(spec, first.start)
