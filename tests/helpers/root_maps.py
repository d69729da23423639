"""Maps that change as the root of the penetration, as where the damping forces jump with the contact state.

They are made: linear, and with a root where the highest point h of the gap function, linear in the start, is above
zero.  Their motions follow from a quadratic.  Where damping forces jump by so much that what has touched is not turned
back, they jump.
"""

from __future__ import annotations

from dataclasses import dataclass
from itertools import pairwise

import numpy as np
from made_map import MadeMap, made_problem

from lapjoint import BaseMotion, Problem, Stop
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import Axis, Grid
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


def past_the_graze(family: Family, solver: Roots) -> Run:
    """The branch from a motion without contact on, past the graze at the amplitude 1."""
    p = 0.1 * np.sign(solver.quadratic[0])
    guess = SectionPoint(FREE, 1 - p * np.linalg.solve(solver.A, solver.b)[None])
    start = corrected(family, 1 + p, guess, 2, fixed=True)
    assert start is not None
    return follow(family, start.along(np.append(np.zeros(solver.g.size), -p)), Limits(1000))


def touched(place: Place, solver: Roots) -> float:
    """h of a motion."""
    return float(solver.g @ (place.point.coordinates[0] - 1))
