r"""How near an orbit comes to every stop, and how near deviations from it do: at every phase, not at samples only.

Along an orbit each stop has a distance |h_s(t)| from its gap, zero where it switches.  A deviation e at the start moves
the beam at the stop by d_s(t) = D_s(t) e.  Time is cut into intervals; in each

    |h_s| >= min over both ends - H w^2 / 8,      |d_s| <= max over both ends + sum_k |a_k| min(|r_k|^2 w^2 / 8, 2)

with w the width, H a bound on |h_s''|, and a_k exp(r_k t) the terms of d_s: no term grows, a chord misses a function by
at most w^2 / 8 of its second derivative, and no term by more than twice its size.  Intervals are made narrower where
the first bound would not be tight, and towards the switches, where h vanishes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from lapjoint.orbits.compiled_watch import IndexArray, largest_motion, orbit_distances
from lapjoint.orbits.period_map import Segment
from lapjoint.problem import FloatArray, Problem

_PER_HALF_PERIOD = 16
"""Least number of intervals of equal width in half a period, to begin with."""
_LEAST = 4
"""Least number of intervals in a segment, to begin with."""
_HALVINGS = 5
"""How often the first and the last interval of a segment are halved, towards the switch at its end."""
_PARTS = 8
"""Most parts that an interval is divided into at once, where the distance to a stop is not known well enough."""
_ROUNDS = 6
"""How often, at most, intervals are so divided: to a 260 000th of their width."""
_NEGLIGIBLE = 1e-9
"""Distance to a stop over its largest, up to which no interval is divided."""
_TIGHT = 0.5
"""Share of the distance at the ends of an interval that must be certain within it, or else it is divided."""


@dataclass(frozen=True)
class Switches:
    """The ``J`` switches of an orbit, by time."""

    time: FloatArray
    """Times, s from the start of the orbit, shape ``(J,)``."""
    stop: IndexArray
    """The stops that switch, shape ``(J,)``."""
    rate: FloatArray
    """|h'| before the switch, m/s, shape ``(J,)``."""
    curvature: FloatArray
    """Largest |h''| on both sides of the switch, m/s2, shape ``(J,)``."""
    spacing: FloatArray
    """Time to the nearest other switch of the same stop, before or after, s, shape ``(J,)``; inf if there is none."""


@dataclass(frozen=True)
class Intervals:
    """``m`` pairs of a stop and an interval of time."""

    stop: IndexArray
    """The stops, shape ``(m,)``."""
    distance: FloatArray
    """Least distance of the stop from its gap, m, shape ``(m,)``."""
    before: IndexArray
    """The last switch of the same stop, as an index into `Switches`, shape ``(m,)``; -1 if there is none."""
    since: FloatArray
    """Time from that switch to the start of the interval, s, shape ``(m,)``; inf if there is none."""
    after: IndexArray
    """The next switch of the same stop, as an index into `Switches`, shape ``(m,)``; -1 if there is none."""
    until: FloatArray
    """Time from the end of the interval to that switch, s, shape ``(m,)``; inf if there is none."""


@dataclass(frozen=True)
class Deviated:
    """What ``K`` deviations come to."""

    largest: FloatArray
    """Bound on their motion at the stop in each interval, m, shape ``(m, K)``."""
    at_switches: FloatArray
    """Motion at the stop that switches, when it does, m, shape ``(J, K)``."""
    rates: FloatArray
    """Its rate just before the switch, m/s, shape ``(J, K)``."""


class Watch(Protocol):
    """An orbit's distances from all stops, and those of deviations from it."""

    @property
    def switches(self) -> Switches:
        """Its switches."""

    @property
    def intervals(self) -> Intervals:
        """Pairs of a stop and an interval, for all stops and all its intervals."""

    def deviated(self, deviations: FloatArray) -> Deviated:
        """What deviations come to along the orbit.

        Parameters
        ----------
        deviations : FloatArray, shape (n, K)
            Deviations at the start of the orbit as columns, in the coordinates that belong to its section point.

        Returns
        -------
        Deviated
            Their motion at the stops, in all intervals and at all switches.
        """


class SegmentWatch:
    """The watch over an orbit whose segments are known in closed form.

    Parameters
    ----------
    problem : Problem
        The problem whose stops are watched.
    segments : tuple of Segment
        The orbit.
    twins : tuple of int, or None
        The twin of each stop on the other side, if the orbit goes on mirrored after the last segment.
    """

    def __init__(self, problem: Problem, segments: tuple[Segment, ...], twins: tuple[int, ...] | None) -> None:
        assert problem.excitation_frequency is not None
        self._segments = segments
        self._sign = np.array([stop.sign for stop in problem.stops], dtype=float)
        self._gap = np.array([stop.gap for stop in problem.stops], dtype=float)
        x = np.array([stop.x for stop in problem.stops])
        _, self._first, self._place = np.unique(x, return_index=True, return_inverse=True)
        self._stack = _Stack(segments)
        self.switches = self._switches(twins)
        segment, tau = self._first_points(math.pi / problem.excitation_frequency / _PER_HALF_PERIOD)
        distance, miss = self._distances(segment, tau)
        least = _NEGLIGIBLE * distance.max(axis=1, initial=0.0, keepdims=True)
        for _ in range(_ROUNDS):
            inside = segment[:-1] == segment[1:]
            # A chord of a part of the width misses by the square of that part.
            parts = np.sqrt(miss / np.maximum((1 - _TIGHT) * distance, 1e-300))
            parts = np.where(inside & (distance > least), np.ceil(np.minimum(parts, _PARTS)), 1).max(axis=0, initial=1)
            poor = np.flatnonzero(parts > 1)
            if not poor.size:
                break
            tau, segment = _divided(tau, segment, poor, parts[poor].astype(int))
            distance, miss = self._distances(segment, tau)
        inside = segment[:-1] == segment[1:]
        start = np.array([one.start for one in segments])[segment] + tau
        sure = np.maximum(distance - miss, 0.0)[:, inside]
        self.intervals = intervals_of(
            self.switches, start[:-1][inside], start[1:][inside], sure, segments[-1].end, twins
        )
        self._cut(segment, tau)

    def deviated(self, deviations: FloatArray) -> Deviated:
        """See `Watch`."""
        count, places, (segments, terms, n) = deviations.shape[1], self._first.size, self._rows.shape
        parts = np.asarray(self._rows.reshape(segments * terms, n) @ deviations, dtype=complex)
        parts = parts.reshape(segments, terms, count)
        values = self._at_switches @ parts[self._switching]
        at_switches, rates = values.real[:, 0], values.real[:, 1]
        drift: FloatArray = np.zeros((0, 0, 2, count))
        if self._drift is not None:
            drift = (self._drift.reshape(segments * places * 2, n) @ deviations).reshape(segments, places, 2, count)
            own = drift[self._switching, self._place[self.switches.stop]]
            at_switches = at_switches + own[:, 0] + own[:, 1] * self._durations[self._switching, None]
            rates = rates + own[:, 1]
        cut = self._real, self._imaginary, self._misses
        largest = largest_motion(*cut, parts, drift, self._tau, self._counts, self._place)
        return Deviated(largest.reshape(self.intervals.stop.size, count), at_switches, rates)

    def _first_points(self, width: float) -> tuple[IndexArray, FloatArray]:
        """Segments and times from their starts, s, of the ends of all intervals, shape ``(points,)`` each."""
        which, times = [], []
        for i, segment in enumerate(self._segments):
            duration = segment.end - segment.start
            count = max(_LEAST, math.ceil(duration / width))
            grid = duration / count * np.arange(count + 1.0)
            ends = grid[1] * 0.5 ** np.arange(_HALVINGS, 0, -1.0)
            grid = np.concatenate([grid[:1], ends, grid[1:-1], (duration - ends)[::-1], [duration]])
            which.append(np.full(grid.size, i, dtype=np.intp))
            times.append(grid)
        return np.concatenate(which), np.concatenate(times)

    def _distances(self, segment: IndexArray, tau: FloatArray) -> tuple[FloatArray, FloatArray]:
        """Distances at the nearer end of each interval, and by what they may be less within, m, ``(P, points - 1)``.

        A stop that truncation leaves beyond its gap at a switch switches again when it comes back to where it was left.
        """
        it = self._stack
        return orbit_distances(
            segment,
            tau,
            it.rates,
            it.amplitudes,
            it.weights[:, self._first],
            it.polynomial[:, self._first],
            it.orientation,
            self._sign,
            self._gap,
            self._place,
        )

    def _cut(self, segment: IndexArray, tau: FloatArray) -> None:
        """Set up the terms of deviations at the ends of all intervals; all segments get equally many intervals."""
        segments = self._segments
        first = np.searchsorted(segment, np.arange(len(segments) + 1))
        most = int(np.diff(first).max())
        column = np.minimum(first[:-1, None] + np.arange(most), first[1:, None] - 1)
        self._tau = tau[column]
        self._counts = np.diff(first) - 1
        self._durations = np.array([one.end - one.start for one in segments])
        terms, n = max(one.deviations.shape[0] for one in segments), segments[0].deviations.shape[1]
        self._rows = np.zeros((len(segments), terms, n), dtype=complex)
        rates = np.zeros((len(segments), terms), dtype=complex)
        weights = np.zeros((len(segments), self._first.size, terms), dtype=complex)
        for i, one in enumerate(segments):
            size = one.deviations.shape[0]
            self._rows[i, :size], rates[i, :size] = one.deviations, one.rates[:size]
            weights[i, :, :size] = one.weights[self._first, :size]
        drifts = any(one.drift.any() for one in segments)
        self._drift = np.array([one.drift[self._first] for one in segments]) if drifts else None
        waves = np.exp(rates[:, None] * self._tau[:, :, None])
        phases = weights[:, :, None] * waves[:, None]
        self._real, self._imaginary = np.ascontiguousarray(phases.real), np.ascontiguousarray(phases.imag)
        bends = (rates.real**2 + rates.imag**2)[:, None] * (np.diff(self._tau) ** 2 / 8)[:, :, None]
        miss = np.minimum(bends, 2.0) * np.abs(waves[:, :-1])
        self._misses = np.abs(weights)[:, :, None] * miss[:, None]
        self._switching = np.array([i for i, one in enumerate(segments) if one.switched >= 0], dtype=np.intp)
        own = (
            weights[self._switching, self._place[self.switches.stop]]
            * np.exp(rates * self._durations[:, None])[self._switching]
        )
        self._at_switches = np.stack([own, own * rates[self._switching]], axis=1)

    def _switches(self, twins: tuple[int, ...] | None) -> Switches:
        segments, it = self._segments, self._stack
        last = len(segments) - 1
        which = np.array([i for i, segment in enumerate(segments) if segment.switched >= 0], dtype=np.intp)
        stop = np.array([segments[i].switched for i in which], dtype=np.intp)
        time = np.array([segments[i].end for i in which])
        rate, before = it.derivatives(which, stop, time - np.array([segments[i].start for i in which]))
        other = stop if twins is None else np.where(which == last, np.array(twins, dtype=np.intp)[stop], stop)
        _, after = it.derivatives(np.where(which == last, 0, which + 1), other, np.zeros(which.size))
        apart = spacings(time, stop, segments[-1].end, twins)
        return Switches(time, stop, np.abs(rate), np.maximum(np.abs(before), np.abs(after)), apart)


def _divided(
    tau: FloatArray, segment: IndexArray, poor: IndexArray, parts: IndexArray
) -> tuple[FloatArray, IndexArray]:
    """Ends of intervals of which the `poor` ones are divided into equal parts."""
    where = np.repeat(poor, parts - 1)
    number = np.concatenate([np.arange(1, count) / count for count in parts])
    return (
        np.insert(tau, where + 1, tau[where] + number * (tau[where + 1] - tau[where])),
        np.insert(segment, where + 1, segment[where]),
    )


class _Stack:
    """Segments as arrays with the segment first, padded with terms of no size."""

    def __init__(self, segments: tuple[Segment, ...]) -> None:
        count, stops = len(segments), segments[0].closed.size
        terms = max(segment.rates.size for segment in segments)
        self.rates = np.zeros((count, terms), dtype=complex)
        self.amplitudes = np.zeros((count, terms), dtype=complex)
        self.weights = np.zeros((count, stops, terms), dtype=complex)
        for i, segment in enumerate(segments):
            n = segment.rates.size
            self.rates[i, :n] = segment.rates
            self.amplitudes[i, :n] = segment.amplitudes
            self.weights[i, :, :n] = segment.weights
        self.polynomial = np.array([segment.polynomial for segment in segments])
        self.orientation = np.where([segment.closed for segment in segments], -1.0, 1.0)

    def derivatives(self, which: IndexArray, stop: IndexArray, tau: FloatArray) -> tuple[FloatArray, FloatArray]:
        """First two derivatives of z at stops, `tau` after the starts of segments, shape ``(J,)`` each."""
        rates, p = self.rates[which], self.polynomial[which, stop]
        waves = self.weights[which, stop] * self.amplitudes[which] * np.exp(rates * tau[:, None])
        z1, z2 = ((waves * rates**order).sum(axis=1).real for order in (1, 2))
        return z1 + p[:, 1] + 2 * tau * p[:, 2], z2 + 2 * p[:, 2]


def unrolled(
    times: FloatArray, stops: IndexArray, stop: int, duration: float, twins: tuple[int, ...] | None
) -> tuple[FloatArray, IndexArray]:
    """Switches of one stop in the period before, in this one, and in the one after.

    Where the orbit goes on mirrored, the periods before and after hold the switches of the twin.

    Parameters
    ----------
    times : FloatArray, shape (J,)
        Times of all switches of the orbit, s from its start, ascending.
    stops : IndexArray, shape (J,)
        The stops that switch.
    stop : int
        The stop whose switches are asked for.
    duration : float
        Length of the orbit, s.
    twins : tuple of int, or None
        The twin of each stop, if the orbit goes on mirrored.

    Returns
    -------
    times : FloatArray, shape (k,)
        Times of the switches, s from the start of the orbit, ascending.
    indices : IndexArray, shape (k,)
        Which of the J switches each is, or repeats.
    """
    twin = stop if twins is None else twins[stop]
    own, other = np.flatnonzero(stops == stop), np.flatnonzero(stops == twin)
    return (
        np.concatenate([times[other] - duration, times[own], times[other] + duration]),
        np.concatenate([other, own, other]),
    )


def spacings(times: FloatArray, stops: IndexArray, duration: float, twins: tuple[int, ...] | None) -> FloatArray:
    """Time from each switch to the nearest other one of the same stop, before or after.

    Parameters
    ----------
    times : FloatArray, shape (J,)
        Times of all switches of the orbit, s from its start, ascending.
    stops : IndexArray, shape (J,)
        The stops that switch.
    duration : float
        Length of the orbit, s.
    twins : tuple of int, or None
        The twin of each stop, if the orbit goes on mirrored.

    Returns
    -------
    FloatArray, shape (J,)
        Times, s.
    """
    result = np.full(times.size, np.inf)
    for stop in set(stops.tolist()):
        own = np.flatnonzero(stops == stop)
        all_times, _ = unrolled(times, stops, stop, duration, twins)
        steps = np.concatenate([[np.inf], np.diff(all_times), [np.inf]])
        at = (all_times.size - own.size) // 2 + np.arange(own.size)
        result[own] = np.minimum(steps[at], steps[at + 1])
    return result


def intervals_of(
    switches: Switches,
    start: FloatArray,
    end: FloatArray,
    distance: FloatArray,
    duration: float,
    twins: tuple[int, ...] | None,
) -> Intervals:
    """Intervals with their position among the switches.

    Parameters
    ----------
    switches : Switches
        The switches of the orbit.
    start, end : FloatArray, shape (I,)
        Start and end of each interval, s from the start of the orbit.
    distance : FloatArray, shape (P, I)
        Least distance of each stop from its gap in each interval, m.
    duration : float
        Length of the orbit, s.
    twins : tuple of int, or None
        The twin of each stop, if the orbit goes on mirrored.

    Returns
    -------
    Intervals
        All P I pairs of a stop and an interval, stop by stop.
    """
    stops, count = distance.shape
    before, after = np.full((2, stops, count), -1, dtype=np.intp)
    since, until = np.full((2, stops, count), np.inf)
    middle = 0.5 * (start + end)
    for stop in range(stops):
        times, index = unrolled(switches.time, switches.stop, stop, duration, twins)
        if times.size:  # then some lie in the period before, and some in the one after
            at = np.searchsorted(times, middle)
            known = at > 0
            last, following = np.maximum(at - 1, 0), np.minimum(at, times.size - 1)
            before[stop], since[stop] = np.where(known, index[last], -1), np.where(known, start - times[last], np.inf)
            known = at < times.size
            after[stop] = np.where(known, index[following], -1)
            until[stop] = np.where(known, times[following] - end, np.inf)
    tiny = 1e-12 * duration  # ends of intervals that are switches are so to rounding
    return Intervals(
        stop=np.repeat(np.arange(stops), count),
        distance=distance.ravel(),
        before=before.ravel(),
        since=np.where(since <= tiny, 0.0, since).ravel(),
        after=after.ravel(),
        until=np.where(until <= tiny, 0.0, until).ravel(),
    )
