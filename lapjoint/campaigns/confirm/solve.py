"""How a bifurcation is confirmed: the first solver finds it again, and the other solver looks for it."""

from __future__ import annotations

import json
from dataclasses import dataclass

import numpy as np

from lapjoint.campaigns.branches.plain import located_of
from lapjoint.campaigns.branches.spec import range_of
from lapjoint.campaigns.confirm.spec import ConfirmSpec
from lapjoint.errors import SolverError
from lapjoint.orbits.branches.confirmation import Verdict, confirmed
from lapjoint.orbits.branches.errors import Stated


@dataclass(frozen=True)
class Confirmed:
    """The result of the other solver for a bifurcation."""

    value: float = np.nan
    """The parameter by the other solver, in its SI unit; NaN where the other solver does not find the bifurcation."""
    error: float = np.nan
    """Error of the other solver's value, in the unit of the value; infinite where none can be stated, NaN where the
    bifurcation is not found."""
    verdict: Verdict = "not found"
    """Whether both solvers agree."""
    message: str = ""
    """Why the bifurcation is not found."""


def solve_bifurcation(spec: ConfirmSpec, cell: int) -> Confirmed:
    """The result of the other solver for one bifurcation, by its number."""
    row = spec.rows[cell]
    if not row.arcs:
        return Confirmed(message="the file has no motion of it")
    try:
        what = located_of(range_of(spec.branches.at(row.also)), json.loads(row.arcs))
        if what is None:
            return Confirmed(message="the first solver does not find it again from the motion in the file")
        found = confirmed(Stated(row.value, row.error, what), range_of(spec.other.at(row.also)))
    except SolverError as error:
        return Confirmed(message=str(error))
    if found.other is None:
        return Confirmed(message="the other solver does not find it")
    return Confirmed(float(found.other.value), float(found.other.error), found.verdict)
