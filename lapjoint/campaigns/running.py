"""Runs a job: resumes what is done, gives the rest to workers, keeps the journal, and writes the dataset."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.batch import Batch, Solved, batches, batches_of, solve_batch, solver_of
from lapjoint.campaigns.dataset import read_result
from lapjoint.campaigns.job import CellSolver, Job, Rehearses, Spec
from lapjoint.campaigns.journal import CellJournal
from lapjoint.campaigns.pace import Pace
from lapjoint.campaigns.point import PlainSection
from lapjoint.campaigns.workers import Deliver, Workers, check_workers, work_here, work_in_processes, work_mapped
from lapjoint.errors import InputError
from lapjoint.files.netcdf import write_netcdf
from lapjoint.machine.processes import StandingPool, standing_pool
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr


def run_job(
    job: Job[Any, Any],
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """The dataset of a job, from `out` if the file holds it finished, else found by `solve_job`, with its arguments.

    With `force`, a finished file of another job is replaced; without, it is an InputError.
    """
    found = None if out is None else stored(job.spec, out, force=force)
    if found is not None:
        return found
    return solve_job(job, workers=workers, scheduler=scheduler, out=out, force=force, progress=progress)


def solve_job(
    job: Job[Any, Any],
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | None = None,
) -> xr.Dataset:
    """Run a job, and replace what is in `out`.

    If there is a journal of the job beside `out`, the job resumes from it; with `force`, a journal of another job is
    thrown away.  `workers` is a number of processes, -1 for all processors, or a function like `map`.  `scheduler` is
    the address of a dask scheduler, whose workers are used instead.  `progress` is called with the number of cells done
    and the number of all.

    InputError is raised if the job is not valid, the journal belongs to another job, or another process has it;
    OutputError, if the disk is full; SolverError, if the workers are lost; Interrupted, after Ctrl-C.  The messages of
    OutputError, SolverError and Interrupted say what is kept.
    """
    workers = check_workers(workers)
    job.check()
    if out is None:
        points: dict[int, Any] = {}
        _find_missing(job, points, None, workers, scheduler, progress)
        return job.dataset(points)
    journal = CellJournal(job, out, force=force)
    with journal.going():
        _find_missing(job, journal.points, journal, workers, scheduler, progress)
        dataset = job.dataset(journal.points)
        write_netcdf(dataset, out)
        journal.remove()
    return dataset


def stored(plan: Spec, out: str | Path, *, force: bool = False) -> xr.Dataset | None:
    """The finished dataset of a sweep, or of other work, if its file is there.

    Parameters
    ----------
    plan : Spec
        What is asked: `Plan`, `BasinPlan`, ...
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


def _find_missing(
    job: Job[Any, Any],
    points: dict[int, Any],
    journal: CellJournal | None,
    workers: Workers,
    scheduler: str | None,
    progress: Progress | None,
) -> None:
    """Find the answers that are missing in `points`, those of the journal if there is one, and keep them there."""

    def say(done: float = 0.0, total: float = 1.0) -> None:
        """Tell progress, with the part that is done of the cell under way."""
        if progress is not None and done < total:
            progress(len(points) + done / total if done else len(points), job.spec.size)

    pace = Pace(job.spec.noun)

    def deliver(solved: Solved) -> tuple[Batch, ...]:
        if journal is None:
            points.update(solved.points)
        else:
            journal.append(solved.points, solved.section)
        pace.take(solved.points.values(), job.spec.size - len(points))
        say()
        return ()

    say()
    sections: Mapping[int, PlainSection | None] = journal.sections if journal else {}
    first = (cell for cell in range(job.first_stage) if cell not in points)
    send(job, batches_of(first, 1), workers, scheduler, deliver, say)
    job = job.informed(points)
    length = job.longest_batch
    if isinstance(workers, int):
        length = max(1, min(length, job.spec.size // (4 * workers)))
    send(job, batches(job, points, sections, length), workers, scheduler, deliver, say)


def send(
    job: CellSolver,
    todo: list[Batch],
    workers: Workers | StandingPool,
    scheduler: str | None,
    deliver: Deliver,
    progress: Progress | None = None,
) -> None:
    """Send batches to the workers: processes, standing processes, a function like `map`, or the workers of a dask
    scheduler.

    `deliver` takes each `Solved`, in any sequence, and may give more batches.  If this process solves the cells,
    `progress` is called with the part of a cell that is done and the whole.
    """
    if not todo:
        return
    if scheduler is not None:
        from lapjoint.campaigns.cluster import work_on_cluster

        work_on_cluster(job, _after_first_cell(job, todo, deliver), scheduler, deliver)
    elif callable(workers):
        work_mapped(job, _after_first_cell(job, todo, deliver), workers, deliver)
    elif isinstance(workers, StandingPool):
        work_in_processes(job, _after_first_cell(job, todo, deliver), workers, deliver)
    elif workers > 1:
        with standing_pool(min(workers, len(todo))) as pool:
            work_in_processes(job, _after_first_cell(job, todo, deliver), pool, deliver)
    else:
        work_here(job, todo, deliver, progress)


def _after_first_cell(job: CellSolver, todo: list[Batch], deliver: Deliver) -> Iterator[Batch]:
    """Solve the first cell in this process, or rehearse it, and give the batches that are left for the workers.

    That makes numba compile the march and store the machine code on the disk.  The workers then load the machine code,
    instead of each compiling the same functions at the same time.
    """
    if isinstance(job, Rehearses):
        job.rehearse(solver_of(job.spec))
        yield from todo
        return
    solved = solve_batch(job, todo[0].first())
    more = deliver(solved)
    left = todo[0].after(1, solved.section)
    if left is not None:
        yield left
    yield from todo[1:]
    yield from more
