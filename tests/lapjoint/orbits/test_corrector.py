"""Back to a curve by Newton's method, on made maps: to the same places with chords, and with what is known of folds.

The maps are x -> x + A x + B x^2 + p b with the squares of all coordinates, p the amplitude of the base less 1.
"""

from __future__ import annotations

from collections import Counter
from dataclasses import dataclass, field

import numpy as np
import pytest
from made_map import MadeMap, made_problem

from lapjoint import BaseMotion, Problem
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches import corrector, newton_steps
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.problem import FloatArray

AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 0.7, 1.3


@dataclass(frozen=True)
class Squares:
    """A solver with such maps."""

    A: FloatArray
    B: FloatArray
    b: FloatArray
    asked: Counter[str] = field(default_factory=Counter)
    """How often maps have been marched, and derivatives taken."""
    name = "squares"

    def period_map(self, problem: Problem) -> SquareMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return SquareMap(problem, self.A, self, problem.base_motion.amplitude - 1)


@dataclass(frozen=True)
class SquareMap(MadeMap):
    """See `Squares`."""

    of: Squares | None = None
    p: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        it, x = self.of, start.coordinates[0] - 1
        assert it is not None
        it.asked["marches"] += 1

        def derivative() -> Derivative:
            it.asked["derivatives"] += 1
            return Derivative(np.eye(x.size) + it.A + 2 * it.B * x, it.b)

        end = x + it.A @ x + it.B @ x**2 + self.p * it.b
        return Linearised(SectionPoint(FREE, 1 + end[None]), derivative, tuple)

    def linearised_by(self, _: str, start: SectionPoint, half_periods: int) -> Linearised:
        """The same: it knows its derivative by the number."""
        return self.linearised(start, half_periods)


def made(seed: int) -> tuple[Family, Squares, float, SectionPoint]:
    """A random map of two to seven coordinates, and a guess beside its curve."""
    rng = np.random.default_rng((61, seed))
    n = 2 + seed % 6
    A, B = rng.standard_normal((2, n, n))
    solver = Squares(A, 10.0 ** rng.uniform(-3, 0.5) * B, rng.standard_normal(n))
    problem = made_problem(LOW)
    grid = Grid(problem, (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    p = rng.uniform(-0.1, 0.1)
    guess = -p * np.linalg.solve(A, solver.b) + 10.0 ** rng.uniform(-6, -1) * rng.standard_normal(n)
    return family, solver, 1 + p, SectionPoint(FREE, 1 + guess[None])


@pytest.mark.parametrize("fixed", [False, True])
def test_chords_lead_to_the_same_places_with_fewer_derivatives(fixed: bool, monkeypatch: pytest.MonkeyPatch) -> None:
    spared = found = 0
    for seed in range(300):
        family, solver, value, guess = made(seed)
        monkeypatch.setattr(corrector, "_CHORD", 4.0)
        one = corrected(family, value, guess, 2, fixed=fixed)
        with_chords = solver.asked.copy()
        solver.asked.clear()
        monkeypatch.setattr(corrector, "_CHORD", np.inf)
        other = corrected(family, value, guess, 2, fixed=fixed)
        assert solver.asked["derivatives"] == solver.asked["marches"] - (other is None and solver.asked["marches"] > 0)
        assert (one is None) == (other is None)
        if one is None or other is None:
            continue
        found += 1
        spared += solver.asked["derivatives"] - with_chords["derivatives"]
        assert with_chords["marches"] <= solver.asked["marches"] + 1
        assert one.orbit.residual <= RESIDUAL
        apart = np.linalg.norm(one.point.coordinates - other.point.coordinates) + abs(one.value - other.value)
        assert apart <= 1e-6  # both are within the residual of the curve, where the map may hardly change
        assert is_tangent(one, solver)
    assert found
    assert spared > 0.3 * found


def is_tangent(place: Place, solver: Squares) -> bool:
    """Whether a place's tangent is a unit null vector of the derivative there, in scaled coordinates."""
    x = place.point.coordinates[0] - 1
    J = np.column_stack([solver.A + 2 * solver.B * x, solver.b * place.value * place.weights[0]])
    missed = float(np.linalg.norm(J @ place.tangent)) / float(np.linalg.norm(J))
    return missed < 1e-12 and abs(float(np.linalg.norm(place.tangent)) - 1) < 1e-12


@pytest.mark.parametrize("least", [1.0, 1e-3, 1e-5, 1e-7, 1e-9, 1e-12, 1e-15, 0.0])
def test_the_tangent_and_the_shortest_step_hold_up_to_a_fold(least: float) -> None:
    rng = np.random.default_rng(62)
    for _ in range(100):
        n = int(rng.integers(1, 30))
        u, v = (np.linalg.qr(rng.standard_normal((n, n)))[0] for _ in range(2))
        sizes = np.append(10.0 ** rng.uniform(-2, 2, n - 1), least)
        J = np.column_stack([u @ np.diag(sizes) @ v, u @ rng.uniform(0.5, 2.0, n)])
        F = 1e-5 * rng.standard_normal(n)
        w, s, vt = np.linalg.svd(J)
        tangent, _ = newton_steps.tangent_and_step(J, F)
        assert np.linalg.norm(tangent - (tangent @ vt[-1]) * vt[-1]) <= 1e-9
        step = newton_steps.newton_step(J, F, fixed=False)
        shortest = -vt[:n].T @ ((w.T @ F) / s)
        assert np.linalg.norm(step - shortest) <= 1e-7 * np.linalg.norm(shortest)
