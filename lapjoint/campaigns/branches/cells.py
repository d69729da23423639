"""The parts of searches for branches that can be done at the same time, as cells that workers solve."""

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
    """What a part came to."""

    result: dict[str, Any]
    """As `lapjoint.campaigns.branches.solve.solve_start` or `solve_branch` gives it."""

    @property
    def message(self) -> str:
        """Why there is nothing; empty where there is something."""
        return str(self.result.get("message", ""))


@dataclass
class Parts:
    """Parts of the work that do not depend on each other: `lapjoint.campaigns.job.CellSolver`.

    Others come to them while workers solve some.
    """

    spec: BranchSpec
    """What is asked, at all values of the second parameter."""
    parts: Mapping[int, Part]
    """The parts that are not done, by the numbers of their cells; never changed, but replaced by another mapping, as a
    worker may be about to be sent it."""
    size: int
    """Number of cells so far."""

    def more(self, parts: Sequence[Part]) -> list[int]:
        """Take further parts.

        Parameters
        ----------
        parts : sequence of Part
            The parts.

        Returns
        -------
        list of int
            The numbers of their cells.
        """
        cells = list(range(self.size, self.size + len(parts)))
        self.parts = {**self.parts, **dict(zip(cells, parts, strict=True))}
        self.size += len(parts)
        return cells

    def done(self, cell: int) -> Part:
        """Forget a part that is done.

        Parameters
        ----------
        cell : int
            Number of its cell.

        Returns
        -------
        Part
            The part.
        """
        part = self.parts[cell]
        self.parts = {other: one for other, one in self.parts.items() if other != cell}
        return part

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Found, None]:
        """Do a part. See `lapjoint.campaigns.job.CellSolver.answer`."""
        return Found(self.parts[cell].solved(self.spec, progress)), None

    def point(self, fields: Mapping[str, Any]) -> Found:
        """A part that is given up. See `lapjoint.campaigns.job.CellSolver.point`."""
        return Found({"starts": [], "points": [], **fields})

    def rehearse(self, solver: Solver) -> None:
        """Have what workers need compiled. See `lapjoint.campaigns.job.Rehearses.rehearse`."""
        first = next(iter(self.parts.values()))
        spec = self.spec.at(first.value)
        if first.start is None:
            period_map = range_of(spec).resolution(spec.first).map(spec.first)
            period_map.march(period_map.initial(), 2)
        else:
            follow_a_little(spec, first.start)
