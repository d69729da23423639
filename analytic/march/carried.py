"""The compiled march over whole periods, for transients: alone, or with deviations that travel along."""

from __future__ import annotations

import math

import numpy as np

from analytic.march.compiled import DONE, MISSING_SWITCH, STUCK, TOO_MANY, enter, leave
from analytic.march.motion import NO_SWITCH, PENDING, PERIODS, SLOT, SWITCHES, Motion, Work
from analytic.march.tables import IntArray, Tables
from analytic.march.tangent import flow, new_switching, saltation, set_levels
from lapjoint.compiled.arrays import put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.orbits.period_map import LEAST_GROWTH
from lapjoint.problem import FloatArray

_WITHIN_REACH = 1e100
"""Size of a deviation, kg^1/2 m, above which it is scaled back to 1: its square stays finite over one more switch."""


@njit_called()
def size_of(deviation: FloatArray, period: float) -> float:
    """The size |dq| + |dv| period / 2 pi, kg^1/2 m, of a deviation (dq, dv), ``(2 N, 1)``; `period` in s."""
    n = deviation.shape[0] // 2
    q, v = 0.0, 0.0
    for i in range(n):
        q += deviation[i, 0] * deviation[i, 0]
        v += deviation[n + i, 0] * deviation[n + i, 0]
    return math.sqrt(q) + math.sqrt(v) * period / (2 * math.pi)


@njit_called()
def advance_periods(
    tables: Tables,
    motion: Motion,
    work: Work,
    period: float,
    count: int,
    penetration: FloatArray,
    slots: IntArray,
    sections: FloatArray,
    now: FloatArray,
    level: FloatArray,
    growth: FloatArray,
    most: int,
) -> tuple[int, FloatArray]:
    """March until `count` periods are done, each from the time 0 as a march of its own, and carry deviations along.

    `motion` is where the march is, with its time counted from the start of the period; it is changed in place.  `most`
    is the most switches in all.  `period` is in s.  `penetration`, m s, ``(rows, P)``, takes each stop's penetration
    over time in each period; what does not fit is added to the last row.  `slots`, ``(count,)`` or ``(0,)``, takes the
    state at the end of each period if it has room, and `sections`, ``(count, 2, N)`` or ``(0, 2, N)``, takes q, kg^1/2
    m, and v, kg^1/2 m/s, there.

    `now`, ``(2 N, m)``, holds deviations (dq, dv) as columns at the time of `motion`, before a pending switch, kg^1/2 m
    and kg^1/2 m/s; it may have no column, and is changed in place.  `level`, m, ``(P, m)``, says at which level each
    stop switches next with these deviations; it is changed in place, and may be anything at the start of a period.  If
    `growth`, ``(count,)`` or ``(0,)``, has room, the logarithm of the growth of the one deviation in each period is
    added to it, and the deviation is scaled to a size of 1 kg^1/2 m at the end of each period.

    Returned are the reason to come back, see `analytic.march.compiled.DONE`, and the deviations, ``(2 N, m)``, then.
    """
    carried, depth = now.shape[1] > 0, bool(np.bool_(False))
    q_old, v_old = motion.q.copy(), motion.v.copy()
    switching = new_switching(level, motion.q.size)
    while motion.counts[PERIODS] < count:
        slot, stop, t = motion.counts[SLOT], motion.counts[PENDING], motion.time[0]
        if carried:
            put(q_old, motion.q)
            put(v_old, motion.v)
        if not enter(tables, None, None, motion, work):
            return MISSING_SWITCH, now
        if carried and stop >= 0:
            n, m = tables.modes[slot], now.shape[1]
            then = zeros((2 * tables.modes[motion.counts[SLOT]], m))
            rate, q, v = motion.time[1], motion.q, motion.v
            saltation(tables, slot, stop, work.theta, rate, q_old, v_old, q, v, n, now, then, switching)
            now = then
        if carried:
            set_levels(tables, motion.counts[SLOT], stop >= 0, work.theta, motion.q, motion.v, now, switching)
        if not leave(tables, None, None, motion, work, period, 0.0, depth):
            return STUCK, now
        if carried:
            flow(tables, motion.counts[SLOT], motion.time[0] - t, now, now)
        if growth.size > 0:
            growth[motion.counts[PERIODS]] += _keep_within_reach(now, level, period)
        if motion.counts[PENDING] == NO_SWITCH and motion.time[0] >= period:
            done = motion.counts[PERIODS]
            if slots.size > 0:
                slots[done] = motion.counts[SLOT]
                put(sections[done, 0], motion.q)
                put(sections[done, 1], motion.v)
            if growth.size > 0:
                growth[done] += _rescale(now, period)
            _next_period(motion, penetration[min(done, penetration.shape[0] - 1)])
        elif motion.counts[SWITCHES] > most:
            return TOO_MANY, now
    return DONE, now


@njit_inner()
def _keep_within_reach(deviation: FloatArray, level: FloatArray, period: float) -> float:
    """Scale a deviation, ``(2 N, 1)``, and its levels, ``(P, 1)``, if its size nears the limits of double precision.

    The deviation is scaled to a size of 1 kg^1/2 m, in place; the logarithm of the divisor is returned.
    """
    size = size_of(deviation, period)
    if size < LEAST_GROWTH or (1 / _WITHIN_REACH < size and size < _WITHIN_REACH):
        return 0.0
    deviation /= size
    level /= size
    return math.log(size)


@njit_inner()
def _rescale(deviation: FloatArray, period: float) -> float:
    """Scale a deviation, ``(2 N, 1)``, to a size of 1 kg^1/2 m, in place; the logarithm of its size is returned.

    A deviation that has all but vanished has lost its direction, and any other goes on in its place.
    """
    size = size_of(deviation, period)
    found = max(size, LEAST_GROWTH)
    if size < LEAST_GROWTH:
        deviation[:, 0] = 1.0
        size = size_of(deviation, period)
    deviation /= size
    return math.log(found)


@njit_inner()
def _next_period(motion: Motion, penetration: FloatArray) -> None:
    """Begin a period at the time 0, and add the penetrations, m s, of the previous period to `penetration`,
    ``(P,)``."""
    for k in range(motion.total.size):
        penetration[k] += motion.total[k]
        motion.total[k] = 0.0
        motion.last_switch[k] = 0.0
    motion.time[0] = 0.0
    motion.counts[PERIODS] += 1
