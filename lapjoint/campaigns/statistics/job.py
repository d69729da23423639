"""The job of statistics."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.campaigns.statistics.solve import Realised, rehearse, solve_realisation
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.campaigns.statistics.table import statistics_dataset
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class StatisticsJob(Job[Realisations, Realised]):
    """The work on statistics; its cells are the realisations."""

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Realised, None]:
        """The sums of a realisation."""
        return solve_realisation(self.spec, cell, solver, progress), None

    def rehearse(self, cell: int, solver: Solver) -> bool:
        """Compile the functions that workers need."""
        rehearse(self.spec, solver)
        return True

    def point(self, fields: Mapping[str, Any]) -> Realised:
        """The result of a realisation, from its attributes."""
        return Realised(**fields)

    def dataset(self, points: Mapping[int, Realised]) -> xr.Dataset:
        """The statistics of all realisations."""
        return statistics_dataset(self.spec, points)
