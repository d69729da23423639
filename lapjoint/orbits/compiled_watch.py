"""Bounds on deviations from an orbit, and their comparison with the distances of stops; see `lapjoint.orbits.watch`."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.compiled.arrays import bool_zeros, zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.orbits.compiled_intervals import BoolArray, IndexArray
from lapjoint.problem import FloatArray


@njit_called()
def terms_at_points(
    segment: IndexArray,
    tau: FloatArray,
    rates: ComplexArray,
    weights: ComplexArray,
    watched: BoolArray,
    count: int,
) -> tuple[FloatArray, FloatArray]:
    """The terms of deviations at the points between intervals, and the error of a chord of each term.

    `segment` and `tau`, (I + 1,), are the segment of each point and the time from its start, s.  `rates`, (S, K'), are
    the exponents of the terms, 1/s, and `weights`, (S, U, K'), their weights at the places of stops; deviations have
    the first ``K = count <= K'``.  `watched`, (S, U), says whether a stop there may switch in each segment: all else is
    0.  The answer is the real and the imaginary part of each term of unit amplitude, (2, U,
    I + 1, K), and the largest error of its chord between two points, divided by its amplitude, (U, I, K).
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
                if not watched[s, u]:
                    continue
                weight = weights[s, u, k]
                term = weight * wave
                terms[0, u, i, k], terms[1, u, i, k] = term.real, term.imag
                if i + 1 < tau.size:
                    misses[u, i, k] = bend * abs(wave) * abs(weight)
    return terms, misses


@njit_called(vectorised=True)
def largest_motion(
    segment: IndexArray,
    tau: FloatArray,
    terms: FloatArray,
    misses: FloatArray,
    amplitudes: FloatArray,
    drift: FloatArray,
    watched: BoolArray,
    place: IndexArray,
    result: FloatArray,
) -> None:
    """Write bounds on the motion that ``C`` deviations make at the stops in each interval to `result`, (P, I, C), m.

    `segment`, `tau` and `watched` are arguments of `terms_at_points`, and `terms` and `misses` its results.
    `amplitudes`, (2, S, K, C), are real and imaginary parts of the amplitudes in each segment.  `drift`, (S, U, 2, C),
    is the displacement, m, and speed, m/s, of rigid-body modes; without such modes it is empty.  `place`, (P,), is the
    place of each stop.
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
            for k in range(count if watched[s, u] else 0):
                a, b = terms[0, u, i, k], terms[1, u, i, k]
                for c in range(columns):
                    now[c] += a * amplitudes[0, s, k, c] - b * amplitudes[1, s, k, c]
            if drift.size and watched[s, u]:
                for c in range(columns):
                    now[c] += drift[s, u, 0, c] + drift[s, u, 1, c] * tau[i]
            if i == 0 or segment[i - 1] != s:
                continue
            j += 1
            for c in range(columns):
                bound[c] = max(abs(last[c]), abs(now[c]))
            for k in range(count if watched[s, u] else 0):
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
    """Whether each of ``C`` deviations meets all conditions of `lapjoint.orbits.approach`, shape (C,).

    `largest`, (m, C), bounds the motion by the deviations, m; `at_switches` and `rates`, (J, C), are their motion at
    the stop that switches, m, and its rate, m/s.  `distance`, `before`, `since`, `after` and `until`, (m,), are the
    fields of `Intervals`; `rate`, `curvature` and `spacing`, (J,), those of `Switches`.  `limits` are the fraction of
    the distance that a deviation may reach; the number of shifts from a switch within which the distance does not
    matter; and the fraction of the rate by which a deviation may change it.
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
