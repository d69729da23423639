"""Where branches end, and where they do not: two joints like the paper's on which curves were lost.

With 0.09 of damping a motion comes to the rebound from a stop ever more slowly.  Were it not for the damping forces,
which jump as the stop is left, it would turn there; so no extremum of its own shows the graze at which its branch ends.
Both solvers must have that end at one frequency.  With four fifths of the gaps a contact is made so lightly that the
curve beyond seems to lead back across its graze; followed so, it never comes to the other end of the range.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from lapjoint import FREQUENCY, Problem, branch, paper_joint
from validation.case import Say
from validation.verdict import Check, Criterion, Estimate

RATIO, RANGE = 0.09, (4390.0, 4374.0)  # of critical damping; rad/s, from the end at which the branch begins
GAPS, LIGHTLY = 0.8, (3.92, 3.88)  # of the paper's gaps; rad/s, from the end at which the branch begins
OPTIONS: dict[str, dict[str, Any]] = {"analytic": {}, "fe": {"elements": 60}}
"""Of each solver; with 40 elements, the next finer self has the end too far away to say."""
CLOSELY = 1e-5
"""Largest stated error over the value: an error that says nothing would hide any difference."""


def damped() -> Problem:
    """The paper's joint with more damping."""
    joint = paper_joint()
    return joint.replace(damping=joint.damping.model_copy(update={"ratio": RATIO}))


def tight() -> Problem:
    """The paper's joint with narrower gaps."""
    joint = paper_joint()
    return joint.replace(stops=tuple(stop.model_copy(update={"gap": GAPS * stop.gap}) for stop in joint.stops))


def at_upper_end(found: xr.Dataset, high: float) -> int | None:
    """The number of the branch that comes from the upper end of the range; None if there is none."""
    there = np.flatnonzero(np.abs(found["angular_frequency"].values - high) <= 1e-9 * high)
    return int(found["branch"].values[there[0]]) if there.size else None


def over_ends(say: Say) -> Iterator[Check | Criterion]:
    """The end of the one branch by both solvers, and the way of the other."""
    values = []
    for solver, options in OPTIONS.items():
        say(f"end of a branch, {solver}")
        found = branch(damped(), FREQUENCY, *RANGE, solver=solver, options=options)
        number = at_upper_end(found, RANGE[0])
        ends = (
            () if number is None else tuple(str(found[f"branch_{end}_end"].values[number]) for end in ("first", "last"))
        )
        yield Criterion(f"a branch ends at a graze (1: yes): {solver}", "1", float("graze" in ends), 1, 1, "not lost")
        mine = np.flatnonzero(
            (found["bifurcation_branch"].values == number) & (found["bifurcation_after"].values == "ends")
        )
        yield Criterion(f"grazes at which it ends: {solver}", "1", float(mine.size), 1, 1, "as it has one such end")
        if mine.size != 1:
            return
        value, error = (float(found[f"bifurcation_{name}"].values[mine[0]]) for name in ("value", "error"))
        yield Criterion(f"error of the end over its value: {solver}", "1", error / value, 1e-16, CLOSELY, "resolved")
        values.append(Estimate(value, error, f"{solver}, with its error"))
    one, other = values
    yield Check("end of a branch: both solvers", "rad/s", one, other)
    say("lightly made contact")
    found = branch(tight(), FREQUENCY, *LIGHTLY)
    mine = found["branch"].values == at_upper_end(found, LIGHTLY[0])
    left = float(found["angular_frequency"].values[mine].min(initial=LIGHTLY[0])) - LIGHTLY[1]
    reason = "the curve goes on in its own direction"
    yield Criterion("what is left of the range beyond a lightly made contact", "rad/s", left, 0.0, 1e-9, reason)
