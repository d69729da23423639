"""All natural frequencies and modes of the mesh in one contact state; the lowest and the highest keep their last
digits."""

from __future__ import annotations

from dataclasses import replace
from functools import lru_cache

import numpy as np
from scipy.linalg import LinAlgError, cholesky, eigh, solve_triangular

from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, Line, PlacedStop
from lapjoint.problem.problem import resting
from lapjoint.problem.structure import Structure

_SOFT = 0.1
"""Largest stiffness against a rigid-body motion that springs hold softly, for a displacement of 1 in root mean square
along the beams, in units of EI / L^3 with the mean EI, and largest omega^2 of it, in units of EI / m L^4; of several
beams the least unit counts."""
_APART, _MIXED = 1e-6, 1e-3
"""Least relative distance of two omega^2, and largest part of one mode in another, at which first order is enough."""
_ROUNDS = 4
"""Iterations for a soft mode; each multiplies its error by (omega^2 / omega^2 of bending)^2, at most 1e-4."""


def eigenmodes(assembly: Assembly, state: ContactState) -> tuple[FloatArray, FloatArray]:
    """All angular frequencies, rad/s, ascending, ``(n,)``, and mass-normalised modes, kg^-1/2, as columns, ``(n, n)``.

    Rigid-body modes have frequency 0.  Both arrays are read-only.  They depend on the beam, its masses, its springs and
    the mesh alone, and are cached: problems with other gaps, damping or excitation share one solution.  Contact states
    whose closed stops have equal positions and stiffnesses, on either side of the beam, share it too.
    """
    return _eigenmodes(*assembly.without_stops, springs_of(assembly, state))


def weighted(assembly: Assembly, state: ContactState) -> FloatArray:
    """M Phi of a contact state, kg^1/2, ``(n, n)``, one column a mode, read-only; cached like the modes."""
    return _weighted(*assembly.without_stops, springs_of(assembly, state))


def transfer(assembly: Assembly, old: ContactState, new: ContactState) -> FloatArray:
    """The orthogonal matrix Phi_new^T M Phi_old, ``(n, n)``, read-only; cached like the modes."""
    return transfer_between(*assembly.without_stops, springs_of(assembly, old), springs_of(assembly, new))


Springs = tuple[tuple[tuple[tuple[float, float], ...], float], ...]
"""Closed stops: what the gap of each sees, see `PlacedStop.reading`, and the stiffness, N/m; ascending."""


def _assembled(joint: Structure, nodes: tuple[float, ...], springs: Springs = ()) -> Assembly:
    """A joint on a mesh, with a stop for each spring besides its supports."""
    stops = tuple(PlacedStop(1, reading, 0.0, 0.0, k, 0.0, False, "", "top") for reading, k in springs)
    return Assembly(resting(replace(joint, stops=stops)), np.array(nodes))


def springs_of(assembly: Assembly, state: ContactState) -> Springs:
    """The closed stops of a state, as caches are keyed by them."""
    stops = assembly.problem.structure.stops
    return tuple(sorted((stops[k].reading, stops[k].stiffness) for k in state.closed))


@lru_cache(maxsize=64)
def _weighted(joint: Structure, nodes: tuple[float, ...], springs: Springs) -> FloatArray:
    found = np.asarray(_assembled(joint, nodes).mass @ _eigenmodes(joint, nodes, springs)[1])
    found.flags.writeable = False
    return found


@lru_cache(maxsize=128)
def transfer_between(joint: Structure, nodes: tuple[float, ...], old: Springs, new: Springs) -> FloatArray:
    """`transfer` by all that it depends on."""
    found = _eigenmodes(joint, nodes, new)[1].T @ _weighted(joint, nodes, old)
    found.flags.writeable = False
    return found


@lru_cache(maxsize=64)
def _eigenmodes(joint: Structure, nodes: tuple[float, ...], springs: Springs) -> tuple[FloatArray, FloatArray]:
    """The modes of a beam with springs (x, k) besides its supports.

    Two dense solutions are joined, because each is accurate where the other is not.  The inverted problem M v = mu (K +
    sigma M) v keeps the digits of the low modes, K v = omega^2 M v keeps the digits of the high modes.  Where the beam
    can move as a rigid body, or is held by soft springs alone, `_soft` gives these modes.  The basis is
    orthonormalised, soft modes first, so that a change of state loses nothing, and the frequencies are Rayleigh
    quotients.  The number of rigid-body modes follows from the supports, not from the size of frequencies.
    """
    assembly = _assembled(joint, nodes, springs)
    state = ContactState(tuple(range(len(springs))))
    M, (rows, k) = assembly.mass, assembly.springs(state)
    rigid = _softly_held(assembly, rows, k)
    r = rigid.shape[1]
    joined = _without(rigid, _joined(assembly, M, assembly.stiffness(state)), M)
    vectors = _orthonormal(np.concatenate([rigid, joined], axis=1), M)
    vectors = _orthonormal(_unmixed(assembly, rows, k, vectors, r), M)
    square = _rayleigh(assembly, rows, k, vectors)
    if r:
        square[:r], vectors[:, :r] = _soft(assembly, rows, k, vectors, square, r)
        vectors = _orthonormal(vectors, M)
        square[r:] = _rayleigh(assembly, rows, k, vectors[:, r:])
    order = np.argsort(square, kind="stable")
    omega, vectors = np.sqrt(square[order]), np.ascontiguousarray(vectors[:, order])
    omega[: assembly.rigid_modes(state)] = 0.0
    omega.flags.writeable = vectors.flags.writeable = False
    return omega, vectors


def _unmixed(assembly: Assembly, rows: FloatArray, k: FloatArray, vectors: FloatArray, r: int) -> FloatArray:
    """Modes without the part of other modes that rounding of the stiffness has mixed in; the `r` soft modes stay.

    Curvatures lose digits as h^-2 where the stiffness loses them as h^-4.  With 464 elements of a cantilever, other
    modes make up 1e-7 of the first mode before this correction, and 1e-11 after it.  With g_i the curvatures and spring
    forces of mode i, the mixed part of mode j is (g_i . g_j) / (omega_i^2 - omega_j^2), to first order.
    """
    g = np.vstack([assembly.curvature @ vectors, np.sqrt(k)[:, None] * (rows @ vectors)])
    products = g.T @ g
    square = np.diag(products)
    apart = square[None, :] - square[:, None]
    told = np.abs(apart) > _APART * np.maximum(square[None, :], square[:, None])
    mixed = np.where(told, products, 0.0) / np.where(told, apart, 1.0)
    mixed[:, :r] = mixed[:r] = 0.0
    mixed[np.abs(mixed) > _MIXED] = 0.0
    return np.asarray(vectors + vectors @ mixed)


def _rayleigh(assembly: Assembly, rows: FloatArray, k: FloatArray, vectors: FloatArray) -> FloatArray:
    """Twice the energy of mass-normalised vectors as columns, from curvatures and springs: omega^2, 1/s2."""
    return np.asarray(np.sum((assembly.curvature @ vectors) ** 2, axis=0) + k @ (rows @ vectors) ** 2)


def _softly_held(assembly: Assembly, rows: FloatArray, k: FloatArray) -> FloatArray:
    """Rigid-body motions that springs hold softly or not at all, mass-normalised as columns, ``(n, 0 to 2)``."""
    line, rigid = assembly.problem.line, assembly.rigid_motions
    count = rigid.shape[1]
    held = np.vstack([np.sqrt(k)[:, None] * (rows @ rigid), np.zeros((count, count))])
    _, size, directions = np.linalg.svd(held)
    motions = rigid @ directions.T
    starts, ends = (assembly.shapes(np.array(x), 0) @ motions for x in (line.starts, line.ends))
    square = np.sum(starts**2 + starts * ends + ends**2, axis=0) / 3  # mean along each beam
    unit = min(beam.EI / beam.length**3 for beam in line.beams)
    return np.asarray(motions[:, (size**2 < _SOFT * unit * square) & (size**2 < _SOFT * _slowest_bending(line))])


def _slowest_bending(line: Line) -> float:
    """EI / m L^4 of the beam that bends most slowly, 1/s2."""
    return min(beam.EI / (beam.m * beam.length**4) for beam in line.beams)


def _without(motions: FloatArray, modes: FloatArray, M: FloatArray) -> FloatArray:
    """Modes without as many of them as there are motions, those most like the motions, as columns.

    A heavy mass may make a bending mode slower than a rigid-body motion on soft springs.
    """
    alike = np.sum((motions.T @ M @ modes) ** 2, axis=0) / np.sum(modes * (M @ modes), axis=0)
    kept = np.argsort(alike, kind="stable")[: alike.size - motions.shape[1]]
    return modes[:, np.sort(kept)]


def _soft(
    assembly: Assembly, rows: FloatArray, k: FloatArray, V: FloatArray, square: FloatArray, r: int
) -> tuple[FloatArray, FloatArray]:
    """omega^2 and vectors of the `r` soft modes: rigid-body motions, and the bending that their springs' forces cause.

    A rigid-body motion has no curvature, and none is computed, so that rounding of the beam's stiffness is not taken
    for the stiffness of a soft spring.  The amount of another mode in a soft mode is the spring force on the other
    mode, divided by (omega^2 - omega_other^2).
    """
    rigid, bending, felt = V[:, :r], V[:, r:], rows @ V
    coupling = felt[:, r:].T @ (k[:, None] * felt[:, :r])
    found, turn = np.zeros(r), np.eye(r)
    for _ in range(_ROUNDS):
        bent = -(coupling @ turn) / (square[r:, None] - found)
        curvature = assembly.curvature @ (bending @ bent)
        forces = np.sqrt(k)[:, None] * (felt[:, :r] @ turn + felt[:, r:] @ bent)
        factor = cholesky(turn.T @ turn + bent.T @ bent)
        strained = solve_triangular(factor, np.vstack([curvature, forces]).T, trans="T").T
        directions = np.linalg.svd(strained)[2][::-1]  # of the strains, not their squares: a softer spring keeps digits
        rotation = solve_triangular(factor, directions.T)
        turn, bent = turn @ rotation, bent @ rotation
        found = np.sum((curvature @ rotation) ** 2, axis=0) + np.sum((forces @ rotation) ** 2, axis=0)
    return found, rigid @ turn + bending @ bent


def _joined(assembly: Assembly, M: FloatArray, K: FloatArray) -> FloatArray:
    """Low modes of the inverted problem beside high modes of the direct one, shape ``(n, n)``.

    A mode far slower than the beam's bending would take the digits of the next modes in the inverted problem, so the
    problem is shifted then: a soft spring or a heavy mass makes such modes.
    """
    unit = _slowest_bending(assembly.problem.line)
    square, direct = eigh(K, M)
    sigma = unit if square[0] < unit else 0.0
    c = 1 / np.sqrt(np.diag(K + sigma * M))
    try:
        low = c[:, None] * eigh(M * np.outer(c, c), (K + sigma * M) * np.outer(c, c))[1][:, ::-1]
    except LinAlgError:
        raise _singular(assembly) from None
    middle = np.sqrt(max(square[0] + sigma, unit) * max(square[-1], unit))
    split = int(np.count_nonzero(square < middle))
    return np.concatenate((low[:, :split], direct[:, split:]), axis=1)


def _orthonormal(V: FloatArray, M: FloatArray) -> FloatArray:
    """Gram-Schmidt in the mass inner product, first column first, by Cholesky factors, twice for full precision."""
    V = V / np.sqrt(np.sum(V * (M @ V), axis=0))
    for _ in range(2):
        V = solve_triangular(cholesky(V.T @ M @ V), V.T, trans="T").T
    return V


def _singular(assembly: Assembly) -> SolverError:
    """What is wrong with a mesh whose stiffness is singular to rounding, and what to change."""
    h, EI = assembly.element_lengths, [piece.EI for piece in assembly.problem.line.pieces]
    return SolverError(
        f"the stiffness of the mesh is singular to rounding: its elements are {h.min():.3g} to {h.max():.3g} m long, "
        f"and EI changes by a factor of {max(EI) / min(EI):.3g}; take fewer elements, or nodes farther "
        "apart"
    )
