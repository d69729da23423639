"""How a bifurcation is confirmed: found again by the first solver, and looked for by the other one."""

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
    """What the other solver has for a bifurcation."""

    value: float = np.nan
    """The number, in its SI unit; NaN where it does not find it."""
    error: float = np.nan
    """Its error, in the same unit; infinite where none can be stated, NaN where it does not find it."""
    verdict: Verdict = "not found"
    """Whether both agree."""
    message: str = ""
    """Why there is none."""


def solve_bifurcation(spec: ConfirmSpec, cell: int) -> Confirmed:
    """What the other solver has for a bifurcation."""
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
