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
    n, H, R = tables.modes[slot], theta.size, ramps.slope.shape[1]
    extra = n
    for i in range(n):
        x, y = q[i], v[i]
        for h in range(H):
            wave = tables.harmonic[slot, h, i] * theta[h]
            x -= wave.imag
            y -= tables.omega[h] * wave.real
        force, slope = tables.force[slot, 0, i], 0.0
        if ramps.rigid[slot, 0] != i and ramps.rigid[slot, 1] != i:
            x -= tables.static[slot, i, 0]
            for r in range(R):
                g = ramps.slope[j, r]
                f = ramps.force[j, r] + g * (t - ramps.time[j])
                x -= f * ramps.gain[slot, r, i] + g * ramps.lag[slot, r, i]
                y -= g * ramps.gain[slot, r, i]
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
        for r in range(R):
            g, p = ramps.slope[j, r], tables.force[slot, 1 + H + r, i]
            force += p * (ramps.force[j, r] + g * (t - ramps.time[j]))
            slope += p * g
        b = 0 if ramps.rigid[slot, 0] == i else 1
        body[b, 0], body[b, 1], body[b, 2] = x, y, force - ramps.drag[slot] * y
        body[b, 3] = slope - ramps.drag[slot] * body[b, 2]


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
                body[b, 3] += change * tables.force[slot, 1 + theta.size + r, ramps.rigid[slot, b]]


@njit_called()
def move_body(drag: float, s: float, body: FloatArray) -> None:
    """Advance the rigid-body modes, of twice the damping rate `drag`, 1/s, by `s` seconds without a knot, in place."""
    e0, e1, e2, e3, _ = fading_powers(drag, s)
    for b in range(2):
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
    """Write the time derivative of `order` 0 to 2 of q at `t`, s, to `q`, ``(N,)``, kg^1/2 m over s^order."""
    for i in range(tables.modes[slot]):
        x = tables.static[slot, i, 0] if order == 0 else 0.0
        for h in range(theta.size):
            wave, w = tables.harmonic[slot, h, i] * theta[h], tables.omega[h]
            x += wave.imag if order == 0 else (w * wave.real if order == 1 else -w * w * wave.imag)
        for r in range(ramps.slope.shape[1]):
            g = ramps.slope[j, r]
            if order == 0:
                f = ramps.force[j, r] + g * (t - ramps.time[j])
                x += f * ramps.gain[slot, r, i] + g * ramps.lag[slot, r, i]
            elif order == 1:
                x += g * ramps.gain[slot, r, i]
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
    """Write z at the stops' positions but for terms and harmonics: `drift`, ``(U, 3)``, and its third derivative."""
    for u in range(jerk.size):
        drift[u, 0], drift[u, 1], drift[u, 2], jerk[u] = ramps.still[slot, u], 0.0, 0.0, 0.0
        for r in range(ramps.slope.shape[1]):
            g, gain = ramps.slope[j, r], ramps.gain_at_stops[slot, u, r]
            drift[u, 0] += (ramps.force[j, r] + g * (t - ramps.time[j])) * gain + g * ramps.lag_at_stops[slot, u, r]
            drift[u, 1] += g * gain
        for b in range(2):
            if ramps.rigid[slot, b] >= 0:
                weight = tables.weight[slot, u, ramps.rigid[slot, b]]
                drift[u, 0] += weight * body[b, 0]
                drift[u, 1] += weight * body[b, 1]
                drift[u, 2] += weight * body[b, 2] / 2
                jerk[u] += weight * body[b, 3]


@njit_inner()
def carry_ramps(
    tables: Tables, ramps: RampTables, slot: int, stop: int, t: float, harmonics: int, q: FloatArray, v: FloatArray
) -> None:
    """Add to `q` and `v`, ``(N,)``, the part of the left-out modes that a switch at `t`, s, carries over under the
    ramps.

    `slot` is the state before the switch of `stop`; `q`, kg^1/2 m, and `v`, kg^1/2 m/s, are the coordinates after it.
    See `analytic.march.switching.switch`.
    """
    j, onto = interval_at(ramps, ramps.interval[0], t), tables.carry_residual[tables.passage[slot, stop]]
    for r in range(ramps.slope.shape[1]):
        g = ramps.slope[j, r]
        f = ramps.force[j, r] + g * (t - ramps.time[j])
        for i in range(tables.modes[tables.next_slot[slot, stop]]):
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
    """Write the modal displacements and two time derivatives, ``(m, 3, N)``, kg^1/2 m over powers of s, to `result`.

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
        for order in range(3):
            state_on_ramps(tables, ramps, slot, j, t[i], theta, now, moved, order, result[i, order])
