"""What deviations from an orbit come to, and what that is compared with, compiled; see `lapjoint.orbits.watch`."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.compiled.arrays import bool_zeros, zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.problem import FloatArray


@njit_called()
def terms_at_points(
    segment: IndexArray, tau: FloatArray, rates: ComplexArray, weights: ComplexArray, count: int
) -> tuple[FloatArray, FloatArray]:
    """The terms of deviations at the points between intervals, and what a chord of each misses.

    Parameters
    ----------
    segment, tau : ndarray, shape (I + 1,)
        Segment of each point, and time from its start, s.
    rates : ndarray, complex, shape (S, K' >= K)
        Exponents of the terms in each segment, 1/s; deviations have the first ``K``.
    weights : ndarray, complex, shape (S, U, K')
        Weights of the terms at the ``U`` places of stops.
    count : int
        K.

    Returns
    -------
    terms : ndarray, shape (2, U, I + 1, K)
        Real and imaginary part of each term of unit amplitude, at each place.
    misses : ndarray, shape (U, I, K)
        What a chord of it misses between two points, over the size of its amplitude.
    """
    places = weights.shape[1]
    terms, misses = zeros((2, places, tau.size, count)), zeros((places, tau.size - 1, count))
    for i in range(tau.size):
        s = segment[i]
        width = tau[i + 1] - tau[i] if i + 1 < tau.size and segment[i + 1] == s else 0.0
        for k in range(count):
            rate = rates[s, k]
            wave = np.exp(rate * tau[i])
            bend = min((rate.real * rate.real + rate.imag * rate.imag) * width * width / 8, 2.0)
            for u in range(places):
                weight = weights[s, u, k]
                term = weight * wave
                terms[0, u, i, k], terms[1, u, i, k] = term.real, term.imag
                if i + 1 < tau.size:
                    misses[u, i, k] = bend * abs(wave) * abs(weight)
    return terms, misses


@njit_called()
def largest_motion(
    segment: IndexArray,
    tau: FloatArray,
    terms: FloatArray,
    misses: FloatArray,
    amplitudes: FloatArray,
    drift: FloatArray,
    place: IndexArray,
    result: FloatArray,
) -> None:
    """Bounds on the motion that deviations make at the stops, in each interval.

    Parameters
    ----------
    segment, tau : ndarray, shape (N,)
        Segment of each point between intervals, and time from its start, s.
    terms : ndarray, shape (2, U, N, K)
        Real and imaginary part of each term of unit amplitude there, at the places of stops.
    misses : ndarray, shape (U, N - 1, K)
        What a chord of each term misses between two points, over the size of its amplitude.
    amplitudes : ndarray, shape (2, S, K, C)
        Real and imaginary part of the amplitudes of ``C`` deviations in each segment.
    drift : ndarray, shape (S, U, 2, C)
        Displacement, m, and speed, m/s, that rigid-body modes make there; of size 0 without such modes.
    place : ndarray, shape (P,)
        Which of the places each stop is at.
    result : ndarray, shape (P, I, C)
        Takes the bounds, m; intervals in the order of time.
    """
    count, columns = terms.shape[3], amplitudes.shape[3]
    size = zeros((amplitudes.shape[1], count, columns))
    for s in range(size.shape[0]):
        for k in range(count):
            for c in range(columns):
                size[s, k, c] = math.sqrt(amplitudes[0, s, k, c] ** 2 + amplitudes[1, s, k, c] ** 2)
    last, now, bound = zeros(columns), zeros(columns), zeros(columns)
    for u in range(terms.shape[1]):
        j = -1
        for i in range(segment.size):
            s = segment[i]
            for c in range(columns):
                last[c], now[c] = now[c], 0.0
            for k in range(count):
                a, b = terms[0, u, i, k], terms[1, u, i, k]
                for c in range(columns):
                    now[c] += a * amplitudes[0, s, k, c] - b * amplitudes[1, s, k, c]
            if drift.size:
                for c in range(columns):
                    now[c] += drift[s, u, 0, c] + drift[s, u, 1, c] * tau[i]
            if i == 0 or segment[i - 1] != s:
                continue
            j += 1
            for c in range(columns):
                bound[c] = max(abs(last[c]), abs(now[c]))
            for k in range(count):
                a = misses[u, i - 1, k]
                for c in range(columns):
                    bound[c] += a * size[s, k, c]
            for p in range(place.size):
                if place[p] == u:
                    for c in range(columns):
                        result[p, j, c] = bound[c]


@njit_called(error_model="numpy")
def sound_columns(
    largest: FloatArray,
    at_switches: FloatArray,
    rates: FloatArray,
    distance: FloatArray,
    before: IndexArray,
    since: FloatArray,
    after: IndexArray,
    until: FloatArray,
    rate: FloatArray,
    curvature: FloatArray,
    spacing: FloatArray,
    limits: tuple[float, float, float],
) -> np.ndarray:
    """Whether deviations meet all conditions of `lapjoint.orbits.approach`.

    Parameters
    ----------
    largest : ndarray, shape (m, C)
        Bounds on the motion by ``C`` deviations, m.
    at_switches, rates : ndarray, shape (J, C)
        Their motion at the stop that switches, m, and its rate, m/s.
    distance : ndarray, shape (m,)
        Distance of the orbit from the stop, m.
    before, since : ndarray, shape (m,)
        Index of the stop's last switch, and the time since then, s.
    after, until : ndarray, shape (m,)
        Index of its next switch, and the time until then, s.
    rate, curvature, spacing : ndarray, shape (J,)
        |h'|, m/s, |h''|, m/s2, and the time to the stop's nearest other switch, s, of each switch.
    limits : tuple of float
        Share of the distance that a deviation may take; number of shifts from a switch within which nothing is asked
        for; share of the rate that it may change.

    Returns
    -------
    ndarray of bool, shape (C,)
        Whether each deviation does.
    """
    share, shifts, change = limits
    shift, sound = zeros(at_switches.shape), bool_zeros(largest.shape[1])
    for c in range(sound.size):
        sound[c] = True
    for j in range(rate.size):
        for c in range(sound.size):
            moved = abs(at_switches[j, c])
            now = 0.0 if moved == 0 else moved / rate[j]
            shift[j, c] = now
            kept = now <= spacing[j] / 3 and 3 * now * curvature[j] <= rate[j] and abs(rates[j, c]) <= change * rate[j]
            sound[c] = sound[c] and kept
    for i in range(largest.shape[0]):
        allowed = share * distance[i]
        for c in range(sound.size):
            if largest[i, c] <= allowed or not sound[c]:
                continue
            near = before[i] >= 0 and since[i] <= shifts * shift[before[i], c]
            if not near and not (after[i] >= 0 and until[i] <= shifts * shift[after[i], c]):
                sound[c] = False
    return sound
