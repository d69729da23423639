"""Bifurcations of a branch as the case `branches` compares them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr

import analytic
import fe_lapjoint
from validation.cases.rigid_bar import CURVED, RATIO
from validation.verdict import Criterion, Estimate

AMPLITUDE = "base_motion.amplitude"
BARS: dict[str, tuple[dict[str, int], Any]] = {
    "analytic": ({"n_modes": 2}, analytic.Solver(n_modes=2)),
    "fe": ({"elements": 1}, fe_lapjoint.Solver(elements=1)),
}
CLOSELY = {"analytic": 1e-6, "fe": 1e-3}
"""Largest stated error, divided by the value: a larger error would hide any difference."""


@dataclass(frozen=True)
class Found:
    """A bifurcation."""

    kind: str
    """Kind of the bifurcation."""
    value: Estimate
    """Parameter at the bifurcation, with its error."""
    stop: int
    """The stop that is grazed; -1 if there is no graze."""
    after: str
    """Continuation of the branch at a graze."""


def bifurcations(found: xr.Dataset, solver: str) -> list[Found]:
    """Bifurcations of the first branch, in their order along it."""
    names = found["bifurcation_kind"].attrs["flag_meanings"].split()
    result = []
    for i in np.flatnonzero(found["bifurcation_branch"].values == 0).tolist():
        value, error = float(found["bifurcation_value"][i]), float(found["bifurcation_error"][i])
        kind = names[int(found["bifurcation_kind"][i])]
        estimate = Estimate(value, error, f"{solver}, with its error")
        result.append(
            Found(kind, estimate, int(found["bifurcation_stop"][i]), str(found["bifurcation_after"].values[i]))
        )
    return result


def sure(label: str, solver: str, found: Sequence[Found]) -> Iterator[Criterion]:
    """Stated errors of bifurcations: above zero, and at most `CLOSELY`."""
    for i, one in enumerate(found):
        error = one.value.uncertainty / one.value.value
        yield Criterion(f"{label} {i + 1}, error over value: {solver}", "1", error, 1e-16, CLOSELY[solver], "resolved")


def to_rigid(soft: Estimate, stiff: Estimate, stiffness: float) -> Estimate:
    """A number of the rigid bar, extrapolated from beams of bending stiffness `stiffness`, N m2, and `RATIO` times
    that."""
    change = stiff.value - soft.value
    errors = stiff.uncertainty + (stiff.uncertainty + soft.uncertainty) / (RATIO - 1)
    how = f"beams {stiffness:g} and {RATIO * stiffness:g} N m2 stiff, taken to the limit"
    return Estimate(stiff.value + change / (RATIO - 1), CURVED * abs(change) + errors, how)
