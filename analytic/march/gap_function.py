"""The displacement at the stops and its derivatives at a moment within a state, summed over terms and harmonics.

Arguments are named as in `analytic.march.terms`; besides, `drift`, shape ``(U, 3)``, holds the coefficients of 1, s,
s^2 of z at the positions of the stops, m, and `out`, shape ``(U, 4)``, takes z, z', z'' and the bound on |z'''| there.
"""

from __future__ import annotations

import math
from typing import NamedTuple, SupportsIndex

from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

_SHORT = 2.0  # drag times time up to which the fading powers are summed as series
_SERIES = 22  # terms of these series: the next term is 2^22 4! / 26!, 3e-19 of the first


class Rigid(NamedTuple):
    """Motion that rigid-body modes add to z at ``U`` positions while the force on these modes is linear in time.

    A rigid-body mode obeys q'' + drag q' = F + G s, so that its third derivative is j exp(-drag s) with j = G - drag
    q''(0).  Beside the polynomial of q, q', q'' at s = 0 the mode moves by j times a fading power, `fading_powers`.
    The fading power stays exact for a drag that is small, or 0, where the sum of exp(-drag s) and a polynomial is a
    difference of huge numbers.
    """

    jerk: FloatArray
    """Parts of the third derivative of z at s = 0, m/s3, shape ``(U, C)``."""
    drag: FloatArray
    """The rate at which each part falls, twice the damping rate of rigid-body modes, 1/s, shape ``(C,)``."""


@njit_called()
def fading_powers(drag: float, s: float) -> tuple[float, float, float, float, float]:
    """exp(-drag s), and its integrals from 0 to s, taken once to four times; without drag they are s^n / n!.

    `drag`, 1/s, is 0 or more; the integrals are in s, s^2, s^3 and s^4.
    """
    x = drag * s
    if x > _SHORT:
        e = math.exp(-x)
        e1 = -math.expm1(-x) / drag
        e2 = (s - e1) / drag
        e3 = (s * s / 2 - e2) / drag
        return e, e1, e2, e3, (s * s * s / 6 - e3) / drag
    e4, term, n = 1.0, 1.0, 4
    while n < _SERIES + 4 and term != 0.0:
        n += 1
        term *= -x / n
        e4 += term
    e4 *= s * s * s * s / 24
    e3 = s * s * s / 6 - drag * e4
    e2 = s * s / 2 - drag * e3
    e1 = s - drag * e2
    return 1.0 - drag * e1, e1, e2, e3, e4


@njit_inner()
def add_rigid(rigid: Rigid, u: int, s: float, out: FloatArray) -> None:
    """Add the rigid-body modes' part beside the polynomial to `out[u]`, of ``(U, 4)``, `s` seconds after the start."""
    for c in range(rigid.drag.size):
        e0, e1, e2, e3, _ = fading_powers(rigid.drag[c], s)
        jerk = rigid.jerk[u, c]
        out[u, 0] += jerk * e3
        out[u, 1] += jerk * e2
        out[u, 2] += jerk * e1
        out[u, 3] += abs(jerk) * e0


@njit_called()
def add_terms(
    weight: FloatArray, term: ComplexArray, root: ComplexArray, cube: FloatArray, lo: SupportsIndex, hi: int
) -> tuple[float, float, float, float, float]:
    """z, m, z', m/s, z'', m/s^2, the bound on |z'''|, m/s^3, and that on |z|, m, of the terms from `lo` to before `hi`.

    `weight`, ``(T,)``, is the mode of each term at one position, kg^-1/2, `root` its lambda, 1/s, and `cube` the cube
    of its modulus.  `lo` is a variable because numba would compile another function for a constant in the call.
    """
    z, z1, z2, b3, size = 0.0, 0.0, 0.0, 0.0, 0.0
    for t in range(lo, hi):
        w, x, y = weight[t], term[t].real, term[t].imag
        a, b = root[t].real, root[t].imag
        x1, y1 = a * x - b * y, a * y + b * x
        z += w * x
        z1 += w * x1
        z2 += w * (a * x1 - b * y1)
        most = abs(w) * math.sqrt(x * x + y * y)
        size += most
        b3 += cube[t] * most
    return z, z1, z2, b3, size


@njit_called()
def add_twisted(
    weight: FloatArray,
    twist: FloatArray,
    term: ComplexArray,
    root: ComplexArray,
    cube: FloatArray,
    lo: SupportsIndex,
    hi: int,
) -> tuple[float, float, float, float, float]:
    """`add_terms` of terms whose weights are complex, with the imaginary parts `twist`, kg^-1/2, ``(T,)``."""
    z, z1, z2, b3, size = 0.0, 0.0, 0.0, 0.0, 0.0
    for t in range(lo, hi):
        a, b = root[t].real, root[t].imag
        # of i times a term the real part is minus the imaginary part
        x = weight[t] * term[t].real - twist[t] * term[t].imag
        y = weight[t] * term[t].imag + twist[t] * term[t].real
        x1, y1 = a * x - b * y, a * y + b * x
        z += x
        z1 += x1
        z2 += a * x1 - b * y1
        most = math.sqrt(x * x + y * y)
        size += most
        b3 += cube[t] * most
    return z, z1, z2, b3, size


@njit_called()
def at_position(
    u: int,
    forced: ComplexArray,
    omega: FloatArray,
    s: float,
    theta: ComplexArray,
    drift: FloatArray,
    out: FloatArray,
) -> None:
    """Write to `out[u]`, of ``(U, 4)``, the part of z and its derivatives that does not depend on the modal terms.

    `forced`, ``(U, H)``, holds the amplitudes of the forced motion, m; `omega`, ``(H,)``, rad/s, the frequencies; `s`
    is the time since the start of the state, s, and `theta`, ``(H,)``, exp(i theta_h) now.
    """
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
