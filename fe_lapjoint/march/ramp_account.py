"""Impulses and deepest penetrations of contacts along ramps, by the closed forms of `fe_lapjoint.march.ramp_interval`.

Arrays are named as in `fe_lapjoint.march.ramp_tables`.
"""

from __future__ import annotations

import math

import numpy as np

from fe_lapjoint.march.events import BoolArray
from fe_lapjoint.march.ramp_interval import (
    Interval,
    areas_of,
    begin_interval,
    interval_of,
    move,
    next_form,
    places_at,
    put_motion,
    waves_of,
)
from fe_lapjoint.march.ramp_tables import Knots, RampTables
from fe_lapjoint.march.system import ComplexArray
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

_RELATIVE = 1e-12
"""Relative error of the deepest penetration; a maximum is flat, so its time is known to 1e-6."""
_DEEP = 48
"""Most halvings of an interval in the search for the deepest penetration: more than reach its last digit."""
_NEWTON = 30
"""Most steps of Newton's method in the search for a maximum."""
_EPS = float(np.finfo(float).eps)


@njit_called()
def account(
    tables: RampTables,
    knots: Knots,
    t: float,
    end: float,
    x: ComplexArray,
    it: Interval,
    depth: bool,
    closed: BoolArray,
    areas: FloatArray,
    deepest: FloatArray,
) -> None:
    """Integrals and deepest penetrations of the stops over a march from `t` to `end`, s, without switches.

    `x`, ``(X,)``, holds the amplitudes at `t`, and is replaced by those where the last closed form begins; `it` is room
    for a closed form.  `areas`, m s, ``(P,)``, takes the time integral of what the force of each stop reads.  If
    `depth`, the values of `deepest`, m, ``(P,)``, of the `closed` stops are raised to their deepest penetrations.
    """
    p, stops = tables.factors.shape[0], closed.size
    sums, waves, z = zeros(p), complex_zeros(tables.rates.shape), zeros((2, p, 3))
    j, begun = interval_of(knots, t), False
    while t < end:
        until, width, following = next_form(tables, knots, j, t, end)
        begin_interval(tables, knots, j, t, width, x, it)
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
        if until < end:
            move(tables, it, width, waves, x)
        put_motion(z[0], z[1])
        t, j, begun = until, following, True
    for k in range(closed.size):
        areas[k] = sums[tables.force_place[k]]


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
    u, sign, offset = tables.force_place[k], -tables.orientation[k], tables.offset[k]
    waves, z = complex_zeros(tables.rates.shape), zeros((tables.factors.shape[0], 3))
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
    u, sign, offset = tables.force_place[k], -tables.orientation[k], tables.offset[k]
    waves, z = complex_zeros(tables.rates.shape), zeros((tables.factors.shape[0], 3))
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
