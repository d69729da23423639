"""A march without damping loses or gains energy at its switches by truncation, and the stated errors hold that."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from lapjoint import NoDamping, Problem, Stop
from lapjoint.answers import History
from lapjoint.problem import PolynomialShape
from tests.helpers.beams import CLAMP, UNIT
from tests.helpers.few_and_many import few_and_many

FEW_MODES, MANY_MODES = 8, 64
DURATION = 120.0  # s, of 1.8 s for each cycle of the free cantilever


def drawn(index: int) -> Problem:
    """A cantilever, bent and let go, against a stop at its tip or inside."""
    rng = np.random.default_rng((45, index))
    gap = float(rng.uniform(1e-4, 1e-3))
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=(
            Stop(x=float(rng.uniform(0.5, 1.0)), side="top", gap=gap, stiffness=float(10 ** rng.uniform(-0.5, 1.5))),
        ),
        damping=NoDamping(),
        initial=PolynomialShape(displacement=(0.0, 0.0, 3e-3, -1e-3)),
    )


def held(index: int) -> tuple[int, int]:
    """How many starts and impulses are within their stated errors, and of how many."""
    few, many = (analytic.Solver(n_modes=count) for count in (FEW_MODES, MANY_MODES))
    motion = few.simulate(drawn(index), DURATION)
    finite = [one for one in motion.contacts if one.impulse_error is not None and math.isfinite(one.impulse_error)]
    right = many.simulate(drawn(index), DURATION, errors=False).contacts
    good = 0
    for one, its in zip(finite, right, strict=False):
        assert one.start_error is not None
        assert one.impulse_error is not None
        good += abs(one.start - its.start) <= one.start_error
        good += abs(one.impulse - its.impulse) <= one.impulse_error
    return good, 2 * len(finite)


@pytest.mark.thorough
@pytest.mark.parametrize("problems", few_and_many(range(20), range(20, 200)))
def test_contacts_without_damping_are_within_their_stated_errors(problems: range) -> None:
    held_of_each, of_each = np.array([held(index) for index in problems]).T
    assert held_of_each.sum() >= 0.92 * of_each.sum()


def energy(motion: History, t: float) -> float:
    """Of bending, of motion, and of the pressed stop, J."""
    x, when = np.linspace(0.0, 1.0, 801), np.array([t])
    (stop,) = motion.problem.stops
    density = motion.evaluate(x, when, dx=2)[:, 0] ** 2 + motion.velocity(x, when)[:, 0] ** 2
    pressed = max(float(motion.displacement(stop.x, when)[0, 0]) - stop.gap, 0.0)
    return float(np.trapezoid(density, x) + stop.stiffness * pressed**2) / 2


@pytest.mark.parametrize("index", range(3))
def test_energy_that_switches_lose_is_within_what_impulses_are_said_to_be_off(index: int) -> None:
    """Impulses go with the root of the energy."""
    motion = analytic.Solver(n_modes=FEW_MODES).simulate(drawn(index), 5 * DURATION)
    errors = np.array([one.impulse_error for one in motion.contacts], dtype=float)
    assert len(errors) > 300
    largest = max(abs(one.impulse) for one in motion.contacts)
    lost = energy(motion, 5 * DURATION) / energy(motion, 0.0) - 1
    assert abs(lost) / 2 <= errors[np.isfinite(errors)].max() / largest
