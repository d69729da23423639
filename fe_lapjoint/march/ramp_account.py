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
_SERIES = 14
"""Terms of the series of (exp(x) - 1) / x for |x| up to a half: the next is 0.5^14 / 15! = 5e-17 of the first."""
_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(8)
"""Gauss' rule on [-1, 1]: exact for a polynomial, and to 1e-15 for one times an exponential that turns by 1."""
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
    damped: BoolArray,
    areas: FloatArray,
    deepest: FloatArray,
    works: FloatArray,
) -> None:
    """Integrals and deepest penetrations of the stops over a march from `t` to `end`, s, without switches.

    `x`, ``(X,)``, holds the amplitudes at `t`, and is replaced by those where the last closed form begins; `it` is room
    for a closed form.  `areas`, m s, ``(P,)``, takes the time integral of what the force of each stop reads.  If
    `depth`, the values of `deepest`, m, ``(P,)``, of the `closed` stops are raised to their deepest penetrations, and
    `works`, ``(P, 3)``, takes for those that are `damped`: half of what the square of the penetration d grows by, m2;
    the time integral of d'^2, m2/s; and the sum of the moduli of the parts of this integral.
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
            if depth and closed[k] and damped[k]:
                u, sign, offset = tables.place_of[k], -tables.orientation[k], tables.offset[k]
                works[k, 0] += ((sign * z[1, u, 0] + offset) ** 2 - (sign * z[0, u, 0] + offset) ** 2) / 2
                value, size = _squared_speed(tables, it, u, width, waves)
                works[k, 1] += value
                works[k, 2] += size
        if until < end:
            move(tables, it, width, waves, x)
        put_motion(z[0], z[1])
        t, j, begun = until, following, True
    for k in range(closed.size):
        areas[k] = sums[tables.force_place[k]]


@njit_inner()
def _mean_wave(x: complex, wave: complex) -> complex:
    """(exp(x) - 1) / x, where `wave` is exp(x)."""
    if abs(x) > 0.5:
        return (wave - 1.0) / x
    total = 0j
    for n in range(_SERIES, 0, -1):
        total = 1.0 + total * x / (n + 1)
    return total


@njit_inner()
def _squared_speed(tables: RampTables, it: Interval, u: int, s: float, waves: ComplexArray) -> tuple[float, float]:
    """The time integral of the square of a place's velocity over `s` seconds, m2/s, and the moduli of its parts, added.

    The velocity is a sum of exponentials and a polynomial P; `waves`, ``(m,)``, holds exp(rate s).  Products of two
    exponentials are exponentials.  P with an exponential is integrated by parts, or by Gauss' rule if it hardly turns.
    There are no slow terms.
    """
    total, size, m = 0.0, 0.0, tables.rates.size
    line = it.line[u]
    for g in range(_NODES.size):
        t = s * (1 + _NODES[g]) / 2
        speed, slow = 0.0, 0.0
        for n in range(line.size - 1, 0, -1):
            speed = line[n] + speed * t / n
        for i in range(m):
            r = tables.rates[i]
            if abs(r) * s <= 1:
                slow += (it.at_places[u, i] * r * np.exp(r * t)).real
        total += _WEIGHTS[g] * s / 2 * speed * (speed + 2 * slow)
        size += abs(_WEIGHTS[g] * s / 2 * speed * (abs(speed) + 2 * abs(slow)))
    for i in range(m):
        r = tables.rates[i]
        one = it.at_places[u, i] * r
        if abs(r) * s > 1:
            factor = 2 * one / r
            for d in range(1, line.size):
                speed = 0.0
                for n in range(line.size - 1, d - 1, -1):
                    speed = line[n] + speed * s / (n - d + 1)
                part = factor * (waves[i] * speed - line[d])
                total += part.real
                size += abs(part)
                factor = -factor / r
        for j in range(i + 1):
            q = tables.rates[j]
            other = it.at_places[u, j] * q
            both = one * other * _mean_wave((r + q) * s, waves[i] * waves[j])
            crossed = one * other.conjugate() * _mean_wave((r + q.conjugate()) * s, waves[i] * waves[j].conjugate())
            share = s if j < i else s / 2
            total += share * (both + crossed).real
            size += share * (abs(both) + abs(crossed))
    return total, size


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
