"""Runs a job: resumes what is done, gives the rest to workers, keeps the journal, and writes the dataset."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypedDict

from lapjoint.campaigns.batch import Solved, solve_batch, solver_of
from lapjoint.campaigns.cluster import work_on_cluster
from lapjoint.campaigns.dataset import read_result
from lapjoint.campaigns.job import Answers, Batch, Job, Spec, Stage
from lapjoint.campaigns.journal import Journal
from lapjoint.campaigns.pace import Pace
from lapjoint.campaigns.workers import Deliver, Workers, check_workers, work_here, work_in_processes, work_mapped
from lapjoint.errors import InputError
from lapjoint.files.netcdf import write_netcdf
from lapjoint.machine.processes import StandingPool
from lapjoint.solver import Progress

if TYPE_CHECKING:
    import xarray as xr


class Running(TypedDict, total=False):
    """How a campaign is run: the keyword arguments that all campaigns share.

    The dataset depends neither on the workers nor on interruptions.  InputError is raised if an argument of the
    campaign is not valid, `out` holds something else, or another process works on it; OutputError, if the disk is full;
    SolverError, if the workers are lost; Interrupted, after Ctrl-C.  The messages of OutputError, SolverError and
    Interrupted say what is kept in the journal.
    """

    workers: Workers
    """Number of processes, 1 by default, -1 for all processors; or a function that maps a function over an iterable, as
    ``multiprocessing.Pool.imap_unordered`` does.  A script that asks for processes must do so below ``if __name__ ==
    "__main__"``."""
    scheduler: str | None
    """Address of a dask scheduler whose workers do the work instead, ``tcp://host:8786``."""
    out: str | Path | None
    """File of the dataset, as NetCDF.  Until the work is finished, a journal beside it keeps what is done, and the same
    call resumes.  A file that holds the finished dataset is read, and nothing is computed."""
    force: bool
    """Whether the result or the journal of other work in `out` may be thrown away."""
    progress: Progress | bool | None
    """True shows how far the work is, as the command line does: a bar on a terminal, lines elsewhere.  Or a function,
    called with the number of cells done (points, chunks of starts, branches, ...), and the number known of; where
    this process solves the cells of long motions and branches, also with the fraction of a cell under way."""


def run_job(
    job: Job[Any, Any],
    *,
    workers: Workers = 1,
    scheduler: str | None = None,
    out: str | Path | None = None,
    force: bool = False,
    progress: Progress | bool | None = None,
) -> xr.Dataset:
    """The dataset of a job, from `out` if the file holds it finished, else found; `Running` documents the arguments."""
    found = None if out is None else stored(job.spec, out, force=force)
    if found is not None:
        return found
    crew = Crew(check_workers(workers), scheduler)
    job.check()
    if out is None:
        with _told(job.spec, progress) as tell:
            return _solved(job, Answers(), crew, tell)
    journal = Journal(job, out, force=force)
    with journal.going():
        with _told(job.spec, progress) as tell:
            dataset = _solved(job, journal, crew, tell)
        write_netcdf(dataset, out)
        journal.remove()
    return dataset


@contextmanager
def _told(spec: Spec, progress: Progress | bool | None) -> Iterator[Progress | None]:
    """What is called with the progress of a campaign: the given function, or a display, as the command line has it."""
    if progress is not True:
        yield progress or None
        return
    from lapjoint.cli.progress import shown_points, shown_search  # rich is loaded for those who want it

    with (shown_search if spec.grows else shown_points)(spec.noun) as shown:
        yield shown


def stored(spec: Spec, out: str | Path, *, force: bool = False) -> xr.Dataset | None:
    """The finished dataset of a campaign from its file; None if there is no such file.

    A file that holds something else is an InputError, or None with `force`.
    """
    if not Path(out).exists():
        return None
    try:
        found = read_result(out, spec.noun)
    except InputError:
        if force:
            return None
        raise
    if found.attrs.get("fingerprint") == spec.fingerprint:
        return found
    if force:
        return None
    raise InputError(f"{out}: is the result of another {spec.noun}; choose another --out, or overwrite it with --force")


def _solved(job: Job[Any, Any], answers: Answers, crew: Crew, progress: Progress | None) -> xr.Dataset:
    """The dataset of a job, whose missing answers are found and kept."""
    pace = Pace(job.spec.noun)
    with crew.at_work():
        for stage in job.stages(answers, crew.processes):
            _solve(stage, answers, crew, pace, progress)
    return job.dataset(answers.points)


def _solve(stage: Stage, answers: Answers, crew: Crew, pace: Pace, progress: Progress | None) -> None:
    """Find the answers of a stage, and keep them."""

    def say(done: float = 0.0, total: float = 1.0) -> None:
        """Tell progress, with the part that is done of the cell under way."""
        if progress is not None and done < total:
            progress(len(answers.points) + done / total if done else len(answers.points), stage.size())

    def deliver(solved: Solved) -> list[Batch]:
        answers.append(solved.points, solved.section)
        pace.take(solved.points.values(), stage.size() - len(answers.points))
        say()
        return stage.more()

    say()
    if stage.batches:
        crew.solve(stage, deliver, say)


class Crew:
    """The workers of a campaign: processes, a function like `map`, or the workers of a dask scheduler."""

    def __init__(self, workers: Workers, scheduler: str | None) -> None:
        self._workers, self._scheduler = workers, scheduler
        self._pool: StandingPool | None = None

    @property
    def processes(self) -> int | None:
        """Number of processes; None where others do the work."""
        return self._workers if isinstance(self._workers, int) and self._scheduler is None else None

    @contextmanager
    def at_work(self) -> Iterator[None]:
        """A context for the work; the processes of the pool, which stand from stage to stage, end with it."""
        try:
            yield
        finally:
            self._end()

    def solve(self, stage: Stage, deliver: Deliver, progress: Progress) -> None:
        """Solve the batches of a stage.

        `deliver` takes each `Solved`, in any sequence, and may give more batches.  If this process solves the cells,
        `progress` is called with the part of a cell that is done and the whole.
        """
        job, workers = stage.job, self._workers
        if self.processes == 1:
            work_here(job, stage.batches, deliver, progress)
            return
        batches = _after_first_cell(stage, deliver)
        if self._scheduler is not None:
            work_on_cluster(job, batches, self._scheduler, deliver)
        elif callable(workers):
            work_mapped(job, batches, workers, deliver)
        else:
            count = workers if stage.all_workers else min(workers, len(stage.batches))
            work_in_processes(job, batches, self._standing(count), deliver)

    def _standing(self, count: int) -> StandingPool:
        """A pool of a number of processes: the pool of the stage before, if it has this number."""
        if self._pool is None or self._pool.workers != count:
            self._end()
            self._pool = StandingPool(count)
        return self._pool

    def _end(self) -> None:
        if self._pool is not None:
            self._pool.end()


def _after_first_cell(stage: Stage, deliver: Deliver) -> Iterator[Batch]:
    """Solve the first cell in this process, or rehearse it, and give the batches that are left for the workers.

    That makes numba compile the march and store the machine code on the disk.  The workers then load the machine code,
    instead of each compiling the same functions at the same time.
    """
    job, (first, *others) = stage.job, stage.batches
    if job.rehearse(first.cells[0], solver_of(job.spec)):
        yield from stage.batches
        return
    solved = solve_batch(job, first.first())
    more = deliver(solved)
    left = first.after(1, solved.section)
    if left is not None:
        yield left
    yield from others
    yield from more
