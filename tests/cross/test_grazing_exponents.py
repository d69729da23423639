"""How a touch departs from the motion without contact: as the 3/2 power of the penetration, or as its square root.

The force of a stop is continuous, so a touch of depth d lasts as sqrt(d), and its impulse is of the size of d^(3/2).
Modal damping jumps with the contact state: with two modes or more it pushes as long as the touch lasts, as sqrt(d).
"""

from __future__ import annotations

import math
from typing import Any

import pytest
from beams import CLAMP, UNIT

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, ModalDamping, Problem, Stop, ViscousDamping
from lapjoint.answers import SectionPoint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import find_orbit

GAP = 1e-3
VISCOUS, MODAL = ViscousDamping(coefficient=0.8), ModalDamping(ratio=0.1)


def cantilever(damping: ViscousDamping | ModalDamping, amplitude: float, gap: float) -> Problem:
    """A cantilever of EI = m = L = 1 with a stop above its tip."""
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=(Stop(x=1.0, side="top", gap=gap, stiffness=50.0),),
        damping=damping,
        base_motion=BaseMotion(amplitude=amplitude, angular_frequency=5.0),
    )


def without_contact(map_: Any) -> SectionPoint:
    """The section point of the motion that never comes to its stop."""
    orbit = find_orbit(HalfPeriods(map_), map_.march(map_.initial(), 40).end, 2, 2.0)
    assert orbit is not None
    return orbit.point


def departure(solver: Any, damping: ViscousDamping | ModalDamping, beyond: float) -> float:
    """Relative distance after a period from the motion without contact, which goes `beyond` the gap, relatively."""
    far = solver.period_map(cantilever(damping, GAP, 1e3 * GAP))
    point = without_contact(far)
    history = far.history(point, 1)
    z, v = history.displacement(1.0, 0.0).item(), history.velocity(1.0, 0.0).item()
    scale = GAP / math.hypot(z, v / 5.0) * (1 + beyond)  # without contact the motion is harmonic
    map_ = solver.period_map(cantilever(damping, GAP * scale, GAP))
    start = SectionPoint(point.state, scale * point.coordinates, point.nodes)
    passage = map_.march(map_.adopted(start), 2)
    assert passage.switches == 2
    return map_.norm(map_.difference(passage.end, start)) / map_.size(start)


@pytest.mark.parametrize(
    ("solver", "damping", "beyond", "exponent", "tolerance"),
    [
        # Truncated modes lose a share of what a touch does; eight leave 0.01 of the exponent at these depths.
        (analytic.Solver(n_modes=8), VISCOUS, 1e-6, 1.5, 0.05),
        (fe_lapjoint.Solver(elements=2), VISCOUS, 1e-6, 1.5, 0.01),
        # The next power, d, is 1e-3 of sqrt(d) at these depths, with a factor of some ten.
        (analytic.Solver(n_modes=4), MODAL, 1e-7, 0.5, 0.02),
        (fe_lapjoint.Solver(elements=2), MODAL, 1e-7, 0.5, 0.02),
    ],
    ids=["analytic viscous", "fe viscous", "analytic modal", "fe modal"],
)
def test_a_touch_departs_from_free_motion_with_the_exponent_of_its_damping(
    solver: Any, damping: ViscousDamping | ModalDamping, beyond: float, exponent: float, tolerance: float
) -> None:
    far, near = (departure(solver, damping, share * beyond) for share in (10.0, 1.0))
    assert math.log10(far / near) == pytest.approx(exponent, abs=tolerance)
