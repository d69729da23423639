"""The sums of an exact flow over its terms, compiled: an array of a hundred numbers costs numpy more calls than work.

A flow has ``n`` modes and ``H`` loads; its motion at each of ``p`` places is the real part of a sum of ``m`` terms
c exp(r s): one for each mode that oscillates, one for each load, and a constant with r = 0, the last.
"""

from __future__ import annotations

import math

from fe_lapjoint.march.system import ComplexArray, IndexArray
from lapjoint.compiled.arrays import complex_zeros, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

SWINGS = 4.0
"""A term of rate r swings within a width w if |r| w is larger: then 2 |c| is less than w^2 |c r^2| / 8."""


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
    """The terms of a flow at its start.

    Parameters
    ----------
    y : FloatArray, shape (2 n,)
        (q, q') at the start, kg^1/2 m and kg^1/2 m/s.
    start : float
        When, s.
    loads : tuple of FloatArray, shape (H,)
        Angular frequencies, rad/s, and phases, rad, of the loads.
    forced : tuple of FloatArray, shape (2 n, 2 H) and (2 n,)
        The forced motion by real and imaginary part of each load, and that without loads.
    which : IndexArray, shape (oscillating,)
        The modes that oscillate.
    roots : tuple of FloatArray, shape (oscillating,)
        Real parts of their roots, 1/s, and inverse imaginary parts, s.
    shares : ComplexArray, shape (p, m)
        What each term is in the motion of the places.
    moduli_of_shares : FloatArray, shape (p, m + n)
        Moduli of the shares, and then of all modes at the places.

    Returns
    -------
    free : FloatArray, shape (2, n)
        (q, q') less that of the forced motion.
    amplitudes : ComplexArray, shape (m,)
        Complex amplitudes of the terms.
    moduli : FloatArray, shape (m,)
        Their moduli.
    terms : ComplexArray, shape (p, m)
        Amplitudes in the motion of each place, m.
    sizes : FloatArray, shape (p,)
        Sum of the moduli of all that is added up to give the displacement of each place, m.
    """
    n, m, count = y.size // 2, shares.shape[1], which.size
    amplitudes, moduli = complex_zeros(m), zeros(m)
    for h in range(loads[0].size):
        angle = loads[0][h] * start + loads[1][h]
        amplitudes[count + h] = complex(math.cos(angle), math.sin(angle))
    amplitudes[m - 1] = 1.0
    free = zeros((2, n))
    for i in range(2 * n):
        left = y[i] - forced[1][i]
        for h in range(loads[0].size):
            load = amplitudes[count + h]
            left -= forced[0][i, 2 * h] * load.real + forced[0][i, 2 * h + 1] * load.imag
        free[i // n, i % n] = left
    for j in range(count):
        x, v = free[0, which[j]], free[1, which[j]]
        amplitudes[j] = complex(x, (roots[0][j] * x - v) * roots[1][j])
    for k in range(m):
        moduli[k] = abs(amplitudes[k])
    terms, sizes = complex_zeros(shares.shape), zeros(shares.shape[0])
    for u in range(shares.shape[0]):
        for k in range(m):
            terms[u, k] = shares[u, k] * amplitudes[k]
            sizes[u] += moduli_of_shares[u, k] * moduli[k]
        for i in range(n):
            sizes[u] += moduli_of_shares[u, m + i] * abs(y[i])
    return free, amplitudes, moduli, terms, sizes


@njit_called()
def moved_on(
    amplitudes: ComplexArray, rates: ComplexArray, forced: tuple[FloatArray, FloatArray], s: float
) -> FloatArray:
    """(q, q') of a flow all of whose modes oscillate.

    Parameters
    ----------
    amplitudes : ComplexArray, shape (m,)
        Of its terms, at the start.
    rates : ComplexArray, shape (m,)
        Their rates r, 1/s.
    forced : tuple of FloatArray, shape (2 n, 2 H) and (2 n,)
        The forced motion by real and imaginary part of each load, and that without loads.
    s : float
        Time since the start, s.

    Returns
    -------
    FloatArray, shape (2 n,)
        kg^1/2 m and kg^1/2 m/s.
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


@njit_called()
def at_place(terms: ComplexArray, rates: ComplexArray, place: int, s: float) -> tuple[float, float]:
    """Displacement and velocity of a place by its terms.

    Parameters
    ----------
    terms : ComplexArray, shape (p, m)
        Their amplitudes at the start, m.
    rates : ComplexArray, shape (m,)
        Their rates r, 1/s.
    place : int
        Which place.
    s : float
        Time since the start, s.

    Returns
    -------
    tuple of float
        m and m/s.
    """
    z, rate = 0.0, 0.0
    for k in range(rates.size):
        now = terms[place, k] * _wave(rates[k], s)
        z += now.real
        rate += (now * rates[k]).real
    return z, rate


@njit_called()
def at_row(terms: ComplexArray, rates: ComplexArray, place: int, waves: FloatArray) -> tuple[float, float]:
    """As `at_place`, where the exponentials are known.

    Parameters
    ----------
    terms : ComplexArray, shape (p, m)
        Amplitudes of the terms at the start, m.
    rates : ComplexArray, shape (m,)
        Their rates r, 1/s.
    place : int
        Which place.
    waves : FloatArray, shape (2 m,)
        exp(r s), conjugate, each as a pair of real numbers.

    Returns
    -------
    tuple of float
        m and m/s.
    """
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
    """How far the terms that swing within an interval are, at its ends, above the least that they can be in it.

    Parameters
    ----------
    terms : ComplexArray, shape (m,)
        Amplitudes at the start in the motion of a place, m.
    rates : ComplexArray, shape (m,)
        Their rates r, 1/s.
    speeds : FloatArray, shape (m,)
        |r| of the terms that may be taken for swinging, 1/s; 0 for the others.
    side : float
        +1 for the motion of the place, -1 for its opposite.
    s : FloatArray, shape (i,)
        When intervals begin, since the start, s.
    width : float
        How long they are, s.

    Returns
    -------
    FloatArray, shape (2, i)
        The sums of these distances at the beginnings and at the ends, m; 0 where no term swings so fast.
    """
    above = zeros((2, s.size))
    for i in range(s.size):
        above[0, i], above[1, i] = above_trough(terms, rates, speeds, side, s[i], width)
    return above


@njit_inner()
def above_trough(
    terms: ComplexArray, rates: ComplexArray, speeds: FloatArray, side: float, s: float, width: float
) -> tuple[float, float]:
    """The same for one interval, which begins at `s`.

    Parameters
    ----------
    terms : ComplexArray, shape (m,)
        As `above_troughs` takes them, m.
    rates, speeds : ndarray, shape (m,)
        The same, 1/s.
    side : float
        +1 or -1.
    s : float
        When it begins, since the start, s.
    width : float
        How long it is, s.

    Returns
    -------
    tuple of float
        The sums at its beginning and at its end, m.
    """
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
    """Time integrals of the displacement of the places by their terms.

    Parameters
    ----------
    terms : ComplexArray, shape (p, m)
        Amplitudes of the terms at the start, m; the last one is constant.
    rates : ComplexArray, shape (m,)
        Their rates r, 1/s.
    T : float
        From the start until when, s.

    Returns
    -------
    FloatArray, shape (p,)
        m s.
    """
    areas = terms[:, rates.size - 1].real * T
    for k in range(rates.size - 1):
        a, b = rates[k].real * T, rates[k].imag * T
        # exp(a + i b) - 1 without cancellation
        less = complex(math.expm1(a) * math.cos(b) - 2 * math.sin(b / 2) ** 2, math.exp(a) * math.sin(b))
        area = less / rates[k]
        for u in range(areas.size):
            areas[u] += (terms[u, k] * area).real
    return areas


@njit_inner()
def _wave(rate: complex, s: float) -> complex:
    """exp(rate s)."""
    size, angle = math.exp(rate.real * s), rate.imag * s
    return complex(size * math.cos(angle), size * math.sin(angle))
