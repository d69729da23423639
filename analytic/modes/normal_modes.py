r"""Mass-normalised modes (16)-(17) of any contact state, with exact shapes, and a sign that neighbours share.

A mode is found up to its sign.  The sign is chosen so that it changes continuously with the problem where that can be,
because a section point of one problem is reused, as modal coordinates, in its neighbours: at the tip

    phi + phi''' / beta^3 > 0,

and rigid-body modes move the tip upwards, or the beam where the tip does not move.  A spring k at the tip, of a support
or a stop, makes EI phi''' = k phi, so the two parts have one sign and cancel for no k from 0 to infinity.  Where no
spring acts between the ends of a uniform beam the sum cannot vanish: with phi = phi''' = 0 at the tip, the solution of
(8) that goes on from there has all derivatives of one sign, and meets no condition at the root.  Nor can it where the
nearest spring is many wavelengths from the tip, whatever that spring is.  What remains are single stiffnesses at which,
with a spring or a mass between the ends, a step, or a rotary inertia at the tip, the sum of a low mode passes 0, and
crossings of two frequencies.

A mass M at the tip makes EI phi''' = (k - omega^2 M) phi.  Where that is negative, phi''' is taken with the other sign:
the two parts have one sign again, and the rule is continuous for every mass.  The limits of an infinite spring and of
an infinite mass, whose shapes are the same, then differ in sign.

Of several beams, the last one decides whose sum phi + phi''' / beta^3 at the tip, with its own beta, is at least a
thousandth of the largest among the beams; a rigid-body mode has phi alone.

No rule is continuous everywhere.  A beam on two pins with a spring k amid has its first two frequencies equal at
k = 4 (2 pi)^3 coth(pi) EI / L^3.  On a closed path around that point, by way of k and the spring's place, the
frequencies stay apart, so each shape can be followed from start to end: it comes back with the other sign, as real
modes do around any such crossing (M. V. Berry, Proc. R. Soc. A 392 (1984) 45).  A comparison of modal coordinates
across problems has to allow for that; a motion does not depend on the signs.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import lru_cache

import numpy as np
from scipy.linalg import eigh, solve_banded

from analytic.modes.beam_functions import TERMS, BeamFunctions, Inertia, gram, inertia_of, squares
from analytic.modes.boundary_conditions import BAND, boundary_band, mode_solutions, whole
from analytic.modes.characteristic_equation import Coupling, Layout, frequencies, layout_of
from analytic.modes.coupled_beams import CoupledBeams
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, Line, Problem
from lapjoint.problem.masses import Mass

_POOL = 40  # least number of modes computed at once
FEW_SPANS = 6  # most spans for which all modes are solved at once, by dense matrices; beyond, one by one, by bands
_TWIN = 1e-12  # relative distance of roots below which rounding makes them one root to the boundary matrix
_NEIGHBOURS = 1e-5  # relative distance of roots of several beams below which a null vector is a singular vector
_SHARED = 1e-12
"""Singular value, divided by the largest, of a null vector: a root itself is known to a hundredth of it.  A root below
that of the stiffest beam alone is known less well, by the square of their ratio."""
_STILL = 1e-9  # displacement of the tip, as a fraction of the bar's, below which the bar turns about its tip
_TAKES_PART = 1e-3  # least part of a beam in a mode, as a fraction of the largest, with which it decides the sign
_BESIDE = 1e-12  # distance of a mass beyond a beam's end, as a fraction of the line, that is rounding
_LEFT = 1e-8  # largest residual of a condition at a support, for unit amplitudes: half of the digits
_APART = 1e-3  # least eigenvalue allowed of the inner products of unit shapes, 1 if orthogonal, 0 if one is lost
_CLUSTER = 1e-3
"""Relative distance of roots below which shapes are made orthogonal: rounding, 1e-16, has mixed them by more than
1e-13, 1e-16 over the distance."""


@dataclass(frozen=True, eq=False)
class NormalModes:
    """Frequencies and shapes of one state: rigid-body modes first, then the elastic ones."""

    omega: FloatArray
    """Natural angular frequencies, rad/s, shape ``(modes,)``."""
    shapes: BeamFunctions
    """Mass-normalised shapes, kg^-1/2."""

    def head(self, count: int) -> NormalModes:
        """The `count` lowest modes."""
        return NormalModes(self.omega[:count], self.shapes.head(count))


def exact_modes(problem: Problem, state: ContactState, count: int) -> NormalModes:
    """The `count` lowest modes of a contact state.

    The last modes computed are kept, because a sweep of the excitation, on which they do not depend, asks for them at
    every point.
    """
    layout = layout_of(problem, state.closed)
    *arrays, _ = fields(layout)
    parts = tuple(tuple(getattr(layout, field.name).tolist()) for field in arrays)
    return _exact_modes(problem.line, problem.structure.masses, parts, layout.couplings, pool_size(count)).head(count)


def pool_size(count: int) -> int:
    """Number of modes to compute, 40, 80, 160, ..., where `count` are asked for: several counts then share the work."""
    size = _POOL
    while size < count:
        size *= 2
    return size


@lru_cache(maxsize=64)
def _exact_modes(
    beam: Line,
    masses: tuple[Mass, ...],
    parts: tuple[tuple[float, ...], ...],
    couplings: tuple[Coupling, ...],
    count: int,
) -> NormalModes:
    """The modes of beams with masses; `parts` are the arrays of their layout, and `couplings` its couplings."""
    x, translational, torsional, mass, rotary, stiffness, wave = map(np.array, parts)
    layout = Layout(x, translational, torsional, mass, rotary, stiffness, wave, couplings)
    L, inertia = beam.length, inertia_of(beam, masses)
    coupled = CoupledBeams(layout) if layout.several else None
    z = frequencies(layout, count) if coupled is None else coupled.frequencies(count)
    rigid = int(np.count_nonzero(z == 0))
    if coupled is None:
        motions, elastic = _rigid_shapes(layout, rigid)[:, None], elastic_shapes(layout, z[rigid:], L)
    else:
        motions, elastic = coupled.rigid()[:rigid], coupled_shapes(coupled, z[rigid:], L)
    shapes = _joined(layout, motions, elastic, inertia.x)
    shapes = shapes.scaled(1 / np.sqrt(squares(shapes, inertia)))  # (16), (17)
    if coupled is not None and rigid:
        shapes = _clear_of_rigid(shapes, rigid, inertia)
    shapes = _orthogonal_clusters(shapes, z, inertia)
    shapes = shapes.scaled(np.where(_at_tip(shapes, layout, z) < 0, -1.0, 1.0))
    return NormalModes((z / L) ** 2 * np.sqrt(beam.EI / beam.m), shapes)  # (10)


def _at_tip(shapes: BeamFunctions, layout: Layout, z: FloatArray) -> FloatArray:
    """phi + phi''' / beta^3 at the tip of each mode, see the module's head, or 1 of a rigid-body mode; ``(modes,)``."""
    if layout.several:
        return _at_tips(shapes, layout, z)
    tip, elastic, L = shapes.nodes[-1:], z > 0, shapes.nodes[-1]
    kappa, _ = layout.springs(layout.x.size - 1, z**4)
    shear = shapes(tip, 3)[:, 0] * (L / np.where(elastic, z, 1.0)) ** 3
    return np.where(elastic, shapes(tip)[:, 0] + np.where(kappa < 0, -shear, shear), 1.0)


def _at_tips(shapes: BeamFunctions, layout: Layout, z: FloatArray) -> FloatArray:
    """phi + phi''' / beta^3 at the tip of the last beam that takes part in each mode, ``(modes,)``."""
    found, elastic, L = np.zeros((len(layout.beams), z.size)), z > 0, shapes.nodes[-1]
    for i, (_, last) in enumerate(layout.beams):
        tip, own = shapes.nodes[last : last + 1], np.where(elastic, z, 1.0) * float(layout.wave[last - 1])
        kappa, _ = layout.springs(last, z**4)
        shear = np.where(elastic, shapes(tip, 3)[:, 0] * (L / own) ** 3, 0.0)
        found[i] = shapes(tip)[:, 0] + np.where(kappa < 0, -shear, shear)
    takes_part = np.abs(found) > _TAKES_PART * np.abs(found).max(axis=0)
    deciding = len(layout.beams) - 1 - np.argmax(takes_part[::-1], axis=0)
    return np.asarray(found[deciding, np.arange(z.size)])


def coupled_shapes(coupled: CoupledBeams, z: FloatArray, L: float) -> BeamFunctions:
    """The shapes of the roots z = beta L of several beams, not normalised: null vectors of the matrix of all."""
    layout, solutions = coupled.layout, mode_solutions(coupled.layout, z)
    waves = 4 * layout.spans.size
    matrix, forces, _ = coupled.bordered(solutions)
    found = null_vectors(matrix) if z.size else np.zeros((0, matrix.shape[2]))
    close = np.flatnonzero(np.diff(z) < _NEIGHBOURS * z[1:])
    member = 0
    for first in np.union1d(close, close + 1).tolist():
        # A root whose matrix has several null vectors, to rounding, shares them with the roots after it.
        if first >= member:
            _, values, vectors = np.linalg.svd(matrix[first])
            null = _SHARED * max(1.0, coupled.stiffest / z[first]) ** 2 * values[0]
            shared = max(1, int(np.count_nonzero(values < null)))
            member = min(first + shared, z.size)
            found[first:member] = vectors[-shared:][: member - first]
    left = np.abs(np.einsum("nij,nj->ni", matrix, found)).max(axis=1, initial=0.0)
    wrong = np.flatnonzero(~(left <= _LEFT))
    if wrong.size:
        raise SolverError(f"no shape at beta L = {z[wrong[0]]:.6g} meets the conditions at all supports and links")
    at_nodes = coupled.node_forces(found[:, waves:] * forces)
    return solutions.functions(layout, found[:, :waves].reshape(z.size, -1, 4), L, free=True, forces=at_nodes)


def elastic_shapes(layout: Layout, z: FloatArray, L: float, few_spans: int = FEW_SPANS) -> BeamFunctions:
    """The shapes of the roots z = beta L, not normalised: null vectors of the boundary matrix."""
    solutions, spans = mode_solutions(layout, z), layout.spans.size
    amplitudes = np.zeros((z.size, 4 * spans))
    if z.size:
        bands, _ = boundary_band(layout, solutions)
        if spans <= few_spans:
            amplitudes = null_vectors(whole(bands))
        # Roots that coincide to rounding share a null space with one dimension for each root: take one vector each.
        for members in np.split(np.arange(z.size), np.flatnonzero(np.diff(z) > _TWIN * z[1:]) + 1):
            if spans > few_spans or members.size > 1:
                amplitudes[members] = null_space_of_band(bands[members[members.size // 2]], members.size)
        _refuse_what_meets_no_conditions(bands, amplitudes, z)
    return solutions.functions(layout, amplitudes.reshape(z.size, spans, 4), L, free=True)


def _refuse_what_meets_no_conditions(bands: FloatArray, amplitudes: FloatArray, z: FloatArray) -> None:
    """Raise `SolverError` where amplitudes of unit length, ``(n, m)``, leave more of (13a)-(13h) than `_LEFT`."""
    m = amplitudes.shape[1]
    left = np.zeros_like(amplitudes)
    for offset in range(-BAND, BAND + 1):
        columns = np.arange(max(0, -offset), min(m, m - offset))
        left[:, columns + offset] += bands[:, BAND + offset, columns] * amplitudes[:, columns]
    wrong = np.flatnonzero(~(np.abs(left).max(axis=1) <= _LEFT))
    if wrong.size:
        raise SolverError(f"no shape at beta L = {z[wrong[0]]:.6g} meets the conditions at all supports")


def null_vectors(matrix: FloatArray) -> FloatArray:
    """The null vector of each of ``n`` matrices that are singular to rounding, ``(n, m, m)``; gives ``(n, m)``."""
    m = matrix.shape[1]
    start = np.broadcast_to(np.cos(np.arange(m))[:, None], (*matrix.shape[:2], 1))
    # A matrix that is singular to the last bit cannot be solved with; another, equal to rounding, can.
    for wobble in (0.0, 8 * np.finfo(float).eps, 64 * np.finfo(float).eps):
        near = matrix * (1 + wobble * np.cos(np.arange(m * m).reshape(m, m))) if wobble else matrix
        try:
            # (A' A)^-1 of any vector: inverse iteration, and one step is enough, as the ratio of the two least singular
            # values enters squared: it is 1e-16 to 1e-7 where there are no twins.
            left = _of_size_one(np.asarray(np.linalg.solve(near.transpose(0, 2, 1), start), dtype=float), 1)
            found = _of_size_one(np.asarray(np.linalg.solve(near, left), dtype=float)[:, :, 0], 1)
        except np.linalg.LinAlgError:
            continue
        return np.asarray(found / np.sqrt((found**2).sum(axis=1, keepdims=True)))
    return np.asarray(np.linalg.svd(matrix)[2][:, -1])


def _of_size_one(found: FloatArray, axis: int) -> FloatArray:
    """Solutions scaled to a largest element of 1 along an axis; `LinAlgError` where a solution overflows.

    A matrix that is singular to the last bit may have a pivot of any size, and squares of its solutions overflow.
    """
    if not np.isfinite(found).all():
        raise np.linalg.LinAlgError("the solution overflows")
    return np.asarray(found / np.abs(found).max(axis=axis, keepdims=True), dtype=float)


def null_space_of_band(band: FloatArray, count: int) -> FloatArray:
    """Orthonormal null vectors of one matrix given by its diagonals, ``(2 BAND + 1, m)``, shape ``(count, m)``; the
    time is proportional to m."""
    m = band.shape[1]
    transposed = np.zeros_like(band)
    for offset in range(-BAND, BAND + 1):
        columns = np.arange(max(0, -offset), min(m, m - offset))
        transposed[BAND - offset, columns + offset] = band[BAND + offset, columns]
    start, wave = np.cos(np.outer(np.arange(m), np.arange(1, count + 1))), np.cos(np.arange(band.size))
    for wobble in (0.0, 8 * np.finfo(float).eps, 64 * np.finfo(float).eps):
        near = 1 + wobble * wave.reshape(band.shape)
        try:
            left = np.linalg.qr(_of_size_one(solve_banded((BAND, BAND), transposed * near, start), 0))[0]
            return np.asarray(np.linalg.qr(_of_size_one(solve_banded((BAND, BAND), band * near, left), 0))[0].T)
        except np.linalg.LinAlgError:
            continue
    return np.asarray(np.linalg.svd(whole(band[None])[0])[2][-count:])


def _rigid_shapes(layout: Layout, count: int) -> FloatArray:
    """The `count` motions of a rigid bar that no spring opposes, orthogonal: deflection at x = 0, and slope times L,
    ``(count, 2)``."""
    ways = _free_ways(layout)
    spring, mass = np.zeros((2, 2)), np.zeros((2, 2))
    for x, k, kt in zip(layout.x, layout.translational, layout.torsional, strict=True):
        spring += (k if math.isfinite(k) else 0.0) * np.outer([1.0, x], [1.0, x])
        spring[1, 1] += kt if math.isfinite(kt) else 0.0
    for x, lumped, rotary in zip(layout.x, layout.mass, layout.rotary, strict=True):
        mass += lumped * np.outer([1.0, x], [1.0, x])
        mass[1, 1] += rotary
    for x0, x1, m in zip(layout.x[:-1], layout.x[1:], layout.span_masses, strict=True):
        middle = (x0 + x1) / 2
        mass += m * (x1 - x0) * np.outer([1.0, middle], [1.0, middle])
        mass[1, 1] += m * (x1 - x0) ** 3 / 12
    # Of springs of very different stiffness, the softer mode is where the stiffer ones do not move, to rounding.
    stiffest = float(spring.max(initial=0.0)) or 1.0
    _, found = eigh(ways.T @ (spring / stiffest) @ ways, ways.T @ mass @ ways)
    moved = (ways @ found).T[:count]
    tip = moved.sum(axis=1)
    up = np.where(np.abs(tip) > _STILL * np.abs(moved).sum(axis=1), tip, moved @ [1, 1 / 2])
    return np.asarray(np.where(up < 0, -1.0, 1.0)[:, None] * moved)


def _free_ways(layout: Layout) -> FloatArray:
    """The motions 1, x / L of a rigid bar, or their sum, that fixed supports allow, as columns, shape ``(2, ways)``."""
    pins = layout.x[np.isinf(layout.translational)]
    held = np.isinf(layout.torsional).any()
    if pins.size > 1 or (pins.size and held):
        return np.zeros((2, 0))
    if pins.size:
        return np.array([[-pins[0]], [1.0]])
    return np.array([[1.0], [0.0]]) if held else np.array([[1.0, -1.0], [0.0, 2.0]])


def _joined(layout: Layout, rigid: FloatArray, elastic: BeamFunctions, masses: FloatArray) -> BeamFunctions:
    """Rigid-body modes, as deflection at each beam's first node and slope times L, ``(rigid, beams, 2)``, and elastic
    ones after them, as one family; `masses` are the positions of lumped masses, m, ``(K,)``."""
    L = elastic.nodes[-1]
    none = np.zeros((rigid.shape[0], *elastic.mu.shape[1:]))
    p = np.zeros((rigid.shape[0], elastic.nodes.size - 1, TERMS))
    at_masses = np.zeros((rigid.shape[0], 2, masses.size))
    for i, (first, last) in enumerate(layout.beams):
        start, end, own = elastic.nodes[first], elastic.nodes[last], rigid[:, i]
        p[:, first:last, 0] = own[:, :1] + own[:, 1:] * (elastic.nodes[first:last] - start) / L
        p[:, first:last, 1] = own[:, 1:]
        on = (masses >= start - _BESIDE * L) & (masses <= end + _BESIDE * L)
        at = (masses[on] - start) / L
        at_masses[:, :, on] = np.stack([own[:, :1] + own[:, 1:] * at, own[:, 1:] / L + 0 * at], axis=1)
    return BeamFunctions(
        elastic.nodes,
        np.concatenate([none, elastic.mu]),
        elastic.right,
        np.concatenate([none, elastic.c]),
        np.concatenate([p, elastic.p]),
        np.concatenate([at_masses, elastic.at_masses]),
        elastic.spaces,
    )


def _clear_of_rigid(shapes: BeamFunctions, rigid: int, inertia: Inertia) -> BeamFunctions:
    """Take the first `rigid` shapes, rigid-body modes, out of slow elastic ones, which have no exponentials.

    Rounding has mixed 1e-16 over the square of a slow frequency of them into those.
    """
    slow = rigid + np.flatnonzero(~shapes.c[rigid:].any(axis=(1, 2)))
    if not slow.size:
        return shapes
    c, p, at_masses = shapes.c, shapes.p.copy(), shapes.at_masses.copy()
    content = gram(shapes.chosen(slow), shapes.head(rigid), inertia)
    p[slow] -= np.einsum("ij,jst->ist", content, p[:rigid])
    at_masses[slow] -= np.einsum("ij,jdk->idk", content, at_masses[:rigid])
    return BeamFunctions(shapes.nodes, shapes.mu, shapes.right, c, p, at_masses, shapes.spaces)


def _orthogonal_clusters(shapes: BeamFunctions, z: FloatArray, inertia: Inertia) -> BeamFunctions:
    """Make the shapes of nearly coincident frequencies orthogonal, moving each as little as possible (Lowdin)."""
    close = np.flatnonzero(np.diff(z) < _CLUSTER * z[1:])
    if not close.size:
        return shapes
    c, p, at_masses = shapes.c.copy(), shapes.p.copy(), shapes.at_masses.copy()
    for cluster in np.split(close, np.flatnonzero(np.diff(close) > 1) + 1):
        members = np.arange(cluster[0], cluster[-1] + 2)
        one = shapes.chosen(members)
        values, vectors = np.linalg.eigh(gram(one, one, inertia))
        if values[0] < _APART:
            raise SolverError(f"the shapes of modes {members[0] + 1} to {members[-1] + 1} cannot be told apart")
        # A shape takes from another, at a distance d, the fraction 1e-16 / d, with its own exponents for the other's:
        # that changes it by d times as much, which is rounding.
        mixed = one.mixed(vectors @ np.diag(values**-0.5) @ vectors.T)
        c[members], p[members], at_masses[members] = mixed.c, mixed.p, mixed.at_masses
    return BeamFunctions(shapes.nodes, shapes.mu, shapes.right, c, p, at_masses, shapes.spaces)
