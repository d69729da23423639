"""The work of a sweep on a dask cluster, whose workers may die."""

from __future__ import annotations

from collections.abc import Iterable
from concurrent.futures import CancelledError
from typing import Any

from lapjoint.campaigns.batch import Batch, Solved, after, solve_batch
from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.workers import Deliver, given_up
from lapjoint.errors import InputError, SolverError

REACHED = 15.0
"""Time that a scheduler has to answer, s."""
PATIENCE = 60.0
"""Time that a scheduler has to have its first worker, s."""


def work_on_cluster(plan: Plan, batches: Iterable[Batch], scheduler: str, deliver: Deliver) -> None:
    """Solve all batches on the workers of a dask scheduler.

    Dask sends a batch whose worker died to another one, a few times; one that kills them all is sent cell by
    cell then, and the cell that does it is given up.

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
    """A client of the scheduler, which has a worker at least."""
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

    flying: dict[Any, tuple[Batch, bool]] = {}
    landing = as_completed(loop=client.loop)

    def fly(batch: Batch, alone: bool = False) -> None:
        future = client.submit(solve_batch, plan, batch.first() if alone else batch, pure=False)
        flying[future] = batch, alone
        landing.add(future)

    for batch in batches:
        fly(batch)
    for future in landing:
        batch, alone = flying.pop(future)
        try:
            solved: Solved = future.result()
        except KilledWorker:
            if not alone:
                fly(batch, alone=True)
                continue
            solved = given_up(batch, "the workers that solved it died")
        deliver(solved)
        left = after(batch, len(solved.points), solved.section)
        if left is not None:
            fly(left, alone)
