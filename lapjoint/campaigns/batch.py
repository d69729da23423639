"""A batch of cells of a sweep: how it is made, and how it is solved, in this process, another one or on a cluster."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING, Any

from lapjoint.campaigns.campaign import Campaign
from lapjoint.campaigns.point import Point, plain_section, point_of, section_from
from lapjoint.errors import InputError, SolverError
from lapjoint.one_thread import in_one_thread
from lapjoint.solver import Solver, make_solver

if TYPE_CHECKING:
    from lapjoint.campaigns.plan import Plan

BATCH_SECONDS = 1.0
"""Time after which a batch is handed back, finished or not, s: it is as much work as a crash can lose."""


@dataclass(frozen=True)
class Batch:
    """Cells to be solved one after the other."""

    cells: tuple[int, ...]
    """Numbers of the cells."""
    chained: bool = False
    """Whether each cell starts from the section point at which the one before it has settled."""
    section: dict[str, Any] | None = None
    """Section point from which the first cell of a chain starts, as `plain_section` gives it; None for the initial
    state of the problem."""

    def first(self) -> Batch:
        """A batch of the first cell alone."""
        return replace(self, cells=self.cells[:1])


@dataclass(frozen=True)
class Solved:
    """The cells of a batch that are done, and what is left of the batch."""

    points: dict[int, Any]
    """What was found, by the number of the cell."""
    section: dict[str, Any] | None
    """Section point from which the next cell of a chain starts, as `plain_section` gives it."""
    left: Batch | None
    """The cells that are not done; None if all are."""


@in_one_thread
def solve_batch(plan: Campaign, batch: Batch) -> Solved:
    """Solve the cells of a batch until all are done or `BATCH_SECONDS` are over, and at least one.

    Parameters
    ----------
    plan : Campaign
        The sweep.
    batch : Batch
        Cells to be solved, in their sequence.

    Returns
    -------
    Solved
        The cells that are done, and what is left of the batch.

    Raises
    ------
    InputError
        If a point has no valid problem; the message names it.
    """
    deadline = time.monotonic() + BATCH_SECONDS
    points: dict[int, Any] = {}
    section = batch.section
    for cell in batch.cells:
        points[cell], section = plan.solve(cell, section if batch.chained else None)
        if time.monotonic() > deadline:
            break
    return Solved(points, section, after(batch, len(points), section))


def after(batch: Batch, done: int, section: dict[str, Any] | None) -> Batch | None:
    """What is left of a batch when some of its cells are done.

    Parameters
    ----------
    batch : Batch
        The batch.
    done : int
        Number of cells that are done, from the first one on.
    section : dict of str to Any, or None
        Section point from which the next cell of a chain starts, as `plain_section` gives it.

    Returns
    -------
    Batch or None
        The cells that are left; None if there are none.
    """
    left = batch.cells[done:]
    return replace(batch, cells=left, section=section if batch.chained else None) if left else None


def batches(plan: Campaign, done: set[int], sections: dict[int, dict[str, Any] | None], length: int) -> Iterator[Batch]:
    """Batches of the cells that are not done: the rest of each chain, or at most `length` independent cells.

    Parameters
    ----------
    plan : Campaign
        The sweep.
    done : set of int
        Numbers of the cells that are done.
    sections : dict of int to dict or None
        Section point at which a chain stands after a cell, as `plain_section` gives it; at least for the last cell of
        each chain that is done.
    length : int
        Largest number of cells in a batch, where they are independent.

    Yields
    ------
    Batch
        The batches, in the sequence of their cells.
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


def steady_cell(plan: Plan, cell: int, section: dict[str, Any] | None) -> tuple[Point, dict[str, Any] | None]:
    """The steady state of a cell of a sweep, and the section point from which the next cell of a chain starts.

    Where the solver gives up, this is the section point from which the cell itself started.

    Parameters
    ----------
    plan : Plan
        The sweep.
    cell : int
        Number of the cell.
    section : dict of str to Any, or None
        Section point from which it starts, as `plain_section` gives it; None for the initial state of its problem.

    Returns
    -------
    Point
        What was found.
    dict of str to Any, or None
        Section point from which the next cell of a chain starts; None where there is no chain.

    Raises
    ------
    InputError
        If there is no valid problem at this point; the message names it.
    """
    solver = made_solver(plan.solver, plan.options)
    try:
        problem = plan.problem_at(cell, solver)
        start = None if section is None else section_from(section)
        found = solver.steady_state(problem, start=start, sensitivity=plan.sensitivity, errors=plan.errors)
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


def made_solver(name: str, options: Mapping[str, Any]) -> Solver:
    """A solver, made once in each process.

    Parameters
    ----------
    name : str
        Its entry-point name.
    options : mapping of str to Any
        Its numerical options.

    Returns
    -------
    Solver
        The same object at every call, as long as it is kept.
    """
    import json

    return _made(name, json.dumps(dict(options), sort_keys=True))
