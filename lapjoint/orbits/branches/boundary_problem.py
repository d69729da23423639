r"""Periodic motions with a given contact sequence as a boundary value problem, and its derivative.

The unknowns are u = (x, delta_1 ... delta_F, p): displacements and velocities x at the section, the durations of all
arcs but the last over the length L of the motion, F of them, and the parameter p.  The equations are the closure
y(L) = x (for an odd number of half periods the mirror image -y(L) = x) and one equation for each of the F events, see
`lapjoint.orbits.arcs`.  With the derivatives A = y_x, B = y_delta, C = g_x, D = g_delta of closure and events the
monodromy matrix is A - B D^-1 C.
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
    """Motions of one contact sequence, over a range of the parameter."""

    resolution: Resolution
    """The solver at one resolution, and the parameter."""
    sequence: ContactSequence
    """Which stops switch between the section and its image, ``M`` events."""
    half_periods: int
    """Number of half periods of the excitation after which the motion repeats; mirrored, if it is odd."""
    phase: float
    """Time of the section over the excitation period, from 0 to 1."""
    tied: frozenset[int] = frozenset()
    """Events at the same time as the event before, of another stop: the arc between has no duration, and of the
    equations of such events that of the first one stands for all.  Stops that mirror each other along the beam switch
    so."""

    @property
    def events(self) -> int:
        """Number ``M`` of events."""
        return len(self.sequence.stops)

    @cached_property
    def free(self) -> npt.NDArray[np.intp]:
        """The events that are not tied to the one before, and the arcs that end with them, shape ``(F,)``."""
        return np.array([i for i in range(self.events) if i not in self.tied], dtype=np.intp)

    def packed(self, x: FloatArray, shares: FloatArray, value: float) -> FloatArray:
        """The unknowns.

        Parameters
        ----------
        x : FloatArray, shape (n,)
            Coordinates of the section.
        shares : FloatArray, shape (M,) or (M + 1,)
            Durations of all arcs over the length of the motion; the last one may be left out.
        value : float
            The parameter, in its SI unit.

        Returns
        -------
        FloatArray, shape (n + F + 1,)
            u.
        """
        return np.concatenate([x, np.asarray(shares, dtype=float)[self.free], [value]])

    def coordinates(self, u: FloatArray) -> int:
        """Number ``n`` of coordinates of the section.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        int
            The number.
        """
        return u.size - 1 - self.free.size

    def position(self, u: FloatArray, arc: int) -> int:
        """Where the duration of an arc is among the unknowns.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.
        arc : int
            An arc that ends with an event that is not tied.

        Returns
        -------
        int
            Its index in u.
        """
        return self.coordinates(u) + int(np.searchsorted(self.free, arc))

    def group(self, event: int) -> range:
        """The events that are at the same time as one of them.

        Parameters
        ----------
        event : int
            The event.

        Returns
        -------
        range
            In sequence; the first one is not tied.
        """
        first, last = event, event + 1
        while first in self.tied:
            first -= 1
        while last in self.tied:
            last += 1
        return range(first, last)

    def arcs(self, u: FloatArray) -> Arcs:
        """The arcs at the parameter of a solution.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        Arcs
            Of the problem with that parameter.
        """
        return self.resolution.arcs(float(u[-1]))

    def shares(self, u: FloatArray) -> FloatArray:
        """Durations of all arcs over the length of the motion.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        FloatArray, shape (M + 1,)
            Without unit; their sum is 1.
        """
        shares = np.zeros(self.events + 1)
        shares[self.free] = u[self.coordinates(u) : -1]
        shares[-1] = 1.0 - shares.sum()
        return shares

    def durations(self, u: FloatArray) -> FloatArray:
        """Durations of all arcs.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        FloatArray, shape (M + 1,)
            s.
        """
        return self.length(u) * self.shares(u)

    def length(self, u: FloatArray) -> float:
        """Length L of the motion, s.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        float
            Half periods of the excitation at the parameter.
        """
        return self._length(self.arcs(u))

    def time(self, u: FloatArray) -> float:
        """Time of the section, s from a multiple of the excitation period.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        float
            The time.
        """
        return self.phase * self.arcs(u).period

    def chain(self, u: FloatArray, derivatives: bool = False) -> Chain:
        """The arcs of a set of unknowns, whether or not they solve the equations.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.
        derivatives : bool
            Whether to carry derivatives along.

        Returns
        -------
        Chain
            The arcs.
        """
        arcs, x, number = self.arcs(u), u[: self.coordinates(u)], self.resolution.path
        times = self.phase * arcs.period, self._length(arcs) * self.shares(u)
        return arcs.chain(self.sequence, x, *times, derivatives, number if derivatives else None)

    def residual(self, u: FloatArray, chain: Chain | None = None) -> FloatArray:
        """Left sides of the equations.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.
        chain : Chain, optional
            Their arcs, if they are known.

        Returns
        -------
        FloatArray, shape (n + F,)
            Of the closure, in the unit of each coordinate, then of the events, m or m/s.
        """
        chain = self.chain(u) if chain is None else chain
        return np.concatenate([self._sign * chain.end - u[: chain.end.size], chain.events[self.free]])

    def linearised(self, u: FloatArray) -> Linearisation:
        """Equations and their derivative.

        Parameters
        ----------
        u : FloatArray, shape (n + F + 1,)
            The unknowns.

        Returns
        -------
        Linearisation
            At the unknowns.
        """
        chain, free = self.chain(u, derivatives=True), self.free
        n, F = chain.end.size, free.size
        assert chain.end_by is not None
        assert chain.events_by is not None
        residual = self.residual(u, chain)
        J = np.empty((n + F, n + F + 1))
        by_all = np.concatenate([self._sign * chain.end_by, chain.events_by[free]])
        J[:, :n] = by_all[:, :n]
        J.ravel()[: n * J.shape[1] : J.shape[1] + 1] -= 1.0
        J[:, n:-1] = self.length(u) * (by_all[:, n + free] - by_all[:, -1:])  # the last arc takes what is left
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
    """Their derivatives by the unknowns, shape ``(n + F, n + F + 1)``."""
    chain: Chain
    """The arcs."""

    @cached_property
    def monodromy(self) -> FloatArray:
        """Derivative of the section's image by the section while the events keep their equations, shape ``(n, n)``."""
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
        """Eigenvalues of the monodromy matrix over the motion's half periods, shape ``(n,)``."""
        return np.linalg.eigvals(self.monodromy).astype(complex)
