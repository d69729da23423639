"""Branches by both solvers, and by a third, against closed forms and against marches on either side."""

from __future__ import annotations

import cmath
from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.answers import SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.seeds import on_branch, seed_from
from lapjoint.orbits.branches.tracing import Seed, Traced, trace
from tests.helpers.toy import Bar, bar

AMPLITUDE = "base_motion.amplitude"
FREQUENCY = "base_motion.angular_frequency"
GAP, OMEGA, DAMPING = 1e-3, 5.0, 0.8
TWO_STOPS = (
    Stop(x=1.0, side="top", gap=GAP, stiffness=50.0),
    Stop(x=0.6, side="top", gap=GAP, stiffness=50.0),
)


def cantilever() -> Problem:
    """A viscously damped cantilever of EI = m = L = 1 with two stops at the top."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=TWO_STOPS,
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


SOLVERS = {"analytic": analytic.Solver(n_modes=16), "fe": fe_lapjoint.Solver(elements=12)}
CLOSED_FORM = min(GAP / response(stop.x) for stop in TWO_STOPS)


@pytest.fixture(scope="module")
def by_amplitude() -> dict[str, tuple[Family, Traced]]:
    """The branch of the cantilever from its first graze on, over the amplitude of its base, by both solvers."""
    low, high = 0.8 * CLOSED_FORM, 1.1 * CLOSED_FORM
    return {name: branch_of(solver, cantilever(), AMPLITUDE, low, high, start=low) for name, solver in SOLVERS.items()}


@pytest.mark.parametrize("name", SOLVERS)
def test_the_first_graze_is_that_of_the_closed_form_within_its_error(
    name: str, by_amplitude: dict[str, tuple[Family, Traced]]
) -> None:
    branch = by_amplitude[name][1].branch
    graze = branch.bifurcations[0]
    assert (graze.kind, graze.stop, graze.after) == ("grazing", 0, "persists")
    assert graze.error <= 1e-5 * CLOSED_FORM
    assert graze.value == pytest.approx(CLOSED_FORM, rel=0, abs=graze.error)
    assert branch.ends == ("boundary", "boundary")


def test_both_solvers_find_the_same_folds_within_their_errors(by_amplitude: dict[str, tuple[Family, Traced]]) -> None:
    own, other = (
        [one for one in found.branch.bifurcations if one.kind == "fold"] for _, found in by_amplitude.values()
    )
    assert len(own) == len(other) == 2
    for a, b in zip(own, other, strict=True):
        assert max(a.error, b.error) <= 1e-5 * a.value
        assert abs(a.value - b.value) <= a.error + b.error


def test_a_graze_lies_at_its_point_whichever_way_the_branch_was_followed(
    by_amplitude: dict[str, tuple[Family, Traced]],
) -> None:
    family, found = by_amplitude["analytic"]
    after = found.branch.points[found.branch.bifurcations[0].index + 2]
    again = trace(family, Seed(after.value, after.motion.section_point, 2), most_multiple=2, errors=False)
    assert again is not None
    for branch in (found.branch, again.branch):
        graze = branch.bifurcations[0]
        assert graze.kind == "grazing"
        assert branch.points[graze.index].value == pytest.approx(graze.value, rel=1e-5)


@pytest.mark.parametrize("name", ["analytic", pytest.param("fe", marks=pytest.mark.thorough)])
def test_a_march_on_either_side_of_a_fold_does_what_the_branch_says(
    name: str, by_amplitude: dict[str, tuple[Family, Traced]]
) -> None:
    family, found = by_amplitude[name]
    points = found.branch.points
    up, down = (one for one in found.branch.bifurcations if one.kind == "fold")
    soft, hard = points[up.index - 1].motion.section_point, points[-1].motion.section_point
    for value, start, pressed in (
        (0.999 * up.value, soft, False),
        (1.001 * up.value, soft, True),
        (1.001 * down.value, hard, True),
        (0.999 * down.value, hard, False),
    ):
        assert (settled(family, value, start) > 1e-3) == pressed


def settled(family: Family, value: float, start: SectionPoint) -> float:
    """Impulse of the first stop in a period, N s, after a march from a section point."""
    map_ = family.at(value).map
    return float(map_.march(map_.march(map_.adopted(start), 2000).end, 2).impulses[0])


@pytest.mark.thorough
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


@pytest.mark.thorough
def test_a_doubled_branch_that_is_come_upon_by_itself_ends_at_its_flip() -> None:
    low, high = 0.745, 0.754
    family, found = branch_of(Bar(), bar(low, (1.0, 20.0)), FREQUENCY, low, high, start=high, errors=False)
    (flip,) = found.branch.bifurcations
    seed = seed_from(family, low, family.at(low).map.initial(), 2)
    assert seed is not None
    doubled = trace(family, seed, most_multiple=2, errors=False)
    assert doubled is not None
    assert doubled.branch.period_multiple == 2
    assert sorted(doubled.branch.ends) == ["bifurcation", "boundary"]
    assert not [one for one in doubled.branch.bifurcations if one.kind == "fold"]
    values = [point.value for point in doubled.branch.points]
    assert values == sorted(values)
    assert values[-1] == pytest.approx(flip.value, rel=1e-5)
