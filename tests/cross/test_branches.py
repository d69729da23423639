"""Branches by both solvers, and by a third, against closed forms and against marches on either side."""

from __future__ import annotations

import cmath
from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.seeds import on_branch, seed_from
from lapjoint.orbits.branches.tracing import Traced, trace
from tests.helpers.toy import Bar, bar

AMPLITUDE = "base_motion.amplitude"
FREQUENCY = "base_motion.angular_frequency"
GAP, OMEGA, DAMPING = 1e-3, 5.0, 0.8
TOP_AND_BOTTOM = (
    Stop(x=1.0, side="top", gap=GAP, stiffness=50.0),
    Stop(x=0.6, side="top", gap=GAP, stiffness=50.0),
)


def cantilever() -> Problem:
    """A viscously damped cantilever of EI = m = L = 1 with two stops at the top."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=TOP_AND_BOTTOM,
        damping=ViscousDamping(coefficient=DAMPING),
        base_motion=BaseMotion(amplitude=1e-4, angular_frequency=OMEGA),
    )


def response(x: float) -> float:
    """|H|: amplitude of the cantilever at x under a base of amplitude 1, from EI z'''' = (m w^2 - i C w) z + m w^2."""
    square = OMEGA**2 - 1j * DAMPING * OMEGA
    b, particular = cmath.sqrt(cmath.sqrt(square)), -(OMEGA**2) / square

    def row(x: float, n: int) -> list[complex]:
        cos = [cmath.cos(b * x), -cmath.sin(b * x), -cmath.cos(b * x), cmath.sin(b * x)][n % 4]
        sin = [cmath.sin(b * x), cmath.cos(b * x), -cmath.sin(b * x), -cmath.cos(b * x)][n % 4]
        cosh, sinh = cmath.cosh(b * x), cmath.sinh(b * x)
        return [b**n * one for one in (cos, sin, *((cosh, sinh) if n % 2 == 0 else (sinh, cosh)))]

    rows = np.array([row(0.0, 0), row(0.0, 1), row(1.0, 2), row(1.0, 3)])
    constants = np.linalg.solve(rows, [-particular, 0, 0, 0])
    return float(abs(particular + np.array(row(x, 0)) @ constants))


def branch_of(
    solver: Any, problem: Problem, path: str, low: float, high: float, *, start: float, errors: bool = True
) -> tuple[Family, Traced]:
    """The branch of the motion from rest at one value."""
    grid = Grid(problem, (Axis(path, (low, high)),))
    family = Family(solver, lambda value: grid.with_values((value,)), path, low, high)
    seed = seed_from(family, start, family.at(start).map.initial(), 1)
    assert seed is not None
    found = trace(family, seed, most_multiple=2, errors=errors)
    assert found is not None
    return family, found


@pytest.mark.parametrize(
    "solver", [analytic.Solver(n_modes=16), fe_lapjoint.Solver(elements=12)], ids=["analytic", "fe"]
)
def test_the_first_graze_is_that_of_the_closed_form_within_its_error(solver: Any) -> None:
    exact = min(GAP / response(stop.x) for stop in TOP_AND_BOTTOM)
    _, found = branch_of(solver, cantilever(), AMPLITUDE, 0.8 * exact, 1.1 * exact, start=0.8 * exact)
    graze = next(one for one in found.branch.bifurcations if one.kind == "grazing")
    assert graze.stop == 0
    assert graze.after == "persists"
    assert graze.error <= 1e-5 * exact
    assert graze.value == pytest.approx(exact, rel=0, abs=graze.error)
    assert found.branch.ends == ("boundary", "boundary")


def test_a_march_on_either_side_of_a_flip_does_what_the_branch_says() -> None:
    low, high = 0.745, 0.754
    problem = bar(low, (1.0, 20.0))
    family, found = branch_of(Bar(), problem, FREQUENCY, low, high, start=high, errors=False)
    (flip,) = found.branch.bifurcations
    assert flip.kind == "flip"
    solver = Bar()
    for value, multiple in ((flip.value - 1e-3, 2), (flip.value + 1e-3, 1)):
        assert (
            solver.steady_state(family.problem_at(value), sensitivity=False, errors=False).period_multiple == multiple
        )
    for point in found.branch.points:
        assert point.motion.stable == (point.value > flip.value)
    (seed,) = found.seeds
    doubled = trace(family, seed, most_multiple=1, errors=False)
    assert doubled is not None
    assert doubled.branch.period_multiple == 2
    assert doubled.branch.ends == ("bifurcation", "boundary")
    assert all(point.value < flip.value and point.motion.stable for point in doubled.branch.points)
    values = [point.value for point in doubled.branch.points]
    sections = [point.motion.section_point for point in doubled.branch.points]
    assert on_branch(family, seed, values, sections, seed.count)
