"""A pool of processes that ends at Ctrl-C, after an error, and with the process that made it.

The processes of the pool ignore Ctrl-C, which a terminal sends to them, too: only the parent answers it.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
import threading
from collections.abc import Collection, Iterator
from concurrent.futures import FIRST_COMPLETED, Future, ProcessPoolExecutor, wait
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager
from multiprocessing.connection import wait as ready_of
from multiprocessing.synchronize import Barrier
from typing import Any, TypeVar

from lapjoint.errors import SolverError

T = TypeVar("T")

LOOK = 1.0
"""Time between two looks for dead processes of a pool while no task is finished, s: seldom enough to cost nothing."""
PATIENCE = 5.0
"""Time within which the thread of a pool notices that its processes have ended, however busy the machine is, s."""
MOST_STARTS = 3
"""Number of times that a pool is started if its processes die at once; one death may be chance."""


@contextmanager
def process_pool(workers: int) -> Iterator[ProcessPoolExecutor]:
    """A pool of processes, known to start, for the time of a block; if the block raises, they end at once."""
    pool = new_pool(workers)
    try:
        yield pool
    finally:
        end_pool(pool)


class StandingPool:
    """A pool of some processes that is kept from task to task, and made again when one of them dies."""

    def __init__(self, workers: int) -> None:
        self.workers = workers
        self._pool: ProcessPoolExecutor | None = None

    @property
    def pool(self) -> ProcessPoolExecutor:
        """The pool, whose processes start when it is first asked for; a `SolverError` if they do not."""
        if self._pool is None:
            self._pool = new_pool(self.workers)
        return self._pool

    def end(self) -> None:
        """End its processes at once, whatever they are doing; it starts others when it is asked for again."""
        if self._pool is not None:
            end_pool(self._pool)
        self._pool = None


@contextmanager
def standing_pool(workers: int) -> Iterator[StandingPool]:
    """A `StandingPool` for the time of a block; its processes end at once when the block ends."""
    pool = StandingPool(workers)
    try:
        yield pool
    finally:
        pool.end()


def new_pool(workers: int) -> ProcessPoolExecutor:
    """A pool whose processes are known to start, anew and deaf to Ctrl-C, else a `SolverError`; `end_pool` ends it."""
    context = multiprocessing.get_context("spawn")
    for _ in range(MOST_STARTS):
        pool = ProcessPoolExecutor(workers, context, _begin, (context.Barrier(workers),))
        try:
            with interrupts_held():  # a process starts when a task finds none idle, and none is before all have started
                ready = {pool.submit(_ready) for _ in range(workers)}
            while ready:
                for one in (done := first_finished(pool, ready)):
                    one.result()
                ready -= done
        except BrokenProcessPool:
            end_pool(pool)
        except BaseException:
            end_pool(pool)
            raise
        else:
            return pool
    raise SolverError(
        "the worker processes end as soon as they start; a script that asks for workers must do so below "
        'if __name__ == "__main__", as each of them imports it'
    )


def first_finished(pool: ProcessPoolExecutor, tasks: Collection[Future[T]]) -> set[Future[T]]:
    """Wait until one or more tasks of a pool are finished, be it with an error, and return them.

    A `BrokenProcessPool` says that none is, and a process of the pool is dead. A pool that breaks at the moment when it
    takes a task forgets the task, and one whose process dies while it sends an answer waits for the rest of it: neither
    ever finishes its tasks.
    """
    processes = [process.sentinel for process in (pool._processes or {}).values()]
    while True:
        dead = bool(ready_of(processes, timeout=0))
        finished = wait(tasks, timeout=LOOK, return_when=FIRST_COMPLETED).done
        if finished:
            return finished
        if dead:
            raise BrokenProcessPool("a process died, and the pool did not notice")


def end_pool(pool: ProcessPoolExecutor) -> None:
    """End the processes of a pool at once, whatever they are doing; it cannot be used afterwards."""
    processes = list((pool._processes or {}).values())
    answers: Any = pool._result_queue
    manager: threading.Thread | None = pool._executor_manager_thread  # type: ignore[assignment]  # the stubs are wrong
    pool.shutdown(wait=False, cancel_futures=True)  # first: the pool's thread trips over tasks that are cancelled later
    for process in processes:
        process.terminate()
    if manager is not None:
        manager.join(PATIENCE)
        answers._writer.close()  # the last way into it, should its thread wait for the rest of an answer that was cut
        manager.join()


@contextmanager
def interrupts_held() -> Iterator[None]:
    """Block Ctrl-C while processes are started: they inherit the block, and the parent gets Ctrl-C afterwards."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def _begin(all_started: Barrier) -> None:
    """In a new process of a pool: `end_with_parent`, and wait for the other processes."""
    end_with_parent()
    all_started.wait()


def end_with_parent() -> None:
    """In a new process: leave Ctrl-C to the parent, and end with the parent however the parent ends."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    parent = multiprocessing.parent_process()
    assert parent is not None

    def end() -> None:
        parent.join()
        os._exit(1)

    threading.Thread(target=end, daemon=True).start()


def _ready() -> None:
    """Do nothing: a process that comes to this has started."""
