r"""Modes of several beams, and the springs between them: a count of all frequencies, and the boundary matrix of all.

Springs between two beams, of links and of closed stops, are couplings: a stiffness kappa between two deflections, or
two slopes.  The count of one beam (`analytic.modes.characteristic_equation`) gives J_b(z), the frequencies below z of
each beam alone.  With the receptance R(z) of the beams alone, the differences of deflections or slopes at the couplings
under unit pairs of forces,

    J(z) = sum_b J_b(z) - neg(diag(1 / kappa) + R(z)) + number of negative kappa,

where neg counts negative eigenvalues: both sides are the inertia of one symmetric matrix, from which either the forces
of the couplings or the displacements are eliminated first (E. V. Haynsworth, Linear Algebra Appl. 1 (1968) 73).  An
infinite spring has 1 / kappa = 0.  R has poles at the frequencies of the beams alone, where both terms jump and J does
not.

R of a beam without supports grows as 1 / z^4, and would leave no digits to the bending of a beam below its first
bending frequency.  So both ends of each beam are held by springs, and couplings of the negative stiffness to the base
let them go again; the count holds for any stiffness.  Springs as stiff as the beam would leave no digits to its
inertia.  At the geometric mean of stiffness and inertia both lose the square of the distance in z from the first
bending frequency.

The matrix of all conditions is that of the beams, [g] of (15), bordered by the forces of the couplings: each force acts
on both of its nodes, and is kappa times the difference of their motions.  Its determinant has no poles.  Isolated roots
are its changes of sign, and modes its null vectors.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.linalg import eigh
from scipy.optimize import elementwise

from analytic.modes.boundary_conditions import (
    Solutions,
    boundary_band,
    force_row,
    largest_of,
    mode_solutions,
    whole,
)
from analytic.modes.characteristic_equation import IntArray, Layout, Spring, count_below
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray

_ERROR = 1e-12
"""Largest relative error that the count allows a root above the bending of the stiffest beam, some thousand rounding
errors, as of one beam; below, it allows the square of the distance times as much."""
_SLOWEST = 1e-4
"""Least root but 0, divided by beta L of the stiffest beam: there the count has eight digits left.  At 1e-5 it errs
where 24 links join two beams side by side, at 1e-6 where five do."""
_SOLID = 1e-9
"""Singular value of unit rows of displacements below which springs leave a motion of rigid beams free."""


@dataclass(frozen=True)
class _Held(Layout):
    """One beam whose ends are held by springs."""

    def hold(self, node: int, z: FloatArray) -> FloatArray:
        """Stiffness of the spring at an end, times L^3 / EI, ``(n,)``: the beam's dynamic stiffness above its first
        bending frequency; below, the geometric mean of its stiffness and its inertia."""
        span = min(node, self.spans.size - 1)
        own = self.wave[span] * z
        return np.asarray(self.stiffness[span] * own**2 * (1 / self.x[-1] + own))

    def springs(self, node: int, fourth: FloatArray) -> tuple[Spring, Spring]:
        """`Layout.springs` with the holding springs."""
        kappa, kappa_t = super().springs(node, fourth)
        if node in self.held:
            kappa = kappa + self.hold(node, fourth**0.25)
        return kappa, kappa_t

    @cached_property
    def held(self) -> tuple[int, ...]:
        """The ends that are held: those that are not fixed."""
        return tuple(node for node in (0, self.x.size - 1) if not math.isinf(self.translational[node]))


@dataclass(frozen=True)
class CoupledBeams:
    """The conditions of several beams with their couplings."""

    layout: Layout
    """All beams on one line."""

    @cached_property
    def parts(self) -> tuple[_Held, ...]:
        """Each beam alone, held."""
        it = self.layout
        return tuple(
            _Held(
                x=it.x[a : b + 1] - it.x[a],
                translational=it.translational[a : b + 1],
                torsional=it.torsional[a : b + 1],
                mass=it.mass[a : b + 1],
                rotary=it.rotary[a : b + 1],
                stiffness=it.stiffness[a:b],
                wave=it.wave[a:b],
            )
            for a, b in it.beams
        )

    @cached_property
    def stiffest(self) -> float:
        """beta L of the beam that bends fastest: 1 over its length in units of its own waves."""
        return max(1 / float(part.wave @ part.spans) for part in self.parts)

    def count_below(self, z: FloatArray) -> IntArray:
        """Number of natural frequencies, rigid-body modes included, below each trial value beta L > 0, ``(n,)``."""
        try:
            matrix = self._receptance(z)
        except np.linalg.LinAlgError:  # a trial value is a frequency of a beam alone, to the last bit
            z = z * (1 + 8 * np.finfo(float).eps * np.cos(np.arange(z.size)))
            matrix = self._receptance(z)
        count = np.zeros(z.shape, dtype=int)
        for part in self.parts:
            count = count + count_below(part, z)
        diagonal = np.einsum("nii->ni", matrix)
        # Rows are scaled to diagonals of at most 1, so that soft springs do not cover stiff ones.
        inverse = np.concatenate(
            [np.array([[1 / it.stiffness for it in self.layout.couplings]] * z.size), -self._released(z)], axis=1
        )
        scale = 1 / np.sqrt(np.maximum(np.maximum(np.abs(inverse), np.abs(diagonal)), np.finfo(float).tiny))
        matrix = matrix * scale[:, :, None] * scale[:, None, :]
        np.einsum("nii->ni", matrix)[...] += inverse * scale**2
        negative = (np.linalg.eigvalsh(matrix) < 0).sum(axis=1)
        return np.asarray(count - negative + sum(len(part.held) for part in self.parts))

    def _released(self, z: FloatArray) -> FloatArray:
        """1 over the stiffness of each holding spring, ``(n, held ends)``."""
        found = [1 / part.hold(node, z) for part in self.parts for node in part.held]
        return np.array(found).reshape(-1, z.size).T

    def _receptance(self, z: FloatArray) -> FloatArray:
        """Motions at couplings and held ends under unit forces there, of the held beams, ``(n, c, c)``."""
        every, size = self.layout.couplings, len(self.layout.couplings) + sum(len(part.held) for part in self.parts)
        found, at = np.zeros((z.size, size, size)), len(every)
        for (first, last), part in zip(self.layout.beams, self.parts, strict=True):
            ends = [(at + k, node, 0, 1.0) for k, node in enumerate(part.held)]
            at += len(ends)
            own = [
                (i, node - first, it.derivative, sign)
                for i, it in enumerate(every)
                for node, sign in ((it.first, -1.0), (it.second, 1.0))
                if first <= node <= last
            ]
            index = np.array([it[0] for it in own + ends], dtype=int)
            if index.size:
                found[:, index[:, None], index] += _receptance_of(part, z, own + ends)
        return found

    def bordered(self, solutions: Solutions) -> tuple[FloatArray, FloatArray, FloatArray]:
        """The matrix of all conditions for ``n`` functions, ``(n, m, m)``, where ``m`` is four for each span and one
        for each coupling; the forces of the couplings, EI / L^3 or EI / L, for each unit of their amplitudes, ``(n,
        couplings)``; and the factors of their rows, ``(n, couplings)``, of the difference of motions."""
        band, factors = boundary_band(self.layout, solutions)
        waves, every = band.shape[2], self.layout.couplings
        matrix = np.zeros((band.shape[0], waves + len(every), waves + len(every)))
        matrix[:, :waves, :waves] = whole(band)
        forces, balances = np.ones((2, band.shape[0], len(every)))
        for i, it in enumerate(every):
            d, column = it.derivative, waves + i
            beside = [self._side(solutions, node) for node in (it.first, it.second)]
            largest = [largest_of(values, None) for values, _ in beside]
            forces[:, i] = np.max([one[:, 3 - d] for one in largest], axis=0)
            motion = np.max([one[:, d] for one in largest], axis=0)
            balance = balances[:, i] = 1 / (motion + forces[:, i] / it.stiffness)
            for node, (values, span), sign in zip((it.first, it.second), beside, (-1.0, 1.0), strict=True):
                # On the second node acts -f, on the first one f; a row is force balance, or minus that of moments.
                row = force_row(self.layout, node) - d
                unit = forces[:, i] * factors[:, 1 if d == 0 else 3, node]
                matrix[:, row, column] += unit * (sign if d == 0 else -sign)
                matrix[:, column, 4 * span : 4 * span + 4] += sign * balance[:, None] * values[:, d]
            matrix[:, column, column] = -balance * forces[:, i] / it.stiffness
        return matrix, forces, balances

    def _side(self, solutions: Solutions, node: int) -> tuple[FloatArray, int]:
        """`at_ends` on a side of a node, ``(n, 4, 4)``, and the span there."""
        left, right = solutions.beside(self.layout, node)
        found = right if right is not None else left
        assert found is not None
        return found, node if right is not None else node - 1

    def node_forces(self, forces: FloatArray) -> FloatArray:
        """Forces and moments on the nodes, ``(n, 2, nodes)``, of forces of the couplings, ``(n, couplings)``."""
        found = np.zeros((forces.shape[0], 2, self.layout.x.size))
        for i, it in enumerate(self.layout.couplings):
            found[:, it.derivative, it.first] += forces[:, i]
            found[:, it.derivative, it.second] -= forces[:, i]
        return found

    def determinant(self, z: FloatArray) -> FloatArray:
        """The determinant of all conditions times a positive factor; it changes sign at each frequency, ``(n,)``."""
        solutions = mode_solutions(self.layout, z)
        sign, size = np.linalg.slogdet(self.bordered(solutions)[0])
        # The Wronskian of the waves of a span is negative, that of the series 1.
        waves = (~solutions.short[:, self.layout.stiffness > 0]).sum(axis=1)
        return np.asarray(sign * np.where(waves % 2 == 1, -1.0, 1.0) * np.exp(np.clip(size, -600, 600)))

    def rigid(self) -> FloatArray:
        """Motions of rigid beams that no spring opposes, orthogonal: deflection at each beam's first node, and slope
        times L, ``(motions, beams, 2)``."""
        it, rows = self.layout, []
        for node in range(it.x.size):
            rows += [self._row(node, d) for d, k in enumerate((it.translational[node], it.torsional[node])) if k > 0]
        rows += [self._row(one.second, one.derivative) - self._row(one.first, one.derivative) for one in it.couplings]
        ways = np.eye(2 * len(it.beams))
        if rows:
            _, values, right = np.linalg.svd(np.array(rows))
            ways = right[int(np.count_nonzero(values > _SOLID)) :].T
        mass = np.zeros((2 * len(it.beams), 2 * len(it.beams)))
        for node in range(it.x.size):
            for d, lumped in enumerate((it.mass[node], it.rotary[node])):
                mass += lumped * np.outer(self._row(node, d), self._row(node, d))
        for span, m in enumerate(it.span_masses):
            if it.has_span(span):
                left, right = self._row(span, 0), self._row(span + 1, 0)
                mass += (
                    m
                    * it.spans[span]
                    / 6
                    * (np.outer(left + right, left + right) + np.outer(left, left) + np.outer(right, right))
                )
        # Unequal weights of the motions choose one of the bases that are orthogonal.
        weights = ways.T @ np.diag(np.arange(1.0, ways.shape[0] + 1)) @ ways
        return np.asarray((ways @ _generalised(weights, ways.T @ mass @ ways)).T.reshape(-1, len(it.beams), 2))

    def _row(self, node: int, derivative: int) -> FloatArray:
        """Deflection, or slope times L, of a node when each beam shifts or turns, ``(2 beams,)``."""
        it, found = self.layout, np.zeros(2 * len(self.layout.beams))
        beam = next(i for i, (first, last) in enumerate(it.beams) if first <= node <= last)
        found[2 * beam : 2 * beam + 2] = (0.0, 1.0) if derivative else (1.0, it.x[node] - it.x[it.beams[beam][0]])
        return found

    def frequencies(self, count: int) -> FloatArray:
        """The `count` lowest natural frequencies as roots beta L, ascending, 0 for rigid-body modes.

        Each root is bracketed by the count, so none can be missed; the count beside each root confirms it, or
        `SolverError` is raised.
        """
        rigid = min(self.rigid().shape[0], count)
        index = np.arange(rigid, count)
        lo = np.full(index.size, _SLOWEST * self.stiffest)
        if index.size and self.count_below(lo[:1])[0] > rigid:
            raise SolverError(
                "a mode is slower than 1e-8 sqrt(EI / m) / length^2 of the stiffest beam, and rounding would hide it: "
                "supports, links or other beams are too soft, or masses too heavy, beside that beam"
            )
        waves, most = float(self.layout.wave @ self.layout.spans), count + 2 * self.layout.spans.size + 1
        hi = np.full(index.size, math.pi * (most + len(self.layout.couplings)) / waves)
        for _ in range(12):
            if np.all(lo[1:] >= hi[:-1]) and np.all(hi < 1.5 * lo):
                break
            lo, hi = self._bisect(index, lo, hi, steps=4)
        alone = np.append(lo[1:] >= hi[:-1], True) & np.append(True, lo[1:] >= hi[:-1])
        if alone.any():
            alone[alone] &= np.sign(self.determinant(lo[alone])) * np.sign(self.determinant(hi[alone])) < 0
        roots = (lo + hi) / 2
        if alone.any():
            tolerances = {"xrtol": 4e-16, "xatol": 0.0}
            roots[alone] = elementwise.find_root(self.determinant, (lo[alone], hi[alone]), tolerances=tolerances).x
        if not alone.all():
            narrow = self._bisect(index[~alone], lo[~alone], hi[~alone], steps=80)
            roots[~alone] = (narrow[0] + narrow[1]) / 2
        roots = np.sort(roots)
        error = _ERROR * np.maximum(1.0, self.stiffest / roots) ** 2
        beside = np.concatenate([roots * (1 - error), roots * (1 + error)])
        below, above = self.count_below(beside).reshape(2, -1)
        wrong = np.flatnonzero((below > index) | (above <= index))
        if wrong.size:
            raise SolverError(
                f"the count of frequencies below beta L = {roots[wrong[0]]:.6g} does not bear that root out"
            )
        return np.concatenate([np.zeros(rigid), roots])

    def _bisect(self, index: IntArray, lo: FloatArray, hi: FloatArray, steps: int) -> tuple[FloatArray, FloatArray]:
        """Halve the intervals, in z, around the roots with the numbers `index`, by the count, up to `steps` times."""
        for _ in range(steps):
            middle = np.where(hi > 2 * lo, np.sqrt(lo * hi), (lo + hi) / 2)
            if np.all((middle <= lo) | (middle >= hi)):
                break
            above = self.count_below(middle) > index
            lo, hi = np.where(above, lo, middle), np.where(above, middle, hi)
        return lo, hi


def _generalised(stiffness: FloatArray, mass: FloatArray) -> FloatArray:
    """Eigenvectors, as columns, that are orthonormal in the mass product."""
    return np.asarray(eigh(stiffness, mass)[1]) if mass.size else np.zeros((0, 0))


def _receptance_of(part: _Held, z: FloatArray, places: list[tuple[int, int, int, float]]) -> FloatArray:
    """Motions at places under unit forces there, ``(n, p, p)``; a place is an index, a node, a derivative, a sign.

    Of the two motions that are equal, that under the force at the stiffer place is taken: a heavy mass hardly moves.
    """
    solutions = mode_solutions(part, z)
    band, factors = boundary_band(part, solutions)
    loads, reading = np.zeros((z.size, band.shape[2], len(places))), np.zeros((z.size, len(places), band.shape[2]))
    for i, (_, node, d, sign) in enumerate(places):
        # V(+) - V(-) + k phi = force, and M(+) - M(-) - kt theta = -moment
        loads[:, force_row(part, node) - d, i] = sign * (factors[:, 1, node] if d == 0 else -factors[:, 3, node])
        left, right = solutions.beside(part, node)
        values, span = (right, node) if right is not None else (left, node - 1)
        assert values is not None
        reading[:, i, 4 * span : 4 * span + 4] = sign * values[:, d]
    found = reading @ np.linalg.solve(whole(band), loads)
    own = np.abs(np.einsum("nii->ni", found))
    return np.asarray(np.where(own[:, None, :] <= own[:, :, None], found, found.transpose(0, 2, 1)))
