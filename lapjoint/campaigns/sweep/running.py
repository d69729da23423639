"""Runs a sweep from the problem and its axes to the dataset."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection, Point
from lapjoint.campaigns.running import run_job, solve_job
from lapjoint.campaigns.sweep.solve import solve_point
from lapjoint.campaigns.sweep.spec import Plan, Start
from lapjoint.campaigns.sweep.table import sweep_dataset
from lapjoint.campaigns.workers import Workers
from lapjoint.problem import Problem
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


def sweep(
    problem: Problem,
    axes: Iterable[Axis],
    *,
    solver: str = "analytic",
    options: Mapping[str, Any] | None = None,
    start: Start = "rest",
    starts: int = 1,
    seed: int = 0,
    sensitivity: bool = False,
    errors: bool = False,
    summary: Sequence[str] = (),
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find the steady states at every point of a grid of problems.

    Parameters
    ----------
    problem : Problem
        The problem that has all that the axes do not change.
    axes : iterable of Axis
        The numbers that are changed; `start` = "up" and "down" follow the first of them.
    solver : str
        Entry-point name of the solver.
    options : mapping, optional
        Numerical options of the solver.
    start : {"rest", "up", "down", "random"}
        Start of each motion: the problem's own initial state; the motion before it along the first axis, ascending or
        descending; or a random initial state.
    starts : int
        Number of starts at each point; with "rest", the starts after the first are random.
    seed : int
        Seed of the random initial states.
    sensitivity : bool
        Whether to measure how much deviations grew on the way to each motion; it takes about as long again.
    errors : bool
        Whether to estimate the numerical errors of the impulses; it takes less than as long again.
    summary : sequence of str
        Further numbers of each motion, of `lapjoint.summaries.of_orbit.SUMMARIES`, as ``stress_peak``, ``force_rms`` or
        ``contact_time``: variables of the dataset.
    workers : int or map-like callable
        Number of processes, -1 for all processors; or a function that maps a function over an iterable, as
        ``multiprocessing.Pool.imap_unordered`` does.  A script that asks for processes must do so below
        ``if __name__ == "__main__"``.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : str or Path, optional
        File of the dataset, as NetCDF.  Until the sweep is finished, a journal beside it keeps the points that are
        done, and the same call resumes the sweep.
    force : bool
        Whether another sweep in `out` may be thrown away.
    progress : callable, optional
        Called with the number of points done and the number of all.

    Returns
    -------
    xarray.Dataset
        The dataset; `lapjoint.campaigns.sweep.table` says how contacts are stored.  It depends neither on the number of
        workers nor on interruptions.

    Raises
    ------
    InputError
        If a parameter or a point is not valid, `out` holds another sweep, or another process works on it.
    OutputError
        If the disk is full.
    Interrupted
        After Ctrl-C.
    """
    grid, numerics = Grid(problem, tuple(axes)), dict(options or {})
    plan = Plan(grid, solver, numerics, start, starts, seed, sensitivity, errors, tuple(summary))
    return run(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def run(
    plan: Plan,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run the plan of a sweep, unless `out` holds its finished dataset already.  See `sweep` for the arguments."""
    return run_job(SweepJob(plan), workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def solve(
    plan: Plan,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run the plan of a sweep, and replace what is in `out`.  See `sweep` for the arguments.

    If there is a journal of the plan beside `out`, the sweep resumes from it; `force` concerns the journal of another
    sweep.
    """
    return solve_job(SweepJob(plan), workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)
