"""Both solvers find the same static equilibria, within the errors that they state."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lapjoint import Beam, Circle, Material, Problem, Stop, Support
from lapjoint.answers import Equilibrium
from lapjoint.problem.beam import BeamSegment
from lapjoint.problem.static_loads import Gravity
from tests.helpers.random_joints import resting_joint
from tests.helpers.rested import SOLVERS, rested


def check_agree(one: Equilibrium, other: Equilibrium) -> None:
    x, ours, theirs = np.linspace(0, one.problem.beam.length, 57), one.errors, other.errors
    assert one.state == other.state
    assert one.other_equilibria == other.other_equilibria
    for a, b, error in (
        (one.contact_forces, other.contact_forces, ours.contact_forces + theirs.contact_forces),
        (one.support_forces, other.support_forces, ours.support_forces + theirs.support_forces),
        (one.support_moments, other.support_moments, ours.support_moments + theirs.support_moments),
        (one.displacement(x), other.displacement(x), ours.displacement + theirs.displacement),
        (one.slope(x), other.slope(x), ours.slope + theirs.slope),
        (one.moment(x), other.moment(x), ours.moment + theirs.moment),
        (one.shear(x), other.shear(x), ours.shear + theirs.shear),
    ):
        assert np.all(np.abs(a - b) <= error)
    size = np.abs(one.contact_forces).max(initial=0.0)
    assert np.all(theirs.contact_forces <= 1e-8 * size)


@pytest.mark.parametrize("held", [True, False])
def test_random_joints_rest_alike(held: bool) -> None:
    rng = np.random.default_rng(50 + held)
    for _ in range(10):
        found = rested(resting_joint(rng, held=held))
        if found:
            check_agree(*found)


@pytest.mark.slow
@pytest.mark.parametrize("held", [True, False])
def test_500_random_joints_rest_alike(held: bool) -> None:
    rng = np.random.default_rng(4803 + held)
    for _ in range(500):
        found = rested(resting_joint(rng, held=held))
        if found:
            check_agree(*found)


def test_stress_at_a_step_is_that_of_the_thinner_side() -> None:
    steel = Material(youngs_modulus=2e11, density=7800.0)
    sizes = ((0.4, 0.03), (1.0, 0.02))
    segments = [BeamSegment(to=to, section=Circle(diameter=d)) for to, d in sizes]
    problem = Problem(
        beam=Beam(length=1.0, material=steel, segments=segments),
        supports=[Support(x=0.0, translational=math.inf, torsional=math.inf)],
        stops=[Stop(x=1.0, side="bottom", gap=1.0, stiffness=1e5)],
        gravity=Gravity(acceleration=-9.81),
    )
    weight = 7800 * math.pi / 4 * 0.02**2 * 9.81
    moment, modulus = -weight * 0.6**2 / 2, math.pi * 0.02**3 / 32
    for solver in SOLVERS:
        found = solver.equilibrium(problem)
        assert found.moment(0.4)[0] == pytest.approx(moment, rel=1e-12)
        assert found.bending_stress(0.4)[0] == pytest.approx(-moment / modulus, rel=1e-12)
        assert found.moment(np.nextafter(0.4, 1))[0] == pytest.approx(moment, rel=1e-12)
        largest = found.largest_stress()
        assert largest.x == 0.4
        assert largest.value == pytest.approx(-moment / modulus, rel=1e-12)
        assert found.largest_moment().x == 0.0
