"""Branches go on across grazes at which the map changes as the root of the penetration.

So it does where the damping forces jump with the contact state.  The maps are made: linear, and with a root where the
highest point h of the gap function, linear in the start, is above zero.  Their motions follow from a quadratic.  Where
damping forces jump by so much that what has touched is not turned back, maps jump, and branches end.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise, product

import numpy as np
import pytest
from made_map import MadeMap, made_problem

from lapjoint import BaseMotion, Problem, Stop
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits import Passage
from lapjoint.orbits.branches.closing import Start
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.run import Limits, Run
from lapjoint.orbits.period_map import Derivative, Linearised
from lapjoint.orbits.segments import Segment
from lapjoint.problem import FloatArray

AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 0.7, 1.3
FAR = 0.5  # root of h, m, that the end of a motion has that is not turned back
SWING = 100.0  # m: z = gap + h - SWING (1 - cos) about the middle of the period


@dataclass(frozen=True)
class Roots:
    """A solver with the maps x -> x + A x + p b + e root(h), h = g x; p is the amplitude of the base, m, less 1."""

    A: FloatArray
    b: FloatArray
    e: FloatArray
    g: FloatArray
    leaps: bool = False
    """Whether what has touched goes on, and is not turned back."""
    name = "roots"

    def period_map(self, problem: Problem) -> RootMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return RootMap(problem, self.A, self, problem.base_motion.amplitude - 1)

    @property
    def quadratic(self) -> tuple[float, float]:
        """alpha and beta of s^2 + beta s + alpha p = 0, s = root(h), for touched motions; h = -alpha p for others."""
        by_b, by_e = np.linalg.solve(self.A, np.stack([self.b, self.e], axis=1)).T
        return float(self.g @ by_b), float(self.g @ by_e)


@dataclass(frozen=True)
class RootMap(MadeMap):
    """See `Roots`."""

    of: Roots | None = None
    p: float = 0.0

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """See `MadeMap`."""
        return Passage(self.linearised(start, half_periods).end, np.zeros(0), 0)

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        assert self.of is not None
        assert half_periods == 2
        it, x = self.of, start.coordinates[0] - 1
        h = float(it.g @ x)
        root = np.sqrt(max(h, 0.0))
        matrix = np.eye(x.size) + it.A
        if h > 0 and not it.leaps:
            matrix = matrix + np.outer(it.e, it.g) / (2 * root)
        end = x + it.A @ x + self.p * it.b + it.e * (FAR if it.leaps and h > 0 else root)
        return Linearised(SectionPoint(FREE, 1 + end[None]), lambda: Derivative(matrix), lambda: self.gap_function(h))

    def gap_function(self, h: float) -> tuple[Segment, ...]:
        """One flight, or a contact about the middle of the period between two."""
        assert self.of is not None
        half = np.arccos(1 - h / SWING) / (2 * np.pi) if h > 0 else 0.0
        times = [0.0, 0.5 - half, 0.5 + half, 1.0] if h > 0 else [0.0, 1.0]
        if h > 0 and self.of.leaps:
            del times[2]
        drift = np.zeros((1, 2, self.of.g.size))
        drift[0, 0] = self.of.g
        rate = 2j * np.pi
        return tuple(
            Segment(
                start=first,
                end=last,
                closed=np.array([i == 1]),
                rates=np.array([rate]),
                weights=np.array([[SWING * (-1 if i and self.of.leaps else 1) + 0j]]),
                amplitudes=np.array([-np.exp(rate * first)]),
                polynomial=np.array([[1 + h - SWING + (2 * (SWING - h) if i and self.of.leaps else 0.0), 0.0, 0.0]]),
                deviations=np.zeros((0, self.of.g.size), dtype=complex),
                drift=drift,
                switched=0 if last < 1 else -1,
            )
            for i, (first, last) in enumerate(pairwise(times))
        )


def made(seed: int, leaps: bool = False) -> tuple[Family, Roots]:
    """A random map of two to four coordinates, with some motions unstable, and roots of all sizes."""
    rng = np.random.default_rng((43, seed))
    n = 2 + seed % 3
    while True:
        turned = np.linalg.qr(rng.standard_normal((n, n)))[0]
        A = turned @ np.diag(rng.uniform(-3, 3, n) - 1) @ turned.T
        b, e, g = (one / np.linalg.norm(one) for one in rng.standard_normal((3, n)))
        solver = Roots(A, b, e * float(np.exp(rng.uniform(np.log(0.1), np.log(10.0)))), g, leaps)
        alpha, beta = solver.quadratic
        if min(abs(alpha), abs(beta), *np.abs(np.linalg.eigvals(A))) > 0.1:
            break
    problem = made_problem(LOW).replace(stops=(Stop(x=0.5, side="top", gap=1.0, stiffness=1.0),))
    grid = Grid(problem, (Axis(AMPLITUDE, (LOW, HIGH)),))
    return Family(solver, lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH), solver


def touched(place: Place, solver: Roots) -> float:
    """h of a motion."""
    return float(solver.g @ (place.point.coordinates[0] - 1))


def across(seed: int, leaps: bool = False) -> tuple[Family, Roots, Run]:
    """A branch from a motion without contact on, past the graze."""
    family, solver = made(seed, leaps)
    p = 0.1 * np.sign(solver.quadratic[0])
    guess = SectionPoint(FREE, 1 - p * np.linalg.solve(solver.A, solver.b)[None])
    start = corrected(family, 1 + p, guess, 2, fixed=True)
    assert start is not None
    return family, solver, follow(family, start.along(np.append(np.zeros(solver.g.size), -p)), Limits(1000))


@pytest.mark.parametrize("seed", range(40))
def test_a_branch_goes_on_beyond_a_graze_where_the_map_changes_as_a_root(seed: int) -> None:
    _, solver, run = across(seed)
    alpha, beta = solver.quadratic
    assert run.end == "boundary"
    (graze,) = run.grazes
    assert graze.kind == ("persists" if beta > 0 else "folds")
    assert graze.value == pytest.approx(1.0, abs=1e-6)
    assert {touched(one, solver) > 0 for one in run.places} == {False, True}
    for one in run.places:
        h, q = touched(one, solver), one.value - 1
        expected = h + beta * np.sqrt(h) + alpha * q if h > 0 else h + alpha * q
        assert expected == pytest.approx(0.0, abs=1e-7)


@pytest.mark.parametrize("seed", range(20))
def test_a_branch_ends_at_a_graze_where_what_has_touched_is_not_turned_back(seed: int) -> None:
    _, solver, run = across(seed, leaps=True)
    assert run.end == "graze"
    assert run.grazes[-1].kind == "ends"
    assert run.grazes[-1].value == pytest.approx(1.0, abs=1e-6)
    assert all(touched(one, solver) < 0 for one in run.places)


@pytest.mark.parametrize("seed", range(20))
def test_a_branch_that_only_is_not_found_beyond_a_graze_is_lost(seed: int, monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("grazing.beyond_graze", "continuation.across_jump", "continuation.jumped"):
        monkeypatch.setattr(f"lapjoint.orbits.branches.{name}", lambda *_: None)
    _, _, run = across(seed)
    assert run.end == "lost"
    assert run.grazes[-1].kind == "lost"


def test_a_curve_that_folds_at_a_graze_has_not_come_back_to_it() -> None:
    """A mark may be the motion just before a graze, which lies beside chords beyond it."""
    chords = 0
    for seed in range(40):
        family, solver, run = across(seed)
        (graze,) = run.grazes
        if graze.kind == "folds":
            mark = Start(family, run.places[graze.index])
            for first, ratio in product((1e-6, 1e-5, 1e-4, 1e-3), (3, 10, 100)):
                a, b = (beyond(family, solver, root) for root in (first, ratio * first))
                assert mark.between(a.along(b.chord(family, a)), b.along(b.chord(family, a))) is None
                chords += 1
    assert chords >= 100


def beyond(family: Family, solver: Roots, root: float) -> Place:
    """The motion with a given root of h."""
    alpha, beta = solver.quadratic
    p = -(root**2 + beta * root) / alpha
    x = -np.linalg.solve(solver.A, p * solver.b + solver.e * root)
    found = corrected(family, 1 + p, SectionPoint(FREE, 1 + x[None]), 2, fixed=True)
    assert found is not None
    return found
