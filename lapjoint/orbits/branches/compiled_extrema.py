"""The extrema of gap functions between switches, compiled; see `lapjoint.orbits.branches.gap_extrema`."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.compiled_arrays import complex_zeros, zeros
from lapjoint.compiling import njit_called
from lapjoint.orbits.compiled_intervals import IndexArray, Motion, Stops
from lapjoint.problem import FloatArray

_LEAST = 8
"""Least number of points in a segment."""
_STEPS = 60
"""Most steps of the Illinois method, of which some eight are needed."""
_EXACT = 1e-13
"""Width of an interval over the length of its segment at which its extremum is found: the value there is exact."""


@njit_called()
def gap_extrema(motion: Motion, stops: Stops, width: float) -> tuple[IndexArray, FloatArray, FloatArray, np.ndarray]:
    """Extrema of gap functions.

    Parameters
    ----------
    motion, stops : Motion, Stops
        The orbit, and the stops.
    width : float
        Largest distance between two points between which an extremum is looked for, s.

    Returns
    -------
    stop : ndarray, shape (m,)
        The stop of each extremum.
    time : ndarray, shape (m,)
        When, s from the start of the orbit.
    value : ndarray, shape (m,)
        Gap function there, m.
    highest : ndarray, shape (m,)
        Whether it is a maximum, and not a minimum.
    """
    stop, time, value, maximum = [0], [0.0], [0.0], [False]
    places, terms = motion.weights.shape[1], motion.rates.shape[1]
    before, now = zeros(places), zeros(places)
    waves, factors = complex_zeros(terms), complex_zeros(terms)
    for s in range(motion.duration.size):
        count = max(_LEAST, math.ceil(motion.duration[s] / width))
        step = motion.duration[s] / count
        for k in range(terms):
            waves[k] = motion.amplitudes[s, k] * motion.rates[s, k]
            factors[k] = np.exp(motion.rates[s, k] * step)
        for i in range(count + 1):
            for u in range(places):
                now[u] = motion.polynomial[s, u, 1] + 2 * i * step * motion.polynomial[s, u, 2]
            for k in range(terms):
                for u in range(places):
                    now[u] += (motion.weights[s, u, k] * waves[k]).real
                waves[k] *= factors[k]
            for p in range(stops.sign.size):
                u = stops.place[p]
                last, rate = stops.sign[p] * before[u], stops.sign[p] * now[u]
                highest = last > 0 and rate <= 0
                if i > 0 and (highest or (last < 0 and rate >= 0)):
                    tau = _stationary(motion, s, u, (i - 1) * step, i * step)
                    stop.append(p)
                    time.append(motion.start[s] + tau)
                    value.append(stops.sign[p] * _derivative(motion, s, u, tau, 0) - stops.gap[p])
                    maximum.append(highest)
            before, now = now, before
    return np.array(stop)[1:], np.array(time)[1:], np.array(value)[1:], np.array(maximum)[1:]


@njit_called()
def _stationary(motion: Motion, s: int, u: int, a: float, b: float) -> float:
    """Where the rate at a place vanishes between two times at which its signs differ, s."""
    fa, fb = _derivative(motion, s, u, a, 1), _derivative(motion, s, u, b, 1)
    least = _EXACT * motion.duration[s]
    for _ in range(_STEPS):
        if b - a <= least or fa == fb:
            break
        c = (a * fb - b * fa) / (fb - fa)
        c = min(max(c, a), b)
        fc = _derivative(motion, s, u, c, 1)
        if fc == 0.0:
            return c
        if (fc > 0) == (fb > 0):
            shrinks = c > b - least
            b, fb, fa = c, fc, 0.5 * fa
        else:
            shrinks = c < a + least
            a, fa, fb = c, fc, 0.5 * fb
        if shrinks:
            return c
    return 0.5 * (a + b)


@njit_called()
def _derivative(motion: Motion, s: int, u: int, tau: float, order: int) -> float:
    """z at a place, `tau` after the start of a segment, m, or its rate, m/s."""
    one, two, three = motion.polynomial[s, u, 0], motion.polynomial[s, u, 1], motion.polynomial[s, u, 2]
    result = one + tau * (two + tau * three) if order == 0 else two + 2 * tau * three
    for k in range(motion.rates.shape[1]):
        wave = motion.weights[s, u, k] * motion.amplitudes[s, k] * np.exp(motion.rates[s, k] * tau)
        result += (wave if order == 0 else wave * motion.rates[s, k]).real
    return float(result)
