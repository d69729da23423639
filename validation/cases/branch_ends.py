"""Ends of branches, and ranges without a branch: two joints like the paper's.

The first joint has a damping ratio of 0.09.  Its damping forces jump when the beam leaves a stop, and reverse the
acceleration at the stop.  A short flight would therefore be on the wrong side of the stop, and the branch ends at the
graze.  Both solvers must find this end at the same frequency.

The second joint has four fifths of the paper's gaps.  Contacts begin and end in close succession, and symmetries break
between them.  A branch that turns back at one of these grazes never reaches the other end of the range.  Branches from
both ends must therefore cover the range, and parts that they do not cover must be reported.
"""

from __future__ import annotations

from collections.abc import Iterator
from typing import Any

import numpy as np
import xarray as xr

from lapjoint import FREQUENCY, Problem, branch, paper_joint
from validation.case import Say
from validation.verdict import Check, Criterion, Estimate

RATIO, RANGE = 0.09, (4390.0, 4374.0)
"""Damping ratio, and the range, rad/s, from the end at which the branch begins."""
OPTIONS: dict[str, dict[str, Any]] = {"analytic": {}, "fe": {"elements": 30}}  # Numerical options of each solver
CLOSELY = 1e-5  # Largest stated error, divided by the value: a larger error would hide any difference
GAPS, LIGHTLY = 0.8, (3.88, 3.92)  # Gaps, divided by the gaps of the paper, and the range, rad/s
SHARE = 1e-3  # Largest fraction of the range that may be without a branch, if it is reported
LEAST = 1e-9  # Least width of a part that counts, divided by the range; ends of branches are solved to 1e-9


def damped() -> Problem:
    """The paper's joint with more damping."""
    joint = paper_joint()
    return joint.replace(damping=joint.damping.model_copy(update={"ratio": RATIO}))


def tight() -> Problem:
    """The paper's joint with narrower gaps."""
    joint = paper_joint()
    return joint.replace(stops=tuple(stop.model_copy(update={"gap": GAPS * stop.gap}) for stop in joint.stops))


def gaps_of(intervals: list[tuple[float, float]], low: float, high: float) -> list[tuple[float, float]]:
    """Lower and upper end of each part of the range from `low` to `high` that no interval covers."""
    found, covered = [], low
    for first, last in [*sorted(intervals), (high, high)]:
        if first - covered > LEAST * (high - low):
            found.append((covered, first))
        covered = max(covered, last)
    return found


def over_ends(say: Say) -> Iterator[Check | Criterion]:
    """The end of a branch by both solvers, and the joint of narrow gaps from both ends of the range."""
    yield from _end(say)
    say("lightly made contacts")
    low, high = LIGHTLY
    found = branch(tight(), FREQUENCY, low, high)
    number, value = found["branch"].values, found["angular_frequency"].values
    on_branches = [(value[number == i].min(), value[number == i].max()) for i in range(found.sizes["branch_number"])]
    told = told_of(found)
    left = sum(last - first for first, last in gaps_of(on_branches, low, high)) / (high - low)
    yield Criterion("share of the range on no branch, lightly made contacts", "1", left, 0.0, SHARE, "the rest is")
    unsaid = sum(last - first for first, last in gaps_of([*on_branches, *told], low, high))
    yield Criterion("what is on no branch and not told", "rad/s", unsaid, 0.0, 0.0, "each part is told, with its end")
    both = [one for one in told if any(first < (one[0] + one[1]) / 2 < last for first, last in on_branches)]
    yield Criterion("parts told to be on no branch that are", "1", float(len(both)), 0, 0, "")


def _end(say: Say) -> Iterator[Check | Criterion]:
    """The graze at which a branch ends, by both solvers."""
    values = []
    for solver, options in OPTIONS.items():
        say(f"end of a branch, {solver}")
        found = branch(damped(), FREQUENCY, *RANGE, solver=solver, options=options)
        mine = np.flatnonzero(found["bifurcation_after"].values == "ends")
        yield Criterion(f"grazes at which a branch ends: {solver}", "1", float(mine.size), 1, 1, "it has one such end")
        if mine.size != 1:
            return
        value, error = (float(found[f"bifurcation_{name}"].values[mine[0]]) for name in ("value", "error"))
        yield Criterion(f"error of the end over its value: {solver}", "1", error / value, 1e-16, CLOSELY, "resolved")
        values.append(Estimate(value, error, f"{solver}, with its error"))
    one, other = values
    yield Check("end of a branch: both solvers", "rad/s", one, other)


def told_of(found: xr.Dataset) -> list[tuple[float, float]]:
    """The parts of the range that the dataset reports as without a branch."""
    if "uncovered_from" not in found:
        return []
    ends = np.stack([found["uncovered_from"].values, found["uncovered_to"].values], axis=1)
    return [(float(first), float(last)) for first, last in ends]
