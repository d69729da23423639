"""Finds where starts end: from the problem to the dataset, by many workers, resumed from a journal."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.basin_chunk import Chunk
from lapjoint.campaigns.basin_plan import EFFORT, BasinPlan, library_text
from lapjoint.campaigns.batch import Batch, Solved
from lapjoint.campaigns.grid import Axis
from lapjoint.campaigns.journal import Journal
from lapjoint.campaigns.running import resumable, send, stored
from lapjoint.campaigns.workers import Workers, check_workers
from lapjoint.problem import Problem
from lapjoint.problem.plane import Plane
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr

LONGEST_BATCH = 4
"""Largest number of chunks that are sent at once, so that all workers end at about the same time."""


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
    found = None if out is None else stored_basins(plan, out, force=force)
    if found is not None:
        return found
    return solve_basins(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def stored_basins(plan: BasinPlan, out: str | Path, *, force: bool = False) -> xr.Dataset | None:
    """The finished dataset of a plan, if its file is there.

    Parameters
    ----------
    plan : BasinPlan
        The plan.
    out : str or Path
        File of the dataset.
    force : bool
        Whether the file may be something else, to be thrown away.

    Returns
    -------
    xarray.Dataset or None
        The dataset; None if there is no such file, or it is something else that may be thrown away.

    Raises
    ------
    InputError
        If the file is something else, and may not be thrown away.
    """
    from lapjoint.campaigns.basin_dataset import read_basins

    return stored(plan, out, force=force, read=read_basins)


def check_basins(plan: BasinPlan) -> None:
    """Check everything that can be checked before any work.

    Parameters
    ----------
    plan : BasinPlan
        The plan.

    Raises
    ------
    InputError
        If the solver does not take its options, or the starts, or a value has no valid problem.
    """
    from lapjoint.campaigns.basin_solving import period_map_of, prepared

    if plan.grid is not None:
        plan.grid.check()
    if plan.plane is not None:
        plan.plane.check(plan.problem)
    period_map_of(plan.solver, dict(plan.options), plan.problem_at(0))
    prepared(plan, 0, "[]")


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
    from lapjoint.campaigns.basin_dataset import write_basins

    workers = check_workers(workers)
    check_basins(plan)
    if out is None:
        found: dict[int, Chunk] = {}
        _work(plan, found, None, workers, scheduler, progress)
        return _dataset(plan, found)
    journal = Journal(plan, out, force=force)
    with resumable(journal):
        _work(plan, journal.points, journal, workers, scheduler, progress)
        dataset = _dataset(plan, journal.points)
        write_basins(dataset, out)
        journal.remove()
    return dataset


def _dataset(plan: BasinPlan, chunks: Mapping[int, Chunk]) -> xr.Dataset:
    """The dataset, when all chunks are done."""
    from lapjoint.campaigns.basin_dataset import dataset_of_basins
    from lapjoint.campaigns.basin_table import branches_of, table_of

    tables = []
    for value in range(plan.values):
        first = plan.values + value * plan.chunks
        own = [chunks[cell] for cell in range(first, first + plan.chunks)]
        tables.append(table_of(plan, value, chunks[value], own))
    return dataset_of_basins(plan, tables, None if plan.over is None else branches_of(plan, tables))


def _work(
    plan: BasinPlan,
    chunks: dict[int, Chunk],
    journal: Journal | None,
    workers: Workers,
    scheduler: str | None,
    progress: Progress | None,
) -> None:
    """Find the chunks that are missing, first the scouts, and keep them in `chunks` or in the journal."""

    def deliver(solved: Solved) -> None:
        if journal is None:
            chunks.update(solved.points)
        else:
            journal.append(solved.points, solved.section)
        if progress is not None:
            progress(len(chunks), plan.size)

    if progress is not None:
        progress(len(chunks), plan.size)
    scouts = _batches((cell for cell in range(plan.values) if cell not in chunks), 1)
    if scouts:
        send(plan, scouts, workers, scheduler, deliver)
    known = replace(plan, libraries=tuple(library_text(chunks[value]) for value in range(plan.values)))
    left = [cell for cell in range(plan.values, plan.size) if cell not in chunks]
    parts = workers if isinstance(workers, int) else 1
    todo = _batches(left, max(1, min(LONGEST_BATCH, len(left) // (4 * parts))))
    if todo:
        send(known, todo, workers, scheduler, deliver)


def _batches(cells: Iterable[int], length: int) -> list[Batch]:
    """Batches of at most `length` cells."""
    left = list(cells)
    return [Batch(tuple(left[i : i + length])) for i in range(0, len(left), length)]
