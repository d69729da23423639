"""A bifurcation that a finer solver has not is not taken for a neighbour of its kind that it has.

The curves are made: p = 1 + g(y) with the coordinate 1 + y, whose slope is a cubic of the coarse solver with two folds,
and one of the finer solver with the first of them alone.  A hairpin may be shorter than a first step of the search.
"""

from __future__ import annotations

from dataclasses import dataclass
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from made_map import Made, MadeMap, made_problem, of_trace

from lapjoint import BaseMotion, Problem
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.errors import SolverError
from lapjoint.orbits.branches import found_again, grazing
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import graze_finder, is_same, smooth_finder
from lapjoint.orbits.branches.locating import Kind
from lapjoint.orbits.branches.value_errors import AIM, stated
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.orbits.refinement import Refinement

AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 0.9, 1.1
SHORT = 5e-6  # below the first step by which it is found out how fast the tangent turns


@dataclass(frozen=True)
class Folds:
    """A solver whose curve has a fold at y = 0 and, unless it is the finer one that lacks it, one at `second`."""

    second: float
    lacks: bool
    steep: float
    finest: bool = False

    name = "folds"

    def finer(self, problem: Problem) -> tuple[Refinement, Folds] | None:
        """One finer solver."""
        if self.finest:
            return None
        return Refinement("made", 2.0, 2.0), Folds(self.second * (1 + 1e-6), self.lacks, self.steep, True)

    def period_map(self, problem: Problem) -> FoldMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return FoldMap(problem, np.eye(1), self, problem.base_motion.amplitude - 1)


@dataclass(frozen=True)
class FoldMap(MadeMap):
    """y -> y + p - 1 - g(y)."""

    of: Folds | None = None
    p: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        it, y = self.of, start.coordinates[0, 0] - 1
        assert it is not None
        a, K = it.second, it.steep
        alone = it.lacks and it.finest
        g, rise = (-K * a * y**2 / 2, -K * a * y) if alone else (K * (y**3 / 3 - a * y**2 / 2), K * y * (y - a))
        end = SectionPoint(FREE, np.array([[1 + y + self.p - g]]))
        return Linearised(end, lambda: Derivative(np.array([[1 - rise]])), tuple)


@dataclass(frozen=True)
class Hairpin(MadeMap):
    """y -> y + p - 1 + K y^2 / 2, which cannot be marched from farther than `SHORT` from its fold at y = 0."""

    steep: float = 0.0
    p: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        y = start.coordinates[0, 0] - 1
        if abs(y) > SHORT:
            raise SolverError("too far")
        end = SectionPoint(FREE, np.array([[1 + y + self.p - 1 + self.steep * y**2 / 2]]))
        return Linearised(end, lambda: Derivative(np.array([[1 + self.steep * y]])), tuple)


@dataclass(frozen=True)
class Short:
    """A solver that gives such maps."""

    steep: float
    name = "short"

    def period_map(self, problem: Problem) -> Hairpin:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return Hairpin(problem, np.eye(1), self.steep, problem.base_motion.amplitude)


@pytest.mark.parametrize("seed", range(25))
def test_a_fold_in_a_hairpin_that_is_shorter_than_a_first_step_is_found(seed: int) -> None:
    rng = np.random.default_rng((72, seed))
    steep, y = 10 ** rng.uniform(4, 4.5), rng.choice([-1, 1]) * rng.uniform(0.3, 0.5) * SHORT
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(Short(steep), lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    place = corrected(family, 1 - steep * y**2 / 2, SectionPoint(FREE, np.array([[1 + y]])), 2)
    assert place is not None
    found = smooth_finder("fold")(family, place)
    assert found is not None
    assert abs(found.place.point.coordinates[0, 0] - 1) <= 1e-8


@pytest.mark.parametrize("away", [None, 0.004, -0.008])
@pytest.mark.parametrize("imaginary", [0.03, 0.48])
def test_a_pair_whose_real_part_is_minus_one_is_no_flip(imaginary: float, away: float | None) -> None:
    """Two selves with 40 and 61 elements had one so, alike to 8e-8: others had a flip half a millionth farther."""

    def blocks(p: float) -> list[np.ndarray]:
        own = [of_trace(-2 + 0.05 * (p - 1), 1 + imaginary**2)]
        return own if away is None else [*own, np.array([[-1 - 3 * (p - 1 - away)]])]

    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(Made(blocks), lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    place = corrected(family, 1.00001, family.at(1.00001).map.initial(), 2, fixed=True)
    assert place is not None
    found = smooth_finder("flip")(family, place)
    assert (found is None) == (away is None)
    if found is not None and away is not None:
        assert found.value == pytest.approx(1 + away, abs=1e-8)


@pytest.mark.parametrize("lacks", [True, False])
@pytest.mark.parametrize("seed", range(25))
def test_a_fold_that_a_finer_solver_lacks_is_not_another(seed: int, lacks: bool) -> None:
    rng = np.random.default_rng((71, seed))
    second, steep = rng.uniform(0.005, 0.03), rng.uniform(10.0, 300.0)
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(Folds(second, lacks, steep), lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    value = 1 - steep * second**3 / 6
    place = corrected(family, value, SectionPoint(FREE, np.array([[1 + second]])), 2)
    assert place is not None
    assert place.tangent[-1] == pytest.approx(0.0, abs=1e-6)
    found = stated(family, place, place.value, smooth_finder("fold"))
    if lacks:
        assert not np.isfinite(found.error)
    else:
        assert found.error <= AIM
        assert found.value == pytest.approx(value, abs=found.error)


def at(*, repeats_sooner: bool) -> Any:
    """A motion at a bifurcation, or just before a graze."""
    return SimpleNamespace(
        value=1.0,
        tangent=np.zeros(2),
        closings=(2,),
        count=4,
        extrema=SimpleNamespace(duration=1.0),
        orbit=SimpleNamespace(values=np.array([-1.0 + 0j])),
        matching=lambda extremum, duration: extremum,
        moved=lambda family, step: (1.0, None),
        repeats_sooner_than=lambda other: repeats_sooner,
    )


@pytest.mark.parametrize("kind", ["fold", "flip", "symmetry breaking", "neimark-sacker"])
def test_what_repeats_sooner_is_another_one(kind: Kind) -> None:
    """It has the same contacts, and the same critical multiplier."""
    place = at(repeats_sooner=False)
    assert is_same(kind, at(repeats_sooner=False), place)
    assert not is_same(kind, at(repeats_sooner=True), place)


@pytest.mark.parametrize("repeating", [0, 1, 4])
def test_a_graze_that_repeats_sooner_is_looked_for_from_farther_before(
    repeating: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    """From the first of four places before it Newton's method leads to the branch from which its own springs."""
    grazes = [
        SimpleNamespace(place=at(repeats_sooner=i < repeating), value=float(i), left=0.0, touched=False)
        for i in range(4)
    ]
    located, family, extremum = iter(grazes), Any, SimpleNamespace(stop=0)
    monkeypatch.setattr(found_again, "taken_over", lambda *_: at(repeats_sooner=False))
    monkeypatch.setattr(found_again, "corrected", lambda *_: at(repeats_sooner=False))
    monkeypatch.setattr(grazing, "located_graze", lambda *_: next(located))
    before: Any = SimpleNamespace(extremum=extremum, place=at(repeats_sooner=False), closings_of_sides=((2,), (1,)))
    found = graze_finder(before, 1.0)(family, at(repeats_sooner=False))
    assert (None if found is None else found.value) == (None if repeating == 4 else float(repeating))


@pytest.mark.parametrize("repeats_sooner", [False, True])
def test_newtons_method_on_an_extremum_that_leads_to_a_motion_that_repeats_sooner_finds_no_graze(
    repeats_sooner: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    there: Any = SimpleNamespace(place=at(repeats_sooner=repeats_sooner), extremum=SimpleNamespace(value=1e-3))
    monkeypatch.setattr(grazing, "on_extremum", lambda *_, **__: there)
    expected, family = None if repeats_sooner else there, Any
    assert grazing.located_graze(family, at(repeats_sooner=False), there.extremum, 1.0) is expected
    beyond: Any = SimpleNamespace(place=at(repeats_sooner=False), extremum=there.extremum)
    assert grazing._at_share(family, beyond, 0.5, 1.0) is expected
