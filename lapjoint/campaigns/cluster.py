"""The work of a campaign on a dask cluster, which goes on when workers die."""

from __future__ import annotations

import logging
import queue
import time
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from typing import Any, TypeVar

from lapjoint.campaigns.batch import Solved, given_up, solve_batch
from lapjoint.campaigns.job import Batch, Job
from lapjoint.campaigns.workers import Deliver
from lapjoint.errors import InputError, SolverError

REACHED = 15.0
"""Time within which a scheduler must answer, s: enough for a slow network, and short if the address is wrong."""
PATIENCE = 60.0
"""Time within which a scheduler must have its first worker, s: the workers of a batch system start late."""
ALONE = 40.0
"""Time after which a scheduler without workers is given up, s; a nanny starts a new worker after a few seconds."""
LOOK = 5.0
"""Time between two looks at the workers, while nothing is finished, s."""
T = TypeVar("T")


def work_on_cluster(job: Job[Any, Any], batches: Iterable[Batch], scheduler: str, deliver: Deliver) -> None:
    """Solve all batches on the workers of the dask scheduler at an address, as ``tcp://host:8786``.

    Dask sends a batch whose worker died to another worker, a few times.  If all of them die, the batch is sent again
    cell by cell, and the cell whose workers die is given up.  InputError is raised if dask.distributed is not
    installed, or there is no scheduler with a worker at the address; SolverError, if the scheduler is lost, or all its
    workers are, and none comes back within `ALONE`.
    """
    with _quiet():
        client = connected(scheduler)
        try:
            _work(client, job, batches, deliver)
        except (CancelledError, OSError) as error:
            if not _lost(client, error):
                raise
            raise SolverError(f"scheduler = {scheduler!r}: the connection to it was lost") from None
        finally:
            client.close()


def _lost(client: Any, error: BaseException) -> bool:
    """Whether an error came from a lost connection, and not from the code that takes the answers."""
    from distributed.comm import CommClosedError

    return client.status != "running" or isinstance(error, CancelledError | CommClosedError)


@contextmanager
def _quiet() -> Iterator[None]:
    """Silence the log of dask, which prints tracebacks when connections end; whatever matters raises an error."""
    with suppress(ImportError):  # it sets the levels of its loggers
        import distributed  # noqa: F401

    names = [name for name in logging.root.manager.loggerDict if name.split(".")[0] in ("distributed", "tornado")]
    logs = [logging.getLogger(name) for name in (*names, "asyncio")]
    levels = [log.level for log in logs]
    for log in logs:
        log.setLevel(logging.CRITICAL + 1)
    try:
        yield
    finally:
        for log, level in zip(logs, levels, strict=True):
            log.setLevel(level)


def connected(scheduler: str) -> Any:
    """A client of a scheduler that has a worker, to be closed by the caller.

    InputError is raised if dask.distributed is not installed, the scheduler does not answer within `REACHED`, or it has
    no worker within `PATIENCE`.
    """
    import asyncio  # slow, and needed here alone

    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            f"scheduler = {scheduler!r}: needs the package distributed; install it with pip install 'lapjoint[cluster]'"
        ) from None
    try:
        with ThreadPoolExecutor(1) as aside:  # this thread may have a loop already, as notebooks do
            aside.submit(asyncio.run, _answer(scheduler)).result()
        client = Client(scheduler, timeout=REACHED, set_as_default=False)
    except Exception as error:  # whatever dask makes of an address that is none
        raise InputError(f"scheduler = {scheduler!r}: cannot be reached: {error or type(error).__name__}") from None
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        client.close()
        raise InputError(f"scheduler = {scheduler!r}: has no workers after {PATIENCE:g} s") from None
    return client


async def _answer(scheduler: str) -> None:
    """Connect to an address, and leave it again: a client that cannot connect prints a traceback when it ends."""
    from distributed.comm import connect
    from distributed.security import Security

    comm = await connect(scheduler, timeout=REACHED, **Security().get_connection_args("client"))
    comm.abort()


def _work(client: Any, job: Job[Any, Any], batches: Iterable[Batch], deliver: Deliver) -> None:
    from distributed import KilledWorker

    submitted: dict[Any, tuple[Batch, bool]] = {}
    finished: queue.Queue[tuple[Any, Solved | Exception]] = queue.Queue()

    def collect(future: Any) -> None:
        """Ask for an answer, and do not wait: this thread is shared by all clients, and the answer may be lost."""
        client.loop.add_callback(fetch, future)  # of a client that is closed, nothing comes of it

    async def fetch(future: Any) -> None:
        try:
            finished.put((future, await client.gather(future, asynchronous=True)))
        except Exception as error:
            finished.put((future, error))

    def submit(batch: Batch, alone: bool = False) -> None:
        """Submit a batch, or its first cell only if it is `alone`."""
        future = client.submit(solve_batch, job, batch.first() if alone else batch, pure=False)
        submitted[future] = batch, alone
        future.add_done_callback(collect)

    for batch in batches:
        submit(batch)
    while submitted:
        future, solved = _next(client, finished)
        batch, alone = submitted.pop(future)
        if isinstance(solved, KilledWorker):
            if not alone:
                submit(batch, alone=True)
                continue
            solved = given_up(job, batch, "the workers that solved it died")
        elif isinstance(solved, Exception):
            raise solved
        for more in deliver(solved):
            submit(more)
        left = batch.after(len(solved.points), solved.section)
        if left is not None:
            submit(left, alone)


def _next(client: Any, finished: queue.Queue[T]) -> T:
    """The next finished item of a queue; the wait ends with an error if no worker is left."""
    seen = time.monotonic()
    while True:
        try:
            return finished.get(timeout=LOOK)
        except queue.Empty:
            if client.status != "running":
                raise CancelledError from None
            if client.nthreads():
                seen = time.monotonic()
            elif time.monotonic() - seen > ALONE:
                raise SolverError(f"all workers of the scheduler are gone, and none came in {ALONE:g} s") from None
