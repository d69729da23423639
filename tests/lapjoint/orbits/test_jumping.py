"""Branches go on where truncated modes make the map jump as a contact comes or goes.

The maps are lines on both sides of y = 0, with a jump between them: where their motions are is known by hand.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest
from made_map import MadeMap, made_problem

from lapjoint import BaseMotion, Problem
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches import corrector, passings
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extrema
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.tracing import Seed, trace
from lapjoint.orbits.half_periods import Return
from lapjoint.orbits.period_map import Derivative, Linearised

AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 0.5, 1.5


@dataclass(frozen=True)
class JumpMap(MadeMap):
    """y -> y + p + a y where y < 0, and y + p + b (y - d) beyond: motions have y = -p / a there, and y = d - p / b."""

    p: float = 0.0
    a: float = 1.0
    b: float = 1.0
    d: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        y, slope = start.coordinates[0, 0] - 1, 1.0
        for _ in range(half_periods // 2):
            rate, shift = (self.a, 0.0) if y < 0 else (self.b, self.d)
            y, slope = y + self.p + rate * (y - shift), slope * (1 + rate)
        return Linearised(SectionPoint(FREE, np.array([[1 + y]])), lambda: Derivative(np.array([[slope]])), tuple)


@dataclass(frozen=True)
class Jumps:
    """A solver that gives such maps; p is the amplitude of the base, m, less 1, or what 1 is more than that."""

    a: float
    b: float
    d: float
    sign: int
    name = "jumps"

    def period_map(self, problem: Problem) -> JumpMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return JumpMap(problem, np.eye(1), self.sign * (problem.base_motion.amplitude - 1), self.a, self.b, self.d)


def contacts_only(found: Return) -> Extrema:
    """One contact where y > 0; no extremum tells that it comes or goes, as none is zero where it does."""
    none, whole = np.zeros(0), np.zeros(0, dtype=np.intp)
    closings = (int(found.end.coordinates[0, 0] >= 1),)
    return Extrema(whole, whole, none, none, whole.astype(bool), closings, 1.0, whole, none, whole.astype(bool))


@pytest.mark.parametrize("sign", [-1, 1])
@pytest.mark.parametrize("touched", [False, True])
@pytest.mark.parametrize("seed", range(20))
def test_a_branch_goes_on_beyond_a_jump_of_the_map(
    seed: int, touched: bool, sign: int, monkeypatch: pytest.MonkeyPatch
) -> None:
    rng = np.random.default_rng((37, seed))
    folds = seed % 2 == 0
    a, b = (float(np.exp(rng.uniform(*np.log((0.7, 3.0))))) for _ in range(2))
    if folds:
        b = -b
    d = float(rng.choice((-1, 1)) * np.exp(rng.uniform(*np.log((1e-8, 3e-7)))))
    monkeypatch.setattr(corrector, "extrema_of", contacts_only)
    monkeypatch.setattr(corrector, "closings_of", lambda found: contacts_only(found).closings)
    monkeypatch.setattr(passings, "extrema_of", contacts_only)
    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(Jumps(a, b, d, sign), lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    p = -0.25 if touched and not folds else 0.25
    start = SectionPoint(FREE, np.array([[1 + (d - p / b if touched else -p / a)]]))
    found = trace(family, Seed(1 + sign * p, start, 2), most_multiple=1, limits=Limits())
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")
    points = [
        (sign * (point.value - 1), point.motion.section_point.coordinates[0, 0] - 1) for point in found.branch.points
    ]
    for p, y in points:
        assert y == pytest.approx(-p / a if y < 0 else d - p / b, abs=1e-8)
    assert {y > 0 for _, y in points} == {False, True}
    assert {points[0][0], points[-1][0]} == ({0.5} if folds else {-0.5, 0.5})
    (one,) = found.branch.bifurcations
    assert one.kind == "unresolved"
    assert abs(one.value - 1) <= one.error + 1e-6
