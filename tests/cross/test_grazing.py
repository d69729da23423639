"""How far a light touch moves the period map, against how deep it is.

The penetration p lasts for a time of order p^1/2.  A stop's force, of order p, then moves the map by p^3/2.  Modal
damping differs from state to state, so its forces jump when a stop closes: they move the map by p^1/2.
"""

from __future__ import annotations

import math

import numpy as np
import pytest
from beams import CLAMP, UNIT
from scipy.optimize import minimize_scalar

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, ModalDamping, NoDamping, Problem, Stop, ViscousDamping
from lapjoint.problem import FloatArray

Damping = NoDamping | ViscousDamping | ModalDamping
PLACE, OMEGA, FAR = 0.83, 9.0, 1.0  # m, rad/s, and a gap that is never closed, m
SOLVERS = {"analytic": analytic.Solver(n_modes=20), "fe": fe_lapjoint.Solver(elements=4)}
DEPTHS = 10.0 ** -np.arange(6.0, 7.6, 0.5)  # of the displacement at the peak
DAMPINGS: dict[str, tuple[Damping, float]] = {
    "none": (NoDamping(), 1.5),
    "viscous": (ViscousDamping(coefficient=0.8), 1.5),
    "modal": (ModalDamping(ratio=0.1), 0.5),
    "modal, of several ratios": (ModalDamping(ratio=(0.1, 0.02, 0.05)), 0.5),
}


def cantilever(damping: Damping, gap: float) -> Problem:
    """A cantilever of EI = m = L = 1 with one stop, which moves from rest."""
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=(Stop(x=PLACE, side="top", gap=gap, stiffness=50.0),),
        damping=damping,
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=OMEGA),
    )


def departures(solver: analytic.Solver | fe_lapjoint.Solver, damping: Damping) -> FloatArray:
    """How far the end of the first period is from that of the motion without contact, for each of `DEPTHS`."""
    history = solver.simulate(cantilever(damping, FAR), 2 * math.pi / OMEGA, errors=False)
    t = np.linspace(history.start, history.end, 2001)
    i = int(history.displacement(PLACE, t)[0, :-1].argmax())
    found = minimize_scalar(
        lambda time: -history.displacement(PLACE, time)[0, 0], bounds=(t[i - 1], t[i + 1]), method="bounded"
    )
    top = -found.fun

    def end(gap: float) -> FloatArray:
        map_ = solver.period_map(cantilever(damping, gap))
        return map_.march(map_.initial(), 2).end.coordinates

    free = end(FAR)
    return np.array([np.abs(end(top * (1 - depth)) - free).max() for depth in DEPTHS])


@pytest.mark.parametrize("damping", DAMPINGS)
@pytest.mark.parametrize("solver", SOLVERS)
def test_a_light_touch_moves_the_period_map_by_the_power_that_its_damping_has(solver: str, damping: str) -> None:
    kind, exponent = DAMPINGS[damping]
    found = departures(SOLVERS[solver], kind)
    powers = np.diff(np.log(found)) / np.diff(np.log(DEPTHS))
    assert powers == pytest.approx(exponent, abs=0.05)
