"""The displacement at the stops and its derivatives at a moment within a state, summed over terms and harmonics.

Arguments are named as in `analytic.march.terms`; besides, `drift`, shape ``(U, 3)``, holds the coefficients of 1, s,
s^2 of z at the positions of the stops, m, and `out`, shape ``(U, 4)``, takes z, z', z'' and the bound on |z'''| there.
"""

from __future__ import annotations

import math

from numba import njit

from analytic.march.switching import SUM
from analytic.modes.beam_functions import ComplexArray
from lapjoint.problem import FloatArray


@njit(cache=True, fastmath=SUM)
def add_terms(
    weight: FloatArray, term: ComplexArray, root: ComplexArray, lo: int, hi: int
) -> tuple[float, float, float, float]:
    """Sum terms at one position.

    Parameters
    ----------
    weight : FloatArray, shape (T,)
        The mode of each term there, kg^-1/2.
    term : ComplexArray, shape (T,)
        c_t exp(lambda_t s) of each term, kg^1/2 m.
    root : ComplexArray, shape (T,)
        lambda of each term, 1/s.
    lo, hi : int
        The first term, and the one after the last.

    Returns
    -------
    float, float, float, float
        z, m, z', m/s, z'', m/s^2, and the bound on |z'''|, m/s^3.
    """
    z, z1, z2, b3 = 0.0, 0.0, 0.0, 0.0
    for t in range(lo, hi):
        w, x, y = weight[t], term[t].real, term[t].imag
        a, b = root[t].real, root[t].imag
        x1, y1 = a * x - b * y, a * y + b * x
        z += w * x
        z1 += w * x1
        z2 += w * (a * x1 - b * y1)
        square = a * a + b * b
        b3 += abs(w) * square * math.sqrt(square * (x * x + y * y))
    return z, z1, z2, b3


@njit(cache=True)
def at_positions(
    forced: ComplexArray, omega: FloatArray, s: float, theta: ComplexArray, drift: FloatArray, out: FloatArray
) -> None:
    """Write what does not depend on the modal terms.

    Parameters
    ----------
    forced : ComplexArray, shape (U, H)
        Amplitudes of the forced motion, m.
    omega : FloatArray, shape (H,)
        Angular frequencies of the harmonics, rad/s.
    s : float
        Time since the start of the state, s.
    theta : ComplexArray, shape (H,)
        exp(i theta_h), without unit, now.
    drift : FloatArray, shape (U, 3)
        Coefficients of 1, s, s^2 of z, m over powers of s.
    out : FloatArray, shape (U, 4)
        Takes z, z', z'' and the bound on |z'''|, m over powers of s.
    """
    for u in range(out.shape[0]):
        z, z1, z2 = (
            drift[u, 0] + s * (drift[u, 1] + s * drift[u, 2]),
            drift[u, 1] + 2 * s * drift[u, 2],
            2 * drift[u, 2],
        )
        b3 = 0.0
        for h in range(theta.size):
            wave, w = forced[u, h] * theta[h], omega[h]
            z += wave.imag
            z1 += w * wave.real
            z2 -= w * w * wave.imag
            b3 += w * w * w * math.sqrt(wave.real * wave.real + wave.imag * wave.imag)
        out[u, 0], out[u, 1], out[u, 2], out[u, 3] = z, z1, z2, b3
