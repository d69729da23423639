"""The stated error of a bifurcation holds where solvers converge irregularly, and two agree by chance.

Maps are made: a fixed point that stands still, whose multipliers pass the circle at a number which is off by a random
part of what the order of convergence allows, for each self of the solver anew.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace

import numpy as np
import pytest
from made_map import Blocks, Made, MadeMap, made_problem, pair

from lapjoint import Problem
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Again, smooth_finder
from lapjoint.orbits.branches.locating import Kind
from lapjoint.orbits.branches.value_errors import AIM, Stated, stated
from lapjoint.orbits.refinement import Refinement

AMPLITUDE, LOW, HIGH, AT = "base_motion.amplitude", 0.9, 1.1, 1.0
ORDER, RATIO = 3.0, 1.5
LARGEST = 1e-6  # shift of the coarsest self, at most: all agree to 1e-5
MANY = 400
BY_CHANCE = 0.01  # largest difference of two selves that agree by chance, over how far both are off


@dataclass(frozen=True)
class Irregular(Made):
    """A solver that has all of a made map at a number that is larger by the shift of its level."""

    shifts: tuple[float, ...] = ()
    name = "irregular"

    def period_map(self, problem: Problem) -> MadeMap:
        """The map at the amplitude of a problem."""
        return Made(lambda p: self.blocks(p - self.shifts[0])).period_map(problem)

    def finer(self, problem: Problem) -> tuple[Refinement, Irregular] | None:
        """One finer solver."""
        return (Refinement("made", RATIO, ORDER), replace(self, shifts=self.shifts[1:])) if self.shifts[1:] else None


def shifts_of(rng: np.random.Generator, by_chance: bool) -> tuple[float, ...]:
    """Shifts that fall with the order of convergence or faster; the two coarsest selves may agree by chance."""
    shifts = LARGEST * RATIO ** (-ORDER * np.arange(5)) * rng.uniform(-1, 1, 5)
    if by_chance:
        shifts[0] = shifts[1] * (1 + BY_CHANCE * rng.uniform(-1, 1))
    return tuple(shifts.tolist())


def blocks_of(kind: Kind, rate: float) -> Blocks:
    """Multipliers that pass the circle at `AT`."""
    if kind == "flip":
        return lambda p: [np.array([[-np.exp(rate * (p - AT))]]), pair(0.3, 1.0)]
    return lambda p: [pair(float(np.exp(rate * (p - AT))), 1.2), np.array([[0.4]])]


@pytest.mark.parametrize("kind", ["flip", "neimark-sacker"])
@pytest.mark.parametrize(("by_chance", "share"), [(False, 0.01), (True, 0.1)])
def test_errors_hold_where_two_solvers_agree_by_chance(kind: Kind, by_chance: bool, share: float) -> None:
    """All but a share of them: for three may agree by chance, too."""
    too_small = 0
    for seed in range(MANY):
        rng = np.random.default_rng((83, seed))
        shifts, rate = shifts_of(rng, by_chance), rng.choice([-1, 1]) * rng.uniform(1, 50)
        found = stated_of(kind, Irregular(blocks_of(kind, rate), shifts), AT + shifts[0])
        assert found.error <= AIM
        too_small += abs(found.value - AT) > found.error
    assert too_small <= share * MANY


def stated_of(kind: Kind, solver: Irregular, value: float) -> Stated:
    """A bifurcation of a solver with its error."""
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(solver, lambda number: grid.with_values((number,)), AMPLITUDE, LOW, HIGH)
    place = corrected(family, value, family.at(value).map.initial(), 2)
    assert place is not None
    return stated(family, place, value, smooth_finder(kind))


@dataclass(frozen=True)
class Lacking(Made):
    """A solver whose finer selves, from one on, have other multipliers."""

    others: Blocks = field(kw_only=True)
    level: int = field(kw_only=True)
    name = "lacking"

    def period_map(self, problem: Problem) -> MadeMap:
        """The map at the amplitude of a problem."""
        return Made(self.blocks if self.level > 0 else self.others).period_map(problem)

    def finer(self, problem: Problem) -> tuple[Refinement, Lacking]:
        """One finer solver."""
        return Refinement("made", RATIO, ORDER), replace(self, level=self.level - 1)


@pytest.mark.parametrize("level", [1, 2])
def test_a_neighbour_on_which_finer_solvers_agree_is_not_stated(level: int) -> None:
    """However near it is: they lack the one that is meant, and have the neighbour alike."""
    for seed in range(MANY // 4):
        rng = np.random.default_rng((86, seed))
        rate, sign, beside = (
            rng.uniform(5, 50),
            rng.choice([-1, 1]),
            rng.choice([-1, 1]) * 10 ** rng.uniform(-4.5, -2.6),
        )

        def flip(at: float, rate: float = rate * sign) -> Callable[[float], np.ndarray]:
            return lambda p: np.array([[-np.exp(rate * (p - at))]])

        first, neighbour = flip(AT), flip(AT + beside, -rate * sign)
        solver = Lacking(
            lambda p, first=first, neighbour=neighbour: [first(p), neighbour(p)],
            others=lambda p, neighbour=neighbour: [np.array([[0.3]]), neighbour(p)],
            level=level,
        )
        found = stated_of("flip", solver, AT)
        assert found.error == np.inf or abs(found.value - AT) <= found.error


@pytest.mark.parametrize(("lacks", "selves", "sure"), [((), 4, True), ((2,), 4, False), ((3,), 4, True), ((), 2, True)])
def test_what_the_third_self_lacks_is_not_sure(lacks: tuple[int, ...], selves: int, sure: bool) -> None:
    """Two agree, and may by chance; where there is no third one, none is to be asked."""
    shifts = (3e-8, 2e-8, 1e-8, 0.0)[:selves]
    solver = Irregular(blocks_of("flip", 20.0), shifts)
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(solver, lambda number: grid.with_values((number,)), AMPLITUDE, LOW, HIGH)
    place = corrected(family, AT, family.at(AT).map.initial(), 2)
    assert place is not None

    def finder(own: Family, place: Place) -> Again | None:
        return None if own.level in lacks else Again(place, AT + shifts[own.level])

    found = stated(family, place, AT + shifts[0], finder)
    assert found.value == AT + shifts[1]
    assert found.error <= AIM
    assert found.sure == sure
