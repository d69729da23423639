"""The work of a sweep on a dask cluster, which goes on when workers die."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import CancelledError
from typing import Any

from lapjoint.campaigns.batch import Batch, Solved, after, solve_batch
from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.workers import Deliver, given_up
from lapjoint.errors import InputError, SolverError

REACHED = 15.0
"""Time within which a scheduler must answer, s: enough for a slow network, and short enough for a wrong address."""
PATIENCE = 60.0
"""Time within which a scheduler must have its first worker, s: the workers of a batch system start late."""


def work_on_cluster(plan: Plan, batches: Iterable[Batch], scheduler: str, deliver: Deliver) -> None:
    """Solve all batches on the workers of a dask scheduler.

    Dask sends a batch whose worker died to another worker, a few times.  If all of them die, the batch is sent again
    cell by cell, and the cell whose workers die is given up.

    Parameters
    ----------
    plan : Plan
        The sweep.
    batches : iterable of Batch
        The work.
    scheduler : str
        Address of the scheduler, ``tcp://host:8786``.
    deliver : callable
        Takes each `Solved`, in any sequence.

    Raises
    ------
    InputError
        If dask.distributed is not installed, or there is no scheduler with a worker at this address.
    SolverError
        If the scheduler is lost.
    """
    client = connected(scheduler)
    try:
        _work(client, plan, batches, deliver)
    except CancelledError:
        raise SolverError(f"scheduler = {scheduler!r}: the connection to it was lost") from None
    finally:
        client.close()


def connected(scheduler: str) -> Any:
    """Connect to a scheduler that has a worker.

    Parameters
    ----------
    scheduler : str
        Address of the scheduler, ``tcp://host:8786``.

    Returns
    -------
    distributed.Client
        The client of the scheduler, to be closed by the caller.

    Raises
    ------
    InputError
        If dask.distributed is not installed, the scheduler does not answer within `REACHED`, or it has no worker within
        `PATIENCE`.
    """
    try:
        from distributed import Client
    except ImportError:
        raise InputError(
            f"scheduler = {scheduler!r}: needs the package distributed; install it with pip install 'lapjoint[cluster]'"
        ) from None
    try:
        client = Client(scheduler, timeout=REACHED, set_as_default=False)
    except (OSError, ValueError, TypeError) as error:
        raise InputError(f"scheduler = {scheduler!r}: cannot be reached: {error}") from None
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        client.close()
        raise InputError(f"scheduler = {scheduler!r}: has no workers after {PATIENCE:g} s") from None
    return client


def _work(client: Any, plan: Plan, batches: Iterable[Batch], deliver: Deliver) -> None:
    from distributed import KilledWorker, as_completed

    submitted: dict[Any, tuple[Batch, bool]] = {}
    finished = as_completed(loop=client.loop)

    def submit(batch: Batch, alone: bool = False) -> None:
        """Submit a batch, or its first cell only if it is `alone`."""
        future = client.submit(solve_batch, plan, batch.first() if alone else batch, pure=False)
        submitted[future] = batch, alone
        finished.add(future)

    for batch in batches:
        submit(batch)
    for future in finished:
        batch, alone = submitted.pop(future)
        try:
            solved: Solved = future.result()
        except KilledWorker:
            if not alone:
                submit(batch, alone=True)
                continue
            solved = given_up(batch, "the workers that solved it died")
        deliver(solved)
        left = after(batch, len(solved.points), solved.section)
        if left is not None:
            submit(left, alone)
