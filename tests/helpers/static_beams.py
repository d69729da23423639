"""Equilibria of joints under static loads from elements of fifty digits, which share no code with a solver.

The witness is the displacement method: on each beam, cubic elements between all places where anything acts, with
consistent loads, give the exact displacements and slopes of these places.  What infinite springs forbid is taken out by
a basis of all displacements that they allow.  A set of pressing stops is that of the equilibrium if the solution with
these stops as springs presses each of them, and reaches no other: the energy is convex.
"""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath as mp
import numpy as np
from scipy.optimize import nnls

from lapjoint import Problem, StepLoad
from lapjoint.problem import NamedBeam
from tests.helpers.linked_beams import allowed_by

Row = dict[int, int]
"""The factor of each degree of freedom in what a spring or a stop reads."""


class StaticBeams:
    """A problem as a stiffness matrix of cubic elements, in fifty digits; positions are those on the line of beams."""

    def __init__(self, problem: Problem) -> None:
        line, at = problem.line, problem.line.at
        self.problem, self.nodes = problem, []
        beams = problem.beams or (_named(problem),)
        steps = [load for load in problem.point_loads if isinstance(load, StepLoad)]
        self.stops = [(it.between[1], it.between[0]) if it.between else (it.x,) for it in problem.stops]
        shared = [text for it in (*problem.links, *problem.stops) for text in it.between or (it.x,)]
        places = {at(text) for text in (*shared, *(load.x for load in steps))}
        loads = []  # start, end, m, and force per length, N/m
        elements = []
        for beam, start, end in zip(beams, line.starts, line.ends, strict=True):
            g = mp.mpf(problem.gravity.acceleration) if problem.gravity else mp.mpf(0)
            pieces = [(start + p.start, start + p.end, p) for p in beam.pieces]
            loads += [(a, b, mp.mpf(beam.gravity_share * p.mass) * g) for a, b, p in pieces]
            for load in (load for load in problem.uniform_loads if load.beam in ("", beam.name)):
                to = beam.length if load.to is None else load.to
                loads.append((start + load.start, start + to, mp.mpf(load.force_per_length)))
            own = {start, end, *(start + it.x for it in (*beam.supports, *beam.masses))}
            own |= {x for a, b, _ in (*pieces, *loads) for x in (a, b)} | places
            x = sorted(one for one in own if start <= one <= end)
            elements += [
                (len(self.nodes) + i, mp.mpf(b) - mp.mpf(a), mp.mpf(EI), (a, b))
                for i, (a, b) in enumerate(pairwise(x))
                for EI in (next(p.EI for left, right, p in pieces if left <= a and b <= right),)
            ]
            self.nodes += x
        size = 2 * len(self.nodes)
        self.K, self.f = mp.zeros(size), mp.zeros(size, 1)
        for i, h, EI, (a, b) in elements:
            q = sum((force for left, right, force in loads if left <= a and b <= right), mp.mpf(0))
            self._add_element(2 * i, h, EI, q)
        springs: list[tuple[Row, float]] = []
        for beam, start in zip(beams, line.starts, strict=True):
            for mass in beam.masses:
                if problem.gravity:
                    weight = mp.mpf(beam.gravity_share * mass.mass) * mp.mpf(problem.gravity.acceleration)
                    self.f[self.at(start + mass.x)] += weight
            for it in beam.supports:
                i = self.at(start + it.x)
                springs += [({i: 1}, it.translational), ({i + 1: 1}, it.torsional)]
        self.supports = len(springs) // 2
        for it in problem.links:
            one, other = (self.at(at(text)) for text in it.between)
            springs += [({one: -1, other: 1}, it.translational), ({one + 1: -1, other + 1: 1}, it.torsional)]
        self.springs = springs
        for load in steps:
            self.f[self.at(at(load.x))] += mp.mpf(load.force)
        for row, k in springs:
            if math.isfinite(k):
                self._add_spring(self.K, row, mp.mpf(k))
        rigid = [row for row, k in springs if math.isinf(k)]
        rows = np.zeros((len(rigid), size))
        for r, row in enumerate(rigid):
            rows[r, list(row)] = list(row.values())
        self.allowed = mp.matrix(allowed_by(rows).tolist())
        self.pulls = [
            {self.at(at(text)): factor * stop.sign for text, factor in zip(places, (1, -1), strict=False)}
            for places, stop in zip(self.stops, problem.stops, strict=True)
        ]

    def at(self, x: float) -> int:
        """The degree of freedom z at a position on the line, m; the next is the slope."""
        return 2 * self.nodes.index(x)

    def _add_element(self, i: int, h: mp.mpf, EI: mp.mpf, q: mp.mpf) -> None:
        k = EI / h**3
        rows = [
            [12 * k, 6 * h * k, -12 * k, 6 * h * k],
            [6 * h * k, 4 * h * h * k, -6 * h * k, 2 * h * h * k],
            [-12 * k, -6 * h * k, 12 * k, -6 * h * k],
            [6 * h * k, 2 * h * h * k, -6 * h * k, 4 * h * h * k],
        ]
        for a in range(4):
            for b in range(4):
                self.K[i + a, i + b] += rows[a][b]
            self.f[i + a] += (q * h / 2, q * h * h / 12, q * h / 2, -q * h * h / 12)[a]

    @staticmethod
    def _add_spring(K: mp.matrix, row: Row, k: mp.mpf) -> None:
        for i, one in row.items():
            for j, other in row.items():
                K[i, j] += k * one * other

    def displacements(self, pressing: tuple[int, ...]) -> list[mp.mpf]:
        """z and z' of all nodes, with these stops as springs that also pull."""
        K, f = self.K.copy(), self.f.copy()
        for j in pressing:
            stop = self.problem.stops[j]
            k = mp.mpf(stop.stiffness)
            self._add_spring(K, self.pulls[j], k)
            for i, factor in self.pulls[j].items():
                f[i] += k * factor * mp.mpf(stop.gap)
        N = self.allowed
        return list(N * mp.lu_solve(N.T * K * N, N.T * f))

    def read(self, row: Row, z: list[mp.mpf]) -> mp.mpf:
        """What a spring or a stop reads."""
        return sum((factor * z[i] for i, factor in row.items()), mp.mpf(0))

    def depths(self, z: list[mp.mpf]) -> list[mp.mpf]:
        """How far each stop is pressed beyond its gap, m."""
        return [self.read(row, z) - mp.mpf(stop.gap) for row, stop in zip(self.pulls, self.problem.stops, strict=True)]

    def by_quadratic_program(self) -> tuple[int, ...]:
        """The pressing stops of a system that springs hold, by scipy: least complementary energy of their forces."""
        N, count = self.allowed, len(self.pulls)
        pulls = mp.zeros(self.K.rows, count)
        for j, row in enumerate(self.pulls):
            for i, factor in row.items():
                pulls[i, j] = factor
        K, right, B = N.T * self.K * N, N.T * self.f, N.T * pulls
        moved = mp.lu_solve(K, right)
        bent = [mp.lu_solve(K, B[:, j]) for j in range(count)]
        C = mp.matrix([[(B[:, i].T * bent[j])[0] for j in range(count)] for i in range(count)])
        reached = mp.matrix([(B[:, j].T * moved)[0] - mp.mpf(it.gap) for j, it in enumerate(self.problem.stops)])
        for j, stop in enumerate(self.problem.stops):
            C[j, j] += 1 / mp.mpf(stop.stiffness)
        scale = [1 / mp.sqrt(C[j, j]) for j in range(count)]
        scaled = mp.matrix([[C[i, j] * scale[i] * scale[j] for j in range(count)] for i in range(count)])
        factor = mp.cholesky(scaled)
        target = mp.lu_solve(factor, mp.matrix([r * s for r, s in zip(reached, scale, strict=True)]))
        size = max(mp.mpf("1e-300"), *(abs(t) for t in target))
        A = np.array(factor.T.tolist(), dtype=float)
        forces, _ = nnls(A, np.array([float(t / size) for t in target]))
        return tuple(np.flatnonzero(forces).tolist())


def _named(problem: Problem) -> NamedBeam:
    """The only beam of a problem with its supports and masses, as one of several has them."""
    own = {name: getattr(problem.beam, name) for name in type(problem.beam).model_fields}
    return NamedBeam(**own, name="beam", supports=problem.supports, masses=problem.masses)


def in_fifty_digits() -> object:
    """A context in which mpmath computes in fifty digits."""
    return mp.workdps(50)
