"""The closed form of one state under forces that are linear between knots, and how it goes on over a knot.

See `analytic.march.ramps` for the closed form; `analytic.march.segment` searches it for switches.

Arguments are named as in `analytic.march.terms`; `ramps` are the `RampTables`, `j` is the interval between knots, and
`body`, shape ``(2, 4)``, holds q and its first three derivatives of the rigid-body modes at the start of the present
closed form, kg^1/2 m over powers of s.
"""

from __future__ import annotations

import math

from analytic.march.gap_function import fading_powers
from analytic.march.oscillator import OSCILLATING, SPLIT
from analytic.march.ramps import RampTables
from analytic.march.tables import IntArray, Tables
from analytic.march.terms import set_phases, turn_exactly
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

_ROUNDINGS = 1e-15  # relative to the time: rounding error of the distance of two knots


@njit_inner()
def interval_at(ramps: RampTables, first: int, t: float) -> int:
    """The interval between knots, from 0 to K - 2, in which the time `t`, s, lies; `first` is an interval not after it.

    At a knot, it is the interval after the knot; before the first knot and after the last one the nearest ramp goes on.
    """
    j = first
    while j < ramps.time.size - 2 and ramps.time[j + 1] <= t:
        j += 1
    return j


@njit_inner()
def load_at(ramps: RampTables, j: int, r: int, t: float) -> tuple[float, float, float, float]:
    """Load `r` at `t`, s, in interval `j`, and its three derivatives."""
    s = t - ramps.time[j]
    if r < ramps.slope.shape[1]:
        g = ramps.slope[j, r]
        return ramps.force[j, r] + g * s, g, 0.0, 0.0
    y, v, a, jerk = ramps.base[j, 0], ramps.base[j, 1], ramps.base[j, 2], ramps.base[j, 3]
    return y + s * (v + s * (a / 2 + s * jerk / 6)), v + s * (a + s * jerk / 2), a + s * jerk, jerk


@njit_inner()
def up_to_knot(ramps: RampTables, j: int, base: float, end: float) -> tuple[float, float, bool]:
    """End and duration, s, of the closed form that begins at `base`, s, in interval `j`, and whether it is all of `j`.

    It ends at the next knot, or at `end`, s.  All intervals of evenly spaced knots last `ramps.spacing`, to the bit.
    """
    until = min(ramps.time[j + 1], end) if j < ramps.time.size - 2 else end
    width = until - base
    whole = base == ramps.time[j] and j < ramps.time.size - 2 and until == ramps.time[j + 1]
    if whole and abs(width - ramps.spacing) <= _ROUNDINGS * until:
        return until, ramps.spacing, True
    return until, width, False


@njit_inner()
def turn_whole(
    tables: Tables,
    ramps: RampTables,
    slot: int,
    theta0: ComplexArray,
    term0: ComplexArray,
    theta: ComplexArray,
    term: ComplexArray,
) -> None:
    """Write phases ``(H,)`` and terms ``(T,)`` at the end of a whole interval, from those at its start."""
    for k in range(term0.size):
        term[k] = term0[k] * ramps.whole[slot, k]
    for h in range(theta.size):
        angle = tables.omega[h] * ramps.spacing
        theta[h] = theta0[h] * complex(math.cos(angle), math.sin(angle))


@njit_inner()
def start_on_ramps(
    tables: Tables,
    ramps: RampTables,
    slot: int,
    j: int,
    t: float,
    theta: ComplexArray,
    q: FloatArray,
    v: FloatArray,
    term: ComplexArray,
    body: FloatArray,
) -> None:
    """Write the constants `term` of (32), ``(T,)``, and `body` of a state that starts at `t`, s, from `q`, `v`."""
    n, H, R, L = tables.modes[slot], theta.size, ramps.slope.shape[1], ramps.gain.shape[1]
    extra = n
    for i in range(n):
        x, y = q[i], v[i]
        for h in range(H):
            wave = tables.harmonic[slot, h, i] * theta[h]
            x -= wave.imag
            y -= tables.omega[h] * wave.real
        for r in range(L):
            f, g, bend, _ = load_at(ramps, j, r, t)
            x -= f * ramps.gain[slot, r, i] + g * ramps.lag[slot, r, i]
            y += g * (ramps.jolt[slot, r, i] - ramps.gain[slot, r, i]) - bend * ramps.lag[slot, r, i]
        if ramps.rigid[slot, 0] != i and ramps.rigid[slot, 1] != i:
            x -= tables.static[slot, i, 0]
            if tables.kind[slot, i] == OSCILLATING:
                root = tables.root[slot, i]
                term[i] = complex(x, -(y - root.real * x) / root.imag)
            else:
                first, second = tables.root[slot, i].real, tables.root[slot, extra].real
                term[i] = (y - second * x) / (first - second)
                term[extra] = (first * x - y) / (first - second)
                extra += 1
            continue
        term[i] = 0.0
        if tables.kind[slot, i] == SPLIT:
            term[extra] = 0.0
            extra += 1
        b = 0 if ramps.rigid[slot, 0] == i else 1
        force, slope, drag = ramps.pull[slot, b, 0, 0], 0.0, drag_of(ramps, slot, b)
        for r in range(R):
            f, g, _, _ = load_at(ramps, j, r, t)
            pull = ramps.pull[slot, b, 1 + r]
            force += pull[0] * f + pull[1] * g
            slope += pull[0] * g
        body[b, 0], body[b, 1], body[b, 2] = x, y, force - drag * y
        body[b, 3] = slope - drag * body[b, 2]


@njit_inner()
def over_knot(
    tables: Tables,
    ramps: RampTables,
    slot: int,
    j: int,
    s: float,
    theta: ComplexArray,
    term: ComplexArray,
    body: FloatArray,
) -> None:
    """Change the slope of the forces at the knot where interval `j` begins; the closed form before it lasted `s`
    seconds.

    `theta`, ``(H,)``, is written.  `term`, ``(T,)``, holds the terms at the end of the interval before, and `body` the
    rigid-body modes at its start; both are changed in place.
    """
    set_phases(tables, ramps.time[j], theta)
    move_body(ramps.drag[slot], s, body)
    for r in range(ramps.slope.shape[1]):
        change, kick = ramps.slope[j, r] - ramps.slope[j - 1, r], ramps.kick[slot, r]
        for t in range(tables.terms[slot]):
            term[t] += change * kick[t]
        for b in range(2):
            if ramps.rigid[slot, b] >= 0:
                pull, drag, i = ramps.pull[slot, b, 1 + r], drag_of(ramps, slot, b), ramps.rigid[slot, b]
                speed = (pull[2] - ramps.gain[slot, r, i]) * change
                body[b, 0] -= ramps.lag[slot, r, i] * change
                acceleration = pull[1] * change - drag * speed
                body[b, 1] += speed
                body[b, 2] += acceleration
                body[b, 3] += pull[0] * change - drag * acceleration


@njit_inner()
def drag_of(ramps: RampTables, slot: int, b: int) -> float:
    """Twice the damping rate of rigid-body mode `b`, 1/s."""
    return float(ramps.drag[slot, b if ramps.drag.shape[1] > 1 else 0])


@njit_called()
def move_body(drag: FloatArray, s: float, body: FloatArray) -> None:
    """Advance the rigid-body modes, of twice the damping rates `drag`, 1/s, by `s` seconds without a knot, in place."""
    e0, e1, e2, e3, _ = fading_powers(drag[0], s)
    for b in range(2):
        if b > 0 and drag.size > 1:
            e0, e1, e2, e3, _ = fading_powers(drag[b], s)
        x, y, a, jerk = body[b, 0], body[b, 1], body[b, 2], body[b, 3]
        body[b, 0] = x + s * (y + s * a / 2) + jerk * e3
        body[b, 1] = y + s * a + jerk * e2
        body[b, 2], body[b, 3] = a + jerk * e1, jerk * e0


@njit_inner()
def state_on_ramps(
    tables: Tables,
    ramps: RampTables,
    slot: int,
    j: int,
    t: float,
    theta: ComplexArray,
    term: ComplexArray,
    body: FloatArray,
    order: int,
    q: FloatArray,
) -> None:
    """Write the time derivative of `order` 0 to 3 of q at `t`, s, to `q`, ``(N,)``, kg^1/2 m over s^order."""
    for i in range(tables.modes[slot]):
        x = tables.static[slot, i, 0] if order == 0 else 0.0
        for h in range(theta.size):
            wave, w = tables.harmonic[slot, h, i] * theta[h], tables.omega[h]
            if order == 0 or order == 2:
                x += wave.imag if order == 0 else -w * w * wave.imag
            else:
                x += w * wave.real if order == 1 else -w * w * w * wave.real
        for r in range(ramps.gain.shape[1]):
            f, g, bend, jerk = load_at(ramps, j, r, t)
            if order == 1:
                f, g = g, bend
            elif order > 1:
                f, g = (bend, jerk) if order == 2 else (jerk, 0.0)
            x += f * ramps.gain[slot, r, i] + g * ramps.lag[slot, r, i]
        q[i] = x
    for k in range(tables.terms[slot]):
        root, value = tables.root[slot, k], term[k]
        for _ in range(order):
            value *= root
        q[tables.mode_of[slot, k]] += value.real
    for b in range(2):
        if ramps.rigid[slot, b] >= 0:
            q[ramps.rigid[slot, b]] += body[b, order]


@njit_inner()
def carried_on_ramps(
    tables: Tables,
    ramps: RampTables,
    slot: int,
    j: int,
    t: float,
    theta: ComplexArray,
    term: ComplexArray,
    body: FloatArray,
    q: FloatArray,
    v: FloatArray,
) -> None:
    """Write the coordinates that the march carries on from `t`, s: q, kg^1/2 m, and v, kg^1/2 m/s, ``(N,)`` each."""
    state_on_ramps(tables, ramps, slot, j, t, theta, term, body, 0, q)
    state_on_ramps(tables, ramps, slot, j, t, theta, term, body, 1, v)
    if tables.owner is not None and tables.coupled[slot]:
        for r in range(ramps.gain.shape[1]):
            _, g, _, _ = load_at(ramps, j, r, t)
            for i in range(tables.modes[slot]):
                v[i] -= ramps.jolt[slot, r, i] * g


@njit_inner()
def polynomial_on_ramps(
    tables: Tables,
    ramps: RampTables,
    slot: int,
    j: int,
    t: float,
    body: FloatArray,
    drift: FloatArray,
    jerk: FloatArray,
) -> None:
    """Write z at the stops' positions but for terms and harmonics: `drift`, ``(U, 3)``, and the parts of its third
    derivative, ``(U, C)``."""
    parts = jerk.shape[1]
    for u in range(jerk.shape[0]):
        drift[u, 0], drift[u, 1], drift[u, 2] = ramps.still[slot, u], 0.0, 0.0
        for c in range(parts):
            jerk[u, c] = 0.0
        for r in range(ramps.gain.shape[1]):
            f, g, bend, third = load_at(ramps, j, r, t)
            gain, lag = ramps.gain_at_stops[slot, u, r], ramps.lag_at_stops[slot, u, r]
            drift[u, 0] += f * gain + g * lag
            drift[u, 1] += g * gain + bend * lag
            drift[u, 2] += (bend * gain + third * lag) / 2
            jerk[u, parts - 1] += third * gain
        for b in range(2):
            if ramps.rigid[slot, b] >= 0:
                weight, by_speed = ramps.rigid_at_stops[slot, u, b, 0], ramps.rigid_at_stops[slot, u, b, 1]
                drift[u, 0] += weight * body[b, 0] + by_speed * body[b, 1]
                drift[u, 1] += weight * body[b, 1] + by_speed * body[b, 2]
                drift[u, 2] += (weight * body[b, 2] + by_speed * body[b, 3]) / 2
                jerk[u, b if parts > 1 else 0] += (weight - drag_of(ramps, slot, b) * by_speed) * body[b, 3]


@njit_inner()
def carry_ramps(
    tables: Tables, ramps: RampTables, slot: int, stop: int, t: float, harmonics: int, q: FloatArray, v: FloatArray
) -> None:
    """Add to `q` and `v`, ``(N,)``, the part of the left-out modes that a switch at `t`, s, carries over under the
    ramps.

    `slot` is the state before the switch of `stop`; `q`, kg^1/2 m, and `v`, kg^1/2 m/s, are the coordinates after it.
    See `analytic.march.switching.switch`.
    """
    j, row = interval_at(ramps, ramps.interval[0], t), tables.passage[slot, stop]
    onto = tables.carry_residual[row]
    for r in range(ramps.gain.shape[1]):
        f, g, _, _ = load_at(ramps, j, r, t)
        for i in range(tables.modes[tables.next_slot[slot, stop]]):
            if tables.owner is not None:
                whole = tables.whole_load[row, 1 + harmonics + r]
                q[i] += f * whole[0, i].real + g * whole[0, i].imag
                v[i] += f * whole[1, i].real + g * whole[1, i].imag
                continue
            q[i] += f * onto[1 + harmonics + r, i]
            v[i] += g * onto[1 + harmonics + r, i]


@njit_called()
def coordinates_on_ramps(
    tables: Tables,
    ramps: RampTables,
    slots: IntArray,
    start: FloatArray,
    q: FloatArray,
    v: FloatArray,
    which: IntArray,
    t: FloatArray,
    result: FloatArray,
) -> None:
    """Write the modal displacements and their time derivatives, ``(m, orders, N)``, kg^1/2 m over powers of s, to
    `result`.

    The ``M`` segments have the states `slots` and start at `start`, s, from `q`, kg^1/2 m, and `v`, kg^1/2 m/s, ``(M,
    N)``.  The ``m`` times `t`, s, and their segments `which` are ascending.
    """
    theta, none = complex_zeros(tables.omega.size), complex_zeros(0)
    term, now = complex_zeros((2, tables.root.shape[1]))
    body, moved, slot, j, base = zeros((2, 4)), zeros((2, 4)), 0, 0, 0.0
    for i in range(t.size):
        if i == 0 or which[i] != which[i - 1]:
            slot, base = slots[which[i]], start[which[i]]
            j = interval_at(ramps, j, base)
            set_phases(tables, base, theta)
            start_on_ramps(tables, ramps, slot, j, base, theta, q[which[i]], v[which[i]], term, body)
        terms = tables.terms[slot]
        while j < ramps.time.size - 2 and ramps.time[j + 1] <= t[i]:
            s = ramps.time[j + 1] - base
            if base == ramps.time[j] and abs(s - ramps.spacing) <= _ROUNDINGS * ramps.time[j + 1]:
                for k in range(terms):
                    term[k] *= ramps.whole[slot, k]
            else:
                turn_exactly(tables.root[slot], tables.omega[:0], terms, s, term, none)
            j += 1
            base = ramps.time[j]
            over_knot(tables, ramps, slot, j, s, theta, term, body)
        put(now, term)
        put(moved[0], body[0])
        put(moved[1], body[1])
        turn_exactly(tables.root[slot], tables.omega[:0], terms, t[i] - base, now, none)
        move_body(ramps.drag[slot], t[i] - base, moved)
        set_phases(tables, t[i], theta)
        for order in range(result.shape[1]):
            state_on_ramps(tables, ramps, slot, j, t[i], theta, now, moved, order, result[i, order])
