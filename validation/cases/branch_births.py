"""Symmetry breaking and the birth of a torus: bars of one contact, whose motions have a closed form.

Branches of a bar on a pin between two equal stops, and of a bar on two springs beside one stop, are followed over the
amplitude of the base, at two bending stiffnesses.  The bifurcations of a rigid bar are where a multiplier of
`validation.references.bilinear_map` leaves the unit circle.  The branch must be stable on exactly one side of each
bifurcation.
"""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import xarray as xr

from lapjoint import branch
from lapjoint.problem.files import from_toml
from validation.case import Say
from validation.cases.branch_found import AMPLITUDE, BARS, Found, bifurcations, sure, to_rigid
from validation.cases.rigid_bar import RATIO
from validation.references.bilinear_map import BilinearMap, OneContact
from validation.references.rigid_bar import RigidBar
from validation.verdict import Check, Criterion, Estimate, Kind

STIFFNESS = 1e6  # Bending stiffness of the softer bar, N m2: bending displaces a bifurcation by 6e-5
SPAN = 0.96, 1.04  # Range of the branch, divided by the amplitude at the bifurcation
SOLVER = "analytic"
AT = (
    1e-9  # Largest distance of the branch point from the bifurcation, where a multiplier is 1, divided by the amplitude
)
_BEAM = """
[beam]
length = 1.5
bending_stiffness = {stiffness}
mass_per_length = 4.0
[base_motion]
amplitude = 1e-3
"""
BETWEEN = (
    _BEAM
    + """angular_frequency = 8.5
[damping]
kind = "modal"
ratio = 0.05
[[supports]]
x = 0.0
translational = inf
torsional = 450.0
[[stops]]
x = 1.2
side = "top"
gap = 1e-3
stiffness = 2000.0
[[stops]]
x = 1.2
side = "bottom"
gap = 1e-3
stiffness = 2000.0
"""
)
ON_SPRINGS = (
    _BEAM
    + """angular_frequency = 26.5
[damping]
kind = "viscous"
coefficient = 10.5
[[supports]]
x = 0.0
translational = 600.0
[[supports]]
x = 1.5
translational = 1220.0
[[stops]]
x = 1.15
side = "top"
gap = 1e-3
stiffness = 10800.0
"""
)


@dataclass(frozen=True)
class Birth:
    """A bar, and its bifurcation."""

    kind: str
    """Name of the bifurcation in a dataset of branches."""
    text: str
    """The problem file, with a place for the bending stiffness."""

    @property
    def name(self) -> str:
        """The kind of bifurcation in words."""
        return self.kind.replace("_", " ")

    def closed_form(self) -> OneContact:
        """The motion at the bifurcation of least amplitude."""
        known = BilinearMap.of_bar(RigidBar.from_toml(self.text.format(stiffness="inf")))
        found = known.flips() if known.mirrored else known.neimark_sackers()
        return min((one for one in found if known.exists(one)), key=lambda one: one.amplitude)


BIRTHS = (Birth("symmetry_breaking", BETWEEN), Birth("neimark-sacker", ON_SPRINGS))


def over_births(say: Say) -> Iterator[Check | Criterion]:
    """Both bars at two bending stiffnesses, against closed form."""
    for birth in BIRTHS:
        yield from _over(birth, say)


def _over(birth: Birth, say: Say) -> Iterator[Check | Criterion]:
    exact, values = birth.closed_form().amplitude, list[Estimate]()
    for stiffness in (STIFFNESS, RATIO * STIFFNESS):
        where = f"{stiffness:g} N m2"
        say(f"bar, {birth.name}, {where}")
        problem = from_toml(birth.text.format(stiffness=repr(stiffness)))
        low, high = (share * exact for share in SPAN)
        data = branch(problem, AMPLITUDE, low, high, solver=SOLVER, options=BARS[SOLVER][0])
        found = bifurcations(data, SOLVER)
        there = [one.kind for one in found] == [birth.kind] and data.sizes["bifurcation"] == 1
        yield Criterion(f"one {birth.name}, {where} (1: yes)", "1", float(there), 1, 1, "as the closed form has")
        if not there:
            return
        yield from sure(f"{birth.name}, {where}, bifurcation", SOLVER, found)
        yield from _beside(birth, data, found, where)
        values.append(found[0].value)
    soft, stiff = values
    a = to_rigid(soft, stiff, STIFFNESS)
    b = Estimate(exact, 0.0, "where a multiplier of a rigid bar leaves the circle", Kind.ANALYTICAL)
    yield Check(f"bar, {birth.name}: {SOLVER}, against closed form", "m", a, b)


def _beside(birth: Birth, data: xr.Dataset, found: Sequence[Found], where: str) -> Iterator[Criterion]:
    """Points are stable below the bifurcation; if a symmetry breaks there, a stable asymmetric branch begins above."""
    x, stable, first = (data[name].values for name in ("base_motion_amplitude", "stable", "branch"))
    mine = first == 0
    wrong = np.count_nonzero(stable[mine] != (x[mine] < found[0].value.value))
    name = f"{birth.name}, {where}: points that are not stable just below it"
    yield Criterion(name, "1", float(wrong), 0, 0, "by the multipliers of the closed form")
    if birth.kind != "symmetry_breaking":
        return
    symmetric = data["symmetric"].values
    lost = np.count_nonzero(symmetric[mine] != 1) + np.count_nonzero(symmetric[~mine] != 0)
    name = f"{birth.name}, {where}: points that mirror themselves elsewhere than on the first branch, or do not on it"
    yield Criterion(name, "1", float(lost), 0, 0, "")
    ends = [{str(data[f"branch_{end}_end"].values[i]) for end in ("first", "last")} for i in range(first.max() + 1)]
    name = f"{birth.name}, {where}: one branch springs from it, and goes to the end of the range (1: yes)"
    yield Criterion(name, "1", float(ends[1:] == [{"bifurcation", "boundary"}]), 1, 1, "a start comes to it, too")
    name = f"{birth.name}, {where}: points of it that are unstable, or not above"
    above = x / found[0].value.value - 1
    its_own = ~mine & (np.abs(above) > AT)
    wrong = np.count_nonzero((stable[its_own] != 1) | (above[its_own] < 0))
    yield Criterion(name, "1", float(wrong), 0, 0, "it takes the stability over")
