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
    """z, z', z'' and the bound on |z'''| of the terms `lo` to `hi` at one position; `weight` is ``(T,)``."""
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
    """Write what does not depend on the modal terms, at the time `s`, s, to `out`.

    `forced`, m, shape ``(U, H)``, holds the amplitudes of the forced motion, and `omega`, rad/s, its frequencies.
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
