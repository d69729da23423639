"""The sums of an exact flow over its terms, compiled: for a hundred numbers, numpy spends more time on calls than on
sums.

A flow has ``n`` modes and ``H`` loads.  Its motion at each of ``p`` places, the positions of stops, is the real part of
a sum of ``m`` terms c exp(r s).  There is one term for each mode that oscillates, one for each load, and last a
constant with r = 0.
"""

from __future__ import annotations

import math

from fe_lapjoint.march.system import ComplexArray, IndexArray
from lapjoint.compiled.arrays import complex_zeros, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

SWINGS = 4.0
"""A term c exp(r s) swings within a width w, s, if |r| w is larger.  Its bound by amplitude, 2 |c|, is then less than
its bound by curvature, w^2 |c r^2| / 8."""
LITTLE = 0.5
"""Product of a rate and a time below which exp less 1 loses more than a binary digit."""


@njit_called()
def start_terms(
    y: FloatArray,
    start: float,
    loads: tuple[FloatArray, FloatArray],
    forced: tuple[FloatArray, FloatArray],
    which: IndexArray,
    roots: tuple[FloatArray, FloatArray],
    shares: ComplexArray,
    moduli_of_shares: FloatArray,
) -> tuple[FloatArray, ComplexArray, FloatArray, ComplexArray, FloatArray]:
    """The terms of a flow at its start, from (q, q') there, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``.

    Given are the loads' angular frequencies, rad/s, and phases, rad, ``(H,)``; the forced motion by real and imaginary
    part of each load, ``(2 n, 2 H)``, and without loads, ``(2 n,)``; the indices of the modes that oscillate, with the
    real parts of their roots, 1/s, and the inverse imaginary parts, s; the factor of each term in the motion of the
    places, ``(p, m)``; and the moduli of these factors followed by those of all modes, ``(p, m + n)``.

    Returned are (q, q') less the forced motion, ``(2, n)``; the complex amplitudes of the terms and their moduli,
    ``(m,)``; the amplitudes in the motion of each place, m, ``(p, m)``; and the sum of the moduli of all addends of
    each place's displacement, m, ``(p,)``.
    """
    n, m, count = y.size // 2, shares.shape[1], which.size
    amplitudes = complex_zeros(m)
    free = _free_motion(y, start, loads, forced, amplitudes, count)
    for j in range(count):
        x, v = free[0, which[j]], free[1, which[j]]
        amplitudes[j] = complex(x, (roots[0][j] * x - v) * roots[1][j])
    return free, amplitudes, *_at_places(amplitudes, y[:n], shares, moduli_of_shares)


@njit_called(vectorised=True)
def start_coupled(
    y: FloatArray,
    start: float,
    loads: tuple[FloatArray, FloatArray],
    forced: tuple[FloatArray, FloatArray],
    back: FloatArray,
    shares: ComplexArray,
    moduli_of_shares: FloatArray,
) -> tuple[FloatArray, ComplexArray, FloatArray, ComplexArray, FloatArray]:
    """`start_terms` of a flow whose modes are coupled, as its free terms are.

    `back` holds real and imaginary part of the amplitude of each free term, in turn, for units of (q, q'), ``(2 n, 2
    T)``; `moduli_of_shares` the moduli of the factors of all terms and of (q, q'), ``(p, m + 2 n)``.
    """
    n, m, count = y.size // 2, shares.shape[1], back.shape[1] // 2
    amplitudes, parts = complex_zeros(m), zeros(2 * count)
    free = _free_motion(y, start, loads, forced, amplitudes, count)
    for i in range(2 * n):
        one = free[i // n, i % n]
        for j in range(2 * count):
            parts[j] += one * back[i, j]
    for j in range(count):
        amplitudes[j] = complex(parts[2 * j], parts[2 * j + 1])
    return free, amplitudes, *_at_places(amplitudes, y, shares, moduli_of_shares)


@njit_inner()
def _free_motion(
    y: FloatArray,
    start: float,
    loads: tuple[FloatArray, FloatArray],
    forced: tuple[FloatArray, FloatArray],
    amplitudes: ComplexArray,
    count: int,
) -> FloatArray:
    """(q, q') less the forced motion, ``(2, n)``; the amplitudes of the loads and the constant, after `count` others,
    are written into `amplitudes`."""
    n = y.size // 2
    for h in range(loads[0].size):
        angle = loads[0][h] * start + loads[1][h]
        amplitudes[count + h] = complex(math.cos(angle), math.sin(angle))
    amplitudes[amplitudes.size - 1] = 1.0
    free = zeros((2, n))
    for i in range(2 * n):
        left = y[i] - forced[1][i]
        for h in range(loads[0].size):
            load = amplitudes[count + h]
            left -= forced[0][i, 2 * h] * load.real + forced[0][i, 2 * h + 1] * load.imag
        free[i // n, i % n] = left
    return free


@njit_inner()
def _at_places(
    amplitudes: ComplexArray, y: FloatArray, shares: ComplexArray, moduli_of_shares: FloatArray
) -> tuple[FloatArray, ComplexArray, FloatArray]:
    """Moduli, amplitudes at places and sizes as in `start_terms`; `y` is what `moduli_of_shares` takes after terms."""
    m = amplitudes.size
    moduli = zeros(m)
    for k in range(m):
        moduli[k] = abs(amplitudes[k])
    terms, sizes = complex_zeros(shares.shape), zeros(shares.shape[0])
    for u in range(shares.shape[0]):
        for k in range(m):
            terms[u, k] = shares[u, k] * amplitudes[k]
            sizes[u] += moduli_of_shares[u, k] * moduli[k]
        for i in range(y.size):
            sizes[u] += moduli_of_shares[u, m + i] * abs(y[i])
    return moduli, terms, sizes


@njit_called()
def moved_on(
    amplitudes: ComplexArray, rates: ComplexArray, forced: tuple[FloatArray, FloatArray], s: float
) -> FloatArray:
    """(q, q') `s` seconds after the start of a flow all of whose modes oscillate, kg^1/2 m and kg^1/2 m/s, ``(2 n,)``.

    Given are the amplitudes of the terms at the start and their rates, 1/s, ``(m,)``, and the forced motion as
    `start_terms` takes it.
    """
    y = forced[1].copy()
    n = y.size // 2
    for h in range(rates.size - 1 - n):
        load = amplitudes[n + h] * _wave(rates[n + h], s)
        for i in range(2 * n):
            y[i] += forced[0][i, 2 * h] * load.real + forced[0][i, 2 * h + 1] * load.imag
    for i in range(n):
        now = amplitudes[i] * _wave(rates[i], s)
        y[i] += now.real
        y[n + i] += (now * rates[i]).real
    return y


@njit_called(vectorised=True)
def moved_on_coupled(
    amplitudes: ComplexArray,
    rates: ComplexArray,
    motion: FloatArray,
    forced: tuple[FloatArray, FloatArray],
    s: float,
) -> FloatArray:
    """`moved_on` of a flow whose modes are coupled, but for rigid-body motion.

    `motion` holds (q, q') for units of the real and of the imaginary part of the amplitude of each free term, in turn,
    shape ``(2 T, 2 n)``.
    """
    y, count = forced[1].copy(), motion.shape[0] // 2
    for k in range(rates.size - 1):
        now = amplitudes[k] * _wave(rates[k], s)
        if k < count:
            for i in range(y.size):
                y[i] += motion[2 * k, i] * now.real + motion[2 * k + 1, i] * now.imag
        else:
            h = k - count
            for i in range(y.size):
                y[i] += forced[0][i, 2 * h] * now.real + forced[0][i, 2 * h + 1] * now.imag
    return y


@njit_called(vectorised=True)
def turned(amplitudes: FloatArray, rates: ComplexArray, s: float) -> FloatArray:
    """The amplitudes of the first terms of ``m`` motions, real and imaginary parts in turn, ``(2 count, m)``, `s`
    seconds later."""
    result = zeros(amplitudes.shape)
    for k in range(amplitudes.shape[0] // 2):
        wave = _wave(rates[k], s)
        for j in range(amplitudes.shape[1]):
            re, im = amplitudes[2 * k, j], amplitudes[2 * k + 1, j]
            result[2 * k, j] = wave.real * re - wave.imag * im
            result[2 * k + 1, j] = wave.real * im + wave.imag * re
    return result


@njit_called()
def at_place(terms: ComplexArray, rates: ComplexArray, place: int, s: float) -> tuple[float, float]:
    """Displacement, m, and velocity, m/s, of a place by amplitudes, m, ``(p, m)``, and rates, 1/s, ``(m,)``."""
    z, rate = 0.0, 0.0
    for k in range(rates.size):
        now = terms[place, k] * _wave(rates[k], s)
        z += now.real
        rate += (now * rates[k]).real
    return z, rate


@njit_called()
def at_row(terms: ComplexArray, rates: ComplexArray, place: int, waves: FloatArray) -> tuple[float, float]:
    """`at_place` with known exponentials exp(r s), conjugate, as pairs of real numbers, shape ``(2 m,)``."""
    z, rate = 0.0, 0.0
    for k in range(rates.size):
        now = terms[place, k] * complex(waves[2 * k], -waves[2 * k + 1])
        z += now.real
        rate += (now * rates[k]).real
    return z, rate


@njit_called()
def above_troughs(
    terms: ComplexArray, rates: ComplexArray, speeds: FloatArray, side: float, s: FloatArray, width: float
) -> FloatArray:
    """Sum of the swinging terms at both ends of each interval, less its lower bound within, m, shape ``(2, i)``.

    Given are a place's amplitudes, m, and rates, 1/s, ``(m,)``; the moduli of the rates, 1/s, or 0 for terms that may
    not swing, ``(m,)``; `side`, +1 for the place's motion or -1 for its opposite; the beginnings of the intervals after
    the start, s, ``(i,)``; and their width, s.
    """
    above = zeros((2, s.size))
    for i in range(s.size):
        above[0, i], above[1, i] = above_trough(terms, rates, speeds, side, s[i], width)
    return above


@njit_inner()
def above_trough(
    terms: ComplexArray, rates: ComplexArray, speeds: FloatArray, side: float, s: float, width: float
) -> tuple[float, float]:
    """The two numbers of `above_troughs`, m, for one interval that begins `s` seconds after the start."""
    begin, end = 0.0, 0.0
    for k in range(rates.size):
        if speeds[k] * width > SWINGS:
            now = terms[k] * _wave(rates[k], s)
            size = abs(now)
            begin += size + side * now.real
            end += size + side * (now * _wave(rates[k], width)).real
    return begin, end


@njit_called()
def integrals(terms: ComplexArray, rates: ComplexArray, T: float) -> FloatArray:
    """Time integrals of the displacements of the places over `T` seconds, m s, ``(p,)``; the last term is constant."""
    areas = terms[:, rates.size - 1].real * T
    for k in range(rates.size - 1):
        a, b = rates[k].real * T, rates[k].imag * T
        # exp(a + i b) - 1 without cancellation
        less = complex(math.expm1(a) * math.cos(b) - 2 * math.sin(b / 2) ** 2, math.exp(a) * math.sin(b))
        area = less / rates[k]
        for u in range(areas.size):
            areas[u] += (terms[u, k] * area).real
    return areas


@njit_called()
def integral_of_product(one: ComplexArray, other: ComplexArray, rates: ComplexArray, T: float) -> float:
    """The time integral over `T` seconds of the product of two motions, Re(c exp(r s)) summed over the terms of each.

    Given are the amplitudes of both, m and m/s, for instance, and their rates, 1/s, ``(m,)``.  Products of terms are
    exponentials again, and those of a pair of terms have two rates, r + r' and r + conj r'.
    """
    m, total = rates.size, 0.0
    waves = complex_zeros(m)
    for i in range(m):
        waves[i] = _wave(rates[i], T)
    for i in range(m):
        for j in range(i + 1):
            mean = 0.5 if i == j else 1.0  # the pairs of different terms are two, with the same integrals
            back = complex(rates[j].real, -rates[j].imag)
            turning = _integral_of_waves(rates[i] + rates[j], waves[i] * waves[j], T)
            still = _integral_of_waves(rates[i] + back, waves[i] * complex(waves[j].real, -waves[j].imag), T)
            a = one[i] * other[j] + one[j] * other[i]
            b = one[i] * complex(other[j].real, -other[j].imag) + complex(one[j].real, -one[j].imag) * other[i]
            total += mean * ((a * turning).real + (b * still).real)
    return total / 2


@njit_inner()
def _integral_of_waves(rate: complex, end: complex, T: float) -> complex:
    """The integral of exp(rate s) over `T` seconds, s; `end` is exp(rate T).

    `end` less 1 loses digits where it turns or falls by little; there it is computed by `expm1`.
    """
    a, b = rate.real * T, rate.imag * T
    if max(abs(a), abs(b)) < LITTLE:
        if a == 0 and b == 0:
            return complex(T, 0.0)
        less = complex(math.expm1(a) * math.cos(b) - 2 * math.sin(b / 2) ** 2, math.exp(a) * math.sin(b))
    else:
        less = end - 1.0
    size = rate.real**2 + rate.imag**2
    return complex(
        (less.real * rate.real + less.imag * rate.imag) / size, (less.imag * rate.real - less.real * rate.imag) / size
    )


@njit_inner()
def _wave(rate: complex, s: float) -> complex:
    """exp(rate s)."""
    size, angle = math.exp(rate.real * s), rate.imag * s
    return complex(size * math.cos(angle), size * math.sin(angle))
