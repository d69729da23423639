"""The motion of one contact state under forces that are linear between knots, and the search for its switches."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_lapjoint.march.compiled import above_troughs
from fe_lapjoint.march.envelope import Envelope
from fe_lapjoint.march.events import SURE, BoolArray, in_python
from fe_lapjoint.march.ramp_interval import Interval, Knots, knots_of, moved, new_interval, place_at
from fe_lapjoint.march.ramp_stretch import Watch, account, coordinates_at, over_knots
from fe_lapjoint.march.ramp_tables import RampTables, ramp_tables
from fe_lapjoint.march.system import System
from lapjoint.problem import FloatArray

LONGEST = 64
"""Most knots of a piece of the motion; a piece keeps its start alone, and is marched again when it is evaluated."""


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

        `closed` says which stops count, ``(P,)``; `deepest` holds their deepest penetration before, m, ``(P,)``;
        `depth` says whether penetrations are looked at.
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
    """Follow a motion to its first switch, to `end`, s, or over `LONGEST` knots.

    Given back are the time reached, s, (q, q') there, ``(2 n,)``, and the stop that switches, -1 for none. `fresh`,
    ``(P,)``, says whether each stop may have switched at the start. `shift`, m, ``(P,)``, says how far above 0 each gap
    function was when its stop switched, until it has been below 0; it is changed in place. `rounding`, m, ``(P,)``, is
    the rounding error of each gap function before; the error at the end replaces it.
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
