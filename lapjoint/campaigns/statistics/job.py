"""The job of statistics: each cell is a realisation, which is summarised by sums whose number does not grow with the
duration."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.campaigns.statistics.sampled import sampled_dataset
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.campaigns.statistics.table import Realised, statistics_dataset
from lapjoint.errors import SolverError
from lapjoint.solver import Progress, Solver
from lapjoint.summaries.measure import sums_of
from lapjoint.summaries.sums import Sums

if TYPE_CHECKING:
    import xarray as xr

REHEARSAL = 1e-3
"""Fraction of the duration that is marched to compile all functions before workers begin."""


@dataclass(frozen=True)
class StatisticsJob(Job[Realisations, Realised]):
    """The work on statistics; its cells are the realisations."""

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Realised, None]:
        """The sums of a realisation; `progress` is called with the time marched and the whole, s."""
        return solve_realisation(self.spec, cell, solver, progress), None

    def rehearse(self, cell: int, solver: Solver) -> bool:
        """March a small part of the duration, so that everything is compiled."""
        short = replace(self.spec.measure(solver), duration=REHEARSAL * self.spec.duration, settle=0.0, units=1)
        sums_of(short, solver, self.spec.problem_of(0))
        return True

    def plain(self, point: Realised) -> dict[str, Any]:
        """The result of a realisation as values that JSON can hold."""
        return {**vars(point), "sums": None if point.sums is None else point.sums.plain()}

    def point(self, fields: Mapping[str, Any]) -> Realised:
        """The result of a realisation, from its attributes."""
        sums = fields.get("sums")
        return Realised(**{**fields, "sums": None if sums is None else Sums.from_plain(sums)})

    def dataset(self, points: Mapping[int, Realised]) -> xr.Dataset:
        """The statistics of all realisations, together or of each sample."""
        samples = self.spec.samples
        if samples is None:
            return statistics_dataset(self.spec, points)
        return sampled_dataset(self.spec, samples, points)


def solve_realisation(spec: Realisations, cell: int, solver: Solver, progress: Progress | None = None) -> Realised:
    """The sums of a realisation, without bins if it is one of a sample."""
    try:
        sums = sums_of(spec.measure(solver, cell // spec.seeds), solver, spec.realisation(cell), progress)
        return Realised(sums if spec.samples is None else sums.without_bins())
    except SolverError as error:
        return Realised(message=str(error))
