"""Who does the work of a sweep: this process, processes of its own, or whatever the caller maps with.

Each function takes a plan and its batches, and delivers what is solved, in any order.
"""

from __future__ import annotations

import os
import time
from collections import Counter, deque
from collections.abc import Callable, Iterable
from concurrent.futures import FIRST_COMPLETED, Future, wait
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from typing import Any

from lapjoint.campaigns.batch import BATCH_SECONDS, Batch, Solved, after, solve_batch
from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.point import Point
from lapjoint.errors import InputError
from lapjoint.processes import end_pool, interrupts_held, new_pool

Deliver = Callable[[Solved], None]
Mapper = Callable[[Callable[[Batch], Solved], Iterable[Batch]], Iterable[Solved]]
Workers = int | Callable[..., Any]
MOST_DEATHS = 3
"""A point at which so many processes died is given up."""


def check_workers(workers: Workers) -> Workers:
    """The number of processes, -1 standing for all processors; or the map-like callable as it is.

    Raises
    ------
    InputError
        If it is neither.
    """
    if callable(workers):
        return workers
    if isinstance(workers, bool) or not isinstance(workers, int) or workers == 0 or workers < -1:
        raise InputError(f"workers = {workers!r}: must be a positive integer, -1 for all processors, or like map")
    return len(os.sched_getaffinity(0)) if workers == -1 else workers


def work_here(plan: Plan, batches: Iterable[Batch], deliver: Deliver) -> None:
    """Solve all batches in this process."""
    for batch in batches:
        left: Batch | None = batch
        while left is not None:
            solved = solve_batch(plan, left)
            deliver(solved)
            left = solved.left


def work_mapped(plan: Plan, batches: Iterable[Batch], mapper: Mapper, deliver: Deliver) -> None:
    """Solve all batches with a callable like `map`, in rounds: what a batch leaves undone is in the next."""
    left = list(batches)
    while left:
        done, left = left, []
        for solved in mapper(partial(solve_batch, plan), done):
            deliver(solved)
            if solved.left is not None:
                left.append(solved.left)


def given_up(batch: Batch, reason: str) -> Solved:
    """A batch whose first cell is given up."""
    return Solved({batch.cells[0]: Point(message=reason)}, batch.section, after(batch, 1, batch.section))


def work_in_processes(plan: Plan, batches: Iterable[Batch], workers: int, deliver: Deliver) -> None:
    """Solve all batches in processes, whose death is survived."""
    waiting = deque(batches)
    if not waiting:
        return
    crew = _Crew(plan, waiting, workers, deliver)
    try:
        crew.work()
    finally:
        crew.end()


class _Crew:
    """A pool of processes, renewed when one dies, and the batches that wait or are with it.

    A dead process breaks the whole pool, and does not say whose batch it had: all that were in flight are
    suspects then.  A suspect flies alone, one cell at a time, for longer than it can have flown before.
    """

    def __init__(self, plan: Plan, waiting: deque[Batch], workers: int, deliver: Deliver) -> None:
        self._plan, self._waiting, self._deliver = plan, waiting, deliver
        self._workers = min(workers, len(waiting))
        self._suspects: deque[Batch] = deque()
        self._cleared_at = 0.0
        self._flying: dict[Future[Solved], Batch] = {}
        self._deaths: Counter[int] = Counter()
        self._pool = new_pool(self._workers)

    def work(self) -> None:
        """Go on until all batches are done."""
        while self._waiting or self._suspects or self._flying:
            self._launch()
            landed, _ = wait(self._flying, return_when=FIRST_COMPLETED)
            lost = self._land(landed)
            if lost:
                lost += self._land(wait(self._flying).done)
                self._bury(lost)

    def end(self) -> None:
        """End the processes at once, whatever they are doing."""
        end_pool(self._pool)

    def _launch(self) -> None:
        if self._suspects:
            if not self._flying:
                self._fly(self._suspects.popleft(), alone=True)
            return
        while self._waiting and len(self._flying) < self._workers + 1:
            if not self._fly(self._waiting.popleft()):
                break

    def _fly(self, batch: Batch, alone: bool = False) -> bool:
        """Whether the pool took a batch; it does not once it is broken."""
        try:
            with interrupts_held():
                future = self._pool.submit(solve_batch, self._plan, batch.first() if alone else batch)
        except BrokenProcessPool:
            self._waiting.appendleft(batch)
            if not self._flying:
                self._renew()
            return False
        self._flying[future] = batch
        return True

    def _land(self, landed: Iterable[Future[Solved]]) -> list[Batch]:
        """Deliver what has come back; returns the batches that were lost."""
        lost = []
        for future in landed:
            batch = self._flying.pop(future)
            try:
                solved = future.result()
            except BrokenProcessPool:
                lost.append(batch)
                continue
            self._done(batch, solved)
        return lost

    def _done(self, batch: Batch, solved: Solved) -> None:
        self._deliver(solved)
        left = after(batch, len(solved.points), solved.section)
        if left is not None:
            suspect = time.monotonic() < self._cleared_at
            (self._suspects if suspect else self._waiting).appendleft(left)

    def _bury(self, lost: list[Batch]) -> None:
        """Start anew after a death; a cell that was alone and died too often is given up."""
        self._cleared_at = time.monotonic() + len(lost) * 2 * BATCH_SECONDS
        self._renew()
        for batch in lost:
            cell = batch.cells[0]
            self._deaths[cell] += 1
            if len(lost) == 1 and self._deaths[cell] >= MOST_DEATHS:
                self._done(batch, given_up(batch, f"the process that solved it died {self._deaths[cell]} times"))
            else:
                self._suspects.append(batch)

    def _renew(self) -> None:
        end_pool(self._pool)
        self._pool = new_pool(self._workers)
