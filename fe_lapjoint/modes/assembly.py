"""Hermite beam elements by scikit-fem: stiffness, mass, loads, and evaluation of the result.

Slopes are scaled by L, so that the matrices are well conditioned whatever the units.

scikit-fem (12.0.2) builds Hermite functions from monomials in the global x by inverting a Vandermonde matrix per
element, which costs digits as elements shrink: against the textbook matrices, the mass matrix of a whole mesh is
off by 2e-10 of its largest entry at 64 elements and by 2e-8 at 256.  Therefore the weak forms are integrated on one
element of unit length, where they are exact to rounding, and scaled by h to every element of the mesh.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cache, cached_property

import numpy as np
import numpy.typing as npt
from skfem import Basis, BilinearForm, ElementLineHermite, MeshLine
from skfem.helpers import dd, ddot

from fe_lapjoint.modes.mesh import SAME
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray, NoDamping, Problem
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.structure import Structure, structure_of


@BilinearForm
def bending(u, v, _):  # type: ignore[no-untyped-def]
    """Integral of u'' v'' over the element. See `skfem.BilinearForm` for the arguments."""
    return ddot(dd(u), dd(v))


@BilinearForm
def inertia(u, v, _):  # type: ignore[no-untyped-def]
    """Integral of u v over the element: the consistent mass. See `skfem.BilinearForm` for the arguments."""
    return u * v


@cache
def unit_element() -> tuple[FloatArray, FloatArray]:
    """Stiffness and mass, ``(4, 4)`` each, of an element with h = EI = m = 1; read-only."""
    basis = Basis(MeshLine([0.0, 1.0]), ElementLineHermite(), intorder=6)  # mass: degree 3 + 3
    order = basis.nodal_dofs.T.ravel()
    pick = np.ix_(order, order)
    K, M = (form.assemble(basis).toarray()[pick] for form in (bending, inertia))
    for part in (K, M):
        part.flags.writeable = False
    return K, M


def two_points(a: FloatArray, b: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gauss' two points between `a` and `b`, m, ``(e,)`` each, and half the lengths b - a, m, as weights: ``(2 e,)``.

    They integrate cubics without error.
    """
    h = b - a
    x = a[:, None] + h[:, None] * np.array([0.5 - 0.5 / math.sqrt(3), 0.5 + 0.5 / math.sqrt(3)])
    return x.ravel(), np.repeat(h, 2) / 2


_UNDAMPED = NoDamping()
_HELD = 1e-9
"""Supports that resist a rigid-body motion of unit size by less than this do not resist it; see also `mesh.CLOSE`."""


@dataclass(frozen=True)
class Assembly:
    """Matrices of the free beam on one mesh; degrees of freedom are (z, L z_x), m, node by node.

    ``n`` of them are free: no infinite spring fixes them.
    """

    problem: Problem
    nodes: FloatArray
    """Node positions, m, shape ``(nodes,)``."""

    @cached_property
    def _matrices(self) -> tuple[FloatArray, FloatArray]:
        size, middle = 2 * self.nodes.size, (self.nodes[:-1] + self.nodes[1:]) / 2
        K, M = np.zeros((size, size)), np.zeros((size, size))
        k, m = unit_element()
        beam = self.problem.line
        rows = zip(np.diff(self.nodes), beam.EI_at(middle), beam.inertia_at(middle), strict=True)
        for e, (h, EI, inertia) in enumerate(rows):
            here, slope = slice(2 * e, 2 * e + 4), h / beam.length
            scale = np.array([1.0, slope, 1.0, slope])
            K[here, here] += EI / h**3 * k * np.outer(scale, scale)
            M[here, here] += inertia * h * m * np.outer(scale, scale)
        return K, M

    @cached_property
    def strain_points(self) -> tuple[FloatArray, FloatArray]:
        """Two Gauss points an element, m, and sqrt(EI w) with their weights w, N^1/2 m^3/2, ``(2 e,)`` each."""
        x, w = two_points(self.nodes[:-1], self.nodes[1:])
        return x, np.sqrt(self.problem.line.EI_at(x) * w)

    @cached_property
    def curvature(self) -> FloatArray:
        """B with B^T B the stiffness without springs: sqrt(EI w) z'' at two Gauss points an element, ``(2 e, n)``.

        Strain energy from B u loses far fewer digits on fine meshes than u^T K u: cancellation is of order h^-2.
        """
        x, weight = self.strain_points
        return weight[:, None] * self.shapes(x, 2)

    @property
    def mass(self) -> FloatArray:
        """Mass of the free degrees of freedom, kg, ``(n, n)``: consistent of the beam, and the masses on it."""
        M, L = self._matrices[1][np.ix_(self.free, self.free)], self.problem.line.length
        for it in self.problem.structure.masses:
            for row, size in ((self.reading(it.x), it.mass), (self.reading(it.x, 1), it.rotary_inertia / L**2)):
                M += size * np.outer(row, row)
        return np.asarray(M)

    @cached_property
    def drag(self) -> FloatArray:
        """Integrals of products of shape functions along the beam, m, ``(n, n)``: a viscous force of 1 N s/m2."""
        L, unit = self.problem.line.length, unit_element()[1]
        drag = np.zeros((2 * self.nodes.size, 2 * self.nodes.size))
        for e, h in enumerate(np.diff(self.nodes)):
            here, scale = slice(2 * e, 2 * e + 4), np.array([1.0, h / L, 1.0, h / L])
            drag[here, here] += h * unit * np.outer(scale, scale)
        return np.asarray(drag[np.ix_(self.free, self.free)])

    def load(self, shape: LoadShape) -> FloatArray:
        """The load vector, ``(n,)``, of a load of size 1; read-only."""
        if shape not in self._loads:
            self._loads[shape] = self._consistent(shape)
            self._loads[shape].flags.writeable = False
        return self._loads[shape]

    @cached_property
    def _loads(self) -> dict[LoadShape, FloatArray]:
        return {}

    def _consistent(self, shape: LoadShape) -> FloatArray:
        """The work, ``(n,)``, of a load of size 1 on a unit of each degree of freedom: the integral of its forces."""
        found = np.zeros(self.free.size)
        for x, force in shape.points:
            found += force * self.reading(x)
        for start, end, force in shape.pieces:
            a, b = np.maximum(self.nodes[:-1], self.place(start)), np.minimum(self.nodes[1:], self.place(end))
            points, w = two_points(a[a < b], b[a < b])
            found += force * (w @ self.shapes(points, 0))
        return found

    @cached_property
    def free(self) -> npt.NDArray[np.int64]:
        """Indices of the degrees of freedom that no infinite spring fixes, shape ``(n,)``."""
        fixed = set()
        for support in self.problem.structure.supports:
            node = self.node(support.x)
            if math.isinf(support.translational):
                fixed.add(2 * node)
            if math.isinf(support.torsional):
                fixed.add(2 * node + 1)
        return np.array([i for i in range(2 * self.nodes.size) if i not in fixed], dtype=int)

    def node(self, x: float) -> int:
        """Index of the node nearest to a position, m."""
        return int(np.argmin(np.abs(self.nodes - x)))

    def place(self, x: float) -> float:
        """A position, m, or the position of a node from which it differs by rounding only."""
        near = float(self.nodes[self.node(x)])
        return near if abs(near - x) <= SAME * self.problem.line.length else x

    def reading(self, x: float, derivative: int = 0) -> FloatArray:
        """The row, ``(n,)``, that reads z (`derivative` 0) or L z_x (1) at a position; at a node its entries are 0 and
        1.

        The row is also the load vector of a unit force at the position, or of a unit couple divided by L.
        """
        row = self.shapes(np.array([self.place(x)]), derivative)[0]
        return np.asarray(row * self.problem.line.length**derivative)

    @cached_property
    def without_stops(self) -> tuple[Structure, tuple[float, ...]]:
        """The beams with supports, links and masses, without stops and damping, and the nodes, m: what modes depend
        on."""
        it = self.problem.structure
        return structure_of(it.line, it.supports, (), _UNDAMPED, it.masses, it.links), tuple(self.nodes.tolist())

    @cached_property
    def base_shares(self) -> FloatArray:
        """How much of the base's motion each stop's gap sees, shape ``(P,)``."""
        return np.array([stop.base_share for stop in self.problem.structure.stops])

    @cached_property
    def stop_places(self) -> tuple[npt.NDArray[np.intp], npt.NDArray[np.intp]]:
        """The first stop of each place, shape ``(p,)``, and the place of each stop, shape ``(P,)``.

        The gaps of all stops of one place see the same.
        """
        stops = self.problem.structure.stops
        seen = [(*((self.place(x), a) for x, a in stop.reading), (stop.base_share, 0.0)) for stop in stops]
        places = sorted(set(seen))
        place_of = np.array([places.index(one) for one in seen], dtype=np.intp)
        return np.unique(place_of, return_index=True)[1], place_of

    @cached_property
    def stop_rows(self) -> FloatArray:
        """Rows that read z at the stops, without unit, shape ``(P, n)``."""
        rows = [
            sum((factor * self.reading(x) for x, factor in stop.reading), np.zeros(self.free.size))
            for stop in self.problem.structure.stops
        ]
        return np.array(rows).reshape(len(rows), self.free.size)

    def springs(self, state: ContactState) -> tuple[FloatArray, FloatArray]:
        """Finite supports and closed stops as rows, ``(s, n)``, that read z or L z_x, and stiffnesses, N/m, ``(s,)``.

        Their energy is half of ``k @ (rows @ u)**2``.  The stiffness of a torsional spring is divided by L^2.
        """
        L, found = self.problem.line.length, []
        for support in self.problem.structure.supports:
            if 0 < support.translational < math.inf:
                found.append((self.reading(support.x), support.translational))
            if 0 < support.torsional < math.inf:
                found.append((self.reading(support.x, 1), support.torsional / L**2))
        found += [(self.stop_rows[k], self.problem.structure.stops[k].stiffness) for k in state.closed]
        rows = np.array([row for row, _ in found]).reshape(len(found), self.free.size)
        return rows, np.array([k for _, k in found], dtype=float)

    def stiffness(self, state: ContactState) -> FloatArray:
        """Stiffness with the finite supports and the closed stops as springs, N/m, shape ``(n, n)``."""
        rows, k = self.springs(state)
        return np.asarray(self._matrices[0][np.ix_(self.free, self.free)] + rows.T @ (k[:, None] * rows))

    @cached_property
    def rigid_motions(self) -> FloatArray:
        """Rigid-body motions that the fixed supports allow, mass-normalised, kg^-1/2, shape ``(n, 0 to 2)``.

        Two of them are translation, and rotation about the centre of mass: orthogonal however heavy a mass is.
        """
        full = self._translation_and_rotation(0.5)
        fixed = np.delete(full, self.free, axis=0)
        _, size, directions = np.linalg.svd(np.vstack([fixed, np.zeros((2, 2))]))
        motions = full[self.free] @ directions[size <= _HELD].T
        if motions.shape[1] == 2:
            total, moment = full.T @ (self.mass @ full[:, 0])
            motions = self._translation_and_rotation(0.5 + moment / total)
        return np.asarray(motions / np.sqrt(np.sum(motions * (self.mass @ motions), axis=0)))

    def _translation_and_rotation(self, centre: float) -> FloatArray:
        """Translation, and rotation about a centre in beam lengths, of all degrees of freedom, ``(2 nodes, 2)``."""
        full = np.zeros((2 * self.nodes.size, 2))
        full[::2, 0] = 1.0
        full[::2, 1] = self.nodes / self.problem.line.length - centre
        full[1::2, 1] = 1.0
        return full

    def rigid_modes(self, state: ContactState) -> int:
        """Number of rigid-body modes, 0 to 2, that supports and closed stops leave."""
        L, supports = self.problem.line.length, self.problem.structure.supports
        rows = [(1.0, s.x / L) for s in supports if s.translational > 0]
        rows += [(0.0, 1.0) for s in supports if s.torsional > 0]
        rows += [(1.0, self.problem.structure.stops[k].x / L) for k in state.closed]
        return 2 - int(np.linalg.matrix_rank(np.array(rows), tol=_HELD)) if rows else 2

    def shapes(self, x: FloatArray, derivative: int) -> FloatArray:
        """Rows ``(k, n)``, 1/m^derivative, that give z or an x-derivative (0 to 3) at positions ``(k,)``, m.

        Within an element the second derivative is linear and the third constant.  At a node both are those of the
        element to the left.
        """
        e = np.clip(np.searchsorted(self.nodes, x, side="left") - 1, 0, self.nodes.size - 2)
        h = np.diff(self.nodes)[e]
        s = (x - self.nodes[e]) / h
        L = self.problem.line.length
        values = _hermite(s, derivative) / h**derivative  # (4, k)
        values[1::2] *= h / L
        full = np.zeros((x.size, 2 * self.nodes.size))
        for j in range(4):
            full[np.arange(x.size), 2 * e + j] = values[j]
        return np.asarray(full[:, self.free])


def _hermite(s: FloatArray, derivative: int) -> FloatArray:
    """Derivatives of the four cubic Hermite polynomials on [0, 1], shape ``(4, k)``."""
    return np.asarray(np.polynomial.polynomial.polyval(s, _cubics(derivative)))


@cache
def _cubics(derivative: int) -> FloatArray:
    """Coefficients of 1, s, ... of derivatives of the four cubic Hermite polynomials, shape ``(4 - derivative, 4)``."""
    cubics = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
    return np.asarray(np.polynomial.polynomial.polyder(cubics.T, derivative))
