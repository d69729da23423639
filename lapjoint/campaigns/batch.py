"""A batch of cells: how it is made, and how it is solved, in this process, another one or on a cluster."""

from __future__ import annotations

import json
import time
from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import Any

from lapjoint.campaigns.job import Answer, CellSolver, Job, Spec
from lapjoint.campaigns.point import PlainSection
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.solver import Progress, Solver, make_solver

BATCH_SECONDS = 1.0
"""Time after which a batch is handed back, finished or not, s: a crash loses at most about this much work of a
process."""


@dataclass(frozen=True)
class Batch:
    """Cells to be solved one after the other."""

    cells: tuple[int, ...]
    """Numbers of the cells."""
    chained: bool = False
    """Whether each cell starts from the section point at which the cell before it has settled."""
    section: PlainSection | None = None
    """Section point from which the first cell of a chain starts; None if it starts from the problem's initial state."""

    def first(self) -> Batch:
        """A batch of the first cell alone."""
        return replace(self, cells=self.cells[:1])

    def after(self, done: int, section: PlainSection | None) -> Batch | None:
        """The rest of the batch after its first `done` cells, with a chain at `section`; None if no cell is left."""
        left = self.cells[done:]
        return replace(self, cells=left, section=section if self.chained else None) if left else None


@dataclass(frozen=True)
class Solved:
    """The cells of a batch that are done, and what is left of the batch."""

    points: Mapping[int, Answer]
    """The answers, by the numbers of the cells."""
    section: PlainSection | None
    """Section point from which the next cell of a chain starts."""
    left: Batch | None
    """The cells that are not done; None if all are."""


@in_one_thread
def solve_batch(job: CellSolver, batch: Batch, progress: Progress | None = None) -> Solved:
    """Solve the cells of a batch in sequence, at least one, until all are done or `BATCH_SECONDS` have passed.

    `progress` is called as `CellSolver.answer` says.  InputError is raised if a cell has no valid problem.
    """
    solver = solver_of(job.spec)
    deadline = time.monotonic() + BATCH_SECONDS
    points: dict[int, Answer] = {}
    section = batch.section
    for cell in batch.cells:
        points[cell], section = job.answer(cell, solver, section if batch.chained else None, progress)
        if time.monotonic() > deadline:
            break
    return Solved(points, section, batch.after(len(points), section))


def batches_of(cells: Iterable[int], length: int) -> list[Batch]:
    """Batches of at most `length` independent cells, in the sequence of the cells."""
    left = tuple(cells)
    return [Batch(left[i : i + length]) for i in range(0, len(left), length)]


def batches(
    job: Job[Any, Any], done: Collection[int], sections: Mapping[int, PlainSection | None], length: int
) -> list[Batch]:
    """Batches of the cells that are not done: the rest of each chain, or at most `length` independent cells.

    `sections` has the section point at which a chain stands after a cell, at least for the last cell that is done.
    """
    chains = tuple(job.chains())
    if not chains:
        return batches_of((cell for cell in range(job.spec.size) if cell not in done), length)
    found = []
    for chain in chains:
        number = next((i for i, cell in enumerate(chain) if cell not in done), len(chain))
        if number < len(chain):
            found.append(Batch(chain[number:], True, sections.get(chain[number - 1]) if number else None))
    return found


@lru_cache(maxsize=4)
def made_solver(name: str, options: str) -> Solver:
    """The solver of an entry-point name and of numerical options as JSON, made once in each process."""
    return make_solver(name, **json.loads(options))


def solver_of(spec: Spec) -> Solver:
    """The solver of a specification, made once in each process."""
    return made_solver(spec.solver, json.dumps(dict(spec.options), sort_keys=True))
