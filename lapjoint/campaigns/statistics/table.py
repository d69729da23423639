"""The dataset of statistics, from the sums of the realisations in the order of their numbers."""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass
from typing import TYPE_CHECKING

from lapjoint.campaigns.dataset import head, tail
from lapjoint.campaigns.statistics.spec import Realisations
from lapjoint.errors import SolverError
from lapjoint.solver import make_solver
from lapjoint.summaries.sums import Sums
from lapjoint.summaries.table import remarks, table

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class Realised:
    """The result of one realisation."""

    sums: Sums | None = None
    """Sums over the motion; None if the solver gave up."""
    message: str = ""
    """Why the solver gave up; empty where it did not."""


def statistics_dataset(spec: Realisations, points: Mapping[int, Realised]) -> xr.Dataset:
    """The dataset of statistics from the answers of all realisations; SolverError if none has its sums."""
    answers = [points[cell] for cell in range(spec.size)]
    parts = [answer.sums for answer in answers if answer.sums is not None]
    failed = [answer.message for answer in answers if answer.sums is None]
    if not parts:
        raise SolverError(f"no realisation came to its end: {failed[0]}")
    solver = make_solver(spec.solver, **spec.options)
    sums, what = Sums.joined(parts), spec.measure(solver)
    attributes = {
        **head(),
        "result_of": spec.noun,
        "title": f"Statistics of: {spec.problem.title or 'a joint'}",
        "problem": spec.identity["problem"],
        "solver": spec.solver,
        "solver_name": solver.name,
        "options": json.dumps(dict(spec.options)),
        "seeds": spec.seeds,
        "failed": len(failed),
        "messages": "\n".join(failed),
        "remarks": "\n".join(remarks(what, sums, len(parts))),
        **tail(spec),
    }
    return table(what, sums).assign_attrs(attributes)
