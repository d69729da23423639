"""How a batch of cells is solved, in this process, another one or on a cluster."""

from __future__ import annotations

import json
import time
from collections.abc import Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import Any

from lapjoint.campaigns.job import Batch, Job, Spec
from lapjoint.campaigns.point import PlainSection
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.solver import Progress, Solver, make_solver

BATCH_SECONDS = 1.0
"""Time after which a batch is handed back, finished or not, s: a crash loses at most about this much work of a
process."""


@dataclass(frozen=True)
class Solved:
    """The cells of a batch that are done, and what is left of the batch."""

    points: Mapping[Any, Any]
    """The answers, by the keys of the cells."""
    section: PlainSection | None
    """Section point from which the next cell of a chain starts."""
    left: Batch | None
    """The cells that are not done; None if all are."""


@in_one_thread
def solve_batch(job: Job[Any, Any], batch: Batch, progress: Progress | None = None) -> Solved:
    """Solve the cells of a batch in sequence, at least one, until all are done or `BATCH_SECONDS` have passed.

    `progress` is called as `Job.answer` says.  InputError is raised if a cell has no valid problem.
    """
    solver = solver_of(job.spec)
    deadline = time.monotonic() + BATCH_SECONDS
    points: dict[Any, Any] = {}
    section = batch.section
    for cell in batch.cells:
        points[job.key(cell)], section = job.answer(cell, solver, section if batch.chained else None, progress)
        if time.monotonic() > deadline:
            break
    return Solved(points, section, batch.after(len(points), section))


def given_up(job: Job[Any, Any], batch: Batch, reason: str) -> Solved:
    """The first cell of a batch without an answer, with the reason as its message, and the rest of the batch."""
    first = {job.key(batch.cells[0]): job.point({"message": reason})}
    return Solved(first, batch.section, batch.after(1, batch.section))


@lru_cache(maxsize=4)
def made_solver(name: str, options: str) -> Solver:
    """The solver of an entry-point name and of numerical options as JSON, made once in each process."""
    return make_solver(name, **json.loads(options))


def solver_of(spec: Spec) -> Solver:
    """The solver of a specification, made once in each process."""
    return made_solver(spec.solver, json.dumps(dict(spec.options), sort_keys=True))
