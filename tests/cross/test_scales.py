"""A problem in other units of length, mass and time has the same answer in those units: no constant has a unit."""

from __future__ import annotations

import math

import numpy as np
import pytest
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, History, ModalDamping, Problem, Stop, Support
from lapjoint.problem import ViscousDamping

FREQUENCY = 7.0  # rad/s, of the problem in its own units
SCALES = {
    "1e6 rad/s": (1e-3, 1e-6, FREQUENCY * 1e-6),
    "1e-3 rad/s": (1e3, 1e9, FREQUENCY * 1e3),
    "a long beam": (3e3, 1e4, 50.0),
    "tiny": (1e-6, 1e-15, 1e-7),
    "powers of two": (2.0**-40, 2.0**30, 2.0**-11),
}
SOLVERS: dict[str, AnySolver] = {"analytic": analytic.Solver(), "fe": fe_lapjoint.Solver(elements=6)}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)


def scaled(length: float, mass: float, time: float, viscous: bool = False) -> Problem:
    """A cantilever of EI = m = L = 1 between three stops, all numbers in other units."""
    force = mass * length / time**2

    def stop(x: float, side: str, gap: float, stiffness: float) -> Stop:
        return Stop(x=x * length, side=side, gap=gap * length, stiffness=stiffness * force / length)

    return Problem(
        beam=Beam(length=length, bending_stiffness=force * length**2, mass_per_length=mass / length),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        stops=(stop(1.0, "top", 1e-3, 1e4), stop(1.0, "bottom", 2e-3, 300.0), stop(0.6, "top", 4e-4, 2e3)),
        damping=ViscousDamping(coefficient=0.4 * mass / length / time) if viscous else ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=1e-3 * length, angular_frequency=FREQUENCY / time),
    )


def contacts(history: History, length: float, mass: float, time: float) -> np.ndarray:
    """Contacts in the problem's own units."""
    momentum = mass * length / time
    return np.array(
        [
            (c.stop, c.start / time, c.end / time, c.impulse / momentum, c.peak_force * time / momentum)
            for c in history.contacts
        ]
    )


@solvers
@pytest.mark.parametrize("viscous", [False, pytest.param(True, marks=pytest.mark.thorough)])
@pytest.mark.parametrize("name", SCALES)
def test_a_motion_in_other_units(name: str, viscous: bool, solver: AnySolver) -> None:
    scales = SCALES[name]
    period = 2 * math.pi / FREQUENCY
    own = contacts(solver.simulate(scaled(1.0, 1.0, 1.0, viscous), 3 * period), 1.0, 1.0, 1.0)
    other = contacts(solver.simulate(scaled(*scales, viscous), 3 * period * scales[2]), *scales)
    assert own.shape == other.shape
    assert len(own) > 5
    np.testing.assert_allclose(other, own, rtol=1e-7, atol=1e-9)  # rounding, grown by some ten impacts


@solvers
@pytest.mark.parametrize("name", SCALES)
def test_a_steady_state_in_other_units(name: str, solver: AnySolver) -> None:
    length, mass, time = SCALES[name]
    own = solver.steady_state(scaled(1.0, 1.0, 1.0), sensitivity=False)
    other = solver.steady_state(scaled(length, mass, time), sensitivity=False)
    assert (own.outcome, own.period_multiple) == (other.outcome, other.period_multiple)
    np.testing.assert_allclose(other.impulses * time / (mass * length), own.impulses, rtol=1e-7)
