"""The free motions of a state whose modes are coupled, as exponentials.

The matrix of (omega q, q') of q'' + D q' + omega^2 q = 0 has its own eigenvalues r and eigenvectors, and a motion is
the real part of a sum of c exp(r s), with one term for each pair of complex eigenvalues and one for each real one.
Rigid-body modes are in no force; their displacement, an integral of their velocity, has a constant or a linear part
beside the exponentials.  Rates are known to the rounding error of the fastest one, so that a motion of the slowest mode
keeps eps times the ratio of the highest and lowest frequency: 1e-9 where stops stand 1 mm apart on a beam of 1 m.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
import scipy.linalg

from fe_lapjoint.march.system import ComplexArray
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray

_STILL = 1e-12
"""Damping of a rigid-body motion, relative to the largest of such motions, below which it is rounding: the motion then
has none."""
_APART = float(np.finfo(float).eps) ** (2 / 3)
"""Relative change of the coupling damping that parts two eigenvalues by its square root, 4e-11; doubled until it does.
What is left of rounding, times the condition number of the eigenvectors, is then as small as the change."""
_SKEW = _APART**-0.5
"""Condition number of the eigenvectors from which on two of them nearly coincide."""
_ATTEMPTS = 8
_KEPT = 256  # states whose free motions are kept, each of half a megabyte with 40 elements


@dataclass(frozen=True, eq=False)
class Exponentials:
    """The free motions of a state with ``n`` modes as ``T`` terms c exp(r s), of which the real part counts."""

    rates: ComplexArray
    """Rates r, 1/s, shape ``(T,)``; of a coupled state the slowest decay comes first."""
    modes: ComplexArray
    """Modal displacements of each term of unit amplitude, kg^1/2 m, shape ``(n, T)``."""
    speeds: ComplexArray
    """Modal velocities of each term of unit amplitude, kg^1/2 m/s, shape ``(n, T)``."""
    back: ComplexArray
    """Amplitudes c for units of (q, q') at the start, shape ``(T, 2 n)``."""
    rest: FloatArray | None
    """Displacement and speed of rigid-body modes beside the terms for units of (q, q'), shape ``(2, n, 2 n)``; None
    without such modes."""

    @cached_property
    def real_motion(self) -> FloatArray:
        """(q, q') for units of the real and of the imaginary part of each amplitude, in turn, shape ``(2 T, 2 n)``:
        half the work of products of complex matrices."""
        motion = np.concatenate([self.modes, self.modes * self.rates]).T
        return np.stack([motion.real, -motion.imag], axis=1).reshape(-1, motion.shape[1])

    @cached_property
    def real_back(self) -> FloatArray:
        """Real and imaginary part of each amplitude, in turn, for units of (q, q'), shape ``(2 n, 2 T)``."""
        return np.ascontiguousarray(self.back.T).view(float)

    def driven(self, push: ComplexArray, w: float) -> ComplexArray:
        """The P of the motion P exp(i w t) under modal forces `push` exp(i w t), kg^1/2 m, shape ``(n,)``, as exact as
        the rates; there are no rigid-body modes."""
        n = self.modes.shape[0]
        real, imaginary = (np.stack([push.real, push.imag]) @ self.real_back[n:]).view(complex)
        one, other = (real + 1j * imaginary) / (1j * w - self.rates), (real - 1j * imaginary) / (-1j * w - self.rates)
        both = np.stack([one + other, 1j * (other - one)]).view(float) @ self.real_motion[:, :n] / 2
        return np.asarray(both[0] + 1j * both[1])

    @cached_property
    def decay(self) -> FloatArray:
        """Rates at which the terms fall, 1/s, shape ``(T,)``."""
        return -self.rates.real

    def outlasting(self, s: float, most: float) -> int:
        """How many terms have decayed by less than exp(-`most`) after `s` seconds: the first ones of all."""
        return int((self.decay * s).searchsorted(most))


def exponentials(omega: FloatArray, own: FloatArray, coupling: FloatArray) -> Exponentials:
    """The free motions of q'' + D q' + omega^2 q = 0, of frequencies ``(n,)`` and matrices D = own + coupling, 1/s.

    Where two eigenvectors nearly coincide, as at critical damping, `coupling` is changed by as little as parts them.
    They are kept by the numbers that they depend on: the same joint asks for them again under other loads.
    """
    return _kept_exponentials(omega.tobytes(), own.tobytes(), coupling.tobytes())


@cached(_KEPT)
def _kept_exponentials(*numbers: bytes) -> Exponentials:
    """`exponentials` of arrays in the form of bytes; not to be written to."""
    omega, *both = (np.frombuffer(part) for part in numbers)
    own, coupling = (matrix.reshape(omega.size, -1) for matrix in both)
    best, least = None, math.inf
    for i in range(_ATTEMPTS):
        found, skew = _exponentials(omega, own + coupling * (1 + (_APART * 2**i if i else 0.0)))
        if best is None or skew < least:
            best, least = found, skew
        if skew < _SKEW:
            break
    assert best is not None
    _ = best.real_motion, best.real_back  # made here, so that they count in the size of what is kept
    return best


def _exponentials(omega: FloatArray, D: FloatArray) -> tuple[Exponentials, float]:
    """`exponentials` of a matrix D, and the condition number of the eigenvectors."""
    n, bends = omega.size, omega > 0
    if bends.all():
        turn, dragged = None, bends
    else:
        turn, dragged = rigid_directions(omega, D)
        D = turn.T @ D @ turn
        D[~bends & ~dragged] = D[:, ~bends & ~dragged] = 0.0
    e, moving = np.flatnonzero(bends), np.flatnonzero(bends | dragged)
    s, m = omega[e], e.size
    A = np.zeros((m + moving.size, m + moving.size))
    at = m + np.searchsorted(moving, e)
    A[np.arange(m), at] = s
    A[at, np.arange(m)] = -s
    A[m:, m:] = -D[np.ix_(moving, moving)]
    values, vectors = scipy.linalg.eig(A)
    skew = float(np.linalg.cond(vectors)) if values.size else 1.0
    upper = np.flatnonzero(values.imag >= 0)
    upper = upper[np.argsort(-values[upper].real, kind="stable")]
    rates, vectors = values[upper], vectors[:, upper]
    inverse = _amplitudes_of(vectors, rates.imag > 0)
    rates = np.minimum(rates.real, 0.0) + 1j * rates.imag
    (modes, speeds), back = np.zeros((2, n, rates.size), dtype=complex), np.zeros((rates.size, 2 * n), dtype=complex)
    modes[moving], speeds[moving] = vectors[m:] / rates, vectors[m:]
    modes[e] = vectors[:m] / s[:, None]
    back[:, e], back[:, n + moving] = inverse[:, :m] * s, inverse[:, m:]
    if turn is None:
        return Exponentials(rates, modes, speeds, back, None), skew
    rest, rigid = np.zeros((2, n, 2 * n)), np.flatnonzero(~bends)
    rest[0, rigid] = -(modes[rigid] @ back).real
    rest[0, rigid, rigid] += 1.0
    alone = np.flatnonzero(~bends & ~dragged)
    rest[1, alone, n + alone] = 1.0
    both = scipy.linalg.block_diag(turn, turn)
    turned, rate = (np.asarray(turn @ of, dtype=complex) for of in (modes, speeds))
    return Exponentials(rates, turned, rate, back @ both.T, turn @ rest @ both.T), skew


def rigid_directions(omega: FloatArray, D: FloatArray) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """An orthogonal matrix, ``(n, n)``, that turns the rigid-body modes into motions each of which is damped or not,
    and whether each mode bends or is damped, ``(n,)``: a motion that no damper resists is in no damping force."""
    rigid, turn, dragged = np.flatnonzero(omega == 0), np.eye(omega.size), np.ones(omega.size, dtype=bool)
    damping, turn[np.ix_(rigid, rigid)] = np.linalg.eigh(D[np.ix_(rigid, rigid)])
    dragged[rigid] = damping > _STILL * max(damping.max(), _STILL * np.abs(D).max())
    return turn, dragged


def _amplitudes_of(vectors: ComplexArray, ring: npt.NDArray[np.bool_]) -> ComplexArray:
    """The c for which the real part of vectors @ c is given, ``(T, size)``, of ``T`` vectors, ``(size, T)``.

    `ring`, ``(T,)``, says which vectors have an imaginary part.  Real and imaginary parts are columns of one real
    matrix: in a complex inverse, two nearly equal vectors would leave errors that do not cancel in the real part.
    """
    others = vectors.imag[:, ring]
    sizes = np.linalg.norm(others, axis=0)
    inverse = np.linalg.inv(np.concatenate([vectors.real, others / sizes], axis=1))
    found = inverse[: ring.size].astype(complex)
    found[ring] -= 1j * inverse[ring.size :] / sizes[:, None]
    return found
