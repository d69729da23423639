"""A sweep from its plan to its dataset: what is done already, who does the rest, and what an interruption leaves."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.batch import after, batches, solve_batch
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.campaigns.journal import Journal
from lapjoint.campaigns.plan import Plan, Start
from lapjoint.campaigns.point import Point
from lapjoint.campaigns.workers import Deliver, Workers, check_workers, work_here, work_in_processes, work_mapped
from lapjoint.errors import InputError, Interrupted, OutputError
from lapjoint.problem import Problem
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr

    from lapjoint.campaigns.batch import Batch, Solved

LONGEST_BATCH = 32


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
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Steady states at every point of a grid of problems.

    Parameters
    ----------
    problem : Problem
        What is the same at all points.
    axes : iterable of Axis
        What is changed; the first is followed by `start` = "up" and "down".
    solver : str
        Entry-point name of the solver.
    options : mapping, optional
        Its numerical options.
    start : {"rest", "up", "down", "random"}
        Where each motion starts from: the problem's own initial state; the motion before it along the first
        axis, ascending or descending; random initial states.
    starts : int
        Number of starts at each point; with "rest", those after the first are random.
    seed : int
        Seed of the random initial states.
    sensitivity : bool
        Whether to measure how much deviations grew on the way to each motion; it takes about as long again.
    workers : int or map-like callable
        Number of processes, -1 for all processors; or what maps a function over an iterable, as
        ``multiprocessing.Pool.imap_unordered`` does.  A script that asks for processes must do so below
        ``if __name__ == "__main__"``.
    scheduler : str, optional
        Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``.
    out : path, optional
        Where the dataset is written, as NetCDF; while it is not finished, a journal beside it keeps what is
        done, and the same call resumes.
    force : bool
        Whether another sweep in `out` may be thrown away.
    progress : callable, optional
        Called with (points done, points in all).

    Returns
    -------
    xarray.Dataset
        See `lapjoint.campaigns.dataset`.  It does not depend on the number of workers, or on interruptions.

    Raises
    ------
    InputError
        If a parameter or a point is not valid, `out` holds another sweep, or another process is at work on it.
    OutputError
        If the disk is full.
    Interrupted
        After Ctrl-C.
    """
    plan = Plan(Grid(problem, tuple(axes)), solver, dict(options or {}), start, starts, seed, sensitivity)
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
    """Do what a plan asks for, unless `out` holds it already; see `sweep`."""
    found = None if out is None else stored(plan, out, force=force)
    if found is not None:
        return found
    return solve(plan, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def solve(
    plan: Plan,
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Do what a plan asks for, and replace what is in `out`; see `sweep`.

    A journal beside `out` is gone on with; `force` is about that of another sweep.
    """
    from lapjoint.campaigns.dataset import dataset_of, write_curve

    workers = check_workers(workers)
    plan.check()
    if out is None:
        points: dict[int, Point] = {}
        _work(plan, points, None, workers, scheduler, progress)
        return dataset_of(plan, points)
    journal = Journal(plan, out, force=force)
    try:
        _work(plan, journal.points, journal, workers, scheduler, progress)
        dataset = dataset_of(plan, journal.points)
        write_curve(dataset, out)
        journal.remove()
    except OutputError as error:
        raise OutputError(f"{error}; {journal.kept()}") from None
    except KeyboardInterrupt:
        raise Interrupted(f"interrupted: {journal.kept()}") from None
    finally:
        journal.close()
    return dataset


def stored(plan: Plan, out: str | Path, *, force: bool = False) -> xr.Dataset | None:
    """The dataset of this sweep if it is in `out`, finished; None if there is no such file.

    Raises
    ------
    InputError
        If the file is something else, and may not be thrown away.
    """
    from lapjoint.campaigns.dataset import read_curve

    if not Path(out).exists():
        return None
    try:
        found = read_curve(out)
    except InputError:
        if force:
            return None
        raise
    if found.attrs.get("fingerprint") == plan.fingerprint:
        return found
    if force:
        return None
    raise InputError(f"{out}: is the result of another sweep; choose another --out, or overwrite it with --force")


def _work(
    plan: Plan,
    points: dict[int, Point],
    journal: Journal | None,
    workers: Workers,
    scheduler: str | None,
    progress: Progress | None,
) -> None:
    """Find the points that are missing."""

    def deliver(solved: Solved) -> None:
        if journal is None:
            points.update(solved.points)
        else:
            journal.append(solved.points, solved.section)
        if progress is not None:
            progress(len(points), plan.size)

    if progress is not None:
        progress(len(points), plan.size)
    length = LONGEST_BATCH
    if isinstance(workers, int):
        length = max(1, min(length, plan.size // (4 * workers)))
    todo = list(batches(plan, set(points), journal.sections if journal else {}, length))
    if todo:
        _send(plan, todo, workers, scheduler, deliver)


def _send(plan: Plan, todo: list[Batch], workers: Workers, scheduler: str | None, deliver: Deliver) -> None:
    """Send the batches to who does the work."""
    if scheduler is not None:
        from lapjoint.campaigns.cluster import work_on_cluster

        work_on_cluster(plan, _begun(plan, todo, deliver), scheduler, deliver)
    elif callable(workers):
        work_mapped(plan, _begun(plan, todo, deliver), workers, deliver)
    elif workers > 1:
        work_in_processes(plan, _begun(plan, todo, deliver), workers, deliver)
    else:
        work_here(plan, todo, deliver)


def _begun(plan: Plan, todo: list[Batch], deliver: Deliver) -> Iterator[Batch]:
    """Solve the first cell here, and give what is left: what that compiles, the workers find compiled."""
    solved = solve_batch(plan, todo[0].first())
    deliver(solved)
    left = after(todo[0], 1, solved.section)
    if left is not None:
        yield left
    yield from todo[1:]
