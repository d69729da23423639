"""Motions at which something vanishes, on made curves of which the truth is known.

The curve is p = 1 + b y + c y^2 with another coordinate z = s y^2, which decays with a multiplier of its own; what
vanishes is a multiplier plus 1, or the number's part of the tangent.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pytest
from made_map import MadeMap, made_problem

from lapjoint import BaseMotion, Problem
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.critical_search import Critical, change_beside, critical_motion, one_step
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import critical, smooth_finder
from lapjoint.orbits.branches.value_errors import stated
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.orbits.refinement import Refinement

LOCATED = 1e-9  # length of a step along the curve at which it is found
AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 0.5, 1.5
OFF = 1e-3
"""How far the guess is from the curve, and from where something vanishes along it, relative, at most."""


@dataclass(frozen=True)
class Curve:
    """A solver with such a curve."""

    b: float
    c: float
    s: float
    at: float
    """Where the third multiplier is -1."""
    rate: float
    """How fast it changes with y."""
    bend: float
    name = "curve"

    def period_map(self, problem: Problem) -> CurveMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return CurveMap(problem, np.eye(3), self, problem.base_motion.amplitude)

    def multiplier(self, y: float) -> float:
        """The third multiplier."""
        return -1 + self.rate * (y - self.at) + self.bend * (y - self.at) ** 2


@dataclass(frozen=True)
class CurveMap(MadeMap):
    """See the top."""

    of: Curve | None = None
    p: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        it = self.of
        assert it is not None
        y, z, w = start.coordinates[0] - 1
        mu, slope = it.multiplier(y), it.rate + 2 * it.bend * (y - it.at)
        end = [y + self.p - 1 - it.b * y - it.c * y**2, it.s * y**2 + 0.3 * (z - it.s * y**2), mu * w]
        matrix = [[1 - it.b - 2 * it.c * y, 0, 0], [1.4 * it.s * y, 0.3, 0], [slope * w, 0, mu]]
        return Linearised(SectionPoint(FREE, 1 + np.array([end])), lambda: Derivative(np.array(matrix, float)), tuple)


def drawn(seed: int, fold: bool) -> tuple[Curve, Family, float]:
    """A curve, its maps, and the y at which something vanishes."""
    rng = np.random.default_rng((95, seed))
    at = rng.choice([-1, 1]) * rng.uniform(0.01, 0.05)
    c = rng.choice([-1, 1]) * rng.uniform(0.3, 3.0)
    b = -2 * c * at if fold else rng.choice([-1, 1]) * rng.uniform(0.3, 1.2)
    curve = Curve(b, c, rng.uniform(-3, 3), at, rng.choice([-1, 1]) * 10 ** rng.uniform(-1, 2), rng.uniform(-50, 50))
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    return curve, Family(curve, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH), at


def motion(curve: Curve, family: Family, y: float) -> Place:
    point = SectionPoint(FREE, 1 + np.array([[y, curve.s * y**2, 0.0]]))
    found = corrected(family, 1 + curve.b * y + curve.c * y**2, point, 2)
    assert found is not None
    return found


@pytest.mark.parametrize("told", [False, True])
@pytest.mark.parametrize("fold", [False, True])
@pytest.mark.parametrize("seed", range(25))
def test_it_is_found_from_beside_the_curve(seed: int, fold: bool, told: bool) -> None:
    """The rate may be told, wrong by a fifth, by a place that goes either way."""
    curve, family, at = drawn(seed, fold)
    rng = np.random.default_rng((96, seed))
    there = motion(curve, family, at)
    vanishes, y = critical("fold" if fold else "flip", there), at + OFF * rng.uniform(-1, 1)
    like = None
    if told:
        like = change_beside(family, there if seed % 2 else there.turned(), vanishes)
        assert like is not None
        assert like.rate is not None
        like = Critical(like.place, like.rate * rng.uniform(0.8, 1.2))
    guess = SectionPoint(FREE, 1 + np.array([[y, curve.s * y**2 + OFF * rng.uniform(-1, 1), OFF * rng.uniform(-1, 1)]]))
    asked = list[Place]()

    def counted(place: Place) -> float:
        asked.append(place)
        return vanishes(place)

    found = critical_motion(family, 1 + curve.b * y + curve.c * y**2, guess, 2, counted, like)
    assert found is not None
    assert len(asked) <= (7 if told else 9)
    y, z, w = found.place.point.coordinates[0] - 1
    assert y == pytest.approx(at, abs=10 * LOCATED)
    assert z == pytest.approx(curve.s * at**2, abs=10 * LOCATED)
    assert w == pytest.approx(0.0, abs=10 * LOCATED)
    exact = change_beside(family, found.place, vanishes)
    assert exact is not None
    assert found.rate == pytest.approx(exact.rate, rel=0.3)


@pytest.mark.parametrize("fold", [False, True])
@pytest.mark.parametrize("seed", range(25))
def test_one_step_leads_to_where_another_solver_has_it(seed: int, fold: bool) -> None:
    """From that of a curve beside it, to a fifth of the way between both."""
    curve, family, at = drawn(seed, fold)
    rng = np.random.default_rng((98, seed))
    way = rng.choice([-1, 1]) * 10 ** rng.uniform(-6, -5)
    b = -2 * curve.c * (at + way) if fold else curve.b
    other = replace(curve, b=b, s=curve.s * (1 + rng.uniform(-OFF, OFF)), at=at + way)
    theirs = Family(other, family.problem_at, AMPLITUDE, LOW, HIGH)
    there = motion(other, theirs, at + way)
    vanishes = critical("fold" if fold else "flip", there)
    known = change_beside(theirs, there if seed % 2 else there.turned(), vanishes)
    assert known is not None
    ahead = one_step(family, known, vanishes)
    assert ahead is not None
    assert family.marches <= 2  # one, and that of the derivative by the number, which this solver does not know
    truth = np.array([1 + at, 1 + curve.s * at**2, 1.0, 1 + curve.b * at + curve.c * at**2])
    between = np.append(there.point.coordinates[0], there.value) - truth
    missed = np.append(ahead.point.coordinates[0], ahead.value) - truth
    assert np.linalg.norm(missed) <= 0.2 * np.linalg.norm(between)


@pytest.mark.parametrize("seed", range(25))
def test_where_nothing_vanishes_nothing_is_found(seed: int) -> None:
    """The multiplier comes near to -1, and turns back."""
    curve, family, at = drawn(seed, fold=False)
    least = 10 ** np.random.default_rng((97, seed)).uniform(-6, -2)
    never = Curve(curve.b, curve.c, curve.s, at, 0.0, abs(curve.bend) + 1)
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(never, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    there = motion(never, family, at + OFF)
    vanishes = critical("flip", there)
    assert critical_motion(family, there.value, there.point, 2, lambda place: vanishes(place) + least) is None


@pytest.mark.parametrize("seed", range(25))
def test_none_is_found_out_of_reach(seed: int) -> None:
    """Another bifurcation of the curve is not taken for the one that is looked for."""
    curve, family, at = drawn(seed, fold=False)
    there = motion(curve, family, at + 0.03)
    found = critical_motion(family, there.value, there.point, 2, critical("flip", there))
    assert found is None or float(np.linalg.norm(found.place.chord(family, there))) <= 0.011


@pytest.mark.parametrize("told", [False, True])
@pytest.mark.parametrize("seed", range(25))
def test_from_where_it_vanishes_no_step_leads_away(seed: int, told: bool) -> None:
    """To find out how fast something changes takes a step, which must not be what is found."""
    curve, family, at = drawn(seed, fold=False)
    there = motion(curve, family, at * (1 + 1e-9))
    vanishes = critical("flip", there)
    like = change_beside(family, there, vanishes) if told else None
    found = critical_motion(family, there.value, there.point, 2, vanishes, like)
    assert found is not None
    assert found.place.point.coordinates[0, 0] - 1 == pytest.approx(at, abs=2 * LOCATED)


@pytest.mark.parametrize("seed", range(25))
def test_where_rounding_hides_it_the_rest_is_told(seed: int) -> None:
    """Beside a fold a tangent is known to 1e-8: no step comes nearer than that over the rate."""
    curve, family, at = drawn(seed, fold=False)
    there, rounding = motion(curve, family, at + OFF), 10 ** np.random.default_rng((98, seed)).uniform(-9, -7.5)
    vanishes = critical("flip", there)

    def rounded(place: Place) -> float:
        return vanishes(place) + rounding * float(np.sin(1e14 * place.value))

    found = critical_motion(family, there.value, there.point, 2, rounded, change_beside(family, there, vanishes))
    apart = rounding / abs(curve.rate) / 0.3  # arc length over y is 0.3 at least
    assert found is not None
    assert abs(found.place.point.coordinates[0, 0] - 1 - at) <= 3 * (apart + LOCATED)
    assert found.left <= 3 * apart


@dataclass(frozen=True)
class Lacking(Curve):
    """A solver whose finer selves have another curve."""

    other: Curve | None = None

    def finer(self, problem: Problem) -> tuple[Refinement, Lacking]:
        """One finer solver."""
        it = self if self.other is None else self.other
        return Refinement("made", 1.5, 3.0), Lacking(it.b, it.c, it.s, it.at, it.rate, it.bend)


@pytest.mark.parametrize("seed", range(50))
def test_a_neighbour_along_the_curve_is_not_stated_however_near_its_number_is(seed: int) -> None:
    """Finer solvers lack the flip that is meant, and have its neighbour, where the number hardly changes."""
    rng = np.random.default_rng((99, seed))
    at, c, rate = rng.uniform(0.01, 0.05), rng.uniform(0.3, 3.0), rng.choice([-1, 1]) * rng.uniform(1, 50)
    beside = rng.choice([-1, 1]) * 10 ** rng.uniform(-4.5, -3.3)
    b, s = -2 * c * (at + beside / 2) + rng.choice([-1, 1]) * 3e-3, rng.uniform(-3, 3)
    curve = Lacking(b, c, s, at, rate, -rate / beside, Curve(b, c, s, at + beside, -rate, 0.0))
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(curve, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    here = motion(curve, family, at)
    neighbour = 1 + b * (at + beside) + c * (at + beside) ** 2
    assert abs(neighbour - here.value) <= 1e-5
    found = stated(family, here, here.value, smooth_finder("flip", own=family))
    assert found.error == np.inf
