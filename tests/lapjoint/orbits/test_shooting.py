"""Strongly unstable motions are taken to a finer solver, where Newton's method from one point misses them.

The motions are those at 22 of 1500 bifurcations, drawn at random, of the paper's joint with a quarter of its damping:
the coarsest solver's, with multipliers from five to a thousand.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from finer_curve import family as lightly_damped
from made_map import MadeMap, made_problem

import analytic
import fe_lapjoint
from lapjoint import FREE, Axis, Problem, paper_joint
from lapjoint.answers import SectionPoint
from lapjoint.campaigns import Grid
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family, HasPeriodMap
from lapjoint.orbits.branches.shooting import Stretch, _shot, stretches_of, taken_over
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.orbits.period_map import Derivative, Linearised

MOTIONS = json.loads((Path(__file__).parent / "strongly_unstable.json").read_text(encoding="utf-8"))
RATIO = 0.02
STEPS = 3  # each to a solver with half as many modes again
FAR = 2e-3  # distance of the coarsest self's motion, over its size


@pytest.fixture(scope="module")
def family() -> Family:
    return lightly_damped()


def own_place(family: Family, number: int) -> Place:
    """The motion by the solver that found it."""
    value, section, count = MOTIONS[number]
    motion = motion_from((value, section, count))
    place = corrected(family, value, motion.point, count, fixed=True)
    assert place is not None
    return place


def test_finer_solvers_have_strongly_unstable_motions_that_newtons_method_misses_from_one_point(family: Family) -> None:
    """Each of three has it with the same contacts, and nearer to the next than the one before."""
    missed, found = 0, 0
    for number in range(len(MOTIONS)):
        place = own_place(family, number)
        chain = list(finer_ones(family, place))
        assert all(one.orbit.residual <= RESIDUAL for one, _ in chain)
        distances = [distance for _, distance in chain]
        assert distances[0] <= FAR
        if len(chain) == STEPS and {one.closings for one, _ in chain} == {place.closings}:
            assert distances[2] <= 0.5 * distances[1] <= 0.25 * distances[0]
            found += 1
        own = finer_than(family, place)
        missed += corrected(own, place.value, own.adopted(place.value, place.point), place.count) is None
    assert missed >= 0.9 * len(MOTIONS)  # on the edge, rounding decides: of one, and whether others close to 1e-9
    assert found >= 0.8 * len(MOTIONS)


def finer_ones(family: Family, place: Place) -> Iterator[tuple[Place, float]]:
    """The motion by finer solvers in turn, as far as they have it, with its distance from that of the one before."""
    for _ in range(STEPS):
        family = finer_than(family, place)
        there = taken_over(family, place)
        if there is None:
            return
        yield there, float(np.linalg.norm(there.chord(family, place)))
        place = there


def finer_than(family: Family, place: Place) -> Family:
    """The next finer solver."""
    finer = family.finer(place.value)
    assert finer is not None
    return finer[1]


@pytest.mark.parametrize("number", range(len(MOTIONS)))
def test_stretches_make_up_the_motion_in_one_state(family: Family, number: int) -> None:
    place = own_place(family, number)
    stretches = stretches_of(place)
    assert len(stretches) > 1
    assert sum(one.half_periods for one in stretches) == place.count
    assert {one.point.state for one in stretches} == {place.point.state}
    for one, after in zip(stretches, [*stretches[1:], stretches[0]], strict=True):
        half = place.half_periods
        assert half.apart(half.marched(one.point, one.half_periods), after.point) <= 1e-3  # what 1e-9 grows to


def test_a_number_by_which_the_solver_has_no_derivative_is_as_good(family: Family) -> None:
    place = own_place(family, 1)
    path, low, high = "damping.ratio", 0.9 * RATIO, 1.1 * RATIO
    grid = Grid(paper_joint(angular_frequency=place.value), (Axis(path, (low, high)),))
    solver = family.solver_at(place.value)
    over_damping = Family(solver, lambda value: grid.with_values((value,)), path, low, high)
    own = corrected(over_damping, RATIO, over_damping.adopted(RATIO, place.point), place.count, fixed=True)
    assert own is not None
    assert own.orbit.last.by_number is None
    there = taken_over(finer_than(over_damping, own), own)
    assert there is not None
    assert there.value == pytest.approx(RATIO, rel=1e-3)


def test_a_motion_that_is_elsewhere_is_not_found(family: Family) -> None:
    place = own_place(family, 1)
    finer = finer_than(family, place)
    half = finer.at(place.value)
    n = half.map.adopted(place.point).coordinates.size
    step = 0.3 * half.size(place.point) * np.ones(n) / half.unit_norms(n)
    assert taken_over(finer, place, lambda point: half.map.moved(half.map.adopted(point), step)) is None


@dataclass(frozen=True)
class RootMap(MadeMap):
    """P(x) = x + sqrt(x - 1), with the sign of x - 1: Newton's method goes to and fro about 1 for ever."""

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        x = start.coordinates[0] - 1
        end = SectionPoint(FREE, start.coordinates + np.copysign(np.sqrt(np.abs(x)), x))
        return Linearised(end, lambda: Derivative(np.diag(1 + 0.5 / np.sqrt(np.abs(x)))), tuple)


@dataclass(frozen=True)
class Root:
    """A solver with such a map."""

    name = "root"

    def period_map(self, problem: Problem) -> RootMap:
        """The map."""
        return RootMap(problem, np.eye(1))


@pytest.mark.parametrize("count", [1, 2, 3])
def test_steps_that_go_to_and_fro_end(count: int) -> None:
    grid = Grid(made_problem(1.0), (Axis("base_motion.amplitude", (0.5, 1.5)),))
    family = Family(Root(), lambda value: grid.with_values((value,)), "base_motion.amplitude", 0.5, 1.5)
    aside = [Stretch(SectionPoint(FREE, np.array([[1 + 1e-6]])), 2)] * count
    assert _shot(family, 1.0, aside, 2 * count, fixed=True) is None
    assert family.marches <= 7 * count  # four rounds, and derivatives by the number, which this solver does not know


@pytest.mark.parametrize("half_periods", [1, 2])
@pytest.mark.parametrize("solver", [fe_lapjoint.Solver(elements=60), analytic.Solver()], ids=["fe", "analytic"])
def test_deviations_are_carried_as_by_the_whole_matrix(solver: HasPeriodMap, half_periods: int) -> None:
    """Also where it is known by two factors, and where the end of a march over an odd number is mirrored."""
    half = HalfPeriods(solver.period_map(paper_joint(angular_frequency=300.0)))
    start = half.marched(half.map.initial(), 20)
    found = half.linearised(start, half_periods)
    assert (found.linearised.known.factors is None) == isinstance(solver, analytic.Solver)
    deviations = np.random.default_rng(34).normal(size=(found.matrix.shape[0], 3))
    for some in (deviations, deviations[:, 0]):
        carried, whole = found.carried(some), found.matrix @ some
        assert carried == pytest.approx(whole, rel=1e-9, abs=1e-12 * np.abs(whole).max())
