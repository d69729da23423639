"""The extrema of gap functions between switches, compiled; see `lapjoint.orbits.branches.gap_extrema`."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.compiled_arrays import complex_zeros, put, zeros
from lapjoint.compiling import njit_called, njit_inner
from lapjoint.orbits.compiled_intervals import IndexArray, Motion, Stops
from lapjoint.problem import FloatArray

_LEAST = 8
"""Least number of points in a segment."""
_PER_SWING = 3
"""Least number of points in half a period of the fastest term that is not faint."""
_FAINT = 1e-5
"""Rate of a term over the largest rate of all, up to which it is faint: its ripples are too low to matter."""
_BLOCK = 16
"""Number of points from which on it is looked again which terms have become faint."""
_GONE = -45.0
"""Exponent from which on a term is not there any more: 3e-20 of what it was."""
_STEPS = 60
"""Most steps of the search for an extremum, of which three or four are needed."""
_EXACT = 1e-9
"""Step over the first interval at which an extremum is found: the value there is wrong by the square of this."""
_NEAR = 1e-5
"""The same where the step is that of a series, which is wrong by the fourth power of this."""


@njit_called()
def gap_extrema(motion: Motion, stops: Stops, width: float) -> tuple[IndexArray, FloatArray, FloatArray, np.ndarray]:
    """Extrema of gap functions.

    Parameters
    ----------
    motion, stops : Motion, Stops
        The orbit, and the stops.
    width : float
        Largest distance between two points between which an extremum is looked for, s; it is less where fast terms of
        the motion have not decayed.

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
    before, now, found = zeros(places), zeros(places), zeros((places, 2))
    waves, factors, weights = zeros((terms, 2)), zeros((terms, 2)), zeros((places, terms, 2))
    for s in range(motion.duration.size):
        duration = motion.duration[s]
        if duration <= 0:  # stops that switch at one time leave nothing between them
            continue
        tau, step, left, loud = 0.0, 0.0, 0, 0
        while True:
            if left == 0:
                loud, swing = _loud(motion, s, tau, waves, factors, weights)
                count = max(1, math.ceil((duration - tau) / min(width, swing / _PER_SWING, duration / _LEAST)))
                step, left = (duration - tau) / count, min(count, _BLOCK)
                for i in range(loud):
                    factor = np.exp(complex(factors[i, 0], factors[i, 1]) * step)
                    factors[i, 0], factors[i, 1] = factor.real, factor.imag
            turned = False
            for u in range(places):
                rate = motion.polynomial[s, u, 1] + 2 * tau * motion.polynomial[s, u, 2]
                for i in range(loud):
                    rate += weights[u, i, 0] * waves[i, 0] - weights[u, i, 1] * waves[i, 1]
                now[u] = rate
                if tau > 0 and _turns(before[u], rate):
                    turned = True
                    found[u, 0], found[u, 1] = _stationary(motion, s, u, tau - step, tau, before[u], rate)
            for i in range(loud):
                x, y, a, b = waves[i, 0], waves[i, 1], factors[i, 0], factors[i, 1]
                waves[i, 0], waves[i, 1] = x * a - y * b, x * b + y * a
            for p in range(stops.sign.size if turned else 0):
                u = stops.place[p]
                if _turns(before[u], now[u]):
                    stop.append(p)
                    time.append(motion.start[s] + found[u, 0])
                    value.append(stops.sign[p] * found[u, 1] - stops.gap[p])
                    maximum.append(stops.sign[p] * before[u] > 0)
            before, now = now, before
            if tau >= duration:
                break
            tau, left = min(tau + step, duration), left - 1
            if duration - tau < 0.5 * step:
                tau = duration
    return np.array(stop)[1:], np.array(time)[1:], np.array(value)[1:], np.array(maximum)[1:]


@njit_inner()
def _loud(
    motion: Motion, s: int, tau: float, waves: FloatArray, rates: FloatArray, weights: FloatArray
) -> tuple[int, float]:
    """The terms that are not faint at a time: how many, and half a period of the fastest of them, s.

    `waves` and `rates`, ``(K, 2)``, take real and imaginary parts of their rates there and of their exponents, and
    `weights`, ``(U, K, 2)``, of their weights.
    """
    places, terms = motion.weights.shape[1], waves.shape[0]
    wave, sizes, largest = complex_zeros(terms), zeros((terms, places)), zeros(places)
    for k in range(terms):
        root = motion.rates[s, k]
        if root.real * tau < _GONE:
            continue
        wave[k] = motion.amplitudes[s, k] * root * np.exp(root * tau)
        size = wave[k].real ** 2 + wave[k].imag ** 2
        for u in range(places):
            weight = motion.weights[s, u, k]
            sizes[k, u] = size * (weight.real**2 + weight.imag**2)
            largest[u] = max(largest[u], sizes[k, u])
    count, fastest = 0, 0.0
    for k in range(terms):
        loud = False
        for u in range(places):
            loud |= sizes[k, u] > _FAINT**2 * largest[u]
        if loud:
            root = motion.rates[s, k]
            fastest = max(fastest, root.real**2 + root.imag**2)
            waves[count, 0], waves[count, 1] = wave[k].real, wave[k].imag
            rates[count, 0], rates[count, 1] = root.real, root.imag
            for u in range(places):
                weights[u, count, 0], weights[u, count, 1] = motion.weights[s, u, k].real, motion.weights[s, u, k].imag
            count += 1
    return count, math.pi / math.sqrt(fastest) if fastest > 0 else math.inf


@njit_inner()
def _turns(before: float, now: float) -> bool:
    """Whether a rate vanishes between two times."""
    return (before > 0 and now <= 0) or (before < 0 and now >= 0)


@njit_inner()
def _stationary(motion: Motion, s: int, u: int, a: float, b: float, fa: float, fb: float) -> tuple[float, float]:
    """Where the rate at a place vanishes between two times at which its signs differ, s, and z there, m.

    Newton's method, enclosed; with z1 to z4 the derivatives of z, its steps go on where the series of the rate does:

        step = x - c x^2 + (2 c^2 - d) x^3,    x = -z1 / z2,    c = z3 / (2 z2),    d = z4 / (6 z2)
    """
    width = b - a
    t = (a * fb - b * fa) / (fb - fa) if fa != fb else 0.5 * (a + b)
    step, z = 0.0, 0.0
    for _ in range(_STEPS):
        z, rate, bend, third, fourth = _derivatives(motion, s, u, t)
        if (rate > 0) == (fb > 0):
            b = t
        else:
            a = t
        step = -rate / bend if bend != 0.0 else math.inf
        near = abs(third * step) <= abs(bend) and abs(fourth * step * step) <= abs(bend)
        if near:
            c, d = 0.5 * third / bend, fourth / (6 * bend)
            step *= 1 - step * (c - step * (2 * c * c - d))
        if not a <= t + step <= b:
            near, step = False, 0.5 * (a + b) - t
        z += step * (rate + step / 2 * (bend + step / 3 * (third + step / 4 * fourth)))
        t += step
        if abs(step) <= (_NEAR if near else _EXACT) * width or b - a <= _EXACT * width:
            break
    return t, z


@njit_inner()
def _derivatives(motion: Motion, s: int, u: int, tau: float) -> tuple[float, float, float, float, float]:
    """z at a place, `tau` after the start of a segment, m, and its first four derivatives, m over powers of s."""
    one, two, three = motion.polynomial[s, u, 0], motion.polynomial[s, u, 1], motion.polynomial[s, u, 2]
    z, rate, bend, third, fourth = one + tau * (two + tau * three), two + 2 * tau * three, 2 * three, 0.0, 0.0
    for k in range(motion.rates.shape[1]):
        r = motion.rates[s, k]
        wave = motion.weights[s, u, k] * motion.amplitudes[s, k]
        if r.real * tau < _GONE or (wave.real == 0.0 and wave.imag == 0.0):
            continue
        wave *= np.exp(r * tau)
        z += wave.real
        wave *= r
        rate += wave.real
        wave *= r
        bend += wave.real
        wave *= r
        third += wave.real
        fourth += (wave * r).real
    return z, rate, bend, third, fourth


@njit_called()
def moved_events(
    motion: Motion,
    waves: ComplexArray,
    secular: ComplexArray,
    polynomial: FloatArray,
    segment: IndexArray,
    place: IndexArray,
    tau: FloatArray,
) -> FloatArray:
    """How events of a motion move with it, when it moves in some direction.

    Parameters
    ----------
    motion : Motion
        The orbit.
    waves, secular : ndarray, shape (S, U, K)
        Change of the terms' amplitudes at the places, m, and its growth with the time since the segment began, m/s.
    polynomial : ndarray, shape (S, U, 3)
        Change of the coefficients of 1, tau, tau^2, m over powers of s.
    segment, place : ndarray, shape (m,)
        Segment and place of each event.
    tau : ndarray, shape (m,)
        When, s from the start of the segment.

    Returns
    -------
    ndarray, shape (m, 4)
        Change of z, m, and of its rate, m/s, at that time; the rate, m/s, and the rate of that, m/s2.
    """
    found = zeros((tau.size, 4))
    for i in range(tau.size):
        s, u, t = segment[i], place[i], tau[i]
        if i > 0 and s == segment[i - 1] and u == place[i - 1] and t == tau[i - 1]:  # of the stop on the other side
            put(found[i], found[i - 1])
            continue
        one, two, three = polynomial[s, u, 0], polynomial[s, u, 1], polynomial[s, u, 2]
        z, rate = one + t * (two + t * three), two + 2 * t * three
        speed = motion.polynomial[s, u, 1] + 2 * t * motion.polynomial[s, u, 2]
        bend = 2 * motion.polynomial[s, u, 2]
        for k in range(motion.rates.shape[1]):
            r = motion.rates[s, k]
            if r.real * t < _GONE:
                continue
            wave = np.exp(r * t)
            change = (waves[s, u, k] + t * secular[s, u, k]) * wave
            z += change.real
            rate += (r * change + secular[s, u, k] * wave).real
            own = r * motion.weights[s, u, k] * motion.amplitudes[s, k] * wave
            speed += own.real
            bend += (r * own).real
        found[i, 0], found[i, 1], found[i, 2], found[i, 3] = z, rate, speed, bend
    return found


@njit_called()
def nearest(kind: IndexArray, phase: FloatArray, other_kind: IndexArray, other_phase: FloatArray) -> IndexArray:
    """For each of some events of a motion that repeats, the event of another motion that is the nearest in phase.

    Parameters
    ----------
    kind, phase : ndarray, shape (m,)
        What each event is, and when, over the length of the motion.
    other_kind, other_phase : ndarray, shape (n,)
        The same of the events among which it is looked for.

    Returns
    -------
    ndarray, shape (m,)
        Their indices; -1 where there is none of that kind.
    """
    found = np.full(kind.size, -1)
    for i in range(kind.size):
        least = math.inf
        for j in range(other_kind.size):
            if other_kind[j] == kind[i]:
                apart = other_phase[j] - phase[i]
                apart = abs(apart - round(apart))
                if apart < least:
                    found[i], least = j, apart
    return found
