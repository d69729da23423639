"""The branch that springs from a flip is found however steep the old one is there, and however near a graze.

In coordinates w about a fixed point that moves with the number p, the first has w' = -(1 + s) w + w^3 / b^2 within
``near`` of zero, with s = p - P0: from s = 0 on there is a motion of two periods, w^2 = b^2 s.  Beyond ``near``, as
beyond a graze, it has another slope, with which there is none.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from made_map import MadeMap, made_problem

from lapjoint import FREE, BaseMotion, Problem
from lapjoint.answers import SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.switching import switched
from lapjoint.orbits.branches.tracing import Seed, trace
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.problem import FloatArray

LOW, P0, HIGH = 0.97, 1.0, 1.03
AMPLITUDE = "base_motion.amplitude"


@dataclass(frozen=True)
class SteepMap(MadeMap):
    """The map at one number."""

    solver: Steep
    s: float

    @property
    def fixed(self) -> FloatArray:
        """The fixed point."""
        return 1 + self.s * self.solver.speed

    def in_own(self, point: SectionPoint) -> FloatArray:
        """The coordinates about it."""
        return np.asarray(self.solver.basis.T @ (point.coordinates[0] - self.fixed))

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        own, w = self.solver, self.in_own(start)
        matrix = np.eye(w.size)
        for _ in range(half_periods // 2):
            near = float(np.clip(w[0], -own.near, own.near))
            beyond = w[0] - near
            slope = own.slope if beyond else -(1 + self.s) + 3 * near**2 / own.b**2
            here = np.diag([slope, *own.others])
            here[1:, 0] = own.coupling
            first = -(1 + self.s) * near + near**3 / own.b**2 + own.slope * beyond
            w = np.concatenate([[first], here[1:] @ w])
            matrix = here @ matrix
        end = SectionPoint(FREE, (self.fixed + own.basis @ w)[None])
        return Linearised(end, lambda: Derivative(own.basis @ matrix @ own.basis.T), tuple)


@dataclass(frozen=True)
class Steep:
    """A solver that gives such maps."""

    b: float
    near: float
    slope: float
    others: FloatArray
    coupling: FloatArray
    basis: FloatArray
    speed: FloatArray
    name = "steep"

    def period_map(self, problem: Problem) -> SteepMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return SteepMap(problem, np.eye(self.basis.shape[0]), self, problem.base_motion.amplitude - P0)


def any_steep(seed: int) -> Steep:
    """With a fixed point that moves nearly along the vector that flips, and up to ten times as fast as the number."""
    rng = np.random.default_rng((60, seed))
    n = int(rng.integers(2, 6))
    basis, _ = np.linalg.qr(rng.normal(size=(n, n)))
    others, coupling = rng.uniform(-0.6, 0.6, n - 1), rng.normal(size=n - 1)
    along = np.concatenate([[1.0], coupling / (-1 - others)])  # the vector that flips
    along /= np.linalg.norm(along)
    aside = rng.normal(size=n) * 10 ** rng.uniform(-2.0, 0.0)
    speed = 10 ** rng.uniform(-1.0, 1.0) * basis @ (along + aside)
    near = 10 ** rng.uniform(-5.3, -2.0)
    return Steep(rng.uniform(0.5, 5.0), near, -(10 ** rng.uniform(1.0, 3.0)), others, coupling, basis, speed)


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("seed", range(60))
def test_the_branch_that_springs_from_a_flip_is_found(seed: int, sign: int) -> None:
    solver = any_steep(seed)
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    fixed = SectionPoint(FREE, (1 + (LOW - P0) * solver.speed)[None])
    mother = trace(family, Seed(LOW, fixed, 2), most_multiple=1, errors=False)
    assert mother is not None
    assert [point.value for point in (mother.branch.points[0], mother.branch.points[-1])] == [LOW, HIGH]
    (flip,) = (one for one in mother.bifurcations if one.bifurcation.kind == "flip")
    assert flip.springing is not None
    found = switched(family, flip.springing, sign)
    assert found is not None
    assert found.count == 4
    map_ = solver.period_map(grid.with_values((found.value,)))
    w = map_.in_own(found.point)
    assert abs(w[0]) <= solver.near
    assert map_.s == pytest.approx((w[0] / solver.b) ** 2, rel=1e-3, abs=1e-8)  # all that are nearer come back, too
    assert abs(w[0]) > 1e-7
