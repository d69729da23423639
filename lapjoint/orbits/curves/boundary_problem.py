r"""Periodic motions with a given contact sequence as a boundary value problem, and its derivative.

The unknowns are u = (x, delta_1 ... delta_M, p): displacements and velocities x at the section, the durations of all
arcs but the last over the length L of the motion, and the parameter p.  The equations are the closure y(L) = x (for an
odd number of half periods the mirror image -y(L) = x) and one equation for each of the M events, see
`lapjoint.orbits.arcs`.  With the derivatives A = y_x, B = y_delta, C = g_x, D = g_delta of closure and events the
monodromy matrix is A - B D^-1 C.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.arcs import Arcs, Chain, ContactSequence
from lapjoint.orbits.curves.resolution import Resolution
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

    @property
    def events(self) -> int:
        """Number ``M`` of events."""
        return len(self.sequence.stops)

    def arcs(self, u: FloatArray) -> Arcs:
        """The arcs at the parameter of a solution.

        Parameters
        ----------
        u : FloatArray, shape (n + M + 1,)
            The unknowns.

        Returns
        -------
        Arcs
            Of the problem with that parameter.
        """
        return self.resolution.arcs(float(u[-1]))

    def durations(self, u: FloatArray) -> FloatArray:
        """Durations of all arcs.

        Parameters
        ----------
        u : FloatArray, shape (n + M + 1,)
            The unknowns.

        Returns
        -------
        FloatArray, shape (M + 1,)
            s.
        """
        return self._durations(u, self.arcs(u))

    def length(self, u: FloatArray) -> float:
        """Length L of the motion, s.

        Parameters
        ----------
        u : FloatArray, shape (n + M + 1,)
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
        u : FloatArray, shape (n + M + 1,)
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
        u : FloatArray, shape (n + M + 1,)
            The unknowns.
        derivatives : bool
            Whether to carry derivatives along.

        Returns
        -------
        Chain
            The arcs.
        """
        arcs, n, number = self.arcs(u), u.size - 1 - self.events, self.resolution.path
        times = self.phase * arcs.period, self._durations(u, arcs)
        return arcs.chain(self.sequence, u[:n], *times, derivatives, number if derivatives else None)

    def residual(self, u: FloatArray, chain: Chain | None = None) -> FloatArray:
        """Left sides of the equations.

        Parameters
        ----------
        u : FloatArray, shape (n + M + 1,)
            The unknowns.
        chain : Chain, optional
            Their arcs, if they are known.

        Returns
        -------
        FloatArray, shape (n + M,)
            Of the closure, in the unit of each coordinate, then of the events, m or m/s.
        """
        chain = self.chain(u) if chain is None else chain
        return np.concatenate([self._sign * chain.end - u[: chain.end.size], chain.events])

    def linearised(self, u: FloatArray) -> Linearisation:
        """Equations and their derivative.

        Parameters
        ----------
        u : FloatArray, shape (n + M + 1,)
            The unknowns.

        Returns
        -------
        Linearisation
            At the unknowns.
        """
        chain, M, length = self.chain(u, derivatives=True), self.events, self.length(u)
        n = chain.end.size
        assert chain.end_by is not None
        assert chain.events_by is not None
        residual = self.residual(u, chain)
        J = np.empty((n + M, n + M + 1))
        for rows, by, factor in ((J[:n], chain.end_by, self._sign), (J[n:], chain.events_by, 1.0)):
            np.multiply(by[:, :n], factor, out=rows[:, :n])
            np.subtract(by[:, n:-1], by[:, -1:], out=rows[:, n:-1])  # the last arc takes what is left
            rows[:, n:-1] *= factor * length
        J.ravel()[: n * J.shape[1] : J.shape[1] + 1] -= 1.0
        if chain.by_number is None:
            step, moved = self.resolution.difference_step(float(u[-1])), u.copy()
            moved[-1] += step
            J[:, -1] = (self.residual(moved) - residual) / step
        else:
            J[:n, -1], J[n:, -1] = self._sign * chain.by_number[:n], chain.by_number[n:]
        return Linearisation(residual, J, chain)

    def _length(self, arcs: Arcs) -> float:
        return self.half_periods * arcs.period / 2

    def _durations(self, u: FloatArray, arcs: Arcs) -> FloatArray:
        shares = np.empty(self.events + 1)
        shares[:-1] = u[u.size - shares.size : -1]
        shares[-1] = 1.0 - shares[:-1].sum()
        return self._length(arcs) * shares

    @property
    def _sign(self) -> float:
        return -1.0 if self.half_periods % 2 else 1.0


@dataclass(frozen=True)
class Linearisation:
    """The equations of a boundary value problem and their derivative at one set of unknowns."""

    residual: FloatArray
    """Left sides of the equations, shape ``(n + M,)``."""
    jacobian: FloatArray
    """Their derivatives by the unknowns, shape ``(n + M, n + M + 1)``."""
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
    def multipliers(self) -> ComplexArray:
        """Eigenvalues of the monodromy matrix over the motion's half periods, shape ``(n,)``."""
        return np.linalg.eigvals(self.monodromy).astype(complex)
