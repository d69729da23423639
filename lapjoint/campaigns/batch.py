"""A batch of cells, solved wherever it is sent: in this process, another, or on a cluster."""

from __future__ import annotations

import time
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from lapjoint.campaigns.plan import Plan
from lapjoint.campaigns.point import Point, plain_section, point_of, section_from
from lapjoint.errors import InputError, SolverError
from lapjoint.solver import Solver, make_solver

BATCH_SECONDS = 1.0
"""A batch is handed back when it has taken so long, finished or not: what a crash can lose."""


@dataclass(frozen=True)
class Batch:
    """Cells to be solved one after the other."""

    cells: tuple[int, ...]
    chained: bool = False
    """Whether each starts from where the one before it has settled."""
    section: dict[str, Any] | None = None
    """Where the first starts from, if chained; None: from the problem's own initial state."""

    def first(self) -> Batch:
        """A batch of the first cell alone."""
        return replace(self, cells=self.cells[:1])


@dataclass(frozen=True)
class Solved:
    """The cells of a batch that are done, and what is left of it."""

    points: dict[int, Point]
    section: dict[str, Any] | None
    left: Batch | None


def solve_batch(plan: Plan, batch: Batch) -> Solved:
    """Solve the cells of a batch until they are done or `BATCH_SECONDS` are over; one at least.

    One thread does the linear algebra, whoever calls, so that answers do not depend on the number of workers.

    Raises
    ------
    InputError
        If a point has no valid problem; the message names it.
    """
    import scipy.linalg  # noqa: F401  # what it loads is limited only if it is loaded before
    from threadpoolctl import threadpool_limits

    solver = _solver(plan)
    deadline = time.monotonic() + BATCH_SECONDS
    points: dict[int, Point] = {}
    section = batch.section
    with threadpool_limits(1):
        for cell in batch.cells:
            points[cell], section = _solve(plan, solver, cell, section if batch.chained else None)
            if time.monotonic() > deadline:
                break
    return Solved(points, section, after(batch, len(points), section))


def after(batch: Batch, done: int, section: dict[str, Any] | None) -> Batch | None:
    """What is left of a batch when its first `done` cells are."""
    left = batch.cells[done:]
    return replace(batch, cells=left, section=section if batch.chained else None) if left else None


def batches(plan: Plan, done: set[int], sections: dict[int, dict[str, Any] | None], length: int) -> Iterator[Batch]:
    """Batches of what is left to do: whole chains, or at most `length` consecutive cells.

    Parameters
    ----------
    plan : Plan
        The sweep.
    done : set of int
        Cells that are done.
    sections : dict
        Where a chain stands after a cell, for the last one done of each chain at least.
    length : int
        Number of cells in a batch, where they are independent.
    """
    if plan.chained:
        for chain in plan.chains():
            number = next((i for i, cell in enumerate(chain) if cell not in done), len(chain))
            section = sections.get(chain[number - 1]) if number else None
            if number < len(chain):
                yield Batch(chain[number:], True, section)
        return
    left = [cell for cell in range(plan.size) if cell not in done]
    for i in range(0, len(left), length):
        yield Batch(tuple(left[i : i + length]))


def _solve(
    plan: Plan, solver: Solver, cell: int, section: dict[str, Any] | None
) -> tuple[Point, dict[str, Any] | None]:
    """The point of a cell, and the section point to go on from: the last one found, where the solver gives up."""
    try:
        problem = plan.problem_at(cell, solver)
        start = None if section is None else section_from(section)
        found = solver.steady_state(problem, start=start, sensitivity=plan.sensitivity)
    except SolverError as error:
        return Point(message=str(error)), section
    except InputError as error:
        message = str(error)
        where = plan.describe(cell)
        raise InputError(message if message.startswith(where) else f"{where}: {message}") from None
    return point_of(found), plain_section(found.section_point) if plan.chained else None


@lru_cache(maxsize=4)
def _made(name: str, options: str) -> Solver:
    import json

    return make_solver(name, **json.loads(options))


def _solver(plan: Plan) -> Solver:
    """The solver of a plan, made once in each process."""
    import json

    return _made(plan.solver, json.dumps(dict(plan.options), sort_keys=True))
