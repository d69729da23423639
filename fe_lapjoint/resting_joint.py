"""A joint as its static equilibrium by cubic beam elements needs it: rows of what springs and stops read, loads, and
rigid motions."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import replace
from functools import cached_property

import numpy as np
import numpy.typing as npt
from scipy.optimize import nnls

from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.equilibrium import breaks_of, nothing_resists
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.problem import resting

_HELD = 1e-13
"""Springs that resist a rigid motion of unit size by less than this do not resist it."""
UNDRIVEN = 1e-12
"""Work of the loads on a rigid motion, divided by the sum of their moduli, that is rounding."""


class RestingJoint:
    """The beams on a mesh without supports and links, their loads, and their springs as rows, in units of L and EI."""

    def __init__(self, problem: Problem) -> None:
        self.problem, self.L, self.EI = problem, problem.line.length, problem.line.EI
        free = replace(problem.structure, supports=(), links=())
        self.assembly = Assembly(resting(free), np.array(breaks_of(problem)))
        self.B = self.assembly.curvature * math.sqrt(self.L**3 / self.EI)
        loads = [force.force * self.assembly.load(force.shape) for force in problem.forces.constant]
        none = np.zeros(self.B.shape[1])
        self.f = sum(loads, none) * self.L**2 / self.EI
        self.size_of_f = sum((np.abs(load) for load in loads), none) * self.L**2 / self.EI
        self.sign = np.array([stop.sign for stop in problem.structure.stops], dtype=float)
        self.gap = np.array([stop.gap for stop in problem.structure.stops], dtype=float) / self.L
        self.stops = self.sign[:, None] * self.assembly.stop_rows
        self.k = np.array([stop.stiffness for stop in problem.structure.stops], dtype=float) * self.L**3 / self.EI
        self.parts: list[tuple[tuple[float, float], ...]] = [((it.x, 1.0),) for it in problem.structure.supports]
        """What each support, and then each link, reads: positions, m, and factors."""
        self.parts += [((it.second, 1.0), (it.first, -1.0)) for it in problem.structure.links]
        held = list(self._springs())
        self.held = [place for place, _, _ in held]
        """The index in `parts`, and the derivative, 0 or 1, of each spring that always acts."""
        self.rows = np.array([row for _, row, _ in held]).reshape(len(held), none.size)
        self.stiffness = np.array([k for _, _, k in held], dtype=float)

    def _springs(self) -> Iterator[tuple[tuple[int, int], FloatArray, float]]:
        """Part and derivative, row and stiffness in units of the beam, of each spring of supports and links that others
        do not replace."""
        joint = self.problem.structure
        stiffness = [(it.translational, it.torsional) for it in joint.supports]
        stiffness += [(it.translational, it.torsional) for it in joint.links]
        for i, (reading, springs) in enumerate(zip(self.parts, stiffness, strict=True)):
            for derivative, k in enumerate(springs):
                if k and (i, derivative) not in joint.idle:
                    row = sum(factor * self.assembly.reading(x, derivative) for x, factor in reading)
                    yield (i, derivative), np.asarray(row), k * self.L ** (3 - 2 * derivative) / self.EI

    @cached_property
    def elements(self) -> npt.NDArray[np.intp]:
        """The elements that are no spaces between beams, ``(e,)``."""
        return np.flatnonzero(self.EI_of)

    @cached_property
    def rigid(self) -> FloatArray:
        """For each beam, as columns, ``(n, 2 beams)``: translation by L, and rotation about its left end that moves the
        other end by L."""
        nodes, line = self.assembly.nodes, self.problem.line
        found = np.zeros((nodes.size, 2, 2 * len(line.beams)))
        for i, (start, end) in enumerate(zip(line.starts, line.ends, strict=True)):
            on = (nodes >= start) & (nodes <= end)
            found[on, 0, 2 * i] = 1.0
            found[on, 0, 2 * i + 1] = (nodes[on] - start) / (end - start)
            found[on, 1, 2 * i + 1] = self.L / (end - start)
        return found.reshape(2 * nodes.size, -1)

    @cached_property
    def tips(self) -> FloatArray:
        """Rows that read z at the ends of all beams, without unit, ``(2 beams, n)``."""
        return self.assembly.shapes(np.array(self.problem.line.edges), 0)

    @cached_property
    def quadrature(self) -> tuple[FloatArray, FloatArray]:
        """Positions, m, and weights over L that integrate the square of a quartic in each element, ``(5 e,)`` each."""
        x, w = np.polynomial.legendre.leggauss(5)
        half, start = self.assembly.element_lengths[:, None] / 2, self.assembly.nodes[self.elements][:, None]
        return np.ravel((start + half) + half * x), np.ravel(half / self.L * w)

    def motion(self, amounts: FloatArray) -> FloatArray:
        """Displacement, m, of the left end of each beam, and its slope, ``(2 beams,)``, of amounts of `rigid`."""
        size = np.array([size for beam in self.problem.line.beams for size in (self.L, self.L / beam.length)])
        return np.asarray(amounts * size)

    def unresisted(self, pressing: tuple[int, ...] = ()) -> FloatArray:
        """Rigid motions, as rows of amounts of `rigid`, that springs and stops leave: ``(0 to 2 beams, 2 beams)``."""
        rows, every = np.vstack([self.rows, self.stops[list(pressing)]]) @ self.rigid, self.rigid.shape[1]
        _, size, directions = np.linalg.svd(np.vstack([rows, np.zeros((every, every))]))
        return np.asarray(directions[size <= _HELD])

    def ways(self, stops: Sequence[int], free: FloatArray) -> FloatArray:
        """How far each of the motions `free`, ``(d, 2 beams)``, goes towards stops; 0 of stops that no motion reaches
        but by rounding, ``(stops, d)``."""
        found = self.stops[list(stops)] @ self.rigid @ free.T
        return np.where(np.linalg.norm(found, axis=1, keepdims=True) > _HELD, found, 0.0)

    def check_resisted(self) -> None:
        """Raise an InputError if the loads drive a rigid motion that supports and stops do not resist.

        The work of the loads on the rigid motions that supports leave must be that of stops which push: a problem of
        least squares, whose residual is such a motion.
        """
        free = self.unresisted()
        if not free.shape[0]:
            return
        motions = self.rigid @ free.T
        work = motions.T @ self.f
        size = float(np.abs(self.rigid).sum(axis=1) @ self.size_of_f)
        push = self.ways(range(self.k.size), free).T
        left = work - push @ nnls(push, work)[0] if push.size else work
        if float(np.abs(left).max()) > UNDRIVEN * size:
            raise InputError(nothing_resists(self.problem.line, self.motion(left @ free).tolist()))

    @cached_property
    def _middle(self) -> FloatArray:
        return (self.assembly.nodes[:-1] + self.assembly.nodes[1:]) / 2

    @cached_property
    def EI_of(self) -> FloatArray:
        """Bending stiffness of each element, N m2, 0 of spaces, ``(e,)``."""
        return self.problem.line.EI_at(self._middle)

    @cached_property
    def q(self) -> FloatArray:
        """The constant load of each element, N/m, ``(e,)``."""
        found = np.zeros(self._middle.size)
        for load in self.problem.forces.constant:
            for start, end, force in load.shape.pieces:
                found[(self._middle > start) & (self._middle < end)] += force * load.force
        return found
