"""Finds where starts end: from the problem to the dataset, by many workers, resumed from a journal."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.basins.spec import EFFORT, BasinPlan
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection
from lapjoint.campaigns.running import run_job, solve_job
from lapjoint.campaigns.workers import Workers
from lapjoint.problem import Problem
from lapjoint.problem.plane import Plane
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.basins.solve import ChunkEnds


@dataclass(frozen=True)
class BasinJob(Job[BasinPlan, "ChunkEnds"]):
    """The work on basins; its cells are chunks of starts, first the scouts.

    Modules that import scipy and numba are imported late, because `lapjoint.campaigns` is also imported for lighter
    work.
    """

    longest_batch: ClassVar[int] = 4
    libraries: tuple[str, ...] = ()
    """The library of motions of each problem, as `library_text` gives it; empty until the scouts are done."""

    def check(self) -> None:
        """Check the plan, and whether its first problem can be started as the plan says."""
        from lapjoint.campaigns.basins.solve import prepared

        super().check()
        prepared(self.spec, 0)

    @property
    def first_stage(self) -> int:
        """Number of the chunks of scouts, one for each problem."""
        return self.spec.values

    def informed(self, points: Mapping[int, ChunkEnds]) -> BasinJob:
        """The job that knows the motions that the scouts found."""
        from lapjoint.campaigns.basins.solve import library_text

        return replace(self, libraries=tuple(library_text(points[value]) for value in range(self.first_stage)))

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[ChunkEnds, None]:
        """Where the starts of a cell end."""
        from lapjoint.campaigns.basins.solve import NO_LIBRARY, solve_chunk

        library = NO_LIBRARY if cell < self.first_stage else self.libraries[self.spec.chunk(cell).value]
        return solve_chunk(self.spec, cell, library), None

    def point(self, fields: Mapping[str, Any]) -> ChunkEnds:
        """The ends of a chunk from their attributes."""
        from lapjoint.campaigns.basins.solve import ChunkEnds

        return ChunkEnds(**fields)

    def dataset(self, points: Mapping[int, ChunkEnds]) -> xr.Dataset:
        """The dataset of all chunks."""
        from lapjoint.campaigns.basins.table import basins_dataset

        return basins_dataset(self.spec, points)


def basins(
    problem: Problem,
    *,
    plane: str | None = None,
    grid: tuple[int, int] = (40, 40),
    ranges: tuple[tuple[float, float], tuple[float, float]] | None = None,
    energy: float | None = None,
    starts: int = 1000,
    seed: int = 0,
    over: Axis | None = None,
    effort: int = EFFORT,
    solver: str = "analytic",
    options: Mapping[str, Any] | None = None,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Find which motion each of many starts ends in.

    Starts are either the points of a grid in a plane, or random ones of bounded energy.  Each is bound to a certified
    motion, or said not to be; see `lapjoint.orbits.binding`.

    Parameters
    ----------
    problem : Problem
        The joint and its excitation; its initial state is what starts are counted from.
    plane : str, optional
        Two coordinates by which the initial state is moved, displacement z or velocity v at places, m:
        ``"z(2.5),v(2.5)"``.
    grid : tuple of int
        Number of values of each coordinate.
    ranges : tuple of tuple of float, optional
        First and last value of each coordinate, m or m/s; by default some times the size of base motion and gap.
    energy : float, optional
        Bound on the energy of random starts, J; they are drawn evenly from all of the solver's space below it.
    starts : int
        Number of random starts.
    seed : int
        Seed of the random starts.
    over : Axis, optional
        A number of the problem, and the values for which all this is done.
    effort : int
        Most periods of the excitation marched from a start; what has not settled after them is undecided.
    solver : str
        Entry-point name of the solver.
    options : mapping, optional
        Numerical options of the solver.
    workers : int or map-like callable
        Number of processes, -1 for all processors; or a function that maps a function over an iterable.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : str or Path, optional
        File of the dataset, as NetCDF.  Until it is finished, a journal beside it keeps what is done, and the same
        call resumes.
    force : bool
        Whether something else in `out` may be thrown away.
    progress : callable, optional
        Called with the number of chunks of starts done and the number of all.

    Returns
    -------
    xarray.Dataset
        The dataset; ``docs/basins.md`` lists its variables.  It depends neither on the number of workers nor on
        interruptions.

    Raises
    ------
    InputError
        If a parameter is not valid, `out` holds something else, or another process works on it.
    OutputError
        If the disk is full.
    Interrupted
        After Ctrl-C.
    """
    plan = BasinPlan(
        problem,
        solver,
        dict(options or {}),
        None if plane is None else Plane.from_text(plane),
        grid,
        ranges,
        energy,
        starts,
        seed,
        effort,
        over,
    )
    return run_job(BasinJob(plan), workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def solve_basins(
    plan: BasinPlan,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run the plan of basins, and replace what is in `out`.  See `basins` for the arguments.

    If there is a journal of the plan beside `out`, the search resumes from it; `force` concerns the journal of other
    work.
    """
    return solve_job(BasinJob(plan), workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)
