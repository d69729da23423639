r"""The mean rate of the displacement at a stop over a duration, which may be short, zero or negative.

Of a term c exp(lambda s) it is c (exp(lambda d) - 1) / d.  For a short duration the difference has no digits, while the
quotient is lambda + lambda^2 d / 2 + ...: there it is summed as a series, as is its derivative by the duration.

Arguments are named as in `analytic.march.terms`.
"""

from __future__ import annotations

import math

from analytic.march.oscillator import OSCILLATING, SPLIT
from analytic.march.tables import Tables
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import complex_zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

_SHORT = 1.0
"""|lambda d| up to which the quotients are summed as series.  Beyond it the formulae lose a factor of three at most."""
_ORDERS = 18
"""Terms of the series: the next is 1 / 19!, 1e-17, of the first."""


@njit_called()
def mean_rate(root: complex, d: float) -> tuple[complex, complex]:
    """The mean rate of exp(lambda s) for s from 0 to d, and its derivative by d.

    Parameters
    ----------
    root : complex
        lambda, 1/s.
    d : float
        Duration, s, of either sign.

    Returns
    -------
    complex, complex
        (exp(lambda d) - 1) / d, 1/s, and its derivative, 1/s2; at d = 0 their limits, lambda and lambda^2 / 2.
    """
    a, b = root.real * d, root.imag * d
    x = complex(a, b)
    if a * a + b * b > _SHORT * _SHORT:
        size = math.exp(a)
        e = complex(size * math.cos(b), size * math.sin(b))
        mean = (e - 1.0) / d
        return mean, (root * e - mean) / d
    first, second = 1.0 + 0.0j, 1.0 + 0.0j  # sum x^k / (k + 1)!, and twice its derivative
    for k in range(_ORDERS, 0, -1):
        first = 1.0 + first * x / (k + 1.0)
        second = 1.0 + second * x * ((k + 1.0) / (k * (k + 2.0)))
    return root * first, root * root * (0.5 * second)


@njit_inner()
def mean_rate_at_stop(
    tables: Tables,
    slot: int,
    u: int,
    d: float,
    theta: ComplexArray,
    term: ComplexArray,
    poly: FloatArray,
    row: FloatArray,
) -> tuple[float, float, float]:
    """The mean rate of the displacement at a position of stops, and what it depends on.

    Parameters
    ----------
    tables : Tables
        The states of the joint.
    slot, u : int
        The state, and the position.
    d : float
        Duration, s, of either sign.
    theta : ComplexArray, shape (H,)
        exp(i theta_h), without unit, at the start.
    term : ComplexArray, shape (T,)
        The c_t, kg^1/2 m.
    poly : FloatArray, shape (N, 3)
        The coefficients a_i, kg^1/2 m over powers of s.
    row : FloatArray, shape (2 N,)
        Takes the derivatives by (q, v) at the start, kg^-1/2 / s and kg^-1/2.

    Returns
    -------
    float, float, float
        The mean rate, m/s; its derivative by the duration, m/s2; and by the time of the start while (q, v) less the
        answer to the harmonics stays, m/s2.
    """
    n, weight = tables.modes[slot], tables.weight[slot, u]
    value, by_duration, by_time = 0.0, 0.0, 0.0
    means = complex_zeros(tables.terms[slot])
    for t in range(means.size):
        mean, slope = mean_rate(tables.root[slot, t], d)
        means[t] = mean
        value += weight[t] * (mean * term[t]).real
        by_duration += weight[t] * (slope * term[t]).real
    extra = n
    for i in range(n):
        value += weight[i] * (poly[i, 1] + poly[i, 2] * d)
        by_duration += weight[i] * poly[i, 2]
        kind, root = tables.kind[slot, i], tables.root[slot, i]
        row[i], row[n + i] = 0.0, weight[i]
        if kind == OSCILLATING:
            sine = means[i].imag / root.imag
            row[i], row[n + i] = weight[i] * (means[i].real - root.real * sine), weight[i] * sine
        elif kind == SPLIT:
            first, second = root.real, tables.root[slot, extra].real
            m1, m2 = means[i].real, means[extra].real
            row[i] = weight[i] * (first * m2 - second * m1) / (first - second)
            row[n + i] = weight[i] * (m1 - m2) / (first - second)
            extra += 1
    for h in range(theta.size):
        wave, turning = tables.forced[slot, u, h] * theta[h], complex(0.0, tables.omega[h])
        mean, slope = mean_rate(turning, d)
        value += (wave * mean).imag
        by_duration += (wave * slope).imag
        by_time += (wave * turning * mean).imag
    return value, by_duration, by_time
