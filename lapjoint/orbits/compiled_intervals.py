"""Compiled cutting of an orbit into intervals: their ends, their distances from the stops, the switches beside them.

`lapjoint.orbits.watch` explains the purpose of the intervals, and the bounds within them.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.compiled.arrays import int_zeros, zeros
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

IndexArray = npt.NDArray[np.intp]
BoolArray = npt.NDArray[np.bool_]

_LEAST = 4
"""Least number of intervals into which a segment is first cut."""
_HALVINGS = 5
"""Number of times that the first and the last interval of a segment are halved, towards the switches at its ends."""
_PARTS = 8
"""Largest number of parts into which one pass divides an interval in which the bound on a distance is not tight."""
_ROUNDS = 6
"""Largest number of passes that divide intervals: 8^6 are 260 000 parts."""
_NEGLIGIBLE = 1e-9
"""Distance to a stop, divided by the largest distance to this stop, below which an interval is not divided."""
_TIGHT = 0.5
"""An interval is divided unless the least distance within it is certain to be at least this fraction of the distance at
its ends."""


@by_reference
class Motion(NamedTuple):
    """An orbit of ``S`` segments as sums of ``K`` terms at the ``U`` places of ``P`` stops."""

    start: FloatArray
    """Start of each segment, s from the start of the orbit, shape ``(S,)``."""
    duration: FloatArray
    """Duration of each segment, s, shape ``(S,)``."""
    rates: ComplexArray
    """Exponents of the terms in each segment, 1/s, shape ``(S, K)``."""
    amplitudes: ComplexArray
    """Amplitudes of the terms at the start of the segment, shape ``(S, K)``; 0 where a segment has fewer terms."""
    weights: ComplexArray
    """Weights of the terms at the places of stops, shape ``(S, U, K)``; weight times amplitude in m."""
    polynomial: FloatArray
    """Coefficients of 1, tau, tau^2 at the places, m, m/s and m/s2, shape ``(S, U, 3)``."""
    orientation: FloatArray
    """+1 where a stop is open, -1 where it is closed, 0 where it may not switch next, shape ``(S, P)``."""


@by_reference
class Stops(NamedTuple):
    """The ``P`` stops that are watched."""

    sign: FloatArray
    """+1 for a stop at the top, -1 for one at the bottom, shape ``(P,)``."""
    gap: FloatArray
    """Gap of each stop, m, shape ``(P,)``."""
    place: IndexArray
    """Index of the place of each stop, shape ``(P,)``."""
    beyond: IndexArray
    """The stop whose switches in this period are those of each stop in the next period, shape ``(P,)``: the stop itself
    or, if the orbit continues mirrored, its twin."""
    begins: IndexArray
    """The row with whose closing each row begins, and with whose opening it ends, shape ``(P,)``: of the force of a
    damped stop the stop's gap, of a gap the gap itself."""


@njit_called()
def slopes_at_switches(
    motion: Motion, stops: Stops, which: IndexArray, stop: IndexArray
) -> tuple[FloatArray, FloatArray]:
    """|h'| before each switch, m/s, and the larger |h''| of both sides of it, m/s2, shape (J,) each.

    `which` are the segments that end with a switch, and `stop` the stops that switch, shape (J,) each.
    """
    rate, curvature = zeros(which.size), zeros(which.size)
    for j in range(which.size):
        i, other = which[j] + 1, stop[j]
        if i == motion.duration.size:
            i, other = 0, stops.beyond[other]
        first, before = _derivatives(motion, which[j], stops.place[stop[j]], motion.duration[which[j]])
        _, after = _derivatives(motion, i, stops.place[other], 0.0)
        rate[j], curvature[j] = abs(first), max(abs(before), abs(after))
    return rate, curvature


@njit_inner()
def _derivatives(motion: Motion, s: int, u: int, tau: float) -> tuple[float, float]:
    """First two derivatives of z at a place, `tau` after the start of a segment, m/s and m/s2."""
    first = motion.polynomial[s, u, 1] + 2 * tau * motion.polynomial[s, u, 2]
    second = 2 * motion.polynomial[s, u, 2]
    for k in range(motion.rates.shape[1]):
        rate = motion.rates[s, k]
        wave = motion.weights[s, u, k] * motion.amplitudes[s, k] * np.exp(rate * tau) * rate
        first += wave.real
        second += (wave * rate).real
    return first, second


@njit_called()
def unrolled(
    times: FloatArray, stops: IndexArray, rows: tuple[int, int], beyond: tuple[int, int], length: float
) -> tuple[FloatArray, IndexArray]:
    """Times and indices of the switches of two rows in the previous, the present and the next period, (k,) each.

    `times`, s from the start of the orbit, ascend, and `stops` are the rows that switch, shape (J,) each.  `rows` may
    be one row twice; `beyond` are their entries of `Stops.beyond`; `length` is the length of the orbit, s.  The index
    of a switch in another period is the index of the switch that it repeats.
    """
    own, others = 0, 0
    for j in range(stops.size):
        own += stops[j] in rows
        others += stops[j] in beyond
    when, index = zeros(own + 2 * others), int_zeros(own + 2 * others)
    before, now, after = 0, others, others + own
    for j in range(stops.size):
        if stops[j] in beyond:
            when[before], index[before] = times[j] - length, j
            when[after], index[after] = times[j] + length, j
            before += 1
            after += 1
        if stops[j] in rows:
            when[now], index[now] = times[j], j
            now += 1
    return when, index


@njit_called()
def spacings(times: FloatArray, stops: IndexArray, beyond: IndexArray, length: float) -> FloatArray:
    """Time from each switch to the nearest other switch of its stop, s, (J,); inf without another.

    `times` and `stops`, (J,), and `length` are as in `unrolled`; `beyond`, (P,), is `Stops.beyond`.
    """
    result = zeros(times.size)
    for stop in range(beyond.size):
        when, index = unrolled(times, stops, (stop, stop), (beyond[stop], beyond[stop]), length)
        own = 0
        for j in range(stops.size):
            own += stops[j] == stop
        first = (when.size - own) // 2
        for i in range(first, first + own):
            before = when[i] - when[i - 1] if i > 0 else np.inf
            after = when[i + 1] - when[i] if i + 1 < when.size else np.inf
            result[index[i]] = min(before, after)
    return result


@njit_called()
def first_points(duration: FloatArray, width: float) -> tuple[IndexArray, FloatArray]:
    """Ends of equal intervals in each segment, the first and the last halved some times, (I,) each.

    `duration`, (S,), are the lengths of the segments, and `width` is the largest width of an interval, s. The answer is
    the segment of each point, and the time from its start, s.
    """
    count = int_zeros(duration.size)
    total = 0
    for s in range(duration.size):
        count[s] = max(_LEAST, math.ceil(duration[s] / width))
        total += count[s] + 1 + 2 * _HALVINGS
    segment, tau = int_zeros(total), zeros(total)
    i = 0
    for s in range(duration.size):
        step, points = duration[s] / count[s], count[s] + 1 + 2 * _HALVINGS
        for j in range(points):
            after, before = j - _HALVINGS, points - 1 - j
            if j == 0:
                tau[i] = 0.0
            elif before == 0:
                tau[i] = duration[s]
            elif after <= 0:
                tau[i] = step * 0.5 ** (1 - after)
            elif before <= _HALVINGS:
                tau[i] = duration[s] - step * 0.5 ** (_HALVINGS + 1 - before)
            else:
                tau[i] = step * after
            segment[i] = s
            i += 1
    return segment, tau


@njit_inner()
def distances(motion: Motion, stops: Stops, segment: IndexArray, tau: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Distance from stops at the nearer end of each interval, m, at least 0, and its largest decrease within, m, (P,
    I).

    `segment` and `tau`, (I + 1,), are the segment of each point and the time from its start, s.  If truncation leaves a
    stop beyond its gap at a switch, the stop switches again when it returns to this value.
    """
    count, places, terms = stops.sign.size, motion.weights.shape[1], motion.rates.shape[1]
    nearer, miss = zeros((count, segment.size - 1)), zeros((count, segment.size - 1))
    last, shift, now, bend = zeros(count), zeros(count), zeros(places), zeros(places)
    before = zeros(places)
    for i in range(segment.size):
        s, t = segment[i], tau[i]
        for u in range(places):
            first, second, third = motion.polynomial[s, u, 0], motion.polynomial[s, u, 1], motion.polynomial[s, u, 2]
            before[u], bend[u] = bend[u], 2 * abs(third)
            now[u] = first + t * (second + t * third)
        for k in range(terms):
            rate = motion.rates[s, k]
            wave = motion.amplitudes[s, k] * np.exp(rate * t)
            square = rate.real * rate.real + rate.imag * rate.imag
            for u in range(places):
                term = motion.weights[s, u, k] * wave
                now[u] += term.real
                bend[u] += math.sqrt(term.real * term.real + term.imag * term.imag) * square
        begins = i == 0 or segment[i - 1] != s
        for p in range(count):
            u = stops.place[p]
            h = motion.orientation[s, p] * (stops.sign[p] * now[u] - stops.gap[p])
            if begins:
                shift[p] = max(h, 0.0)
            distance = shift[p] - h
            if not begins:
                width = t - tau[i - 1]
                nearer[p, i - 1] = max(min(last[p], distance), 0.0)
                miss[p, i - 1] = before[u] * width * width / 8
            last[p] = distance
    return nearer, miss


@njit_called()
def refined(
    motion: Motion, stops: Stops, segment: IndexArray, tau: FloatArray
) -> tuple[IndexArray, FloatArray, FloatArray]:
    """Intervals, divided until the orbit's distance from each stop is known well enough.

    `segment` and `tau`, (N,), are the segment of each point and the time from its start, s.  The answer is the segment
    and the time of all points after the division, (I + 1,) with I + 1 >= N, and the least distance of each stop from
    its gap between two points, m, (P, I).
    """
    nearer, miss = distances(motion, stops, segment, tau)
    least = zeros(stops.sign.size)
    for p in range(least.size):
        for i in range(nearer.shape[1]):
            least[p] = max(least[p], _NEGLIGIBLE * nearer[p, i])
    for _ in range(_ROUNDS):
        parts = _parts(segment, nearer, miss, least)
        more = -parts.size
        for i in range(parts.size):
            more += parts[i]
        if more == 0:
            break
        segment, tau = _divided(segment, tau, parts, more)
        nearer, miss = distances(motion, stops, segment, tau)
    for p in range(least.size):
        for i in range(nearer.shape[1]):
            nearer[p, i] = max(nearer[p, i] - miss[p, i], 0.0)
    return segment, tau, nearer


@njit_inner()
def _parts(segment: IndexArray, nearer: FloatArray, miss: FloatArray, least: FloatArray) -> IndexArray:
    """Number of parts into which each interval is to be divided, shape ``(I,)``.

    The error of a chord falls with the square of the width.  Distances up to `least`, ``(P,)``, do not count.
    """
    parts = int_zeros(segment.size - 1)
    for i in range(parts.size):
        parts[i] = 1
    for p in range(least.size):
        for i in range(parts.size):
            if segment[i] == segment[i + 1] and nearer[p, i] > least[p]:
                wanted = math.sqrt(miss[p, i] / max((1 - _TIGHT) * nearer[p, i], 1e-300))
                parts[i] = max(parts[i], math.ceil(min(wanted, _PARTS)))
    return parts


@njit_inner()
def _divided(segment: IndexArray, tau: FloatArray, parts: IndexArray, more: int) -> tuple[IndexArray, FloatArray]:
    """Segments and times of the points after the intervals are divided into equal parts; `more` points are added in
    all."""
    where, when = int_zeros(segment.size + more), zeros(segment.size + more)
    j = 0
    for i in range(segment.size):
        where[j], when[j] = segment[i], tau[i]
        j += 1
        if i < parts.size:
            for k in range(1, parts[i]):
                where[j], when[j] = segment[i], tau[i] + k / parts[i] * (tau[i + 1] - tau[i])
                j += 1
    return where, when


@njit_called()
def among_switches(
    start: FloatArray, end: FloatArray, times: FloatArray, which: IndexArray, stops: Stops, length: float
) -> tuple[IndexArray, FloatArray, IndexArray, FloatArray]:
    """Index of a row's last switch before each interval (-1 without), time since it, s (inf without); then of the
    next; (P, I).

    `start` and `end`, (I,), of the intervals ascend, s from the start of the orbit.  `times` and `which`, (J,), are the
    times of all switches, s, and their rows; `length` is the length of the orbit, s.  The switches with which a row
    begins and ends count as its own, see `Stops.begins`.
    """
    begins, beyond = stops.begins, stops.beyond
    shape = (beyond.size, start.size)
    before, after = int_zeros(shape), int_zeros(shape)
    since, until = zeros(shape), zeros(shape)
    tiny = 1e-12 * length  # an end of an interval that is a switch has the time of the switch up to rounding
    for stop in range(beyond.size):
        rows = stop, begins[stop]
        when, index = unrolled(times, which, rows, (beyond[rows[0]], beyond[rows[1]]), length)
        at = 0
        for i in range(start.size):
            while at < when.size and when[at] < 0.5 * (start[i] + end[i]):
                at += 1
            before[stop, i], since[stop, i], after[stop, i], until[stop, i] = -1, np.inf, -1, np.inf
            if at > 0:
                gone = start[i] - when[at - 1]
                before[stop, i], since[stop, i] = index[at - 1], gone if gone > tiny else 0.0
            if at < when.size:
                left = when[at] - end[i]
                after[stop, i], until[stop, i] = index[at], left if left > tiny else 0.0
    return before, since, after, until
