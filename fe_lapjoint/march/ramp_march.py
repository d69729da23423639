"""A march along ramps from knot to knot, up to the first switch of a stop.

Sampled forces are linear between their sample times, the knots; a ramp is the force from one knot to the next.  On
every interval the gap functions are bounded as in `fe_lapjoint.march.events`: by a chord where both ends are known, and
by the tangent where it begins.  An interval that neither bound clears of switches is halved, up to `_HALVINGS` times.
The compiled march stops at an interval that may still hold a switch, which `fe_lapjoint.march.events` then searches:
see `follow`.

Arrays are named as in `fe_lapjoint.march.ramp_interval`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple

import numpy as np

from fe_lapjoint.march.compiled import above_troughs
from fe_lapjoint.march.envelope import Envelope
from fe_lapjoint.march.events import CONTINUOUS, SURE, BoolArray, in_python
from fe_lapjoint.march.ramp_interval import (
    Interval,
    Knots,
    RampTables,
    areas_of,
    begin_interval,
    knots_of,
    move,
    moved,
    new_interval,
    place_at,
    places_at,
    ramp_tables,
    state_at,
    waves_of,
)
from fe_lapjoint.march.system import ComplexArray, System
from lapjoint.compiled.arrays import complex_zeros, int_zeros, put, zeros
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

LONGEST = 64
"""Most closed forms, one for each knot or window, in a piece of the motion.  A piece keeps its start alone, and is
marched again when it is evaluated."""
_HALVINGS = 6
"""Halvings of an interval before it is searched: 64 parts of a window, about as many as the steps of a window without
ramps."""
_ROUNDINGS = 1e-15
"""As a fraction of the time: rounding may change the distance between two knots by this much from the usual spacing."""
_RELATIVE = 1e-12
"""Relative error of the deepest penetration; a maximum is flat, so its time is known to 1e-6."""
_DEEP = 48
"""Most halvings of an interval in the search for the deepest penetration: more than reach its last digit."""
_NEWTON = 30
"""Most steps of Newton's method in the search for a maximum."""
_EPS = float(np.finfo(float).eps)
_CLEAR, _UNCLEAR, _RISING = 0, 1, 2
"""No switch; perhaps a switch; one switch, on a gap function that rises all the way."""


@by_reference
class Watch(NamedTuple):
    """The state of the search for switches of ``P`` stops in a march; all but `fresh` is changed in place.

    The unclear part is the part of an interval in which bounds do not exclude a switch.
    """

    fresh: BoolArray
    """Whether each stop may have switched where the march begins, shape ``(P,)``."""
    shift: FloatArray
    """Height of each gap function above 0 where the state was entered, m, shape ``(P,)``; 0 once it has been below
    0."""
    before: FloatArray
    """Rounding error of each gap function in the previous interval, m, shape ``(P,)``."""
    level: FloatArray
    """Level that each gap function must exceed for its stop to switch, m, shape ``(P,)``."""
    held: BoolArray
    """Whether each stop has just switched where the unclear part begins, shape ``(P,)``."""
    unclear: BoolArray
    """Whether each stop may switch in the unclear part, shape ``(P,)``."""
    ends: FloatArray
    """Gap function, m, and its rate, m/s, at the beginning of the unclear part, then at its end; shape ``(P, 4)``."""


@njit_inner()
def interval_of(knots: Knots, t: float) -> int:
    """Index j, 0 to K - 2, of the ramp at time `t`, s; at a knot the later ramp; outside all knots the nearest."""
    return min(max(int(np.searchsorted(knots.time, t, side="right")) - 1, 0), knots.time.size - 2)


@njit_inner()
def _next(tables: RampTables, knots: Knots, j: int, t: float, end: float) -> tuple[float, float, int]:
    """Time, s, up to which a closed form is followed, its length, s, and the index of the ramp where the next one
    begins."""
    knot = knots.time[j + 1] if j < knots.time.size - 2 else np.inf
    until = min(knot, end, t + tables.window)
    width = until - t
    usual = abs(width - tables.spacing) <= _ROUNDINGS * abs(t)
    return until, tables.spacing if usual else width, j + 1 if until == knot else j


@njit_called()
def over_knots(
    tables: RampTables,
    knots: Knots,
    t: float,
    since: float,
    end: float,
    most: int,
    y: FloatArray,
    it: Interval,
    watch: Watch,
) -> tuple[float, float, float, int]:
    """March until a stop may switch, to `end`, s, or over `most` closed forms.

    A closed form is the motion while the forces stay linear.  `t`, s, is where one begins, and no stop switches in its
    first `since` seconds.  `y`, ``(2 n,)``, holds (q, q') at `t`, and is replaced by (q, q') where the last closed form
    begins; `it` takes the last closed form.  Returned are the time, s, where it begins; the times after its beginning
    between which a stop may switch, s, both 0 if none can; and the number of closed forms before it.
    """
    p, stops = tables.places.shape[0], watch.fresh.size
    waves, inner = complex_zeros(tables.rates.shape), complex_zeros(tables.rates.shape)
    z = zeros((_HALVINGS + 2, p, 3))
    j, passed = interval_of(knots, t), 0
    while passed < most and t < end:
        until, width, following = _next(tables, knots, j, t, end)
        begin_interval(tables, knots, j, t, width, y, it)
        places_at(tables, it, width, waves, z[1])
        if stops and since < width:
            if passed == 0:
                places_at(tables, it, since, inner, z[0])
            if since == 0:
                _set_levels(tables, it, passed == 0, z[0], watch)
            lo, hi = _look(tables, it, since, width, inner, z, watch)
            if hi > 0:
                for k in range(stops):
                    watch.held[k] = watch.held[k] and passed == 0 and lo == 0
                return t, lo, hi, passed
        move(tables, it, width, waves, y)
        t, since, j, passed = until, 0.0, following, passed + 1
        _put_motion(z[0], z[1])
    return t, 0.0, 0.0, passed


@njit_inner()
def _put_motion(target: FloatArray, values: FloatArray) -> None:
    """Write the motion of the places, ``(p, 3)``."""
    for u in range(target.shape[0]):
        put(target[u], values[u])


@njit_inner()
def _gap(tables: RampTables, k: int, z: FloatArray) -> tuple[float, float]:
    """A gap function, m, and its rate, m/s, from displacement and velocity of the places, ``(p, 3)``."""
    u, sign = tables.place_of[k], tables.orientation[k]
    return sign * z[u, 0] - tables.offset[k], sign * z[u, 1]


@njit_inner()
def _set_levels(tables: RampTables, it: Interval, first: bool, z: FloatArray, watch: Watch) -> None:
    """Write the level that each gap function must exceed in an interval that begins."""
    for k in range(watch.fresh.size):
        h, _ = _gap(tables, k, z)
        now = it.rounding[tables.place_of[k]] + _EPS * abs(tables.offset[k])
        rounding, watch.before[k] = max(now, watch.before[k]), now
        watch.held[k] = first and watch.fresh[k] and h <= CONTINUOUS * rounding
        if watch.held[k]:
            watch.shift[k] = max(h, 0.0)
        elif h <= 0 or (first and watch.fresh[k]):
            watch.shift[k] = 0.0
        watch.level[k] = SURE * rounding + watch.shift[k]


@njit_inner()
def _look(
    tables: RampTables, it: Interval, since: float, width: float, waves: ComplexArray, z: FloatArray, watch: Watch
) -> tuple[float, float]:
    """Times after the start of an interval, s, between which a stop may switch; both 0 if none can.

    `z`, shape ``(_HALVINGS + 2, p, 3)``, holds the motion of the places at `since`, and at the end.  Its other rows
    take the motion at the points of halving; the earliest of them is the last row in use.
    """
    ends, halvings = zeros(_HALVINGS + 2), int_zeros(_HALVINGS + 2)
    bounds = zeros((3, z.shape[1]))
    ends[0], ends[1], top = since, width, 1
    begin = z[0].copy()
    while top > 0:
        lo, hi = ends[0], ends[top]
        found = _judge(tables, it, lo, hi, begin, z[top], bounds, watch)
        if found == _CLEAR:
            _put_motion(begin, z[top])
            ends[0], top = hi, top - 1
        elif found == _RISING or halvings[top] == _HALVINGS:
            return lo, hi
        else:
            halvings[top] += 1
            ends[top + 1], halvings[top + 1], top = lo + (hi - lo) / 2, halvings[top], top + 1
            places_at(tables, it, ends[top], waves, z[top])
    return 0.0, 0.0


@njit_inner()
def _judge(
    tables: RampTables,
    it: Interval,
    lo: float,
    hi: float,
    begin: FloatArray,
    end: FloatArray,
    bounds: FloatArray,
    watch: Watch,
) -> int:
    """`_CLEAR`, `_UNCLEAR` or `_RISING` for a part of an interval, by the places' motion at its ends, ``(p, 3)``."""
    width, result, sure = hi - lo, _CLEAR, True
    _bound(tables, it, lo, width, bounds)
    for k in range(watch.fresh.size):
        u, level = tables.place_of[k], watch.level[k]
        (h, rate), (h_end, rate_end) = _gap(tables, k, begin), _gap(tables, k, end)
        clear = h <= level and h_end <= level
        most = level + (1 - SURE) / SURE * (level - watch.shift[k])
        clear = clear and (max(h, h_end) + bounds[0, u] <= most or h + rate * width + bounds[1, u] <= most)
        watch.unclear[k] = not clear
        if not clear:
            watch.ends[k, 0], watch.ends[k, 1], watch.ends[k, 2], watch.ends[k, 3] = h, rate, h_end, rate_end
            result, sure = _UNCLEAR, sure and h_end > level and rate > bounds[2, u]
    return _RISING if result and sure else result


@njit_inner()
def _bound(tables: RampTables, it: Interval, since: float, width: float, bounds: FloatArray) -> None:
    """Write by how much places may exceed a chord, m, leave a tangent, m, and change velocity, m/s: ``(3, p)``."""
    bounds[:] = 0.0
    for b in range(tables.fading.size):
        fade = math.exp(-tables.fading[b] * since) if since else 1.0
        value, steep, bent = 2 * it.bounds[0, b], 2 * it.bounds[1, b], it.bounds[2, b] * width
        chord = min(value, bent * (width / 8)) * fade
        stray, turn = min(steep, bent / 2) * (width * fade), min(steep, bent) * fade
        for u in range(bounds.shape[1]):
            share = tables.shares[u, b]
            bounds[0, u] += share * chord
            bounds[1, u] += share * stray
            bounds[2, u] += share * turn


@njit_called()
def account(
    tables: RampTables,
    knots: Knots,
    t: float,
    end: float,
    y: FloatArray,
    it: Interval,
    depth: bool,
    closed: BoolArray,
    areas: FloatArray,
    deepest: FloatArray,
) -> None:
    """Integrals and deepest penetrations of the stops over a march from `t` to `end`, s, without switches.

    `y`, ``(2 n,)``, holds (q, q') at `t`, and is replaced by (q, q') at the end; `it` is room for a closed form.
    `areas`, m s, ``(P,)``, takes the time integral of z at each stop.  If `depth`, the values of `deepest`, m,
    ``(P,)``, of the `closed` stops are raised to their deepest penetrations.
    """
    p, stops = tables.places.shape[0], closed.size
    sums, waves, z = zeros(p), complex_zeros(tables.rates.shape), zeros((2, p, 3))
    j, begun = interval_of(knots, t), False
    while t < end:
        until, width, following = _next(tables, knots, j, t, end)
        begin_interval(tables, knots, j, t, width, y, it)
        areas_of(tables, it, width, sums)
        if depth and not begun:
            places_at(tables, it, 0.0, waves, z[0])
        if depth:
            places_at(tables, it, width, waves, z[1])
        else:
            waves_of(tables, width, waves)
        for k in range(stops):
            if depth and closed[k]:
                deepest[k] = _deepest(tables, it, k, width, z, deepest[k])
        move(tables, it, width, waves, y)
        _put_motion(z[0], z[1])
        t, j, begun = until, following, True
    for k in range(closed.size):
        areas[k] = sums[tables.place_of[k]]


@njit_inner()
def _put_depth(target: FloatArray, sign: float, values: FloatArray, offset: float) -> None:
    """Write the penetration of a stop, m, and two derivatives, from the motion of its place."""
    for d in range(3):
        target[d] = sign * values[d]
    target[0] += offset


@njit_inner()
def _deepest(tables: RampTables, it: Interval, k: int, width: float, limits: FloatArray, found: float) -> float:
    """The larger of `found` and the deepest penetration of a stop in an interval, m.

    `limits`, shape ``(2, p, 3)``, holds the motion of the places at both ends. A part is left out where a bound says
    that it holds nothing deeper, or where the penetration has no inflection: then its maximum is at an end, or where
    its rate passes through 0.  The other parts are halved.
    """
    u, sign, offset = tables.place_of[k], -tables.orientation[k], tables.offset[k]
    waves, z = complex_zeros(tables.rates.shape), zeros((tables.places.shape[0], 3))
    ends, points = zeros(_DEEP + 2), zeros((_DEEP + 2, 3))
    for i in range(2):
        ends[i] = width * i
        _put_depth(points[i], sign, limits[i, u], offset)
        found = max(found, points[i, 0])
    top = 1
    while top > 0:
        lo, hi, left, right = ends[0], ends[top], points[0], points[top]
        enough = found + max(_RELATIVE * abs(found), it.rounding[u])
        chord, inflection = 0.0, 0.0
        for b in range(tables.fading.size):
            fade = tables.shares[u, b] * math.exp(-tables.fading[b] * lo)
            curved = it.bounds[2, b] * ((hi - lo) ** 2 / 8)
            chord += min(2 * it.bounds[0, b], curved) * fade
            inflection += min(2 * it.bounds[2, b], it.bounds[3, b] * ((hi - lo) / 2)) * fade
        concave = max(left[2], right[2]) + inflection < 0
        if max(left[0], right[0]) + chord <= enough or concave or top > _DEEP:
            if concave and left[1] > 0 > right[1]:
                found = max(found, _top(tables, it, k, lo, hi, left[1], right[1]))
            put(left, right)
            ends[0], top = hi, top - 1
            continue
        top += 1
        ends[top] = lo + (hi - lo) / 2
        places_at(tables, it, ends[top], waves, z)
        _put_depth(points[top], sign, z[u], offset)
        found = max(found, points[top, 0])
    return found


@njit_inner()
def _top(tables: RampTables, it: Interval, k: int, lo: float, hi: float, rate: float, rate_end: float) -> float:
    """The maximum, m, of a penetration whose rate falls through 0, by Newton's method kept between `lo` and `hi`, s."""
    u, sign, offset = tables.place_of[k], -tables.orientation[k], tables.offset[k]
    waves, z = complex_zeros(tables.rates.shape), zeros((tables.places.shape[0], 3))
    s, value = lo + (hi - lo) * rate / (rate - rate_end), -np.inf
    for _ in range(_NEWTON):
        places_at(tables, it, s, waves, z)
        value, rate, bend = sign * z[u, 0] + offset, sign * z[u, 1], sign * z[u, 2]
        lo, hi = (s, hi) if rate > 0 else (lo, s)
        step = -rate / bend
        if abs(rate * step) <= _RELATIVE * abs(value) or hi - lo <= _EPS * hi:
            break
        s = s + step if lo < s + step < hi else (lo + hi) / 2
    return value


@njit_called()
def coordinates_at(
    tables: RampTables,
    knots: Knots,
    t: float,
    y: FloatArray,
    it: Interval,
    times: FloatArray,
    order: int,
    result: FloatArray,
) -> None:
    """Write the `order`-th time derivative (0 to 2) of q at ascending `times`, s, ``(m,)``, into `result`, ``(m, n)``.

    The march begins at `t`, s, and has no switches.  `y`, ``(2 n,)``, holds (q, q') at `t`, and is replaced by (q, q')
    where the last closed form begins; `it` is room for a closed form.
    """
    m, i, waves = times.size, 0, complex_zeros(tables.rates.shape)
    j = interval_of(knots, t)
    while i < m:
        until, width, following = _next(tables, knots, j, t, np.inf)
        begin_interval(tables, knots, j, t, width, y, it)
        while i < m and times[i] < until:
            waves_of(tables, times[i] - t, waves)
            state_at(tables, it, times[i] - t, waves, order, result[i])
            i += 1
        if i < m:
            waves_of(tables, width, waves)
            move(tables, it, width, waves, y)
        t, j = until, following


@dataclass(frozen=True)
class RampMotion:
    """The motion of ``n`` modes from a time on, in one block of knots, without switches; as `Coordinates`."""

    tables: RampTables
    knots: Knots
    start: float
    """Start of the motion, s."""
    y: FloatArray
    """(q, q') at the start, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 2) of q at the times ``t``, s, shape ``(m,)``; gives ``(n, m)``."""
        order = np.argsort(t, kind="stable")
        result = np.empty((t.size, self.y.size // 2))
        coordinates_at(
            self.tables, self.knots, self.start, self.y.copy(), new_interval(self.tables), t[order], dt, result
        )
        unsorted = np.empty_like(result)
        unsorted[order] = result
        return unsorted.T

    def accounted(
        self, end: float, depth: bool, closed: BoolArray, deepest: FloatArray
    ) -> tuple[FloatArray, FloatArray]:
        """Time integral of z at each stop up to `end`, m s, and the deepest penetration so far, m, each ``(P,)``.

        `closed` says which stops are closed, ``(P,)``; `deepest` holds their deepest penetrations before, m, ``(P,)``;
        `depth` says whether penetrations are searched for.
        """
        areas, deepest = np.zeros(closed.size), deepest.copy()
        account(
            self.tables,
            self.knots,
            self.start,
            end,
            self.y.copy(),
            new_interval(self.tables),
            depth,
            closed,
            areas,
            deepest,
        )
        return areas, deepest


def motion_of(system: System, t: float, y: FloatArray) -> RampMotion:
    """The motion in one contact state from (q, q') at time `t`, s, to the end of a block of sampled forces."""
    assert system.ramps is not None
    unused = np.zeros(len(system.stops))
    return RampMotion(ramp_tables(system, unused, unused, np.inf), knots_of(system.ramps.ramps.block_at(t)), t, y)


@dataclass(frozen=True)
class RampGaps:
    """The gap functions between two knots; see `fe_lapjoint.march.events.BoundedGaps`."""

    tables: RampTables
    interval: Interval
    start: float
    """Start of the interval, s."""

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate. See `fe_lapjoint.march.events.BoundedGaps.at`."""
        z, rate = place_at(self.tables, self.interval, self.tables.place_of[k], t - self.start)
        sign = float(self.tables.orientation[k])
        return sign * z - float(self.tables.offset[k]), sign * rate

    @cached_property
    def _envelope(self) -> Envelope:
        it = self.tables
        return Envelope(self.start, it.fading, it.shares, *self.interval.bounds[:3])

    @cached_property
    def curvature(self) -> FloatArray:
        """Bounds on the curvature, m/s2, ``(P,)``. See `fe_lapjoint.march.events.BoundedGaps.curvature`."""
        return np.asarray((self._envelope.shares @ self._envelope.curvature)[self.tables.place_of])

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """Bounds between the ends of intervals. See `fe_lapjoint.march.events.BoundedGaps.from_chord`."""
        return np.asarray(self._envelope.from_chord(t, width)[self.tables.place_of])

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """Bounds on a gap function. See `fe_lapjoint.march.events.BoundedGaps.ceiling`."""
        it, u = self.tables, self.tables.place_of[k]
        towards = side * float(it.orientation[k])
        above = above_troughs(self.interval.at_places[u], it.rates, it.swinging, towards, t - self.start, width)
        return np.asarray((side * ends - above).max(axis=0) + self.from_chord(t, width)[k])

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """Bounds on the time ahead. See `fe_lapjoint.march.events.BoundedGaps.from_tangent`."""
        return self._envelope.from_tangent(int(self.tables.place_of[k]), t, width)


def follow(
    motion: RampMotion, end: float, fresh: BoolArray, shift: FloatArray, rounding: FloatArray
) -> tuple[float, FloatArray, int]:
    """Follow a motion to its first switch, to `end`, s, or over `LONGEST` closed forms.

    Returned are the time reached, s, (q, q') there, ``(2 n,)``, and the stop that switches, -1 for none.  `fresh`,
    ``(P,)``, says whether each stop may have switched at the start.  `shift`, m, ``(P,)``, is the height of each gap
    function above 0 when its stop switched, until it has been below 0; it is changed in place.  `rounding`, m,
    ``(P,)``, is the rounding error of each gap function before the start; the error at the end replaces it.
    """
    tables, knots, y = motion.tables, motion.knots, motion.y.copy()
    held, unclear = np.zeros((2, fresh.size), dtype=bool)
    watch = Watch(fresh, shift, rounding, np.zeros(fresh.size), held, unclear, np.zeros((fresh.size, 4)))
    it, t, since, passed = new_interval(tables), motion.start, 0.0, 0
    while True:
        t, lo, hi, more = over_knots(tables, knots, t, since, end, LONGEST - passed, y, it, watch)
        passed, since = passed + more, hi
        if hi == 0:
            return t, y, -1
        begin, latest = t + lo, t + hi
        gaps = RampGaps(tables, it, t)
        rounding = (watch.level - watch.shift) / SURE
        known = watch.unclear, watch.ends, watch.level, rounding, watch.held, gaps.curvature
        time, stop = in_python.first_in(gaps, begin, latest, *known, abs(latest))
        if stop >= 0:
            return float(time), moved(tables, it, time - t), int(stop)
