"""A batch of cells: how it is made, and how it is solved, in this process, another one or on a cluster."""

from __future__ import annotations

import time
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from lapjoint.campaigns.campaign import Cells, Point
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.solver import Progress, Solver, make_solver

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

    points: dict[int, Point]
    """What was found, by the number of the cell."""
    section: dict[str, Any] | None
    """Section point from which the next cell of a chain starts, as `plain_section` gives it."""
    left: Batch | None
    """The cells that are not done; None if all are."""


@in_one_thread
def solve_batch(plan: Cells, batch: Batch, progress: Progress | None = None) -> Solved:
    """Solve the cells of a batch until all are done or `BATCH_SECONDS` are over, and at least one.

    Parameters
    ----------
    plan : Cells
        The work.
    batch : Batch
        Cells to be solved, in their sequence.
    progress : callable, optional
        Called now and then with how much of the cell that is solved is done and the whole, where it takes long.

    Returns
    -------
    Solved
        The cells that are done, and what is left of the batch.

    Raises
    ------
    InputError
        If a point has no valid problem; the message names it.
    """
    solver = solver_of(plan)
    deadline = time.monotonic() + BATCH_SECONDS
    points: dict[int, Point] = {}
    section = batch.section
    for cell in batch.cells:
        points[cell], section = plan.answer(cell, solver, section if batch.chained else None, progress)
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


def batches(plan: Cells, done: set[int], sections: dict[int, dict[str, Any] | None], length: int) -> Iterator[Batch]:
    """Batches of the cells that are not done: the rest of each chain, or at most `length` independent cells.

    Parameters
    ----------
    plan : Cells
        The work.
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


def solver_of(plan: Cells) -> Solver:
    """The solver of a campaign, made once in each process.

    Parameters
    ----------
    plan : Cells
        The work.

    Returns
    -------
    Solver
        The solver, with its options.
    """
    return made_solver(plan.solver, plan.options)
