"""A march along ramps from knot to knot, up to the first switch of a stop.

Sampled forces are linear between their sample times, the knots; a ramp is the force from one knot to the next.  On
every interval the gap functions are bounded as in `fe_lapjoint.march.events`: by a chord where both ends are known, and
by the tangent where it begins.  An interval that neither bound clears of switches is halved, up to `_HALVINGS` times.
The compiled march stops at an interval that may still hold a switch, which `fe_lapjoint.march.events` then searches:
see `follow`.

Arrays are named as in `fe_lapjoint.march.ramp_tables`.
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
from fe_lapjoint.march.ramp_account import account
from fe_lapjoint.march.ramp_interval import (
    Interval,
    begin_interval,
    interval_of,
    move,
    moved,
    new_interval,
    next_form,
    place_at,
    places_at,
    put_motion,
    waves_of,
)
from fe_lapjoint.march.ramp_tables import Knots, RampForm, RampTables, knots_of, ramp_form
from fe_lapjoint.march.system import ComplexArray, System
from lapjoint.compiled.arrays import complex_zeros, int_zeros, zeros
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

LONGEST = 64
"""Most closed forms, one for each knot or window, in a piece of the motion.  A piece keeps its start alone, and is
marched again when it is evaluated."""
_HALVINGS = 6
"""Halvings of an interval before it is searched: 64 parts of a window, about as many as the steps of a window without
ramps."""
_LOST = 1e-9
"""Relative rounding error of an energy from which on quadrature along the motion finds the energy."""
_EPS = float(np.finfo(float).eps)
_CLEAR, _UNCLEAR, _RISING = 0, 1, 2
"""No switch; perhaps a switch; one switch, on a gap function that rises all the way."""


@by_reference
class Watch(NamedTuple):
    """The state of the search for switches of ``P`` gap functions in a march; all but `fresh` is changed in place.

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


@njit_called()
def over_knots(
    tables: RampTables,
    knots: Knots,
    t: float,
    since: float,
    end: float,
    most: int,
    x: ComplexArray,
    it: Interval,
    watch: Watch,
) -> tuple[float, float, float, int]:
    """March until a stop may switch, to `end`, s, or over `most` closed forms.

    A closed form is the motion while the forces stay linear.  `t`, s, is where one begins, and no stop switches in its
    first `since` seconds.  `x`, ``(X,)``, holds the amplitudes at `t`, and is replaced by those where the last closed
    form begins; `it` takes the last closed form.  Returned are the time, s, where it begins; the times after its
    beginning between which a stop may switch, s, both 0 if none can; and the number of closed forms before it.
    """
    p, stops = tables.factors.shape[0], watch.fresh.size
    waves, inner = complex_zeros(tables.rates.shape), complex_zeros(tables.rates.shape)
    z = zeros((_HALVINGS + 2, p, 3))
    j, passed = interval_of(knots, t), 0
    while passed < most and t < end:
        until, width, following = next_form(tables, knots, j, t, end)
        begin_interval(tables, knots, j, t, width, x, it)
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
        move(tables, it, width, waves, x)
        t, since, j, passed = until, 0.0, following, passed + 1
        put_motion(z[0], z[1])
    return t, 0.0, 0.0, passed


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
            put_motion(begin, z[top])
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
def amplitudes_at(
    tables: RampTables, knots: Knots, t: float, x: ComplexArray, it: Interval, times: FloatArray, result: ComplexArray
) -> None:
    """Write the amplitudes at ascending `times`, s, ``(m,)``, into `result`, ``(m, X)``.

    The march begins at `t`, s, and has no switches.  `x`, ``(X,)``, holds the amplitudes at `t`, and is replaced by
    those where the last closed form begins; `it` is room for a closed form.
    """
    m, i, waves = times.size, 0, complex_zeros(tables.rates.shape)
    j = interval_of(knots, t)
    while i < m:
        until, width, following = next_form(tables, knots, j, t, np.inf)
        begin_interval(tables, knots, j, t, width, x, it)
        while i < m and times[i] < until:
            waves_of(tables, times[i] - t, waves)
            move(tables, it, times[i] - t, waves, result[i])
            i += 1
        if i < m:
            waves_of(tables, width, waves)
            move(tables, it, width, waves, x)
        t, j = until, following


@dataclass(frozen=True)
class RampMotion:
    """The motion of ``n`` modes from a time on, in one block of knots, without switches; as `Coordinates`."""

    form: RampForm
    knots: Knots
    start: float
    """Start of the motion, s."""
    y: FloatArray
    """(q, q') at the start, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""

    def __call__(self, t: FloatArray, dt: int = 0) -> FloatArray:
        """The `dt`-th derivative (0 to 2) of q at the times ``t``, s, shape ``(m,)``; gives ``(n, m)``."""
        order, tables, x = np.argsort(t, kind="stable"), self.form.tables, self.amplitudes.copy()
        result = np.empty((t.size, x.size), dtype=complex)
        amplitudes_at(tables, self.knots, self.start, x, new_interval(tables), t[order], result)
        unsorted = np.empty_like(result)
        unsorted[order] = result
        q, v = self.form.motion(t, unsorted).reshape(2, -1, t.size)
        return np.asarray((q, v)[dt] if dt < 2 else self.form.system.next_derivative(t, q, v))

    @cached_property
    def amplitudes(self) -> ComplexArray:
        """The amplitudes at the start, shape ``(X,)``."""
        return self.form.amplitudes(self.start, self.y)

    def accounted(
        self, end: float, depth: bool, closed: BoolArray, damped: BoolArray, deepest: FloatArray
    ) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Time integral of z at each stop up to `end`, m s, of a closed damped stop that of z + (c / k) z'; and the
        deepest penetration of these so far, m, each ``(P,)``; and for `damped` stops half of what the square of the
        penetration d grows by, m2, and the time integral of d'^2, m2/s, ``(P, 2)``: not a number if rounding is too
        large, or if there are slow terms.

        `closed` says which stops are closed, ``(P,)``; `deepest` holds their deepest penetrations before, m, ``(P,)``;
        `depth` says whether penetrations are searched for.
        """
        areas, deepest, tables, works = (
            np.zeros(closed.size),
            deepest.copy(),
            self.form.tables,
            np.zeros((closed.size, 3)),
        )
        if tables.drag.size:
            damped = np.zeros_like(damped)
            works[:] = np.nan
        room = new_interval(tables)
        account(
            tables,
            self.knots,
            self.start,
            end,
            self.amplitudes.copy(),
            room,
            depth,
            closed,
            damped,
            areas,
            deepest,
            works,
        )
        works[works[:, 2] * _EPS > _LOST * np.abs(works[:, 1])] = np.nan
        return areas, deepest, works[:, :2]


def motion_of(system: System, t: float, y: FloatArray) -> RampMotion:
    """The motion in one contact state from (q, q') at time `t`, s, to the end of a block of sampled forces."""
    assert system.ramps is not None
    unused, window = np.zeros(len(system.stops)), 1 / float(system.omega[system.omega > 0].min())
    return RampMotion(ramp_form(system, unused, unused, window), knots_of(system.ramps.ramps.block_at(t)), t, y)


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
    form, knots, x = motion.form, motion.knots, motion.amplitudes.copy()
    tables = form.tables
    held, unclear = np.zeros((2, fresh.size), dtype=bool)
    watch = Watch(fresh, shift, rounding, np.zeros(fresh.size), held, unclear, np.zeros((fresh.size, 4)))
    it, t, since, passed = new_interval(tables), motion.start, 0.0, 0
    while True:
        t, lo, hi, more = over_knots(tables, knots, t, since, end, LONGEST - passed, x, it, watch)
        passed, since = passed + more, hi
        stop, until = -1, t
        if hi:
            begin, latest, gaps = t + lo, t + hi, RampGaps(tables, it, t)
            rounding = (watch.level - watch.shift) / SURE
            known = watch.unclear, watch.ends, watch.level, rounding, watch.held, gaps.curvature
            until, stop = in_python.first_in(gaps, begin, latest, *known, abs(latest))
        if hi and stop < 0:
            continue
        if hi:
            moved(tables, it, until - t, x)
        return float(until), form.motion_at(float(until), x), int(stop)
