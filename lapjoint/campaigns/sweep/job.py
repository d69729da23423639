"""The job of a sweep."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection, Point
from lapjoint.campaigns.sweep.solve import solve_point
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.table import sweep_dataset
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class SweepJob(Job[Plan, Point]):
    """The work on a sweep: its cells are the points and their starts."""

    longest_batch: ClassVar[int] = 32
    """Largest number of independent cells in a batch, so that the last batches end at about the same time."""

    def chains(self) -> Iterable[tuple[int, ...]]:
        """The cells of each chain, in which each motion starts from the motion before it."""
        return self.spec.chains() if self.spec.chained else ()

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Point, PlainSection | None]:
        """The motion of a cell, and where the next cell of a chain starts."""
        return solve_point(self.spec, cell, solver, section)

    def point(self, fields: Mapping[str, Any]) -> Point:
        """A point from its attributes."""
        return Point(**fields)

    def dataset(self, points: Mapping[int, Point]) -> xr.Dataset:
        """The dataset of all points."""
        return sweep_dataset(self.spec, points)
