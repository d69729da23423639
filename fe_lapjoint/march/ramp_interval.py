"""The exact motion of one contact state while its forces stay linear in time, compiled.

An interval is the motion from a given time on while the forces stay linear; `fe_lapjoint.march.ramp_tables` says what
its parts are, and names the sizes of all arrays.  Amplitudes x, shape ``(X,)``, are those of `RampForm`.  A term is an
exponential and a polynomial in time.  An amplitude c of a slow term, which falls with the rate k, is

    c = c0 e0 + b e1 + b' e2 + b'' e3 + b''' e4

with the loads b at the start, exp(-k s) = e0, and its first, second, ... integral e1, e2, ...; where k is 0 they are
s, s^2 / 2 and so on.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_lapjoint.march.compiled import at_place
from fe_lapjoint.march.ramp_tables import Knots, RampTables
from fe_lapjoint.march.system import ComplexArray
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

_TERMS = 22
"""Terms of the series of a fading exponential's sixth integral: the next is 2^22 6! / 28! = 1e-20 of the first."""
_ROUNDINGS = 1e-15
"""As a fraction of the time: rounding may change the distance between two knots by this much from the usual spacing."""
_ROUNDING = float(32 * np.finfo(float).eps)
"""Relative rounding error, as in `fe_lapjoint.march.propagator`."""


@by_reference
class Interval(NamedTuple):
    """The motion of one contact state while the forces stay linear; see `RampTables` for the sizes."""

    loads: FloatArray
    """The loads at the start, and their derivatives, shape ``(L, d)``."""
    terms: ComplexArray
    """Complex amplitudes a of the terms, and of the harmonic loads, 1; shape ``(m,)``."""
    at_places: ComplexArray
    """Complex amplitudes of the terms and harmonic loads in the motion of the places, m, shape ``(p, m)``."""
    slow: FloatArray
    """Amplitude c of each slow term at the start, then its load b and the derivatives of b, shape ``(J, 1 + d)``."""
    body: FloatArray
    """Displacement and speed of each rigid-body mode as a polynomial: value and derivatives at the start, without the
    slow terms; shape ``(r, 2, d + 2)``."""
    line: FloatArray
    """What the places see beside terms, harmonic loads and slow terms: value and derivatives at the start, m over
    powers of s, shape ``(p, d + 2)``."""
    bounds: FloatArray
    """Bounds on each bounded part and its first three derivatives, divided by its `shares`, shape ``(4, b)``."""
    rounding: FloatArray
    """Rounding error of the displacement of each place, m, shape ``(p,)``."""


def new_interval(tables: RampTables) -> Interval:
    """An interval with arrays that are not filled yet; loads keep the zeros among their derivatives."""
    (p, m), (_, L, d) = tables.factors.shape, tables.gain.shape
    J, r = tables.drag.size, tables.body_slow.shape[0]
    return Interval(
        np.zeros((L, d)),
        np.empty(m, dtype=np.complex128),
        np.empty((p, m), dtype=np.complex128),
        np.empty((J, 1 + d)),
        np.empty((r, 2, d + 2)),
        np.empty((p, d + 2)),
        np.empty((4, tables.fading.size)),
        np.empty(p),
    )


@njit_called()
def fading_integrals(drag: float, s: float) -> tuple[float, float, float, float, float, float, float]:
    """exp(-drag s), for 0 <= drag s <= 2, and its integrals from 0 to s, once to six times: s, s^2, ... s^6."""
    series, term = 0.0, 1.0
    for n in range(_TERMS):
        series += term
        term *= -drag * s / (7 + n)
    sixth = series * s**6 / 720
    fifth = s**5 / 120 - drag * sixth
    fourth = s**4 / 24 - drag * fifth
    third = s**3 / 6 - drag * fourth
    second = s**2 / 2 - drag * third
    first = s - drag * second
    return 1 - drag * first, first, second, third, fourth, fifth, sixth


@njit_inner()
def _polynomial(line: FloatArray, first: int, s: float) -> float:
    """The `first`-th derivative, after `s` seconds, of the polynomial with value and derivatives `line` at the
    start."""
    total = 0.0
    for m in range(line.size - 1, first - 1, -1):
        total = line[m] + total * s / (m - first + 1)
    return total


@njit_inner()
def _bend(line: FloatArray, first: int, s: float) -> float:
    """Bound on the `first`-th derivative of a polynomial within `s` seconds; see `_polynomial`."""
    total = 0.0
    for m in range(line.size - 1, first - 1, -1):
        total = abs(line[m]) + total * s / (m - first + 1)
    return total


@njit_inner()
def _steady(tables: RampTables, loads: FloatArray, k: int) -> complex:
    """p of a term under loads and their derivatives, shape ``(L, d)``."""
    total: complex = tables.gain[k, 0, 0]  # the constant load, 1
    for load in range(1, loads.shape[0]):
        for d in range(loads.shape[1]):
            total += tables.gain[k, load, d] * loads[load, d]
    return total


@njit_inner()
def interval_of(knots: Knots, t: float) -> int:
    """Index j, 0 to K - 2, of the ramp at time `t`, s; at a knot the later ramp; outside all knots the nearest."""
    return min(max(int(np.searchsorted(knots.time, t, side="right")) - 1, 0), knots.time.size - 2)


@njit_inner()
def next_form(tables: RampTables, knots: Knots, j: int, t: float, end: float) -> tuple[float, float, int]:
    """Time, s, up to which a closed form is followed, its length, s, and the index of the ramp where the next one
    begins."""
    knot = knots.time[j + 1] if j < knots.time.size - 2 else np.inf
    until = min(knot, end, t + tables.window)
    width = until - t
    usual = abs(width - tables.spacing) <= _ROUNDINGS * abs(t)
    return until, tables.spacing if usual else width, j + 1 if until == knot else j


@njit_inner()
def _set_loads(tables: RampTables, knots: Knots, j: int, t: float, it: Interval) -> None:
    """Write the loads at time `t`, s, between knots j and j + 1."""
    s, R = t - knots.time[j], knots.slope.shape[1]
    it.loads[0, 0] = 1.0
    for r in range(R):
        it.loads[1 + r, 0], it.loads[1 + r, 1] = knots.force[j, r] + knots.slope[j, r] * s, knots.slope[j, r]
    if knots.base.shape[0]:
        for d in range(4):
            value = _polynomial(knots.base[j], d, s)
            it.loads[1 + R, d] = value
            if d:
                it.loads[2 + R, d - 1] = value


@njit_inner()
def begin_interval(
    tables: RampTables, knots: Knots, j: int, t: float, ahead: float, x: ComplexArray, it: Interval
) -> None:
    """Write into `it` the closed form of the motion from time `t`, s, on, between knots j and j + 1.

    `x` holds the amplitudes at `t`; the bounds hold for `ahead` seconds.
    """
    (L, D), T, H, J = it.loads.shape, tables.gain.shape[0], tables.driven.size, tables.drag.size
    _set_loads(tables, knots, j, t, it)
    for k in range(T):
        it.terms[k] = x[k] - _steady(tables, it.loads, k)
    for h in range(H):
        angle = tables.driven[h] * t + tables.phase[h]
        it.terms[T + h] = complex(math.cos(angle), math.sin(angle))
    for k in range(J):
        it.slow[k, 0] = x[T + k].real
        for d in range(D):
            it.slow[k, 1 + d] = 0.0
            for load in range(L):
                it.slow[k, 1 + d] += tables.slow_push[k, load] * it.loads[load, d]
    bodies = it.body.shape[0]
    for b in range(bodies):
        place, speed = it.body[b]
        place[0], speed[0], speed[D + 1] = x[T + J + b].real, x[T + J + bodies + b].real, 0.0
        for d in range(D):
            speed[d + 1], place[d + 1] = 0.0, speed[d]
            for load in range(L):
                place[d + 1] += tables.body_push[b, 0, load] * it.loads[load, d]
                speed[d + 1] += tables.body_push[b, 1, load] * it.loads[load, d]
        place[D + 1] = speed[D]
    _write_places(tables, it)
    _write_bounds(tables, ahead, it)


@njit_inner()
def _write_places(tables: RampTables, it: Interval) -> None:
    """Write the motion of the places."""
    (L, D), J = it.loads.shape, tables.drag.size
    for u in range(it.line.shape[0]):
        size, line = 0.0, it.line[u]
        line[:] = 0.0
        for load in range(L):
            for d in range(D if load else 1):
                size += tables.gain_sizes[u, load, d] * abs(it.loads[load, d])
                for m in range(D - d):
                    line[m] += tables.gain_at_places[u, load, d] * it.loads[load, m + d]
        for b in range(it.body.shape[0]):
            for kind in range(2):
                share = tables.body_at_places[u, b, kind]
                size += abs(share * it.body[b, kind, 0])
                for m in range(D + 2):
                    line[m] += share * it.body[b, kind, m]
        for k in range(J):
            size += abs(tables.slow_at_places[u, k, 0] * it.slow[k, 0])
        for k in range(tables.rates.size):
            now = tables.factors[u, k] * it.terms[k]
            it.at_places[u, k] = now
            size += abs(now.real) + tables.turned[k] * abs(now.imag)
        it.rounding[u] = _ROUNDING * size


@njit_inner()
def _write_bounds(tables: RampTables, ahead: float, it: Interval) -> None:
    """Write the bounds at the start; later each falls as exp(-fading s).

    An amplitude bounds its term, and gains a factor of its rate with each derivative.  A nearly critical mode, with the
    damping rate a, moves by at most abs(x) + abs(v + a x) t times exp(-a t), and t is at most 2 exp(a t / 2) / e a.
    Of a slow term, the derivatives of c obey the equation of c, too, and grow from their values at the start
    by no more than the integral of the load.
    """
    m = tables.rates.size
    for k in range(m):
        size, now, rate = abs(it.terms[k]), it.terms[k], tables.rates[k]
        for d in range(4):
            if tables.swinging[k] == 0:
                drift = abs((rate * now).real - rate.real * now.real)
                it.bounds[d, k] = abs(now.real) - drift * 2 / (math.e * rate.real)
                now *= rate
            else:
                it.bounds[d, k] = size
                size *= tables.swinging[k]
    for u in range(tables.fading.size - m):
        it.bounds[0, m + u] = it.bounds[1, m + u] = np.inf
        for d in range(2, 4):
            it.bounds[d, m + u] = _bend(it.line[u], d, ahead)
        for k in range(tables.drag.size):
            drag, now = tables.drag[k], it.slow[k]
            first = now[1] - drag * now[0]
            second = now[2] - drag * first
            first = abs(first) + ahead * _bend(now, 2, ahead)
            second = abs(second) + ahead * _bend(now, 3, ahead)
            value, sum_ = abs(tables.slow_at_places[u, k, 0]), abs(tables.slow_at_places[u, k, 1])
            it.bounds[2, m + u] += value * second + sum_ * first
            it.bounds[3, m + u] += value * (drag * second + _bend(now, 3, ahead)) + sum_ * second


@njit_inner()
def waves_of(tables: RampTables, s: float, waves: ComplexArray) -> None:
    """Write exp(rate s) of each rate into `waves`, shape ``(m,)``."""
    if s == tables.spacing:
        put(waves, tables.whole)
        return
    if s == 0:
        waves[:] = 1.0
        return
    for k in range(waves.size):
        size, angle = math.exp(tables.rates[k].real * s), tables.rates[k].imag * s
        waves[k] = complex(size * math.cos(angle), size * math.sin(angle))


@njit_inner()
def _slow_motion(tables: RampTables, it: Interval, k: int, s: float) -> tuple[float, float, float, float, float]:
    """Twice the time integral of a slow term's amplitude c, once, c itself, and two derivatives, after `s` seconds."""
    e, now = fading_integrals(tables.drag[k], s), it.slow[k]
    area, once, c = now[0] * e[2], now[0] * e[1], now[0] * e[0]
    for d in range(now.size - 1):
        area += now[1 + d] * e[d + 3]
        once += now[1 + d] * e[d + 2]
        c += now[1 + d] * e[d + 1]
    rate = _polynomial(now, 1, s) - tables.drag[k] * c
    return area, once, c, rate, _polynomial(now, 2, s) - tables.drag[k] * rate


@njit_inner()
def places_at(tables: RampTables, it: Interval, s: float, waves: ComplexArray, z: FloatArray) -> None:
    """Write displacement, m, velocity, m/s, and acceleration, m/s2, of the places after `s` seconds: `z`, ``(p, 3)``.

    `waves`, shape ``(m,)``, takes exp(rate s) of each rate.
    """
    waves_of(tables, s, waves)
    for u in range(z.shape[0]):
        x, v, a = _polynomial(it.line[u], 0, s), _polynomial(it.line[u], 1, s), _polynomial(it.line[u], 2, s)
        for k in range(waves.size):
            now = it.at_places[u, k] * waves[k]
            x += now.real
            now *= tables.rates[k]
            v += now.real
            a += now.real * tables.rates[k].real - now.imag * tables.rates[k].imag
        z[u, 0], z[u, 1], z[u, 2] = x, v, a
    for k in range(tables.drag.size):
        _, once, c, rate, bend = _slow_motion(tables, it, k, s)
        for u in range(z.shape[0]):
            share, of_integral = tables.slow_at_places[u, k, 0], tables.slow_at_places[u, k, 1]
            z[u, 0] += share * c + of_integral * once
            z[u, 1] += share * rate + of_integral * c
            z[u, 2] += share * bend + of_integral * rate


@njit_called()
def place_at(tables: RampTables, it: Interval, u: int, s: float) -> tuple[float, float]:
    """Displacement, m, and velocity, m/s, of place `u` after `s` seconds."""
    x, v = at_place(it.at_places, tables.rates, u, s)
    x, v = x + _polynomial(it.line[u], 0, s), v + _polynomial(it.line[u], 1, s)
    for k in range(tables.drag.size):
        _, once, c, rate, _ = _slow_motion(tables, it, k, s)
        share, of_integral = tables.slow_at_places[u, k, 0], tables.slow_at_places[u, k, 1]
        x, v = x + share * c + of_integral * once, v + share * rate + of_integral * c
    return x, v


@njit_inner()
def move(tables: RampTables, it: Interval, s: float, waves: ComplexArray, x: ComplexArray) -> None:
    """Write the amplitudes after `s` seconds into `x`, shape ``(X,)``; `waves`, ``(m,)``, holds exp(rate s)."""
    T, J, bodies = tables.gain.shape[0], tables.drag.size, it.body.shape[0]
    loads = zeros(it.loads.shape)
    for load in range(loads.shape[0]):
        for d in range(loads.shape[1]):
            loads[load, d] = _polynomial(it.loads[load], d, s)
    for k in range(T):
        x[k] = it.terms[k] * waves[k] + _steady(tables, loads, k)
    for b in range(bodies):
        x[T + J + b], x[T + J + bodies + b] = _polynomial(it.body[b, 0], 0, s), _polynomial(it.body[b, 1], 0, s)
    for k in range(J):
        _, once, x[T + k], _, _ = _slow_motion(tables, it, k, s)
        for b in range(bodies):
            x[T + J + b] += tables.body_slow[b, k] * once


@njit_called()
def moved(tables: RampTables, it: Interval, s: float, x: ComplexArray) -> None:
    """Write the amplitudes after `s` seconds into `x`, shape ``(X,)``."""
    waves = complex_zeros(tables.rates.shape)
    waves_of(tables, s, waves)
    move(tables, it, s, waves, x)


@njit_inner()
def areas_of(tables: RampTables, it: Interval, s: float, areas: FloatArray) -> None:
    """Add the time integrals of the places' displacements over the first `s` seconds to `areas`, m s, ``(p,)``."""
    for u in range(areas.size):
        total = 0.0
        for m in range(it.line.shape[1] - 1, -1, -1):
            total = (it.line[u, m] + total) * s / (m + 1)
        areas[u] += total
    usual = s == tables.spacing
    for k in range(tables.rates.size):
        less = tables.whole_areas[k] if usual else _wave_area(tables.rates[k], s)
        for u in range(areas.size):
            areas[u] += (it.at_places[u, k] * less).real
    for k in range(tables.drag.size):
        twice, once, _, _, _ = _slow_motion(tables, it, k, s)
        for u in range(areas.size):
            areas[u] += tables.slow_at_places[u, k, 0] * once + tables.slow_at_places[u, k, 1] * twice


@njit_inner()
def _wave_area(rate: complex, s: float) -> complex:
    """The integral of exp(rate t) from 0 to `s`, s, without cancellation."""
    a, b = rate.real * s, rate.imag * s
    less = complex(math.expm1(a) * math.cos(b) - 2 * math.sin(b / 2) ** 2, math.exp(a) * math.sin(b))
    return less / rate


@njit_inner()
def put_motion(target: FloatArray, values: FloatArray) -> None:
    """Write the motion of the places, ``(p, 3)``."""
    for u in range(target.shape[0]):
        put(target[u], values[u])
