r"""Bounds on the distances of an orbit from all stops, and on the motion of deviations there, at every phase.

Along an orbit the beam has a distance |h_s(t)| from the gap of each stop s, zero where the stop switches.  A deviation
e at the start moves the beam at the stop by d_s(t) = D_s(t) e.  Time is cut into intervals; in each

    |h_s| >= min over both ends - H w^2 / 8,      |d_s| <= max over both ends + sum_k |a_k| min(|r_k|^2 w^2 / 8, 2)

where w is the width of the interval, H a bound on |h_s''|, and a_k exp(r_k t) are the terms of d_s, of which none
grows.  The reason is that the error of a chord is at most w^2 / 8 times the second derivative of the function, and for
a term at most twice its size.  Intervals are narrower where the first bound would not be tight, and towards the
switches, where h vanishes.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from lapjoint.compiled.by_reference import in_c_order
from lapjoint.orbits.compiled_intervals import (
    BoolArray,
    IndexArray,
    Motion,
    Stops,
    among_switches,
    first_points,
    refined,
    slopes_at_switches,
    spacings,
)
from lapjoint.orbits.compiled_watch import largest_motion, terms_at_points
from lapjoint.orbits.segments import Segment, Segments
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.supports_and_stops import PlacedStop

_PER_HALF_PERIOD = 16
"""Least number of intervals in half a period of the fastest excitation, before intervals are divided."""


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
    """The last switch of the same stop, as an index into `Switches`, shape ``(m,)``; -1 if there is none.  The force of
    a damped stop switches with the stop's gap, too; see `compiled_intervals.Stops.begins`."""
    since: FloatArray
    """Time from the last switch to the start of the interval, s, shape ``(m,)``; inf if there is none."""
    after: IndexArray
    """The next switch of the same stop, as an index into `Switches`, shape ``(m,)``; -1 if there is none."""
    until: FloatArray
    """Time from the end of the interval to the next switch, s, shape ``(m,)``; inf if there is none."""


@dataclass(frozen=True)
class Deviated:
    """The motion of ``K`` deviations along an orbit."""

    largest: FloatArray
    """Bound on the motion at the stop in each interval, m, shape ``(m, K)``."""
    at_switches: FloatArray
    """Motion at the stop that switches, at the switch, m, shape ``(J, K)``."""
    rates: FloatArray
    """Rate of `at_switches` just before the switch, m/s, shape ``(J, K)``."""


class Watch(Protocol):
    """An orbit's distances from all stops, and the motion of deviations there."""

    @property
    def switches(self) -> Switches:
        """The switches of the orbit."""

    @property
    def intervals(self) -> Intervals:
        """Pairs of a stop and an interval, for all stops and all intervals."""

    def deviated(self, deviations: FloatArray) -> Deviated:
        """The motion along the orbit of deviations, (n, K), columns in the coordinates of the orbit's section point."""


def stops_of(stops: Sequence[PlacedStop], twins: Sequence[int] | None = None) -> Stops:
    """The arrays of stops for compiled functions, with the twin of each stop if the motion continues mirrored; places
    ascend."""
    places = sorted({stop.place for stop in stops})
    return Stops(
        sign=np.array([stop.sign for stop in stops], dtype=float),
        gap=np.array([stop.gap for stop in stops], dtype=float),
        place=np.array([places.index(stop.place) for stop in stops], dtype=np.intp),
        beyond=np.arange(len(stops)) if twins is None else np.array(twins, dtype=np.intp),
        begins=np.arange(len(stops)),
    )


def rows_of(stops: Sequence[PlacedStop], twins: Sequence[int] | None = None) -> Stops:
    """The rows of segments: the stops, and then the force of each damped stop, which ends at a place of its own.

    The force of a damped stop is k times its penetration at a place that moves by z + (c / k) z'.
    """
    own, damped = stops_of(stops, twins), np.flatnonzero([stop.damping > 0 for stop in stops])
    if not damped.size:
        return own
    places = int(own.place.max()) + 1
    return Stops(
        sign=np.concatenate([own.sign, own.sign[damped]]),
        gap=np.concatenate([own.gap, own.gap[damped]]),
        place=np.concatenate([own.place, places + np.arange(damped.size)]),
        beyond=np.concatenate([own.beyond, own.beyond.size + np.searchsorted(damped, own.beyond[damped])]),
        begins=np.concatenate([own.begins, damped]),
    )


def row_of(stops: Sequence[PlacedStop], switch: int) -> int:
    """The row of `rows_of` of a switch k of a stop, or ~k of its force; see `ContactState.toggled`."""
    return switch if switch >= 0 else len(stops) + sum(stop.damping > 0 for stop in stops[:~switch])


def switches_of(stops: Sequence[PlacedStop]) -> IndexArray:
    """The switch of each row of `rows_of`, as `ContactState.toggled` takes it, shape ``(P,)``."""
    damped = np.flatnonzero([stop.damping > 0 for stop in stops])
    return np.concatenate([np.arange(len(stops)), ~damped])


def awake_rows(stops: Sequence[PlacedStop], closed: BoolArray) -> BoolArray:
    """Which rows may switch next, shape ``(S, P)``: a damped stop's force ends or begins while the stop is closed.

    `closed`, ``(S, P)``, says which rows are closed.
    """
    awake = np.ones(closed.shape, dtype=np.bool_)
    for row, k in enumerate((k for k, stop in enumerate(stops) if stop.damping > 0), start=len(stops)):
        awake[:, row] = closed[:, k] & (not stops[k].may_pull)
    return awake


class SegmentWatch:
    """The watch over an orbit with segments in closed form; with `twins` the orbit continues mirrored."""

    def __init__(self, problem: Problem, segments: Sequence[Segment], twins: tuple[int, ...] | None) -> None:
        assert problem.forces.fastest > 0
        segments = Segments.of(segments)
        stops, awake = rows_of(problem.structure.stops, twins), awake_rows(problem.structure.stops, segments.closed)
        self._place = stops.place
        first = np.unique(stops.place, return_index=True)[1]
        self._watched = np.zeros((awake.shape[0], first.size), dtype=np.bool_)
        for row, place in enumerate(stops.place.tolist()):
            self._watched[:, place] |= awake[:, row]
        motion, length = motion_at(segments, first, awake), float(segments.end[-1])
        self._switching = np.flatnonzero(segments.switched >= 0)
        stop, time = segments.switched[self._switching], segments.end[self._switching]
        rate, curvature = slopes_at_switches(motion, stops, self._switching, stop)
        self.switches = Switches(time, stop, rate, curvature, spacings(time, stop, stops.beyond, length))
        points = first_points(motion.duration, math.pi / problem.forces.fastest / _PER_HALF_PERIOD)
        self.segment, self.tau, distance = refined(motion, stops, *points)
        distance[~awake.T[:, self.segment[:-1]]] = np.inf
        self.intervals = self._intervals(motion, stops, distance, length)
        self._set_up_deviations(segments, first, motion)

    def deviated(self, deviations: FloatArray) -> Deviated:
        """See `Watch`."""
        (segments, places, terms), count = self._shape, deviations.shape[1]
        amplitudes = (self._rows @ deviations).reshape(2, segments, terms, count)
        largest = np.empty((self._place.size, self._intervals_in_time, count))
        drift: FloatArray = np.zeros((0, 0, 2, count))
        if self._drift is not None:
            drift = (self._drift @ deviations).reshape(segments, places, 2, count)
        points = self.segment, self.tau, self._terms, self._misses
        largest_motion(*points, amplitudes, drift, self._watched, self._place, largest)
        own = amplitudes[:, self._switching].transpose(1, 0, 2, 3).reshape(self._durations.size, 2 * terms, count)
        at_switches, rates = (self._at_switches @ own)[:, :, 0]
        if self._drift is not None:
            own = drift[self._switching, self._place[self.switches.stop]]
            at_switches = at_switches + own[:, 0] + own[:, 1] * self._durations[:, None]
            rates = rates + own[:, 1]
        return Deviated(largest.reshape(self.intervals.stop.size, count), at_switches, rates)

    def _intervals(self, motion: Motion, stops: Stops, distance: FloatArray, length: float) -> Intervals:
        """The intervals between points of one segment, with their distances and the switches beside them."""
        inside = self.segment[:-1] == self.segment[1:]
        time = motion.start[self.segment] + self.tau
        start, end, switches = time[:-1][inside], time[1:][inside], self.switches
        before, since, after, until = among_switches(start, end, switches.time, switches.stop, stops, length)
        self._intervals_in_time = start.size
        return Intervals(
            stop=np.repeat(np.arange(stops.sign.size), start.size),
            distance=distance[:, inside].ravel(),
            before=before.ravel(),
            since=since.ravel(),
            after=after.ravel(),
            until=until.ravel(),
        )

    def _set_up_deviations(self, segments: Segments, first: IndexArray, motion: Motion) -> None:
        """Rows that give the amplitudes of deviations, and their terms at all points and at all switches."""
        count, terms, n = segments.deviations.shape
        rows = np.array([segments.deviations.real, segments.deviations.imag])
        self._shape, self._rows = (count, first.size, terms), rows.reshape(-1, n)
        self._drift = segments.drift[:, first].reshape(-1, n) if segments.drift.any() else None
        where = self.segment, self.tau, motion.rates, motion.weights, self._watched
        self._terms, self._misses = terms_at_points(*where, terms)
        rates, weights = motion.rates[:, :terms], motion.weights[:, :, :terms]
        at, self._durations = self._switching, motion.duration[self._switching]
        own = weights[at, self._place[self.switches.stop]] * np.exp(rates[at] * self._durations[:, None])
        both = np.stack([own, own * rates[at]])[:, :, None]
        self._at_switches = np.concatenate([both.real, -both.imag], axis=3)


def motion_at(segments: Segments, first: IndexArray, awake: BoolArray | None = None) -> Motion:
    """Segments as compiled functions take them, at the places of the stops with the indices `first`, shape (U,).

    `awake` is that of `awake_rows`; by default every stop may switch.
    """
    made = Motion(
        start=segments.start,
        duration=segments.end - segments.start,
        rates=segments.rates,
        amplitudes=segments.amplitudes,
        weights=segments.weights[:, first],
        polynomial=segments.polynomial[:, first],
        orientation=np.where(segments.closed, -1.0, 1.0) * (1.0 if awake is None else awake),
    )
    return in_c_order(made)
