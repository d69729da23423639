"""Periodic motions with a given contact sequence as a boundary value problem, and its derivative.

The unknowns are u = (x, delta_1 ... delta_F, p).  The vector x holds displacements and velocities at the section, and p
is the parameter.  Each delta is the duration of an arc, divided by the length L of the motion; the last arc takes the
rest of L.

The equations are the closure y(L) = x (for an odd number of half periods, with the mirror image, -y(L) = x) and one
equation g = 0 for each of the F events, see `lapjoint.orbits.arcs`.  With the derivatives A = y_x, B = y_delta, C =
g_x, D = g_delta of closure and events, the monodromy matrix is A - B D^-1 C.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.arcs import Arcs, Chain, ContactSequence
from lapjoint.orbits.branches.resolution import Resolution
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class BoundaryProblem:
    """Equations of the periodic motions with one contact sequence, over a range of the parameter."""

    resolution: Resolution
    """The solver at one resolution, and the parameter."""
    sequence: ContactSequence
    """The stops that switch between the section and its image, ``M`` events."""
    half_periods: int
    """Number of half periods of the excitation after which the motion repeats; an odd number means that it repeats
    mirrored."""
    phase: float
    """Time of the section, divided by the excitation period, from 0 to 1."""
    tied: frozenset[int] = frozenset()
    """Events that are simultaneous with the previous event, of another stop: the arc between them has no duration, and
    the equation of the first event of the group stands for all.  In a motion that is symmetric about the middle of the
    beam, equal stops at x and L - x switch together."""

    @property
    def events(self) -> int:
        """Number ``M`` of events."""
        return len(self.sequence.stops)

    @cached_property
    def free(self) -> npt.NDArray[np.intp]:
        """Indices of the F events that are not tied to the event before, and of the arcs that end with them, shape
        ``(F,)``."""
        return np.array([i for i in range(self.events) if i not in self.tied], dtype=np.intp)

    def packed(self, x: FloatArray, shares: FloatArray, value: float) -> FloatArray:
        """The unknowns u, shape (n + F + 1,): section `x`, (n,), durations divided by the length, `shares`, (M,) or (M
        + 1,), and parameter `value`."""
        return np.concatenate([x, np.asarray(shares, dtype=float)[self.free], [value]])

    def coordinates(self, u: FloatArray) -> int:
        """Number n of coordinates of the section, for unknowns of shape (n + F + 1,)."""
        return u.size - 1 - self.free.size

    def position(self, u: FloatArray, arc: int) -> int:
        """Index of an arc's duration among the unknowns; the arc must end with an event that is not tied."""
        return self.coordinates(u) + int(np.searchsorted(self.free, arc))

    def group(self, event: int) -> range:
        """Indices of the events that are simultaneous with an event, including the event itself; the first of them is
        not tied."""
        first, last = event, event + 1
        while first in self.tied:
            first -= 1
        while last in self.tied:
            last += 1
        return range(first, last)

    def arcs(self, u: FloatArray) -> Arcs:
        """The arcs of the problem at the parameter, which is the last of the unknowns `u`, shape (n + F + 1,)."""
        return self.resolution.arcs(float(u[-1]))

    def shares(self, u: FloatArray) -> FloatArray:
        """Durations of all arcs, divided by the length of the motion, shape (M + 1,); their sum is 1."""
        shares = np.zeros(self.events + 1)
        shares[self.free] = u[self.coordinates(u) : -1]
        shares[-1] = 1.0 - shares.sum()
        return shares

    def durations(self, u: FloatArray) -> FloatArray:
        """Durations of all arcs, shape (M + 1,), in s."""
        return self.length(u) * self.shares(u)

    def length(self, u: FloatArray) -> float:
        """Length L of the motion, in s: half periods of the excitation at the parameter of the unknowns."""
        return self._length(self.arcs(u))

    def time(self, u: FloatArray) -> float:
        """Time of the section, in s from a multiple of the excitation period."""
        return self.phase * self.arcs(u).period

    def chain(self, u: FloatArray, derivatives: bool = False) -> Chain:
        """The arcs of unknowns, shape (n + F + 1,), which need not solve the equations; optionally with derivatives."""
        arcs, x, number = self.arcs(u), u[: self.coordinates(u)], self.resolution.path
        times = self.phase * arcs.period, self._length(arcs) * self.shares(u)
        return arcs.chain(self.sequence, x, *times, derivatives, number if derivatives else None)

    def residual(self, u: FloatArray, chain: Chain | None = None) -> FloatArray:
        """Left sides of the equations, shape (n + F,): the closure in the unit of each coordinate, then the events, in
        m or m/s."""
        chain = self.chain(u) if chain is None else chain
        return np.concatenate([self._sign * chain.end - u[: chain.end.size], chain.events[self.free]])

    def linearised(self, u: FloatArray) -> Linearisation:
        """The equations and their derivative at unknowns of shape (n + F + 1,)."""
        chain, free = self.chain(u, derivatives=True), self.free
        n, F = chain.end.size, free.size
        assert chain.end_by is not None
        assert chain.events_by is not None
        residual = self.residual(u, chain)
        J = np.empty((n + F, n + F + 1))
        by_all = np.concatenate([self._sign * chain.end_by, chain.events_by[free]])
        J[:, :n] = by_all[:, :n]
        J.ravel()[: n * J.shape[1] : J.shape[1] + 1] -= 1.0
        J[:, n:-1] = self.length(u) * (by_all[:, n + free] - by_all[:, -1:])  # the last arc has the rest of the length
        if chain.by_number is None:
            step, moved = self.resolution.difference_step(float(u[-1])), u.copy()
            moved[-1] += step
            J[:, -1] = (self.residual(moved) - residual) / step
        else:
            J[:n, -1], J[n:, -1] = self._sign * chain.by_number[:n], chain.by_number[n:][free]
        return Linearisation(residual, J, chain)

    def _length(self, arcs: Arcs) -> float:
        return self.half_periods * arcs.period / 2

    @property
    def _sign(self) -> float:
        return -1.0 if self.half_periods % 2 else 1.0


@dataclass(frozen=True)
class Linearisation:
    """The equations of a boundary value problem and their derivative at one set of unknowns."""

    residual: FloatArray
    """Left sides of the equations, shape ``(n + F,)``."""
    jacobian: FloatArray
    """Derivatives of the left sides by the unknowns, shape ``(n + F, n + F + 1)``."""
    chain: Chain
    """The arcs with these unknowns, and their derivatives."""

    @cached_property
    def monodromy(self) -> FloatArray:
        """Derivative of the section's image by the section, with the events moving to their switching times, shape
        ``(n, n)``."""
        n = self.chain.end.size
        J = self.jacobian[:, :-1]
        A, B, C, D = J[:n, :n] + np.eye(n), J[:n, n:], J[n:, :n], J[n:, n:]
        return A if not D.size else A - B @ np.linalg.solve(D, C)

    @cached_property
    def modes(self) -> tuple[ComplexArray, ComplexArray]:
        """Eigenvalues and eigenvectors of the monodromy matrix, shapes ``(n,)`` and ``(n, n)``."""
        values, vectors = np.linalg.eig(self.monodromy)
        return values.astype(complex), vectors.astype(complex)

    @cached_property
    def multipliers(self) -> ComplexArray:
        """Eigenvalues of the monodromy matrix, over all half periods of the motion, shape ``(n,)``."""
        return np.linalg.eigvals(self.monodromy).astype(complex)
