"""The workers of a campaign: this process, a pool of processes, or a function like `map` that the caller gives.

Each function takes a job and its batches, and delivers what is solved, in any sequence.
"""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Hashable, Iterable
from concurrent.futures import Future, wait
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from typing import Any

from lapjoint.campaigns.batch import BATCH_SECONDS, Solved, given_up, solve_batch
from lapjoint.campaigns.job import Batch, Job
from lapjoint.errors import InputError
from lapjoint.machine.processes import LOOK, StandingPool, first_finished, interrupts_held
from lapjoint.solver import Progress

Deliver = Callable[[Solved], Iterable[Batch]]
"""Takes the solved part of a batch, and returns new batches that it makes possible; the rest of the batch is not among
them."""
Mapper = Callable[[Callable[[Batch], Solved], Iterable[Batch]], Iterable[Solved]]
"""Maps a function over batches, as ``multiprocessing.Pool.imap_unordered`` does."""
Workers = int | Callable[..., Any]
"""Number of processes, -1 for all processors; or a `Mapper`."""
MOST_DEATHS = 3
"""Number of deaths of the process that solves a cell after which the cell is given up: one or two deaths may have other
causes, such as a lack of memory."""


def check_workers(workers: Workers) -> Workers:
    """The number of processes that is asked for, at least 1, or the function; InputError if it is neither."""
    if callable(workers):
        return workers
    if isinstance(workers, bool) or not isinstance(workers, int) or workers == 0 or workers < -1:
        raise InputError(f"workers = {workers!r}: must be a positive integer, -1 for all processors, or like map")
    return len(os.sched_getaffinity(0)) if workers == -1 else workers


def work_here(job: Job[Any, Any], batches: Iterable[Batch], deliver: Deliver, progress: Progress | None = None) -> None:
    """Solve all batches in this process, one after the other; `progress` is called as in `solve_batch`."""
    waiting = deque(batches)
    while waiting:
        solved = solve_batch(job, waiting.popleft(), progress)
        if solved.left is not None:
            waiting.appendleft(solved.left)
        waiting.extend(deliver(solved))


def work_mapped(job: Job[Any, Any], batches: Iterable[Batch], mapper: Mapper, deliver: Deliver) -> None:
    """Solve all batches by a function like `map`, in rounds: the rest of an unfinished batch is in the next round."""
    left = list(batches)
    while left:
        done, left = left, []
        for solved in mapper(partial(solve_batch, job), done):
            left += deliver(solved)
            if solved.left is not None:
                left.append(solved.left)


def work_in_processes(job: Job[Any, Any], batches: Iterable[Batch], pool: StandingPool, deliver: Deliver) -> None:
    """Solve all batches in a pool of processes, which stand idle afterwards; the work goes on when processes die.

    SolverError is raised if the processes do not start.
    """
    waiting = deque(batches)
    if waiting:
        _PoolWork(job, waiting, pool, deliver).work()


class _PoolWork:
    """The work on batches by a pool of processes, which is renewed when a process dies.

    A dead process breaks its whole pool, and nothing says which batch it was solving.  After a death, every batch that
    the pool had is therefore suspected.  The suspected batches are then solved cell by cell, with one cell in the pool
    at a time, so that the next death can only be due to this cell.  If `MOST_DEATHS` deaths are counted for a cell, and
    it was alone in the pool at the last of them, it is given up.

    A batch had been solved for at most about `BATCH_SECONDS` when its process died.  Cells are therefore solved alone
    for twice this time for each suspected batch.  Afterwards the rest of a batch waits with the others again.
    """

    def __init__(self, job: Job[Any, Any], waiting: deque[Batch], pool: StandingPool, deliver: Deliver) -> None:
        self._job, self._waiting, self._deliver, self._pool = job, waiting, deliver, pool
        self._suspected: deque[Batch] = deque()
        self._suspicion_ends = 0.0
        """Time of the monotonic clock, s."""
        self._submitted: dict[Future[Solved], Batch] = {}
        self._deaths: Counter[Hashable] = Counter()
        """Number of deaths, by the key of the first cell of the batch."""

    def work(self) -> None:
        """Go on until all batches are done."""
        while self._waiting or self._suspected or self._submitted:
            self._submit_next()
            if self._submitted:
                self._take_finished()

    def _take_finished(self) -> None:
        """Wait for batches that are finished; if the pool is broken, collect what it still gives, and recover."""
        try:
            lost = self._collect(first_finished(self._pool.pool, self._submitted))
            broken = bool(lost)
        except BrokenProcessPool:
            lost, broken = [], True
        if broken:
            lost += self._collect(wait(self._submitted, timeout=LOOK).done)
            lost += self._submitted.values()
            self._submitted.clear()
            self._recover(lost)

    def _submit_next(self) -> None:
        """Submit the next suspected batch once the pool is empty, or as many waiting batches as keep it busy."""
        if self._suspected:
            if not self._submitted:
                self._submit(self._suspected.popleft(), alone=True)
            return
        while self._waiting and len(self._submitted) < self._pool.workers + 1:
            if not self._submit(self._waiting.popleft()):
                break

    def _submit(self, batch: Batch, alone: bool = False) -> bool:
        """Submit a batch, or its first cell only if it is `alone`; False if the pool is broken and did not take it."""
        try:
            with interrupts_held():
                future = self._pool.pool.submit(solve_batch, self._job, batch.first() if alone else batch)
        except BrokenProcessPool:
            self._waiting.appendleft(batch)
            if not self._submitted:
                self._pool.end()
            return False
        self._submitted[future] = batch
        return True

    def _collect(self, finished: Iterable[Future[Solved]]) -> list[Batch]:
        """Deliver the batches that were solved; returns those that were lost with their process."""
        lost = []
        for future in finished:
            batch = self._submitted.pop(future)
            try:
                solved = future.result()
            except BrokenProcessPool:
                lost.append(batch)
                continue
            self._take(batch, solved)
        return lost

    def _take(self, batch: Batch, solved: Solved) -> None:
        """Deliver what was solved, and put what is left of the batch at the head of its queue."""
        self._waiting.extend(self._deliver(solved))
        left = batch.after(len(solved.points), solved.section)
        if left is not None:
            suspected = time.monotonic() < self._suspicion_ends
            (self._suspected if suspected else self._waiting).appendleft(left)

    def _recover(self, lost: list[Batch]) -> None:
        """Renew the pool after a death, and suspect the lost batches, or give up a cell that died too often alone."""
        self._suspicion_ends = time.monotonic() + len(lost) * 2 * BATCH_SECONDS
        self._pool.end()
        for batch in lost:
            cell = self._job.key(batch.cells[0])
            self._deaths[cell] += 1
            if len(lost) == 1 and self._deaths[cell] >= MOST_DEATHS:
                reason = f"the process that solved it died {self._deaths[cell]} times"
                self._take(batch, given_up(self._job, batch, reason))
            else:
                self._suspected.append(batch)
