"""Branches that spring from bifurcations which a finer solver has a little elsewhere."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from made_map import MadeMap, made_problem

from lapjoint import BaseMotion, Problem
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches import tracing
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.resolving import Resolved, unrefined
from lapjoint.orbits.branches.run import Limits, Run
from lapjoint.orbits.branches.tracing import Seed, trace
from lapjoint.orbits.period_map import Derivative, Linearised

AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 1.49, 1.5009
FLIP, STEEP, WIDTH = 1.5, 1e5, 1e-4
SOONER = {"coarse": 0.0, "finer": 1e-4}


@dataclass(frozen=True)
class FlipMap(MadeMap):
    """y -> -(1 + 0.01 atan(1e5 (a - y^2))) y about x = 1: beyond a = 0 motions of two periods have y = +- sqrt(a).

    Newton's method finds them from where a - y^2 is 1e-5 at most.
    """

    a: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        y, slope = start.coordinates[0, 0] - 1, 1.0
        for _ in range(half_periods // 2):
            off = STEEP * (self.a - y**2)
            growth = 1 + 0.01 * np.arctan(off)
            y, slope = -y * growth, slope * (0.02 * STEEP * y**2 / (1 + off**2) - growth)
        return Linearised(SectionPoint(FREE, np.array([[1 + y]])), lambda: Derivative(np.array([[slope]])), tuple)


@dataclass(frozen=True)
class Flips:
    """A solver that gives such maps; a is the amplitude of the base, m, less 1.5, and is more for one near there."""

    name: str

    def period_map(self, problem: Problem) -> FlipMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        beyond = problem.base_motion.amplitude - FLIP
        return FlipMap(problem, np.eye(1), beyond + SOONER[self.name] / (1 + (beyond / WIDTH) ** 2))


def family(name: str) -> Family:
    """The period maps of one of them."""
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    return Family(Flips(name), lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)


def test_a_branch_that_a_finer_solver_has_sooner_is_followed_from_farther_along(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    coarse, finer = family("coarse"), family("finer")
    still = SectionPoint(FREE, np.ones((1, 1)))

    def by_the_finer(*_: object, **__: object) -> Resolved:
        start = corrected(finer, LOW, still, 2, fixed=True)
        assert start is not None
        run: Run = follow(finer, start.along(np.array([0.0, 1.0])), Limits())
        return unrefined(finer, run)

    monkeypatch.setattr(tracing, "resolved", by_the_finer)
    found = trace(coarse, Seed(LOW, still, 2), most_multiple=2)
    assert found is not None
    assert [one.value for one in found.branch.bifurcations] == pytest.approx([FLIP - 6.8233e-5], abs=1e-7)
    (seed,) = found.seeds
    monkeypatch.undo()
    sprung = trace(coarse, seed, most_multiple=1, errors=False)
    assert sprung is not None
    assert set(sprung.branch.ends) == {"bifurcation", "boundary"}
    for point in sprung.branch.points:
        y = point.motion.section_point.coordinates[0, 0] - 1
        assert y**2 == pytest.approx(point.value - FLIP, abs=1e-7)
