"""Arcs of a rigid bar on springs, by which the program's equations have the closed forms of `bilinear_map` themselves.

Their modes come from the bar's own mass and springs; a beam's solver has them only in the limit of an infinite bending
stiffness.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property
from itertools import islice

import numpy as np
from galerkin_arcs import AMPLITUDE, GalerkinArcs, GalerkinResolution
from scipy.linalg import eigh

from lapjoint import ModalDamping, Problem, ViscousDamping
from lapjoint.answers.contact_state import FREE
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.bifurcations import Bifurcation, Stretch, within
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.starts import at_parameter
from lapjoint.problem import FloatArray
from validation.references.bilinear_map import BilinearMap, OneContact


class RigidBarArcs(GalerkinArcs):
    """The arcs of a bar that moves by its ends' displacements, or by its tip's where a pin holds its root."""

    @cached_property
    def is_pinned(self) -> bool:
        """Whether a pin holds the root."""
        return any(math.isinf(support.translational) for support in self.problem.supports)

    def place(self, x: float) -> FloatArray:
        """Displacement at x by those of the ends."""
        part = x / self.problem.beam.length
        return np.array([part] if self.is_pinned else [1 - part, part])

    @cached_property
    def mass(self) -> FloatArray:
        """The mass matrix, kg."""
        beam = self.problem.beam
        both = np.array([[2.0, 1.0], [1.0, 2.0]]) * beam.m * beam.length / 6
        return both[1:, 1:] if self.is_pinned else both

    @cached_property
    def natural(self) -> tuple[FloatArray, FloatArray]:
        """Angular frequencies, rad/s, and modes without contact."""
        length, K = self.problem.beam.length, np.zeros_like(self.mass)
        slope = np.array([1.0] if self.is_pinned else [-1.0, 1.0]) / length
        for one in self.problem.supports:
            K += one.torsional * np.outer(slope, slope)
            if not math.isinf(one.translational):
                K += one.translational * np.outer(self.place(one.x), self.place(one.x))
        squares, modes = eigh(K, self.mass)
        return np.sqrt(squares), modes

    def shapes(self, x: float) -> tuple[FloatArray, FloatArray, FloatArray]:
        """See `GalerkinArcs`."""
        omega, modes = self.natural
        beam = self.problem.beam
        whole = np.full(omega.size, beam.m * beam.length / 2)  # the integral of the shapes m N
        return omega, modes.T @ self.place(x), modes.T @ whole


class RigidBarResolution(GalerkinResolution):
    """Such a bar over a range of the amplitude of its base."""

    kind = RigidBarArcs

    @property
    def bar(self) -> RigidBarArcs:
        """The bar at an end of the range."""
        return RigidBarArcs(self.problem_at(self.low), self.modes, self.zeta, self.viscous)

    @staticmethod
    def of(problem: Problem, low: float, high: float) -> RigidBarResolution:
        """The bar of a problem."""
        arcs, damping = RigidBarArcs(problem, 0, 0.0), problem.damping
        omega, viscous = arcs.natural[0], isinstance(damping, ViscousDamping)
        if isinstance(damping, ViscousDamping):
            zeta = damping.coefficient / problem.beam.m / (2 * omega[0])
        else:
            assert isinstance(damping, ModalDamping)
            zeta = damping.ratio
        return RigidBarResolution(problem, AMPLITUDE, low, high, omega.size, zeta, viscous)

    def start(self, known: BilinearMap, motion: OneContact) -> CurvePoint:
        """A motion of one contact, in the middle of whose flight the section lies, as a point of its curve."""
        arcs, flight = self.bar, known.period - motion.duration
        time, n = motion.duration + flight / 2, arcs.natural[0].size
        u = known.state(motion, time).reshape(2, -1)
        u = np.repeat(u, n, axis=1) if u.shape[1] < n else u  # a bar that only moves up and down
        x = (u @ arcs.mass @ arcs.natural[1]).ravel()
        phase = (motion.phase + known.omega * time) / (2 * np.pi) % 1.0
        stop = 1 if known.mirrored else 0  # the next contact is the mirror image of this one
        half_periods = 1 if known.mirrored else 2 * known.periods
        problem = BoundaryProblem(self, ContactSequence(FREE, (stop, stop)), half_periods, phase)
        shares = np.array([flight / 2, motion.duration]) / known.period
        found = at_parameter(problem, problem.packed(x, shares, motion.amplitude))
        assert found is not None
        assert float(np.linalg.norm((found.u[:-1] - problem.packed(x, shares, 0.0)[:-1]) / found.scale[:-1])) < 1e-9
        return found


@dataclass(frozen=True)
class Steps:
    """A curve, followed both ways as far as its motions have one contact."""

    points: list[CurvePoint]
    """Its points."""
    bifurcations: list[Bifurcation]
    """Its bifurcations."""


def steps(start: CurvePoint, most: int) -> Steps:
    """Follow a curve from a motion of one contact for some steps at most, both ways."""
    found = Steps([start], [])
    for way in (start, start.turned()):
        for step in islice(_of_one_contact(way), most):
            found.points.append(step.end)
            found.bifurcations.extend(within(step))
    return found


def _of_one_contact(start: CurvePoint) -> Iterator[Stretch]:
    for step in follow(start):
        if not isinstance(step, Stretch):
            return
        yield step
