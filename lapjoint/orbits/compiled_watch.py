"""The inner loops of the watch over an orbit, compiled: bounds on deviations, and what they are compared with."""

from __future__ import annotations

import math

import numpy as np
import numpy.typing as npt
from numba import njit

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.problem import FloatArray

IndexArray = npt.NDArray[np.intp]

_SUM = {"reassoc", "contract", "nsz"}  # lets sums be vectorised; the order of a sum changes its rounding only


@njit(cache=True)
def orbit_distances(
    segment: IndexArray,
    tau: FloatArray,
    rates: ComplexArray,
    amplitudes: ComplexArray,
    weights: ComplexArray,
    polynomial: FloatArray,
    orientation: FloatArray,
    sign: FloatArray,
    gap: FloatArray,
    place: IndexArray,
) -> tuple[FloatArray, FloatArray]:
    """Distances of an orbit from its stops, in the intervals between points.

    Parameters
    ----------
    segment, tau : ndarray, shape (I + 1,)
        Segment of each point, and time from its start, s.
    rates, amplitudes : ndarray, complex, shape (S, K)
        Terms of the motion in each segment; rates in 1/s.
    weights : ndarray, complex, shape (S, U, K)
        Weights of the terms at the ``U`` places of stops; weight times amplitude in m.
    polynomial : ndarray, shape (S, U, 3)
        Coefficients of 1, tau, tau^2 there, m over powers of s.
    orientation : ndarray, shape (S, P)
        +1 where a stop is open, -1 where it is closed.
    sign, gap : ndarray, shape (P,)
        Side of each stop, and its gap, m.
    place : ndarray, shape (P,)
        Which of the places each stop is at.

    Returns
    -------
    tuple of ndarray, shape (P, I)
        Distance at the nearer end of each interval, m, not less than 0; and by how much it may be less within, m.
    """
    stops, places, terms = sign.size, weights.shape[1], rates.shape[1]
    nearer, miss = np.zeros((stops, segment.size - 1)), np.zeros((stops, segment.size - 1))
    last, shift, now, bend = np.zeros(stops), np.zeros(stops), np.zeros(places), np.zeros(places)
    before = np.zeros(places)
    for i in range(segment.size):
        s, t = segment[i], tau[i]
        before[:] = bend
        for u in range(places):
            now[u] = polynomial[s, u, 0] + t * (polynomial[s, u, 1] + t * polynomial[s, u, 2])
            bend[u] = 2 * abs(polynomial[s, u, 2])
        for k in range(terms):
            rate = rates[s, k]
            wave = amplitudes[s, k] * np.exp(rate * t)
            square = rate.real * rate.real + rate.imag * rate.imag
            for u in range(places):
                term = weights[s, u, k] * wave
                now[u] += term.real
                bend[u] += math.sqrt(term.real * term.real + term.imag * term.imag) * square
        begins = i == 0 or segment[i - 1] != s
        for p in range(stops):
            h = orientation[s, p] * (sign[p] * now[place[p]] - gap[p])
            if begins:
                shift[p] = max(h, 0.0)
            distance = shift[p] - h
            if not begins:
                width = t - tau[i - 1]
                nearer[p, i - 1] = max(min(last[p], distance), 0.0)
                miss[p, i - 1] = before[place[p]] * width * width / 8
            last[p] = distance
    return nearer, miss


@njit(cache=True, fastmath=_SUM)
def largest_motion(
    real: FloatArray,
    imaginary: FloatArray,
    misses: FloatArray,
    parts: ComplexArray,
    drift: FloatArray,
    tau: FloatArray,
    counts: IndexArray,
    place: IndexArray,
) -> FloatArray:
    """Bounds on the motion that deviations make at the stops, in each interval.

    Parameters
    ----------
    real, imaginary : ndarray, shape (S, U, J, K)
        The terms of a deviation at the ends of the intervals of each segment, at the places of stops.
    misses : ndarray, shape (S, U, J - 1, K)
        What a chord of each term misses in an interval, over the size of its amplitude.
    parts : ndarray, complex, shape (S, K, C)
        Amplitudes of the terms of ``C`` deviations in each segment.
    drift : ndarray, shape (S, U, 2, C)
        Displacement, m, and speed, m/s, that rigid-body modes make there; of size 0 without such modes.
    tau : ndarray, shape (S, J)
        Ends of the intervals, s from the start of each segment.
    counts : ndarray, shape (S,)
        Number of intervals of each segment.
    place : ndarray, shape (P,)
        Which of the places each stop is at.

    Returns
    -------
    ndarray, shape (P, I, C)
        m; intervals in the order of time.
    """
    segments, terms, columns = parts.shape
    places, stops = real.shape[1], place.size
    result = np.empty((stops, counts.sum(), columns))
    re, im = np.ascontiguousarray(parts.real), np.ascontiguousarray(parts.imag)
    size = np.sqrt(re * re + im * im)
    last, now, bound = np.zeros(columns), np.zeros(columns), np.zeros(columns)
    first = 0
    for s in range(segments):
        for u in range(places):
            for j in range(counts[s] + 1):
                now[:] = 0.0
                for k in range(terms):
                    a, b = real[s, u, j, k], imaginary[s, u, j, k]
                    for c in range(columns):
                        now[c] += a * re[s, k, c] - b * im[s, k, c]
                if drift.size:
                    for c in range(columns):
                        now[c] += drift[s, u, 0, c] + drift[s, u, 1, c] * tau[s, j]
                if j > 0:
                    for c in range(columns):
                        bound[c] = max(abs(last[c]), abs(now[c]))
                    for k in range(terms):
                        a = misses[s, u, j - 1, k]
                        for c in range(columns):
                            bound[c] += a * size[s, k, c]
                    for p in range(stops):
                        if place[p] == u:
                            result[p, first + j - 1] = bound
                last[:] = now
        first += counts[s]
    return result


@njit(cache=True)
def all_within(
    largest: FloatArray,
    distance: FloatArray,
    shift: FloatArray,
    before: IndexArray,
    since: FloatArray,
    after: IndexArray,
    until: FloatArray,
    share: float,
    shifts: float,
) -> np.ndarray:
    """Whether deviations stay within a share of the distances, but near a stop's own switches.

    Parameters
    ----------
    largest : ndarray, shape (m, C)
        Bounds on the motion by ``C`` deviations, m.
    distance : ndarray, shape (m,)
        Distance of the orbit from the stop, m.
    shift : ndarray, shape (J, C)
        By how much they shift each switch, s.
    before, since : ndarray, shape (m,)
        Index of the stop's last switch, and the time since then, s.
    after, until : ndarray, shape (m,)
        Index of its next switch, and the time until then, s.
    share : float
        Of the distance.
    shifts : float
        So many shifts from a switch nothing is asked for.

    Returns
    -------
    ndarray of bool, shape (C,)
        Whether each deviation does.
    """
    sound = np.ones(largest.shape[1], dtype=np.bool_)
    for i in range(largest.shape[0]):
        allowed = share * distance[i]
        for c in range(sound.size):
            if largest[i, c] <= allowed or not sound[c]:
                continue
            near = before[i] >= 0 and since[i] <= shifts * shift[before[i], c]
            if not near and not (after[i] >= 0 and until[i] <= shifts * shift[after[i], c]):
                sound[c] = False
    return sound
