"""The extrema of gap functions between switches, compiled; see `lapjoint.orbits.branches.gap_extrema`."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.compiled_arrays import complex_zeros, int_zeros, zeros
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
    before, now = zeros(places), zeros(places)
    waves, factors = complex_zeros(terms), complex_zeros(terms)
    loud, active = int_zeros(terms), 0
    for s in range(motion.duration.size):
        duration = motion.duration[s]
        if duration <= 0:  # stops that switch at one time leave nothing between them
            continue
        tau, step, left = 0.0, 0.0, 0
        while True:
            if left == 0:
                active, swing = _loud(motion, s, tau, waves, loud)
                count = max(1, math.ceil((duration - tau) / min(width, swing / _PER_SWING, duration / _LEAST)))
                step, left = (duration - tau) / count, min(count, _BLOCK)
                for i in range(active):
                    factors[i] = np.exp(motion.rates[s, loud[i]] * step)
            for u in range(places):
                rate = motion.polynomial[s, u, 1] + 2 * tau * motion.polynomial[s, u, 2]
                for i in range(active):
                    weight = motion.weights[s, u, loud[i]]
                    rate += weight.real * waves[i].real - weight.imag * waves[i].imag
                now[u] = rate
            for i in range(active):
                waves[i] *= factors[i]
            for p in range(stops.sign.size):
                u = stops.place[p]
                last, rate = stops.sign[p] * before[u], stops.sign[p] * now[u]
                highest = last > 0 and rate <= 0
                if tau > 0 and (highest or (last < 0 and rate >= 0)):
                    at = _stationary(motion, s, u, tau - step, tau, before[u], now[u])
                    stop.append(p)
                    time.append(motion.start[s] + at)
                    value.append(stops.sign[p] * _derivatives(motion, s, u, at)[0] - stops.gap[p])
                    maximum.append(highest)
            before, now = now, before
            if tau >= duration:
                break
            tau, left = min(tau + step, duration), left - 1
            if duration - tau < 0.5 * step:
                tau = duration
    return np.array(stop)[1:], np.array(time)[1:], np.array(value)[1:], np.array(maximum)[1:]


@njit_inner()
def _loud(motion: Motion, s: int, tau: float, waves: ComplexArray, loud: IndexArray) -> tuple[int, float]:
    """The terms that are not faint at a time: how many, and half a period of the fastest of them, s.

    `loud`, ``(K,)``, takes their indices, and `waves`, ``(K,)``, their rates there.
    """
    places, terms = motion.weights.shape[1], waves.size
    all_waves, sizes = complex_zeros(terms), zeros((places, terms))
    largest = zeros(places)
    for k in range(terms):
        all_waves[k] = motion.amplitudes[s, k] * motion.rates[s, k] * np.exp(motion.rates[s, k] * tau)
        for u in range(places):
            sizes[u, k] = abs(motion.weights[s, u, k] * all_waves[k])
            largest[u] = max(largest[u], sizes[u, k])
    count, fastest = 0, 0.0
    for k in range(terms):
        for u in range(places):
            if sizes[u, k] > _FAINT * largest[u]:
                loud[count], waves[count] = k, all_waves[k]
                count, fastest = count + 1, max(fastest, abs(motion.rates[s, k]))
                break
    return count, math.pi / fastest if fastest > 0 else math.inf


@njit_inner()
def _stationary(motion: Motion, s: int, u: int, a: float, b: float, fa: float, fb: float) -> float:
    """Where the rate at a place vanishes between two times at which its signs differ, s: Newton's method, enclosed."""
    least = _EXACT * (b - a)
    t = (a * fb - b * fa) / (fb - fa) if fa != fb else 0.5 * (a + b)
    for _ in range(_STEPS):
        _, rate, bend = _derivatives(motion, s, u, t)
        if (rate > 0) == (fb > 0):
            b = t
        else:
            a = t
        new = t - rate / bend if bend != 0.0 else 0.5 * (a + b)
        if not a <= new <= b:
            new = 0.5 * (a + b)
        if abs(new - t) <= least or b - a <= least:
            return new
        t = new
    return t


@njit_inner()
def _derivatives(motion: Motion, s: int, u: int, tau: float) -> tuple[float, float, float]:
    """z at a place, `tau` after the start of a segment, m, its rate, m/s, and the rate of that, m/s2."""
    one, two, three = motion.polynomial[s, u, 0], motion.polynomial[s, u, 1], motion.polynomial[s, u, 2]
    z, rate, bend = one + tau * (two + tau * three), two + 2 * tau * three, 2 * three
    for k in range(motion.rates.shape[1]):
        r = motion.rates[s, k]
        wave = motion.weights[s, u, k] * motion.amplitudes[s, k]
        if r.real * tau < _GONE or (wave.real == 0.0 and wave.imag == 0.0):
            continue
        wave *= np.exp(r * tau)
        z += wave.real
        wave *= r
        rate += wave.real
        bend += (wave * r).real
    return z, rate, bend


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
