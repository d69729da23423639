"""Branches that double the period, beside where they spring: maps whose motions, and whose multipliers, are known.

The first coordinate y has y' = -(1 + s(p)) y + y^3: y = 0 flips where s passes zero, and between, where s > 0, lies
the doubled motion y^2 = s.  Two more coordinates have a matrix that depends on the side of y, so that over both periods
their multipliers have a given sum T and the product 1/2: the doubled motion flips where T passes -3/2.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np
import pytest
from made_map import MadeMap, made_problem, of_trace

from lapjoint import FREE, BaseMotion, Problem
from lapjoint.answers import SectionPoint
from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import Axis, Grid
from lapjoint.campaigns.branch_parts import plain_seed, seed_of
from lapjoint.errors import SolverError
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.by_another_solver import _Search
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Again
from lapjoint.orbits.branches.found_along import motion_at
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.tracing import Seed, Traced, trace
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.orbits.refinement import Refinement

LOW, HIGH, FIRST, LAST = 1.0, 2.0, 1.3, 1.7
AMPLITUDE = "base_motion.amplitude"
BLIND = 1e-7
SIDE, DEPTH = 1e-5, 1e-3
"""Distances of y from zero from which on the matrix is that of its side, and T is as deep as it gets."""


@dataclass(frozen=True)
class DoublingMap(MadeMap):
    """The map at one number; `total` is T."""

    s: float = 0.0
    total: float = 0.0
    blind: bool = False

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        x, matrix = start.coordinates[0] - 1, np.eye(3)
        if self.blind and abs(x[0]) > BLIND:
            raise SolverError("no march from there")
        for _ in range(half_periods // 2):
            here, y, rest = np.zeros((3, 3)), x[0], x[1:]
            here[0, 0] = -(1 + self.s) + 3 * y**2
            side = np.tanh(y / SIDE)
            mean, half = (of_trace(self.total, 0.5) + np.eye(2)) / 2, (of_trace(self.total, 0.5) - np.eye(2)) / 2
            here[1:, 1:] = mean + side * half
            here[1:, 0] = (1 - side**2) / SIDE * half @ rest
            x = np.concatenate([[-(1 + self.s) * y + y**3], here[1:, 1:] @ rest])
            matrix = here @ matrix
        end = SectionPoint(FREE, 1 + x[None])
        return Linearised(end, lambda: Derivative(matrix), tuple)


@dataclass(frozen=True)
class Doubling:
    """A solver that gives such maps."""

    most: float
    """The largest s."""
    true: float = 0.0
    """How far T lies below -1.4 on the doubled motion, once that is 1e-3 away from the other."""
    deep: float = 0.0
    """What a coarse solver adds to this."""
    share: float = 1.0
    """Share of that which the solver adds."""
    less: float = 0.0
    """By how much a coarse solver has s smaller."""
    sees: float = 1.0
    """Largest share of a solver that can march from beside the motion that stands still."""

    @property
    def name(self) -> str:
        """As it says."""
        return f"with {self.share} of what a coarse solver adds"

    def period_map(self, problem: Problem) -> DoublingMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        p = problem.base_motion.amplitude
        s = self.most * 4 * (p - FIRST) * (LAST - p) / (LAST - FIRST) ** 2 - self.share * self.less
        total = -1.4 - (self.true + self.share * self.deep) * np.tanh(max(s, 0.0) / DEPTH**2)
        return DoublingMap(problem, np.eye(3), s=s, total=float(total), blind=self.share > self.sees)

    def finer(self, problem: Problem) -> tuple[Refinement, Doubling]:
        """The next one, of second order."""
        other = replace(self, share=self.share / 4)
        return Refinement(other.name, 2.0, 2.0), other


def family_of(solver: Doubling) -> Family:
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    return Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)


def doubled(solver: Doubling) -> list[Traced]:
    """The branches that double the motion that stands still."""
    family = family_of(solver)
    mother = trace(family, Seed(LOW, SectionPoint(FREE, np.ones((1, 3))), 2), most_multiple=2)
    assert mother is not None
    assert [round(one.value, 9) for one in flips(mother)] == [FIRST, LAST]
    found = [trace(family, seed, most_multiple=2) for seed in mother.seeds]
    assert len(found) == 2
    return [one for one in found if one is not None]


@pytest.mark.parametrize(("sees", "level"), [(1.0, 0), (0.25, 1), (0.0625, 2)])
def test_where_a_solver_has_no_motion_of_the_branch_finer_ones_are_asked(sees: float, level: int) -> None:
    """By one of them it springs, and that one follows it; without finer ones it is told that none was found."""
    family, stands_still = family_of(Doubling(0.1, sees=sees)), Seed(LOW, SectionPoint(FREE, np.ones((1, 3))), 2)
    mother = trace(family, stands_still, most_multiple=2)
    assert mother is not None
    assert [seed.level for seed in mother.seeds] == [level, level]
    assert mother.unsprung == ()
    for seed in mother.seeds:
        found = trace(family, seed, most_multiple=2)
        assert found is not None
        assert found.branch.ends == ("bifurcation", "bifurcation")
    alone = trace(family, stands_still, most_multiple=2, errors=False)
    assert alone is not None
    assert [round(one.value, 9) for one in alone.unsprung] == ([] if level == 0 else [FIRST, LAST])


def flips(found: Traced) -> list[Bifurcation]:
    assert {one.kind for one in found.branch.bifurcations} <= {"flip"}
    return list(found.branch.bifurcations)


@pytest.mark.parametrize("most", [0.1, 1e-2, 1e-3, 1e-4])
def test_a_branch_ends_where_its_motions_can_be_told_from_those_it_springs_from(most: float) -> None:
    """Nearer to there, the sign of its direction is rounding, and makes folds."""
    for one in doubled(Doubling(most)):
        assert flips(one) == []
        assert one.branch.ends == ("bifurcation", "bifurcation")
        for point in one.branch.points:
            y = point.motion.section_point.coordinates[0, 0] - 1
            s = Doubling(most).period_map(made_problem(point.value)).s
            assert abs(y) == pytest.approx(np.sqrt(s), rel=0.1)  # 1e-9 of p is up to a tenth of the least s
            assert 2 * abs(y) > 1e-4 * np.sqrt(3)  # what it misses to repeat in half the time, over its size


def test_what_a_coarse_solver_has_beside_both_ends_of_a_branch_is_not_listed() -> None:
    """No motion of the branch lies before the flips; the finer solver, which has none, begins where it springs."""
    for one in doubled(Doubling(1e-4, deep=0.2)):
        assert one.branch.ends == ("bifurcation", "bifurcation")
        assert flips(one) == []


def test_what_is_true_beside_both_ends_of_a_branch_is_listed() -> None:
    solver = Doubling(1e-4, true=1.0)
    for one in doubled(solver):
        found = flips(one)
        assert sorted(round(it.value) for it in found) == [1, 2]
        for it in found:
            assert it.error <= 1e-6
            assert solver.period_map(made_problem(it.value)).total == pytest.approx(-1.5, abs=1e-3)


def test_a_motion_that_repeats_sooner_is_not_what_another_solver_is_asked_for() -> None:
    """Finite elements had taken a fold of the branch from which a narrow one springs for that one's."""
    one = doubled(Doubling(1e-2, true=1.0))[0].bifurcations[0]
    assert one.found is not None
    motion, search = motion_at(one.found), _Search(replace(one, rivals=()), one.family)
    sooner = corrected(one.family, motion.value, SectionPoint(FREE, np.ones((1, 3))), motion.count, fixed=True)
    assert sooner is not None
    assert search._is_nearest(0, Again(motion, motion.value))
    assert not search._is_nearest(0, Again(sooner, motion.value))


@pytest.mark.parametrize("level", [1, 2])
def test_a_branch_that_only_a_finer_solver_has_is_followed_by_that(level: int) -> None:
    """By a coarser one it was followed as the branch from which it springs, and so left out."""
    family = family_of(Doubling(1e-2, less=1.5 * 1e-2 * 4 ** (level - 1)))
    mother = trace(family, Seed(LOW, SectionPoint(FREE, np.ones((1, 3))), 2, level=level), most_multiple=2)
    assert mother is not None
    assert len(flips(mother)) == 2
    assert len(mother.seeds) == 2
    for seed in mother.seeds:
        assert seed.level >= level
        assert trace(family, replace(seed, level=level - 1), most_multiple=2) is None
        again = seed_of(json.loads(json.dumps(plain_seed(seed))))
        found = trace(family, again, most_multiple=2)
        assert found is not None
        assert found.branch.ends == ("bifurcation", "bifurcation")
        finer = family.self_at(seed.level)
        for point in found.branch.points:
            y = point.motion.section_point.coordinates[0, 0] - 1
            made = finer.at(point.value).map
            assert isinstance(made, DoublingMap)
            assert abs(y) == pytest.approx(np.sqrt(made.s), rel=0.1)


def test_a_branch_begins_at_a_motion_of_the_solver_that_follows_it() -> None:
    """Not at the finer one's, from which Newton's method may lead elsewhere, or nowhere."""
    family = family_of(Doubling(1e-2, less=4e-6))
    mother = trace(family, Seed(LOW, SectionPoint(FREE, np.ones((1, 3))), 2, level=1), most_multiple=2)
    assert mother is not None
    assert len(mother.seeds) == 2
    for seed in mother.seeds:
        half = family.at(seed.value)
        assert half.relative(half.map.difference(half.marched(seed.point, seed.count), seed.point), seed.point) <= 1e-9
        found = trace(family, seed, most_multiple=2)
        assert found is not None
        assert found.branch.ends == ("bifurcation", "bifurcation")


def test_a_bifurcation_that_only_a_finer_solver_has_is_restored_by_that() -> None:
    """The coarse one, and finer ones, come to the motion from which the branch springs."""
    family = family_of(Doubling(1e-2, true=1.0, less=1.5e-2))
    mother = trace(family, Seed(LOW, SectionPoint(FREE, np.ones((1, 3))), 2, level=1), most_multiple=2)
    assert mother is not None
    branches = [trace(family, seed, most_multiple=2) for seed in mother.seeds]
    found = [one for branch in branches if branch is not None for one in flips(branch)]
    assert len(found) == 4
    for one in found:
        again = restored(family, one)
        assert again is not None
        assert isinstance(again.found, Located)
        assert again.family.level >= 2
        assert not again.found.place.repeats_in_half
