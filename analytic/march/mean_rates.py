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
    """The mean rate of exp(lambda s), 1/s, for s from 0 to `d`, s, of either sign, and its derivative by `d`, 1/s2.

    It is (exp(lambda d) - 1) / d; at d = 0 the limits are lambda and lambda^2 / 2.
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
    """The mean rate at position `u` of stops, m/s, over `d` seconds; its derivatives by duration and time, m/s2.

    `theta`, ``(H,)``, `term`, ``(T,)``, and `poly`, ``(N, 3)``, are the values at the start.  The derivative by the
    time of the start is taken at fixed (q, v) less the answer to the harmonics.  `row`, ``(2 N,)``, takes the
    derivatives by (q, v) at the start, kg^-1/2 / s and kg^-1/2.
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
