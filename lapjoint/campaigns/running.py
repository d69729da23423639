"""Runs a campaign from its plan to its dataset: resumes what is done, gives the rest to workers, keeps the journal."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.batch import after, batches, solve_batch, solver_of
from lapjoint.campaigns.campaign import Campaign, Cells, Kept, Rehearses
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.campaigns.journal import Journal
from lapjoint.campaigns.pace import Pace
from lapjoint.campaigns.plan import Plan, Start
from lapjoint.campaigns.workers import Deliver, Workers, check_workers, work_here, work_in_processes, work_mapped
from lapjoint.errors import InputError
from lapjoint.files.netcdf import write_netcdf
from lapjoint.machine.processes import StandingPool, standing_pool
from lapjoint.problem import Problem
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.batch import Batch, Solved


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
        The dataset; `lapjoint.campaigns.dataset` says how contacts are stored.  It depends neither on the number of
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
    plan: Campaign,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a plan, unless `out` holds its finished dataset already.

    Parameters
    ----------
    plan : Campaign
        The work.
    workers : int or map-like callable
        Number of processes, -1 for all processors, or a function like `map`, as for `sweep`.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead.
    out : str or Path, optional
        File of the dataset.
    force : bool
        Whether another sweep in `out` may be thrown away.
    progress : callable, optional
        Called with the number of points done and the number of all.

    Returns
    -------
    xarray.Dataset
        The dataset.

    Raises
    ------
    InputError
        If the plan is not valid, `out` holds another sweep, or another process works on it.
    OutputError
        If the disk is full.
    Interrupted
        After Ctrl-C.
    """
    found = None if out is None else stored(plan, out, force=force)
    if found is not None:
        return found
    return solve(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def solve(
    plan: Campaign,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
    work: Callable[..., None] | None = None,
) -> xr.Dataset:
    """Run a plan, and replace what is in `out`.

    If there is a journal of the plan beside `out`, the sweep resumes from it; `force` concerns the journal of another
    sweep.

    Parameters
    ----------
    plan : Campaign
        The work.
    workers : int or map-like callable
        Number of processes, -1 for all processors, or a function like `map`, as for `sweep`.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead.
    out : str or Path, optional
        File of the dataset.
    force : bool
        Whether the journal of another sweep may be thrown away.
    progress : callable, optional
        Called with the number of points done and the number of all.
    work : callable, optional
        Finds the cells that are missing, as `all_cells` does, which is the default.

    Returns
    -------
    xarray.Dataset
        The dataset.

    Raises
    ------
    InputError
        If the plan is not valid, the journal belongs to another sweep, or another process works on it.
    OutputError
        If the disk is full; the message says how many points are kept.
    SolverError
        If the workers are lost; the message says how many points are kept.
    Interrupted
        After Ctrl-C; the message says how many points are kept.
    """
    workers, work = check_workers(workers), work or all_cells
    plan.check()
    if out is None:
        points: dict[int, Any] = {}
        work(plan, points, None, workers, scheduler, progress)
        return plan.dataset(points)
    journal = Journal(plan, out, force=force)
    with journal.going():
        work(plan, journal.points, journal, workers, scheduler, progress)
        dataset = plan.dataset(journal.points)
        write_netcdf(dataset, out)
        journal.remove()
    return dataset


def stored(plan: Kept, out: str | Path, *, force: bool = False) -> xr.Dataset | None:
    """The finished dataset of a sweep, or of other work, if its file is there.

    Parameters
    ----------
    plan : Kept
        The work.
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
    from lapjoint.campaigns.dataset import read_result

    if not Path(out).exists():
        return None
    try:
        found = read_result(out, plan.noun)
    except InputError:
        if force:
            return None
        raise
    if found.attrs.get("fingerprint") == plan.fingerprint:
        return found
    if force:
        return None
    raise InputError(f"{out}: is the result of another {plan.noun}; choose another --out, or overwrite it with --force")


def delivery(plan: Campaign, points: dict[int, Any], journal: Journal | None, progress: Progress | None) -> Deliver:
    """What takes batches when they are solved; it says at once how much is done already.

    Parameters
    ----------
    plan : Campaign
        The work.
    points : dict of int to answer
        What is done, by the number of the cell; takes what is found.
    journal : Journal, or None
        Keeps what is found, in `points` too.
    progress : callable, or None
        Called with the number of cells done and the number of all.

    Returns
    -------
    callable
        Takes a batch.
    """

    def say() -> None:
        if progress is not None:
            progress(len(points), plan.size)

    pace = Pace(plan.noun)

    def deliver(solved: Solved) -> tuple[Batch, ...]:
        if journal is None:
            points.update(solved.points)
        else:
            journal.append(solved.points, solved.section)
        pace.take(solved.points.values(), plan.size - len(points))
        say()
        return ()

    say()
    return deliver


def all_cells(
    plan: Campaign,
    points: dict[int, Any],
    journal: Journal | None,
    workers: Workers,
    scheduler: str | None,
    progress: Progress | None,
) -> None:
    """Find the answers that are missing.

    Parameters
    ----------
    plan : Campaign
        The work.
    points : dict of int to answer
        What is done, by the number of the cell; takes what is found.
    journal : Journal, or None
        Keeps what is found, in `points` too.
    workers : int or map-like callable
        Number of processes, or a function like `map`.
    scheduler : str, or None
        Address of a dask scheduler whose workers do it instead.
    progress : callable, or None
        Called with the number of cells done and the number of all.
    """

    def part_of_a_cell(done: float, total: float) -> None:
        if progress is not None and done < total:
            progress(len(points) + done / total, plan.size)

    deliver = delivery(plan, points, journal, progress)
    length = plan.longest_batch
    if isinstance(workers, int):
        length = max(1, min(length, plan.size // (4 * workers)))
    todo = list(batches(plan, set(points), journal.sections if journal else {}, length))
    if todo:
        send(plan, todo, workers, scheduler, deliver, part_of_a_cell)


def send(
    plan: Cells,
    todo: list[Batch],
    workers: Workers | StandingPool,
    scheduler: str | None,
    deliver: Deliver,
    progress: Progress | None = None,
) -> None:
    """Send batches to the workers.

    Parameters
    ----------
    plan : Cells
        The work.
    todo : list of Batch
        What is to be done of it, at least one batch.
    workers : int, StandingPool or map-like callable
        Number of processes, or processes that stand, or a function like `map`.
    scheduler : str, or None
        Address of a dask scheduler whose workers do it instead.
    deliver : callable
        Takes each `Solved`, in any sequence, and may give more batches.
    progress : callable, optional
        Called now and then with how much of a cell is done and the whole, where this process solves them.
    """
    if scheduler is not None:
        from lapjoint.campaigns.cluster import work_on_cluster

        work_on_cluster(plan, _after_first_cell(plan, todo, deliver), scheduler, deliver)
    elif callable(workers):
        work_mapped(plan, _after_first_cell(plan, todo, deliver), workers, deliver)
    elif isinstance(workers, StandingPool):
        work_in_processes(plan, _after_first_cell(plan, todo, deliver), workers, deliver)
    elif workers > 1:
        with standing_pool(min(workers, len(todo))) as pool:
            work_in_processes(plan, _after_first_cell(plan, todo, deliver), pool, deliver)
    else:
        work_here(plan, todo, deliver, progress)


def _after_first_cell(plan: Cells, todo: list[Batch], deliver: Deliver) -> Iterator[Batch]:
    """Solve the first cell in this process, or rehearse it, and give the batches that are left for the workers.

    That makes numba compile the march and store the machine code on the disk.  The workers then load it, instead of
    each compiling the same functions at the same time.
    """
    if isinstance(plan, Rehearses):
        plan.rehearse(solver_of(plan))
        yield from todo
        return
    solved = solve_batch(plan, todo[0].first())
    more = deliver(solved)
    left = after(todo[0], 1, solved.section)
    if left is not None:
        yield left
    yield from todo[1:]
    yield from more
