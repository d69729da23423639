"""A stiff stop without a gap chatters, and deviations grow by more in a period than a double number holds squared."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.orbits.period_map import Follows

BEAM = Beam(length=1.0, bending_stiffness=350.0, mass_per_length=1.56)
SOLVERS = {"analytic": analytic.Solver(n_modes=60), "fe": fe_lapjoint.Solver(elements=12)}
SQUARED = 355.0  # natural logarithm of the root of the largest double number


@pytest.mark.parametrize("name", [pytest.param("analytic", marks=pytest.mark.thorough), "fe"])
def test_the_growth_of_a_deviation_is_a_number_whatever_it_is(name: str) -> None:
    problem = Problem(
        beam=BEAM,
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
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
