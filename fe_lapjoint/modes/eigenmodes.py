"""Natural frequencies and modes of the mesh in one contact state, all of them, to the last digits on both ends."""

from __future__ import annotations

from functools import lru_cache

import numpy as np
from scipy.linalg import cholesky, eigh, solve_triangular

from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import Beam, FloatArray, Problem, Stop, Support

_SOFT = 1e-3  # of EI / m L^4: if the lowest omega^2 is below this, K is nearly singular and is shifted


def eigenmodes(assembly: Assembly, state: ContactState) -> tuple[FloatArray, FloatArray]:
    """All ``n`` frequencies and modes of the mesh in a contact state.

    They depend on the beam, its springs and the mesh alone, and are kept: other gaps, dampings and excitations, and
    the states that mirror each other, share one solution, to the signs of its vectors.

    Parameters
    ----------
    assembly : Assembly
        The problem on a mesh.
    state : ContactState
        The stops that are closed.

    Returns
    -------
    FloatArray, shape (n,)
        Angular frequencies, rad/s, ascending, 0 for rigid-body modes; not to be written to.
    FloatArray, shape (n, n)
        Mass-normalised vectors over the free degrees of freedom as columns, kg^-1/2; not to be written to.
    """
    problem = assembly.problem
    springs = sorted((problem.stops[k].x, problem.stops[k].stiffness) for k in state.closed)
    return _eigenmodes(problem.beam, problem.supports, tuple(springs), tuple(assembly.nodes.tolist()))


@lru_cache(maxsize=64)
def _eigenmodes(
    beam: Beam, supports: tuple[Support, ...], springs: tuple[tuple[float, float], ...], nodes: tuple[float, ...]
) -> tuple[FloatArray, FloatArray]:
    """The modes of a beam with springs (x, k) besides its supports.

    Two dense solutions are joined, because each is poor where the other is good: the inverted problem
    M v = mu (K + sigma M) v keeps the digits of the low modes, K v = omega^2 M v those of the high ones.  sigma is
    zero unless the beam can nearly move as a rigid body.  The joined basis is orthonormalised, so that a change of
    state loses nothing, and the frequencies are Rayleigh quotients.  Rigid-body modes are counted, not detected.
    """
    stops = tuple(Stop(x=x, side="top", gap=0.0, stiffness=k) for x, k in springs)
    assembly = Assembly(Problem(beam=beam, supports=supports, stops=stops), np.array(nodes))
    state = ContactState(tuple(range(len(stops))))
    M = assembly.mass
    vectors = _orthonormal(_joined(assembly, M, assembly.stiffness(state)), M)
    square = np.sum((assembly.curvature @ vectors) ** 2, axis=0) + assembly.springs(state) @ vectors**2
    order = np.argsort(square, kind="stable")
    omega, vectors = np.sqrt(square[order]), np.ascontiguousarray(vectors[:, order])
    omega[: assembly.rigid_modes(state)] = 0.0
    omega.flags.writeable = vectors.flags.writeable = False
    return omega, vectors


def _joined(assembly: Assembly, M: FloatArray, K: FloatArray) -> FloatArray:
    """Low modes of the inverted problem beside high modes of the direct one, shape ``(n, n)``."""
    beam = assembly.problem.beam
    unit = beam.EI / (beam.m * beam.length**4)  # 1/s^2
    square, direct = eigh(K, M)
    sigma = 0.0 if square[0] > _SOFT * unit else unit
    c = 1 / np.sqrt(np.diag(K + sigma * M))
    low = c[:, None] * eigh(M * np.outer(c, c), (K + sigma * M) * np.outer(c, c))[1][:, ::-1]
    middle = np.sqrt(max(square[0] + sigma, unit) * max(square[-1], unit))
    split = int(np.count_nonzero(square < middle))
    return np.concatenate((low[:, :split], direct[:, split:]), axis=1)


def _orthonormal(V: FloatArray, M: FloatArray) -> FloatArray:
    """Gram-Schmidt in the mass inner product, first column first, by Cholesky factors, twice for full precision."""
    V = V / np.sqrt(np.sum(V * (M @ V), axis=0))
    for _ in range(2):
        V = solve_triangular(cholesky(V.T @ M @ V), V.T, trans="T").T
    return V
