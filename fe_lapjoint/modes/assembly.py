"""Hermite beam elements by scikit-fem: stiffness, mass, loads, and evaluation of the result.

Slopes are scaled by L, so that the matrices are well conditioned whatever the units.

Several beams lie on one axis, see `lapjoint.problem.line`.  A space between two of them is an element without stiffness
and mass.  Where an infinite link joins two displacements, or two slopes, these are one degree of freedom.

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
"""Springs that resist a rigid-body motion of unit size by less than this do not resist it; see also `mesh.CLOSE`."""


@dataclass(frozen=True)
class Assembly:
    """Matrices of free beams on one mesh; degrees of freedom are (z, L z_x), m, node by node.

    ``n`` of them are free: no infinite spring fixes them, and those that infinite links join count once.
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

    @property
    def element_lengths(self) -> FloatArray:
        """Lengths of the elements without the spaces between beams, m, ``(elements,)``."""
        return np.diff(self.nodes)[~self._empty]

    @cached_property
    def strain_points(self) -> tuple[FloatArray, FloatArray]:
        """Two Gauss points an element, m, and sqrt(EI w) with their weights w, N^1/2 m^3/2, ``(2 e,)`` each; spaces
        between beams have none."""
        x, w = two_points(self.nodes[:-1][~self._empty], self.nodes[1:][~self._empty])
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
        """Mass of the free degrees of freedom, kg, ``(n, n)``: consistent of the beams, and the masses on them."""
        return self._of_free(self._mass_of_all)

    @property
    def _mass_of_all(self) -> FloatArray:
        """Mass of all degrees of freedom, kg, ``(2 nodes, 2 nodes)``."""
        M, L = self._matrices[1].copy(), self.problem.line.length
        for it in self.problem.structure.masses:
            for derivative, size in enumerate((it.mass, it.rotary_inertia / L**2)):
                row = self._shapes_of_all(np.array([self.place(it.x)]), derivative)[0] * L**derivative
                M += size * np.outer(row, row)
        return M

    @cached_property
    def drag(self) -> FloatArray:
        """Damping that couples the modes, N s/m, ``(n, n)``: viscous along the beams, and dampers of links."""
        L, unit, structure = self.problem.line.length, unit_element()[1], self.problem.structure
        drag, middle = np.zeros((2 * self.nodes.size, 2 * self.nodes.size)), (self.nodes[:-1] + self.nodes[1:]) / 2
        for e, h in enumerate(np.diff(self.nodes)):
            here, scale = slice(2 * e, 2 * e + 4), np.array([1.0, h / L, 1.0, h / L])
            C = sum(C for start, end, C in structure.coupling_drag if start < middle[e] < end)
            drag[here, here] += C * h * unit * np.outer(scale, scale)
        found = self._of_free(drag)
        for it in structure.dampers:
            row = self.reading(it.second, it.derivative) - self.reading(it.first, it.derivative)
            found += it.damping / L ** (2 * it.derivative) * np.outer(row, row)
        return found

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
    def _groups(self) -> list[list[int]]:
        """The degrees of freedom that infinite links join, each ascending; the first group is what supports fix."""
        joint, root = self.problem.structure, list(range(-1, 2 * self.nodes.size))  # root[0] stands for what is fixed

        def first(i: int) -> int:
            while root[i + 1] != i:
                i = root[i + 1]
            return i

        def join(stiffness: float, *members: int) -> None:
            one, other = sorted(map(first, members))
            root[other + 1] = one if math.isinf(stiffness) else root[other + 1]

        for support in joint.supports:
            node = 2 * self.node(support.x)
            join(support.translational, -1, node)
            join(support.torsional, -1, node + 1)
        for link in joint.links:
            one, other = 2 * self.node(link.first), 2 * self.node(link.second)
            join(link.translational, one, other)
            join(link.torsional, one + 1, other + 1)
        found: dict[int, list[int]] = {-1: []}
        for i in range(2 * self.nodes.size):
            found.setdefault(first(i), []).append(i)
        return list(found.values())

    @cached_property
    def free(self) -> npt.NDArray[np.int64]:
        """Indices of the degrees of freedom that no infinite spring fixes, the first of each group that infinite links
        join, shape ``(n,)``."""
        return np.array([group[0] for group in self._groups[1:]], dtype=int)

    @cached_property
    def _joined(self) -> list[tuple[int, int]]:
        """Each degree of freedom that is joined to one in `free`, and the number of that one."""
        return [(i, number) for number, group in enumerate(self._groups[1:]) for i in group[1:]]

    def full(self, u: FloatArray) -> FloatArray:
        """All degrees of freedom, ``(k, 2 nodes)``, from the free ones, ``(k, n)``; the fixed ones are 0."""
        found = np.zeros((u.shape[0], 2 * self.nodes.size))
        found[:, self.free] = u
        for i, number in self._joined:
            found[:, i] = u[:, number]
        return found

    def _rows_of_free(self, full: FloatArray) -> FloatArray:
        """Rows, ``(k, n)``, that read from the free degrees of freedom what ``(k, 2 nodes)`` read from all."""
        found = full[:, self.free]
        for i, number in self._joined:
            found[:, number] += full[:, i]
        return found

    def _of_free(self, matrix: FloatArray) -> FloatArray:
        """A symmetric matrix of all degrees of freedom for the free ones, ``(n, n)``."""
        if not self._joined:
            return np.asarray(matrix[np.ix_(self.free, self.free)])
        return self._rows_of_free(self._rows_of_free(matrix).T)

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
        """Finite supports and links, and closed stops, as rows, ``(s, n)``, and their stiffnesses, N/m, ``(s,)``.

        A row reads z or L z_x, or of two beams the difference.  The energy of the springs is half of ``k @ (rows @
        u)**2``.  The stiffness of a torsional spring is divided by L^2.
        """
        L, found = self.problem.line.length, []
        for support in self.problem.structure.supports:
            if 0 < support.translational < math.inf:
                found.append((self.reading(support.x), support.translational))
            if 0 < support.torsional < math.inf:
                found.append((self.reading(support.x, 1), support.torsional / L**2))
        for link in self.problem.structure.links:
            for derivative, k in enumerate((link.translational, link.torsional)):
                if 0 < k < math.inf:
                    row = self.reading(link.second, derivative) - self.reading(link.first, derivative)
                    found.append((row, k / L ** (2 * derivative)))
        found += [(self.stop_rows[k], self.problem.structure.stops[k].stiffness) for k in state.closed]
        rows = np.array([row for row, _ in found]).reshape(len(found), self.free.size)
        return rows, np.array([k for _, k in found], dtype=float)

    def stiffness(self, state: ContactState) -> FloatArray:
        """Stiffness with the finite supports and the closed stops as springs, N/m, shape ``(n, n)``."""
        rows, k = self.springs(state)
        return np.asarray(self._of_free(self._matrices[0]) + rows.T @ (k[:, None] * rows))

    @cached_property
    def rigid_motions(self) -> FloatArray:
        """Rigid-body motions that infinite springs allow, mass-normalised, kg^-1/2, shape ``(n, 0 to 2 a beam)``.

        Those of each beam are translation, and rotation about its centre of mass: orthogonal however heavy a mass is.
        """
        count = self._left_by([row for row, k in self._springs_on_bodies if math.isinf(k)])
        if not count:
            return np.zeros((self.free.size, 0))
        full, (fixed, *groups) = self._normalised_bodies, self._groups
        rows = np.vstack([full[:0], full[fixed], *(full[group[1:]] - full[group[:1]] for group in groups)])
        size = np.linalg.norm(rows, axis=1, keepdims=True)
        directions = np.linalg.svd(rows / np.where(size > 0, size, 1.0))[2]
        motions = full[self.free] @ directions[-count:].T
        return np.asarray(motions / np.sqrt(np.sum(motions * (self.mass @ motions), axis=0)))

    def rigid_modes(self, state: ContactState) -> int:
        """Number of rigid-body modes, 0 to 2 a beam, that supports, links and closed stops leave."""
        stops = (self.problem.structure.stops[k].reading for k in state.closed)
        return self._left_by([row for row, _ in self._springs_on_bodies] + [self._on_bodies(it) for it in stops])

    def _left_by(self, rows: list[FloatArray]) -> int:
        """Number of rigid-body motions that springs leave, which read them by rows ``(2 beams,)``."""
        every = 2 * len(self.problem.line.beams)
        return every - int(np.linalg.matrix_rank(np.array(rows), tol=_HELD)) if rows else every

    @cached_property
    def _springs_on_bodies(self) -> list[tuple[FloatArray, float]]:
        """Row, ``(2 beams,)``, and stiffness of each spring of supports and links; see `_on_bodies`."""
        joint = self.problem.structure
        held: list[tuple[tuple[tuple[float, float], ...], float, float]] = [
            (((it.x, 1.0),), it.translational, it.torsional) for it in joint.supports
        ]
        held += [(((it.second, 1.0), (it.first, -1.0)), it.translational, it.torsional) for it in joint.links]
        return [
            (self._on_bodies(reading, derivative), k)
            for reading, *springs in held
            for derivative, k in enumerate(springs)
            if k > 0
        ]

    def _on_bodies(self, reading: tuple[tuple[float, float], ...], derivative: int = 0) -> FloatArray:
        """What a sum of displacements, or of slopes times lengths, reads of the motions of each beam: a translation by
        1, and a rotation about its start by 1 over its length; shape ``(2 beams,)``."""
        line, found = self.problem.line, np.zeros(2 * len(self.problem.line.beams))
        for x, factor in reading:
            i = line.beam_at(x)
            own = (0.0, 1.0) if derivative else (1.0, (x - line.starts[i]) / line.beams[i].length)
            found[2 * i : 2 * i + 2] += factor * np.array(own)
        return found

    @cached_property
    def _normalised_bodies(self) -> FloatArray:
        """Translation of each beam, and rotation about its centre of mass, mass-normalised, of all degrees of freedom,
        ``(2 nodes, 2 beams)``."""
        line, found = self.problem.line, np.zeros((2 * self.nodes.size, 2 * len(self.problem.line.beams)))
        for i, (start, end) in enumerate(zip(line.starts, line.ends, strict=True)):
            first, last = self.node(start), self.node(end) + 1
            own, M = slice(2 * first, 2 * last), self._mass_of_all[2 * first : 2 * last, 2 * first : 2 * last]
            full = np.tile([[1.0, 0.0], [0.0, 1.0]], (last - first, 1))
            full[::2, 1] = (self.nodes[first:last] - (start + end) / 2) / line.length
            total, moment = full.T @ (M @ full[:, 0])
            full[::2, 1] -= moment / total
            found[own, 2 * i : 2 * i + 2] = full / np.sqrt(np.sum(full * (M @ full), axis=0))
        return found

    def shapes(self, x: FloatArray, derivative: int) -> FloatArray:
        """Rows ``(k, n)``, 1/m^derivative, that give z or an x-derivative (0 to 3) at positions ``(k,)``, m.

        Within an element the second derivative is linear and the third constant.  At a node both are those of the
        element to the left on the beam.  On a space between beams all are 0.
        """
        return self._rows_of_free(self._shapes_of_all(x, derivative))

    def _shapes_of_all(self, x: FloatArray, derivative: int) -> FloatArray:
        """The rows of `shapes` for all degrees of freedom, ``(k, 2 nodes)``."""
        e = np.clip(np.searchsorted(self.nodes, x, side="left") - 1, 0, self.nodes.size - 2)
        e = np.where(self._empty[e] & (x == self.nodes[e + 1]), e + 1, e)
        h = np.diff(self.nodes)[e]
        s = (x - self.nodes[e]) / h
        L = self.problem.line.length
        values = _hermite(s, derivative) / h**derivative  # (4, k)
        values[1::2] *= h / L
        full = np.zeros((x.size, 2 * self.nodes.size))
        for j in range(4):
            full[np.arange(x.size), 2 * e + j] = values[j]
        full[self._empty[e]] = 0.0
        return full

    @cached_property
    def _empty(self) -> npt.NDArray[np.bool_]:
        """Whether each element is a space between beams, ``(nodes - 1,)``."""
        return np.asarray(self.problem.line.EI_at((self.nodes[:-1] + self.nodes[1:]) / 2) == 0)


def _hermite(s: FloatArray, derivative: int) -> FloatArray:
    """Derivatives of the four cubic Hermite polynomials on [0, 1], shape ``(4, k)``."""
    return np.asarray(np.polynomial.polynomial.polyval(s, _cubics(derivative)))


@cache
def _cubics(derivative: int) -> FloatArray:
    """Coefficients of 1, s, ... of derivatives of the four cubic Hermite polynomials, shape ``(4 - derivative, 4)``."""
    cubics = np.array([[1.0, 0, -3, 2], [0, 1, -2, 1], [0, 0, 3, -2], [0, 0, -1, 1]])
    return np.asarray(np.polynomial.polynomial.polyder(cubics.T, derivative))
