"""A stiff stop without a gap chatters, and deviations grow by more in a period than a double number holds squared."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from beams import CLAMP

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Outcome, Problem, Stop, ViscousDamping
from lapjoint.orbits.period_map import Follows

BEAM = Beam(length=1.0, bending_stiffness=350.0, mass_per_length=1.56)
SOLVERS = {"analytic": analytic.Solver(n_modes=60), "fe": fe_lapjoint.Solver(elements=12)}
SQUARED = 355.0  # natural logarithm of the root of the largest double number


@pytest.mark.thorough
@pytest.mark.parametrize("name", SOLVERS)
def test_the_growth_of_a_deviation_is_a_number_whatever_it_is(name: str) -> None:
    problem = Problem(
        beam=BEAM,
        supports=(CLAMP,),
        stops=(
            Stop(x=1.0, side="top", gap=1e-3, stiffness=1e4),
            Stop(x=0.6, side="bottom", gap=0.0, stiffness=1e9),
        ),
        damping=ViscousDamping(coefficient=3.0),
        base_motion=BaseMotion(amplitude=2e-2, angular_frequency=6.0),
    )
    period_map = SOLVERS[name].period_map(problem)
    assert isinstance(period_map, Follows)
    start = period_map.initial()
    deviation = np.random.default_rng(0).standard_normal(period_map.difference(start, start).size)
    found = period_map.followed(start, deviation / period_map.norm(deviation), 1)
    assert np.isfinite(found.growth).all()
    assert found.growth.max() > SQUARED
    assert period_map.norm(found.deviation) == pytest.approx(1.0)


CHATTERING = Problem(
    beam=Beam(length=1.0, bending_stiffness=350.0, mass_per_length=1.56),
    supports=(CLAMP,),
    stops=(
        Stop(x=1.0, side="top", gap=1e-3, stiffness=1e4),
        Stop(x=0.6, side="bottom", gap=0.0, stiffness=1e12),
    ),
    damping=ViscousDamping(coefficient=3.0),
    base_motion=BaseMotion(amplitude=2e-3, angular_frequency=60.0, phase=0.1),
)
"""The inner stop has 2.9e9 EI / L^3.  Twenty decay times of free vibration, 2 m / C each, are 199 periods."""


@pytest.mark.parametrize(
    ("solver", "sensitivity"),
    [
        pytest.param(fe_lapjoint.Solver(elements=12), True, marks=pytest.mark.thorough),
        pytest.param(analytic.Solver(n_modes=80), False, marks=pytest.mark.thorough),
        pytest.param(fe_lapjoint.Solver(elements=12), False, marks=pytest.mark.slow),
        pytest.param(analytic.Solver(n_modes=80), True, marks=pytest.mark.slow),
        *(
            pytest.param(solver, sensitivity, marks=pytest.mark.slow)
            for solver in (fe_lapjoint.Solver(), analytic.Solver())
            for sensitivity in (True, False)
        ),
    ],
)
def test_the_search_for_a_steady_state_that_rounding_decides_ends(solver: Any, sensitivity: bool) -> None:
    """In each period a deviation grows by more than rounding can be told from: some 300 periods tell that."""
    found = solver.steady_state(CHATTERING, sensitivity=sensitivity)
    assert found.outcome is Outcome.APERIODIC
    assert found.exponent.positive
    assert found.exponent.value * 2 * math.pi / 60.0 > math.log(1 / np.finfo(float).eps)
    assert found.exponent.periods == 199
    assert np.isfinite(found.impulse_errors).all()
    assert found.acceptance.periods < 256
