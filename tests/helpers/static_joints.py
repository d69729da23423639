"""Equilibria of joints under static loads from elements of fifty digits, which share no code with a solver.

The witness is the displacement method: cubic beam elements between all places where anything acts, with consistent
loads, give the exact displacements and slopes of these places.  A set of pressing stops is that of the equilibrium if
the solution with these stops as springs presses each of them, and reaches no other: the energy is convex.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from itertools import pairwise

import mpmath
import numpy as np
from scipy.optimize import nnls

from lapjoint import Problem, StepLoad

DIGITS = 50


@dataclass
class Witness:
    """A problem as a stiffness matrix of cubic elements, in numbers of `number`: float, or `mpmath.mpf`."""

    problem: Problem
    number: type = mpmath.mpf

    def __post_init__(self) -> None:
        problem, beam, num = self.problem, self.problem.beam, self.number
        ends = [segment.to for segment in beam.segments] or [beam.length]
        placed = [*problem.supports, *problem.stops, *problem.masses]
        placed += [load for load in problem.point_loads if isinstance(load, StepLoad)]
        edges = [x for load in problem.uniform_loads for x in (load.start, load.to) if x is not None]
        self.nodes = sorted({0.0, beam.length, *ends, *edges, *(part.x for part in placed)})
        size = 2 * len(self.nodes)
        self.K = [[num(0)] * size for _ in range(size)]
        self.f = [num(0)] * size
        for i, (a, b) in enumerate(pairwise(self.nodes)):
            self._add_element(i, num(b) - num(a), num(a))
        for mass in problem.masses:
            if problem.gravity is not None:
                self.f[self.at(mass.x)] += num(mass.mass) * num(problem.gravity.acceleration)
        for load in problem.point_loads:
            if isinstance(load, StepLoad):
                self.f[self.at(load.x)] += num(load.force)
        self.fixed = set()
        for support in problem.supports:
            for dof, k in ((self.at(support.x), support.translational), (self.at(support.x) + 1, support.torsional)):
                if math.isinf(k):
                    self.fixed.add(dof)
                else:
                    self.K[dof][dof] += num(k)

    def at(self, x: float) -> int:
        """The degree of freedom z at a position, m; the next is the slope."""
        return 2 * self.nodes.index(x)

    def _add_element(self, i: int, h: mpmath.mpf, start: mpmath.mpf) -> None:
        problem, num = self.problem, self.number
        beam, middle = problem.beam, float(start + h / 2)
        segment = next((it for it in beam.segments if middle < it.to), beam)
        EI = num(segment.bending_stiffness)
        q = num(0)
        if problem.gravity is not None:
            # the weight per length in double precision, as the problem states it
            q += num(segment.mass_per_length + beam.contents_per_length) * num(problem.gravity.acceleration)
        for load in problem.uniform_loads:
            if load.start < middle < (beam.length if load.to is None else load.to):
                q += num(load.force_per_length)
        k = EI / h**3
        rows = [
            [12 * k, 6 * h * k, -12 * k, 6 * h * k],
            [6 * h * k, 4 * h * h * k, -6 * h * k, 2 * h * h * k],
            [-12 * k, -6 * h * k, 12 * k, -6 * h * k],
            [6 * h * k, 2 * h * h * k, -6 * h * k, 4 * h * h * k],
        ]
        for a in range(4):
            for b in range(4):
                self.K[2 * i + a][2 * i + b] += rows[a][b]
            self.f[2 * i + a] += (q * h / 2, q * h * h / 12, q * h / 2, -q * h * h / 12)[a]

    def displacements(self, pressing: tuple[int, ...]) -> list[mpmath.mpf]:
        """z and z' of all nodes, with these stops as springs that also pull."""
        K, f, num = [list(row) for row in self.K], list(self.f), self.number
        for j in pressing:
            stop = self.problem.stops[j]
            dof = self.at(stop.x)
            K[dof][dof] += num(stop.stiffness)
            f[dof] += num(stop.stiffness) * stop.sign * num(stop.gap)
        free = [i for i in range(len(f)) if i not in self.fixed]
        solution = mpmath.lu_solve(mpmath.matrix([[K[i][j] for j in free] for i in free]), [f[i] for i in free])
        found = [num(0)] * len(f)
        for i, value in zip(free, solution, strict=True):
            found[i] = value
        return found

    def depths(self, z: list[mpmath.mpf]) -> list[mpmath.mpf]:
        """How far the beam is beyond the gap of each stop, m."""
        return [stop.sign * z[self.at(stop.x)] - self.number(stop.gap) for stop in self.problem.stops]


def by_quadratic_program(problem: Problem) -> tuple[int, ...]:
    """The pressing stops of a joint that supports hold, by scipy: least complementary energy of the stops' forces."""
    with mpmath.workdps(DIGITS):
        witness = Witness(problem)
        free = [i for i in range(2 * len(witness.nodes)) if i not in witness.fixed]
        stops, index = problem.stops, {dof: i for i, dof in enumerate(free)}
        K = mpmath.matrix([[witness.K[i][j] for j in free] for i in free])
        pulls = mpmath.zeros(len(free), len(stops))
        for j, stop in enumerate(stops):
            if witness.at(stop.x) in index:
                pulls[index[witness.at(stop.x)], j] = stop.sign
        inverse = K**-1
        f = mpmath.matrix([witness.f[i] for i in free])
        flexibility = pulls.T * inverse * pulls
        for j, stop in enumerate(stops):
            flexibility[j, j] += 1 / mpmath.mpf(stop.stiffness)
        reached = pulls.T * inverse * f - mpmath.matrix([stop.gap for stop in stops])
        scale = [1 / mpmath.sqrt(flexibility[j, j]) for j in range(len(stops))]
        scaled = [[flexibility[i, j] * scale[i] * scale[j] for j in range(len(stops))] for i in range(len(stops))]
        factor = mpmath.cholesky(mpmath.matrix(scaled))
        target = mpmath.lu_solve(factor, mpmath.matrix([r * s for r, s in zip(reached, scale, strict=True)]))
        size = max(mpmath.mpf("1e-300"), max(abs(t) for t in target))
        A = np.array((factor.T).tolist(), dtype=float)
        forces, _ = nnls(A, np.array([float(t / size) for t in target]))
    return tuple(np.flatnonzero(forces).tolist())
