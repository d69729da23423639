"""Finds where starts end: from the problem to the dataset, by many workers, resumed from a journal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.basin_plan import EFFORT, BasinPlan, library_text
from lapjoint.campaigns.batch import Batch
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.journal import Journal
from lapjoint.campaigns.running import delivery, send, solve, stored
from lapjoint.campaigns.workers import Workers
from lapjoint.problem import Problem
from lapjoint.problem.plane import Plane
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr


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
    found = None if out is None else stored(plan, out, force=force)
    if found is not None:
        return found
    return solve_basins(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def solve_basins(
    plan: BasinPlan,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a plan, and replace what is in `out`; if there is a journal of the plan beside it, resume from that.

    Parameters
    ----------
    plan : BasinPlan
        The plan.
    workers : int or map-like callable
        Number of processes, -1 for all processors, or a function like `map`.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead.
    out : str or Path, optional
        File of the dataset.
    force : bool
        Whether the journal of something else may be thrown away.
    progress : callable, optional
        Called with the number of chunks of starts done and the number of all.

    Returns
    -------
    xarray.Dataset
        The dataset.

    Raises
    ------
    InputError
        If the plan is not valid, the journal belongs to something else, or another process works on it.
    OutputError
        If the disk is full; the message says how much is kept.
    SolverError
        If the workers are lost; the message says how much is kept.
    Interrupted
        After Ctrl-C; the message says how much is kept.
    """
    return solve(
        plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress, work=_scouts_first
    )


def _scouts_first(
    plan: BasinPlan,
    chunks: dict[int, Any],
    journal: Journal | None,
    workers: Workers,
    scheduler: str | None,
    progress: Progress | None,
) -> None:
    """Find the chunks that are missing, first the scouts, and keep them in `chunks` or in the journal."""
    deliver = delivery(plan, chunks, journal, progress)
    scouts = _batches((cell for cell in range(plan.values) if cell not in chunks), 1)
    if scouts:
        send(plan, scouts, workers, scheduler, deliver)
    known = replace(plan, libraries=tuple(library_text(chunks[value]) for value in range(plan.values)))
    left = [cell for cell in range(plan.values, plan.size) if cell not in chunks]
    parts = workers if isinstance(workers, int) else 1
    todo = _batches(left, max(1, min(plan.longest_batch, len(left) // (4 * parts))))
    if todo:
        send(known, todo, workers, scheduler, deliver)


def _batches(cells: Iterable[int], length: int) -> list[Batch]:
    """Batches of at most `length` cells."""
    left = list(cells)
    return [Batch(tuple(left[i : i + length])) for i in range(0, len(left), length)]
