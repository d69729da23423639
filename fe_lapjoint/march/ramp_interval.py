"""The exact flow of one contact state under forces that are linear in time, from one knot to the next, compiled.

The equations are linear, so the response p to the linear forces alone is added to the flow under all other loads, which
starts from the given state less p.  For a modal force f + g s, s seconds after the start, on a mode with stiffness,

    p(s) = (f + g s) / omega^2 - 2 a g / omega^4.

A rigid-body mode, q'' + 2 a q' = f + g s, starts from rest,

    p(s) = f e2 + g e3,

with e1, e2, ... the first, second, ... integral of exp(-2 a s); where a is 0 they are s, s^2 / 2 and so on.

p of modes with stiffness is linear in time, so its bounds on the distance from chord and tangent are 0.

`RampTables` holds one contact state in flat arrays; its letters for their sizes are used throughout.  An interval is
the motion from a given time on while the forces stay linear.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from fe_lapjoint.march.compiled import at_place
from fe_lapjoint.march.system import ComplexArray, IndexArray, System
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.by_reference import by_reference, in_c_order
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray
from lapjoint.problem.ramps import Ramps

_SHORT = 2.0
"""Largest 2 a s for which the integrals are summed as a series."""
_TERMS = 22
"""Terms of the series: the next term is 2^22 4! / 26! = 3e-19 of the first."""
_ROUNDING = float(32 * np.finfo(float).eps)
"""Relative rounding error, as in `fe_lapjoint.march.propagator`."""


@by_reference
class RampTables(NamedTuple):
    """A contact state with ``n`` modes, ``P`` stops at ``p`` places, ``H`` harmonic loads and ``R`` sampled forces.

    Of the modes ``o`` oscillate, ``e`` do not, and ``r`` are rigid-body modes; ``b`` terms are bounded, see
    `fe_lapjoint.march.envelope`: the modes as in `System.bounded`, the loads, and the rigid-body modes.
    """

    omega: FloatArray
    """Natural angular frequencies, rad/s, shape ``(n,)``."""
    damping_rate: FloatArray
    """zeta omega, 1/s, shape ``(n,)``."""
    compliance: FloatArray
    """1 / omega^2, s2, 0 for rigid-body modes, shape ``(n,)``."""
    constant: FloatArray
    """Modal force of the closed stops' gaps and of the step loads, kg^1/2 m/s2, shape ``(n,)``."""
    forces: FloatArray
    """Modal force for each unit of a sampled force, kg^-1/2, or kg^-1/2 m along the beam, shape ``(n, R)``."""
    which: IndexArray
    """The modes that oscillate, shape ``(o,)``."""
    others: IndexArray
    """The modes that do not oscillate, shape ``(e,)``."""
    rigid: IndexArray
    """The rigid-body modes, shape ``(r,)``."""
    rates: ComplexArray
    """Rates of the terms, 1/s: of the modes that oscillate, and of the loads; shape ``(o + H,)``."""
    swinging: FloatArray
    """Moduli of `rates` where the amplitude bounds the term, else 0, 1/s, shape ``(o + H,)``."""
    driven: FloatArray
    """Angular frequencies of the harmonic loads, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases of the harmonic loads, rad, shape ``(H,)``."""
    forced: ComplexArray
    """Complex amplitudes P of the modes under the harmonic loads, Im(P exp(i angle)), kg^1/2 m, shape ``(n, H)``."""
    places: FloatArray
    """Modes at the places, kg^-1/2, shape ``(p, n)``."""
    forced_places: ComplexArray
    """Complex amplitudes of the places under the harmonic loads, m, shape ``(p, H)``."""
    ringing: IndexArray
    """Modes that are bounded by one amplitude."""
    near: IndexArray
    """Modes that are nearly critical."""
    creeping: IndexArray
    """Modes that are bounded by two amplitudes."""
    slow: FloatArray
    """The lower rate of each creeping mode, 1/s."""
    fast: FloatArray
    """The higher rate of each creeping mode, 1/s."""
    shares: FloatArray
    """Moduli of the factor of each bounded term in the motion of the places, shape ``(p, b)``."""
    fading: FloatArray
    """Rates at which the bounds fall, 1/s, shape ``(b,)``."""
    place_of: IndexArray
    """Which place each stop is at, shape ``(P,)``."""
    orientation: FloatArray
    """Sign of z in each gap function, +1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """Gap of each open stop, minus the gap of each closed one, m, shape ``(P,)``; see `Model.offset`."""
    window: float
    """Longest time for which one closed form is followed, s."""
    spacing: float
    """The usual time between knots, s; 0 without one."""
    whole: ComplexArray
    """exp(rate spacing) of each term, shape ``(o + H,)``."""
    whole_areas: ComplexArray
    """The integral of exp(rate s) over `spacing`, s, shape ``(o + H,)``."""


def ramp_tables(system: System, orientation: FloatArray, offset: FloatArray, window: float) -> RampTables:
    """The tables of a contact state with sampled forces; signs and gaps ``(P,)`` as in `Model`; `window` in s."""
    assert system.ramps is not None
    spacing = system.ramps.ramps.block_at(0.0).spacing
    omega, H = system.omega, system.driven.size
    rates, rigid = system.rates_of_terms[:-1].copy(), np.flatnonzero(omega == 0)
    ringing, near, creeping = system.bounded
    bounded = ringing.size + near.size + 2 * creeping.size + H  # without the last term, of constant forces
    made = RampTables(
        omega=omega,
        damping_rate=system.damping_rate,
        compliance=1 / np.where(omega > 0, omega, np.inf) ** 2,
        constant=system.constant,
        forces=system.ramps.shares,
        which=system.which,
        others=np.flatnonzero(~system.oscillating),
        rigid=rigid,
        rates=rates,
        swinging=system.swinging[:-1].copy(),
        driven=system.driven,
        phase=system.phase,
        forced=system.amplitudes,
        places=system.places,
        forced_places=system.place_amplitudes,
        ringing=ringing,
        near=near,
        creeping=creeping,
        slow=system.creeping_rates[0],
        fast=system.creeping_rates[1],
        shares=np.concatenate([system.bounded_shares[:, :bounded], np.abs(system.places[:, rigid])], axis=1),
        fading=np.concatenate([system.fading[:bounded], np.zeros(rigid.size)]),
        place_of=system.place_of,
        orientation=orientation,
        offset=offset,
        window=window,
        spacing=spacing,
        whole=np.exp(rates * spacing),
        whole_areas=np.expm1(rates * spacing) / rates,
    )
    return in_c_order(made)


@by_reference
class Knots(NamedTuple):
    """``K`` knots of ``R`` forces that are linear between them."""

    time: FloatArray
    """Times of the knots, s, ascending, shape ``(K,)``."""
    force: FloatArray
    """Forces at the knots, N or N/m, shape ``(K, R)``."""
    slope: FloatArray
    """Rate of each force from each knot to the next, N/s or N/(m s), shape ``(K - 1, R)``."""


@by_reference
class Interval(NamedTuple):
    """The motion of ``n`` modes and ``p`` places while the forces stay linear; see `RampTables` for the other sizes."""

    begin: FloatArray
    """Displacement of modes with stiffness under constant and linear forces at the start, kg^1/2 m, shape ``(n,)``."""
    rate: FloatArray
    """Rate of `begin`, kg^1/2 m/s, shape ``(n,)``."""
    free: FloatArray
    """Displacement and velocity of the free motion at the start, kg^1/2 m and kg^1/2 m/s, shape ``(2, n)``."""
    body: FloatArray
    """Forces on the rigid-body modes, kg^1/2 m/s2, and their rates, kg^1/2 m/s3, shape ``(2, r)``."""
    terms: ComplexArray
    """Complex amplitudes of the modes that oscillate, kg^1/2 m, and of the loads, 1; shape ``(o + H,)``."""
    at_places: ComplexArray
    """Complex amplitudes of the terms in the motion of the places, m, shape ``(p, o + H)``."""
    line: FloatArray
    """Displacement, m, and velocity, m/s, of the places that `begin` and `rate` cause, shape ``(p, 2)``."""
    bounds: FloatArray
    """Bounds on each term and its first three derivatives, divided by the `shares` of the term, shape ``(4, b)``."""
    rounding: FloatArray
    """Rounding error of the displacement of each place, m, shape ``(p,)``."""


def knots_of(ramps: Ramps) -> Knots:
    """Sampled forces as the compiled march takes them."""
    return in_c_order(Knots(ramps.time, ramps.force, ramps.slope))


def new_interval(tables: RampTables) -> Interval:
    """An interval with arrays that are not filled yet."""
    p, n = tables.places.shape
    m = tables.rates.size
    return Interval(
        np.empty(n),
        np.empty(n),
        np.empty((2, n)),
        np.empty((2, tables.rigid.size)),
        np.empty(m, dtype=np.complex128),
        np.empty((p, m), dtype=np.complex128),
        np.empty((p, 2)),
        np.empty((4, tables.fading.size)),
        np.empty(p),
    )


@njit_called()
def fading_integrals(drag: float, s: float) -> tuple[float, float, float, float, float]:
    """exp(-drag s), with drag >= 0 in 1/s, and its integrals from 0 to s, once to four times: s, s^2, s^3 and s^4."""
    x = drag * s
    if abs(x) <= _SHORT:
        series, term = 0.0, 1.0
        for n in range(_TERMS):
            series += term
            term *= -x / (5 + n)
        fourth = series * s**4 / 24
        third = s**3 / 6 - drag * fourth
        second = s**2 / 2 - drag * third
        first = s - drag * second
        return 1 - drag * first, first, second, third, fourth
    first = -math.expm1(-x) / drag
    second = (s - first) / drag
    third = (s**2 / 2 - second) / drag
    return math.exp(-x), first, second, third, (s**3 / 6 - third) / drag


@njit_inner()
def _response(a: float, omega: float, s: float) -> tuple[float, float]:
    """C and S of `fe_lapjoint.march.propagator.free_response`, of one mode that is not `System.oscillating`."""
    square = a**2 - omega**2
    root, decay = math.sqrt(abs(square)), math.exp(-a * s)
    if root == 0:
        S = decay * s
        return decay + a * S, S
    if square < 0:
        S = decay * math.sin(root * s) / root
        return decay * math.cos(root * s) + a * S, S
    slow = math.exp(-(omega**2 / (a + root)) * s)
    S = -slow * math.expm1(-2 * root * s) / (2 * root)
    return slow * (1 + math.exp(-2 * root * s)) / 2 + a * S, S


@njit_inner()
def begin_interval(
    tables: RampTables, knots: Knots, j: int, t: float, ahead: float, y: FloatArray, it: Interval
) -> None:
    """Write into `it` the closed form of the motion from time `t`, s, on, between knots j and j + 1.

    `y` holds (q, q') at `t`, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``; the bounds hold for `ahead` seconds.
    """
    n, count, H = tables.omega.size, tables.which.size, tables.driven.size
    for h in range(H):
        angle = tables.driven[h] * t + tables.phase[h]
        it.terms[count + h] = complex(math.cos(angle), math.sin(angle))
    for i in range(n):
        force, slope = tables.constant[i], 0.0
        for r in range(knots.slope.shape[1]):
            g = knots.slope[j, r]
            force += tables.forces[i, r] * (knots.force[j, r] + g * (t - knots.time[j]))
            slope += tables.forces[i, r] * g
        soft = tables.compliance[i]
        it.rate[i] = slope * soft
        it.begin[i] = (force - 2 * tables.damping_rate[i] * it.rate[i]) * soft
        x, v = y[i] - it.begin[i], y[n + i] - it.rate[i]
        for h in range(H):
            wave = tables.forced[i, h] * it.terms[count + h]
            x -= wave.imag
            v -= tables.driven[h] * wave.real
        it.free[0, i], it.free[1, i] = x, v
        if soft == 0:
            for b in range(tables.rigid.size):
                if tables.rigid[b] == i:
                    it.body[0, b], it.body[1, b] = force, slope
    for k in range(count):
        x, v = it.free[0, tables.which[k]], it.free[1, tables.which[k]]
        root = tables.rates[k]
        it.terms[k] = complex(x, (root.real * x - v) / root.imag)
    _write_places(tables, y, it)
    _write_bounds(tables, ahead, it)


@njit_inner()
def _write_places(tables: RampTables, y: FloatArray, it: Interval) -> None:
    """Write the motion of the places."""
    p, n = tables.places.shape
    count, H = tables.which.size, tables.driven.size
    for u in range(p):
        x, v, size = 0.0, 0.0, 0.0
        for i in range(n):
            share = tables.places[u, i]
            x += share * it.begin[i]
            v += share * it.rate[i]
            size += abs(share) * (abs(it.begin[i]) + abs(it.free[0, i]) + abs(y[i]))
        it.line[u, 0], it.line[u, 1] = x, v
        for k in range(count):
            it.at_places[u, k] = tables.places[u, tables.which[k]] * it.terms[k]
            size += abs(it.at_places[u, k].real) + abs(it.at_places[u, k].imag)
        for h in range(H):
            wave = -1j * tables.forced_places[u, h]
            it.at_places[u, count + h] = wave * it.terms[count + h]
            size += abs(wave)
        it.rounding[u] = _ROUNDING * size


@njit_inner()
def _write_bounds(tables: RampTables, ahead: float, it: Interval) -> None:
    """Write the bounds at the start; later each falls as exp(-fading s).  See
    `fe_lapjoint.march.propagator.Flow.envelope`."""
    b, ringing, near, creeping = 0, tables.ringing.size, tables.near.size, tables.creeping.size
    for k in range(ringing):
        i = tables.ringing[k]
        a, w = tables.damping_rate[i], tables.omega[i]
        x, v = it.free[0, i], it.free[1, i] + a * it.free[0, i]
        _powers(math.sqrt(x**2 + v**2 / (w**2 - a**2)), w, b + k, it.bounds)
    b += ringing
    for k in range(near):
        i = tables.near[k]
        a, w = tables.damping_rate[i], tables.omega[i]
        least = math.e / 2 * (a - math.sqrt(max(a**2 - w**2, 0.0)))
        x, v = it.free[0, i], it.free[1, i]
        for d in range(4):
            it.bounds[d, b + k] = abs(x) + abs(v + a * x) / least
            x, v = v, -2 * a * v - w**2 * x
    b += near
    for k in range(creeping):
        i = tables.creeping[k]
        x, v = it.free[0, i], it.free[1, i]
        first = (v + tables.fast[k] * x) / (tables.fast[k] - tables.slow[k])
        _powers(abs(first), tables.slow[k], b + k, it.bounds)
        _powers(abs(x - first), tables.fast[k], b + creeping + k, it.bounds)
    b += 2 * creeping
    for h in range(tables.driven.size):
        _powers(1.0, tables.driven[h], b + h, it.bounds)
    b += tables.driven.size
    for k in range(tables.rigid.size):  # |p''| = |f exp(-2 a s) + g e1|, and e1 <= s <= `ahead`
        drag, force, slope = 2 * tables.damping_rate[tables.rigid[k]], abs(it.body[0, k]), abs(it.body[1, k])
        it.bounds[0, b + k] = it.bounds[1, b + k] = np.inf
        it.bounds[2, b + k] = force + slope * ahead
        it.bounds[3, b + k] = force * drag + slope


@njit_inner()
def _powers(amplitude: float, rate: float, b: int, bounds: FloatArray) -> None:
    """Write the bounds on a term and its first three derivatives into column `b`: each gains a factor `rate`."""
    for d in range(4):
        bounds[d, b] = amplitude
        amplitude *= rate


@njit_inner()
def waves_of(tables: RampTables, s: float, waves: ComplexArray) -> None:
    """Write exp(rate s) of each term into `waves`, shape ``(o + H,)``."""
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
def _other_motion(tables: RampTables, it: Interval, i: int, s: float) -> tuple[float, float, float]:
    """Displacement, velocity and acceleration of a mode that does not oscillate; of a rigid-body mode under ramps,
    too."""
    a, w = tables.damping_rate[i], tables.omega[i]
    C, S = _response(a, w, s)
    x, y = it.free[0, i], it.free[1, i]
    q, v = x * C + y * S, -(w**2) * x * S + y * (C - 2 * a * S)
    acceleration = -2 * a * v - w**2 * q
    for b in range(tables.rigid.size):
        if tables.rigid[b] == i:
            e0, e1, e2, e3, _ = fading_integrals(2 * a, s)
            force, slope = it.body[0, b], it.body[1, b]
            q += force * e2 + slope * e3
            v += force * e1 + slope * e2
            acceleration += force * e0 + slope * e1
    return q, v, acceleration


@njit_inner()
def places_at(tables: RampTables, it: Interval, s: float, waves: ComplexArray, z: FloatArray) -> None:
    """Write displacement, m, velocity, m/s, and acceleration, m/s2, of the places after `s` seconds: `z`, ``(p, 3)``.

    `waves`, shape ``(o + H,)``, takes exp(rate s) of each term.
    """
    waves_of(tables, s, waves)
    for u in range(z.shape[0]):
        x, v, a = it.line[u, 0] + it.line[u, 1] * s, it.line[u, 1], 0.0
        for k in range(waves.size):
            now = it.at_places[u, k] * waves[k]
            x += now.real
            now *= tables.rates[k]
            v += now.real
            a += now.real * tables.rates[k].real - now.imag * tables.rates[k].imag
        z[u, 0], z[u, 1], z[u, 2] = x, v, a
    for i in tables.others:
        q, v, a = _other_motion(tables, it, i, s)
        for u in range(z.shape[0]):
            share = tables.places[u, i]
            z[u, 0] += share * q
            z[u, 1] += share * v
            z[u, 2] += share * a


@njit_called()
def place_at(tables: RampTables, it: Interval, u: int, s: float) -> tuple[float, float]:
    """Displacement, m, and velocity, m/s, of place `u` after `s` seconds."""
    x, v = at_place(it.at_places, tables.rates, u, s)
    x, v = x + it.line[u, 0] + it.line[u, 1] * s, v + it.line[u, 1]
    for i in tables.others:
        q, rate, _ = _other_motion(tables, it, i, s)
        x, v = x + tables.places[u, i] * q, v + tables.places[u, i] * rate
    return x, v


@njit_inner()
def state_at(tables: RampTables, it: Interval, s: float, waves: ComplexArray, order: int, q: FloatArray) -> None:
    """Write the `order`-th time derivative (0 to 2) of q after `s` seconds into `q`, kg^1/2 m / s^order, ``(n,)``.

    `waves`, shape ``(o + H,)``, holds exp(rate s) of each term.
    """
    count = tables.which.size
    for i in range(q.size):
        x = it.begin[i] + it.rate[i] * s if order == 0 else (it.rate[i] if order == 1 else 0.0)
        for h in range(tables.driven.size):
            wave, w = tables.forced[i, h] * it.terms[count + h] * waves[count + h], tables.driven[h]
            x += wave.imag if order == 0 else (w * wave.real if order == 1 else -w * w * wave.imag)
        q[i] = x
    for k in range(count):
        now = it.terms[k] * waves[k]
        for _ in range(order):
            now *= tables.rates[k]
        q[tables.which[k]] += now.real
    for i in tables.others:
        q[i] += _other_motion(tables, it, i, s)[order]


@njit_inner()
def move(tables: RampTables, it: Interval, s: float, waves: ComplexArray, y: FloatArray) -> None:
    """Write (q, q') after `s` seconds into `y`, kg^1/2 m and kg^1/2 m/s, ``(2 n,)``; `waves` as in `state_at`."""
    n = y.size // 2
    state_at(tables, it, s, waves, 0, y[:n])
    state_at(tables, it, s, waves, 1, y[n:])


@njit_called()
def moved(tables: RampTables, it: Interval, s: float) -> FloatArray:
    """(q, q') after `s` seconds, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    y, waves = zeros(2 * tables.omega.size), complex_zeros(tables.rates.shape)
    waves_of(tables, s, waves)
    move(tables, it, s, waves, y)
    return y


@njit_inner()
def areas_of(tables: RampTables, it: Interval, s: float, areas: FloatArray) -> None:
    """Add the time integrals of the places' displacements over the first `s` seconds to `areas`, m s, ``(p,)``."""
    for u in range(areas.size):
        areas[u] += s * (it.line[u, 0] + it.line[u, 1] * (s / 2))
    usual = s == tables.spacing
    for k in range(tables.rates.size):
        less = tables.whole_areas[k] if usual else _wave_area(tables.rates[k], s)
        for u in range(areas.size):
            areas[u] += (it.at_places[u, k] * less).real
    for i in tables.others:
        area = _other_area(tables, it, i, s)
        for u in range(areas.size):
            areas[u] += tables.places[u, i] * area


@njit_inner()
def _wave_area(rate: complex, s: float) -> complex:
    """The integral of exp(rate t) from 0 to `s`, s, without cancellation."""
    a, b = rate.real * s, rate.imag * s
    less = complex(math.expm1(a) * math.cos(b) - 2 * math.sin(b / 2) ** 2, math.exp(a) * math.sin(b))
    return less / rate


@njit_inner()
def _other_area(tables: RampTables, it: Interval, i: int, s: float) -> float:
    """The time integral of the displacement of a mode that does not oscillate over `s` seconds, kg^1/2 m s."""
    a, w, x, y = tables.damping_rate[i], tables.omega[i], it.free[0, i], it.free[1, i]
    for b in range(tables.rigid.size):
        if tables.rigid[b] == i:
            _, _, e2, e3, e4 = fading_integrals(2 * a, s)
            return float(x * s + y * e2 + it.body[0, b] * e3 + it.body[1, b] * e4)
    for k in range(tables.creeping.size):
        if tables.creeping[k] == i:
            slow, fast = tables.slow[k], tables.fast[k]
            first = (y + fast * x) / (fast - slow)
            return float(-first * math.expm1(-slow * s) / slow - (x - first) * math.expm1(-fast * s) / fast)
    # The equation of motion integrated once: omega^2 int q = -[q'] - 2 a [q].
    q, v, _ = _other_motion(tables, it, i, s)
    return float(-(v - y + 2 * a * (q - x)) / w**2)
