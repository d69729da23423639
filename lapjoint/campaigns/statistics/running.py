"""Runs statistics from the problem to the dataset."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.campaigns.running import run_job
from lapjoint.campaigns.statistics.solve import Realised, rehearse, solve_realisation
from lapjoint.campaigns.statistics.spec import Realisations, lasting
from lapjoint.campaigns.statistics.table import statistics_dataset
from lapjoint.campaigns.workers import Workers
from lapjoint.problem import Problem
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

    def rehearse(self, solver: Solver) -> None:
        """Compile the functions that workers need."""
        rehearse(self.spec, solver)

    def point(self, fields: Mapping[str, Any]) -> Realised:
        """The result of a realisation, from its attributes."""
        return Realised(**fields)

    def dataset(self, points: Mapping[int, Realised]) -> xr.Dataset:
        """The statistics of all realisations."""
        return statistics_dataset(self.spec, points)


def statistics(
    problem: Problem,
    solver: str = "analytic",
    *,
    duration: float | None = None,
    seeds: int = 1,
    options: Mapping[str, Any] | None = None,
    at: Sequence[float] | None = None,
    quantities: Sequence[str] | None = None,
    settle: float | None = None,
    rate: float | None = None,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Peaks, root mean squares, contacts and their distributions of a long motion, or of several realisations of one.

    Parameters
    ----------
    problem : Problem
        The joint.
    solver : str
        Entry-point name of the solver.
    duration : float, optional
        Of each motion, s, with what is left out at its start; by default that of the shortest record.
    seeds : int
        Number of realisations; more than one needs random excitation.
    options : mapping, optional
        Numerical options of the solver.
    at : sequence of float, optional
        Places, m; by default those of the stops and of the ends that no support fixes.
    quantities : sequence of str, optional
        Of `lapjoint.answers.quantities.QUANTITIES`; by default displacement, velocity, absolute acceleration, moment
        and, where the beam has a section, stress.
    settle : float, optional
        The start that is left out, s; by default seven decay times of the slowest mode.
    rate : float, optional
        Samples a second, Hz; by default sixteen in a period of the slowest mode.
    workers : int or map-like callable
        As for `sweep`.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : str or Path, optional
        File of the dataset, as NetCDF.  Until all is done, a journal beside it keeps the realisations that are done,
        and the same call resumes.
    force : bool
        Whether other statistics in `out` may be thrown away.
    progress : callable, optional
        Called with the number of realisations done and the number of all; in one process, where realisations come one
        after the other, also with parts of the one that is marched.

    Returns
    -------
    xarray.Dataset
        Values and their 95 % intervals; `lapjoint.summaries.table` lists the variables.  It depends neither on the
        workers nor on interruptions.

    Raises
    ------
    InputError
        If a parameter is not allowed, `out` holds something else, or another process works on it.
    OutputError
        If the disk is full.
    SolverError
        If no realisation came to its end.
    Interrupted
        After Ctrl-C.
    """
    spec = Realisations(
        problem,
        lasting(problem, duration),
        seeds,
        solver,
        dict(options or {}),
        None if at is None else tuple(float(x) for x in at),
        None if quantities is None else tuple(quantities),
        settle,
        rate,
    )
    return run_job(StatisticsJob(spec), workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)
