"""Hermite beam elements by scikit-fem: stiffness, consistent mass, loads, and evaluation of the result.

Assembly is done for the beam of unit length, stiffness and mass; x, and with it the slope, is scaled by L, so that
the matrices are well conditioned whatever the units.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from skfem import Basis, BilinearForm, ElementLineHermite, LinearForm, MeshLine
from skfem.helpers import dd, ddot

from lapjoint.contact import ContactState
from lapjoint.problem import FloatArray, Problem


@BilinearForm
def bending(u, v, _):  # type: ignore[no-untyped-def]
    """Integral of u'' v''."""
    return ddot(dd(u), dd(v))


@BilinearForm
def inertia(u, v, _):  # type: ignore[no-untyped-def]
    """Integral of u v: the consistent mass."""
    return u * v


@LinearForm
def uniform(v, _):  # type: ignore[no-untyped-def]
    """Integral of v: a unit force per unit length."""
    return 1.0 * v


@dataclass(frozen=True)
class Assembly:
    """Matrices of the free beam on one mesh; degrees of freedom are (z, L z_x) node by node."""

    problem: Problem
    nodes: FloatArray
    """Node positions, m, shape ``(nodes,)``."""

    @cached_property
    def _matrices(self) -> tuple[FloatArray, FloatArray, FloatArray]:
        beam = self.problem.beam
        L = beam.length
        # A fresh element for every basis: it keeps the polynomials of the first mesh that it meets.
        basis = Basis(MeshLine(self.nodes / L), ElementLineHermite(), intorder=8)
        order = basis.nodal_dofs[:, np.argsort(basis.mesh.p[0])].T.ravel()
        pick = np.ix_(order, order)
        K = bending.assemble(basis).toarray()[pick] * (beam.EI / L**3)
        M = inertia.assemble(basis).toarray()[pick] * (beam.m * L)
        return K, M, uniform.assemble(basis)[order] * L

    @property
    def mass(self) -> FloatArray:
        """Consistent mass of the free degrees of freedom, shape ``(n, n)``."""
        return np.asarray(self._matrices[1][np.ix_(self.free, self.free)])

    @property
    def uniform_load(self) -> FloatArray:
        """Load vector of a unit force per unit length, shape ``(n,)``."""
        return np.asarray(self._matrices[2][self.free])

    @cached_property
    def free(self) -> np.ndarray:
        """Indices of the degrees of freedom that no infinite spring fixes, shape ``(n,)``."""
        fixed = set()
        for support in self.problem.supports:
            node = self.node(support.x)
            if math.isinf(support.translational):
                fixed.add(2 * node)
            if math.isinf(support.torsional):
                fixed.add(2 * node + 1)
        return np.array([i for i in range(2 * self.nodes.size) if i not in fixed], dtype=int)

    def node(self, x: float) -> int:
        """Index of the node at `x`."""
        return int(np.searchsorted(self.nodes, x))

    def unit_force(self, x: float) -> FloatArray:
        """Load vector of a unit force at the node at `x`, shape ``(n,)``; also the row that reads z there."""
        return np.asarray((self.free == 2 * self.node(x)).astype(float))

    def stiffness(self, state: ContactState) -> FloatArray:
        """Stiffness with the finite supports and the closed stops as springs, shape ``(n, n)``."""
        K = self._matrices[0].copy()
        L = self.problem.beam.length
        for support in self.problem.supports:
            i = 2 * self.node(support.x)
            if math.isfinite(support.translational):
                K[i, i] += support.translational
            if math.isfinite(support.torsional):
                K[i + 1, i + 1] += support.torsional / L**2
        for k in state.closed:
            stop = self.problem.stops[k]
            i = 2 * self.node(stop.x)
            K[i, i] += stop.stiffness
        return np.asarray(K[np.ix_(self.free, self.free)])

    def shapes(self, x: FloatArray, derivative: int) -> FloatArray:
        """Rows that give z or an x-derivative (0 to 3) at ``x`` from the free degrees of freedom, ``(k, n)``.

        The second derivative is linear, the third constant in an element; at a node they belong to the element
        to the left.
        """
        e = np.clip(np.searchsorted(self.nodes, x, side="left") - 1, 0, self.nodes.size - 2)
        h = np.diff(self.nodes)[e]
        s = (x - self.nodes[e]) / h
        L = self.problem.beam.length
        values = _hermite(s, derivative) / h**derivative  # (4, k)
        values[1::2] *= h / L
        full = np.zeros((x.size, 2 * self.nodes.size))
        for j in range(4):
            full[np.arange(x.size), 2 * e + j] = values[j]
        return np.asarray(full[:, self.free])


def _hermite(s: FloatArray, derivative: int) -> FloatArray:
    """Derivatives of the four cubic Hermite polynomials on [0, 1], shape ``(4, k)``."""
    cubics = ([1, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1])
    return np.array([np.polynomial.Polynomial(c).deriv(derivative)(s) + 0 * s for c in cubics])
