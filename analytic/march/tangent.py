r"""How small deviations from a motion travel: closed-form flow within a state, a saltation matrix at every switch.

A deviation dy = (dq, dv) is carried over a switch by

    dy_new = J dy_old + (J f_old + b - f_new) dt,    dt = (dc - grad h . dy_old) / h'

where J is the linear part of the passage, b the rate of its time-dependent part, f the rates of y on both sides, dt
by how much later a deviation switches, and h the gap function, which sets the time of the switch where it comes to c.
Under modal damping f jumps at a switch even though the spring force does not.

The level c is 0 unless h is above 0 when the state begins, because the modes of the states before and after a switch
are truncated; then c is that first h, see `analytic.march.segment`.  A deviation therefore has its own level,

    dc = grad h . dy_new + h' dt,

with the gap function, its rate and the deviation just after the switch at which the state began.  With few modes that
is a thousandth of the whole derivative.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from analytic.march.oscillator import OSCILLATING, SPLIT
from analytic.march.tables import Tables
from analytic.modes.beam_functions import ComplexArray
from lapjoint.compiled.arrays import zeros
from lapjoint.compiled.compiling import njit_inner
from lapjoint.problem import FloatArray

_DIED_OUT = -37.0
"""Natural logarithm of the amplitude ratio below which a mode's free motion counts as died out: 1e-16, the rounding of
1."""
_NOTHING = 1e-60
"""Size, kg^1/2 m or kg^1/2 m/s, below which deviations become zero as they flow.  Deviations of fast modes die out to
numbers near 1e-308, which processors multiply fifty times more slowly: a fifth of the time of a branch.  Deviations
begin as units; their largest rest is seldom below 1e-10, and parts below 1e-30 vanish in sums."""


@njit_inner()
def living(tables: Tables, slot: int, s: float) -> int:
    """Number of modes of a state, the slowest ones, whose free motion has not died out after `s` seconds."""
    n = int(tables.modes[slot])
    while n > 0 and tables.kind[slot, n - 1] == OSCILLATING and tables.root[slot, n - 1].real * s < _DIED_OUT:
        n -= 1
    return n


@njit_inner()
def flow(tables: Tables, slot: int, s: float, now: FloatArray, then: FloatArray) -> int:
    """Carry deviations `now`, ``(2 N, m)``, over `s` seconds within a state, to `then`, which may be `now`.

    Deviations (dq, dv), kg^1/2 m and kg^1/2 m/s, are columns.  The number that `living` gives is returned: the
    deviations of all faster modes are zero.
    """
    n, live = tables.modes[slot], living(tables, slot, s)
    extra = n
    for i in range(live):
        kind, root = tables.kind[slot, i], tables.root[slot, i]
        if kind == OSCILLATING:
            a, b = root.real, root.imag
            decay = math.exp(a * s)
            sine, cosine = decay * math.sin(b * s) / b, decay * math.cos(b * s)
            C, S = cosine - a * sine, sine
            C1, S1 = -(a * a + b * b) * sine, cosine + a * sine
        elif kind == SPLIT:
            first, second = root.real, tables.root[slot, extra].real
            extra += 1
            e1, e2 = math.exp(first * s), math.exp(second * s)
            S, C = (e1 - e2) / (first - second), (first * e2 - second * e1) / (first - second)
            S1, C1 = (first * e1 - second * e2) / (first - second), first * second * (e2 - e1) / (first - second)
        else:
            C, S, C1, S1 = 1.0, s, 0.0, 1.0
        for j in range(now.shape[1]):
            x, y = now[i, j], now[n + i, j]
            q, v = C * x + S * y, C1 * x + S1 * y
            then[i, j] = q if abs(q) > _NOTHING else 0.0
            then[n + i, j] = v if abs(v) > _NOTHING else 0.0
    for i in range(live, n):
        for j in range(now.shape[1]):
            then[i, j] = then[n + i, j] = 0.0
    return live


@njit_inner(inline="always")
def _write_rates(
    tables: Tables, slot: int, theta: ComplexArray, q: FloatArray, v: FloatArray, rates: FloatArray
) -> None:
    """Write the rates of a motion in one state, d(q, v)/dt, kg^1/2 m/s and kg^1/2 m/s2, shape ``(2 N,)``.

    `theta`, ``(H,)``, holds exp(i theta_h) at this time.
    """
    n = tables.modes[slot]
    extra = n
    for i in range(n):
        kind, root = tables.kind[slot, i], tables.root[slot, i]
        damping, stiffness = -2 * root.real, root.real**2 + root.imag**2
        if kind == SPLIT:
            other = tables.root[slot, extra].real
            extra += 1
            damping, stiffness = -root.real - other, root.real * other
        force = tables.force[slot, 0, i]
        for h in range(theta.size):
            force += tables.force[slot, 1 + h, i] * theta[h].imag
        if tables.owner is not None:
            force = tables.push[slot, 0, i].real
            for h in range(theta.size):
                force += (tables.push[slot, 1 + h, i] * theta[h]).imag
        rates[i] = v[i]
        rates[n + i] = force - damping * v[i] - stiffness * q[i]


class Switching(NamedTuple):
    """Scratch arrays for `saltation`."""

    delay: FloatArray
    """Delay of the switch for each deviation, s, shape ``(m,)``."""
    level: FloatArray
    """dc, m, of each stop's next switch, shape ``(P, m)``."""
    before: FloatArray
    """Rates of the motion just before a switch, kg^1/2 m/s and kg^1/2 m/s2, shape ``(2 N,)``."""
    after: FloatArray
    """Rates of the motion just after a switch, kg^1/2 m/s and kg^1/2 m/s2, shape ``(2 N,)``."""


@njit_inner()
def new_switching(level: FloatArray, modes: int) -> Switching:
    """Scratch arrays, filled with zeros, for the switches of a march with levels `level`, m, ``(P, m)``."""
    return Switching(zeros(level.shape[1]), level, zeros(2 * modes), zeros(2 * modes))


@njit_inner()
def saltation(
    tables: Tables,
    old: int,
    k: int,
    theta: ComplexArray,
    rate: float,
    q_old: FloatArray,
    v_old: FloatArray,
    q_new: FloatArray,
    v_new: FloatArray,
    live: int,
    now: FloatArray,
    then: FloatArray,
    work: Switching,
) -> None:
    """Carry deviations `now`, ``(2 N_old, m)``, over a switch of stop `k` in state `old` to `then`, ``(2 N_new, m)``.

    The motion, kg^1/2 m and kg^1/2 m/s, ``(N,)``, is `q_old` and `v_old` just before the switch, `q_new` and `v_new`
    just after; `rate` is h' at the switch, m/s, and `theta`, ``(H,)``, exp(i theta_h).  Only the deviations of the
    `live` slowest modes are not zero.  `work.delay` takes how much later each deviation switches; `work.level` is read,
    and `set_levels` has to write it anew.
    """
    new = tables.next_slot[old, k]
    n_old, n_new, m = tables.modes[old], tables.modes[new], now.shape[1]
    row = tables.passage[old, k]
    onto, mode = tables.carry_residual[row], tables.weight[old, tables.position[k]]
    delay, before, after = work.delay, work.before, work.after
    _write_rates(tables, old, theta, q_old, v_old, before)
    _write_rates(tables, new, theta, q_new, v_new, after)
    late = (tables.sign[k] if tables.closed[old, k] else -tables.sign[k]) / rate
    if tables.owner is not None:
        _saltation_of_coupled(
            tables, old, new, row, tables.position[k], late, work.level[k], rate, theta, now, then, work
        )
        return
    S = tables.carry[row][:n_new]
    for c in range(m):
        delay[c] = work.level[k, c] / rate
    for i in range(live):
        weight = late * mode[i]
        for c in range(m):
            delay[c] += weight * now[i, c]
    part = S
    if live < S.shape[1]:  # a matrix product takes rows that follow each other in memory
        part = zeros((n_new, live))
        for j in range(n_new):
            for i in range(live):
                part[j, i] = S[j, i]
    _project(part, now[:live], then[:n_new])
    _project(part, now[n_old : n_old + live], then[n_new : 2 * n_new])
    # Seen at one time, deviations that switch later have gone on with the old rates, and not with the new ones.
    for j in range(n_new):
        x, y = -after[j], -after[n_new + j]
        for i in range(n_old):
            x += S[j, i] * before[i]
            y += S[j, i] * before[n_old + i]
        for h in range(theta.size):
            x += onto[1 + h, j] * tables.omega[h] * theta[h].real
            y -= onto[1 + h, j] * tables.omega[h] ** 2 * theta[h].imag
        for c in range(m):
            then[j, c] += x * delay[c]
            then[n_new + j, c] += y * delay[c]


@njit_inner()
def _saltation_of_coupled(
    tables: Tables,
    old: int,
    new: int,
    row: int,
    u: int,
    late: float,
    level: FloatArray,
    rate: float,
    theta: ComplexArray,
    now: FloatArray,
    then: FloatArray,
    work: Switching,
) -> None:
    """`saltation` of a joint with damped stops, where `work.before` and `work.after` are known.

    `row` is the row of the switch, `u` the position of the stop, `late` its orientation over -h', s/m, and `level`, m,
    ``(m,)``, the levels of its switch; `rate` is h', m/s.
    """
    n_old, n_new, m = tables.modes[old], tables.modes[new], now.shape[1]
    delay, before, after = work.delay, work.before, work.after
    J, load = _whole_of(tables.whole[row], n_new, n_old), tables.whole_load[row]
    for c in range(m):
        delay[c] = level[c] / rate
    for b in range(2):
        for i in range(n_old):
            weight = late * tables.gradient[old, u, b, i]
            for c in range(m):
                delay[c] += weight * now[b * n_old + i, c]
    _project(J, now[: 2 * n_old], then[: 2 * n_new])
    for a in range(2):
        for j in range(n_new):
            x = -after[a * n_new + j]
            for i in range(2 * n_old):
                x += J[a * n_new + j, i] * before[i]
            for h in range(theta.size):
                x += tables.omega[h] * (load[1 + h, a, j] * theta[h]).real
            for c in range(m):
                then[a * n_new + j, c] += x * delay[c]


@njit_inner()
def _whole_of(whole: FloatArray, n_new: int, n_old: int) -> FloatArray:
    """A row of `Tables.whole`, ``(2, N, 2, N)``, as a matrix, ``(2 N_new, 2 N_old)``; without a copy if there is no
    mode to spare."""
    N = whole.shape[1]
    J = whole.reshape((2 * N, 2 * N))
    if n_new == N and n_old == N:
        return J
    part = zeros((2 * n_new, 2 * n_old))
    for a in range(2):
        for b in range(2):
            for j in range(n_new):
                for i in range(n_old):
                    part[a * n_new + j, b * n_old + i] = J[a * N + j, b * N + i]
    return part


@njit_inner()
def set_levels(
    tables: Tables,
    slot: int,
    switched: bool,
    theta: ComplexArray,
    q: FloatArray,
    v: FloatArray,
    now: FloatArray,
    work: Switching,
) -> None:
    """Write to `work.level` the levels at which deviations `now`, ``(2 N, m)``, switch next, at the beginning of a
    state.

    `theta`, ``(H,)``, `q` and `v`, ``(N,)``, are the values of the motion at this time.  If the state begins with a
    switch, `switched`, `work.delay` says by how much later each deviation began it.
    """
    level, m = work.level, now.shape[1]
    if tables.owner is not None:
        _write_rates(tables, slot, theta, q, v, work.after)
    for k in range(tables.sign.size):
        h, rise = 0.0, 0.0
        if tables.owner is None:
            h, rise = _gap_function(tables, slot, k, theta, q, v)
        elif not tables.asleep[slot, k]:
            h, rise = _gap_function_of_coupled(tables, slot, k, theta, q, v, work.after)
        for c in range(m):
            level[k, c] = 0.0
        if h <= 0:
            continue
        orientation = -tables.sign[k] if tables.closed[slot, k] else tables.sign[k]
        mode = tables.weight[slot, tables.position[k]]
        for c in range(m if switched else 0):
            level[k, c] = rise * work.delay[c]
        if tables.owner is not None:
            u, n = tables.position[k], tables.modes[slot]
            for b in range(2):
                for i in range(n):
                    weight = orientation * tables.gradient[slot, u, b, i]
                    for c in range(m):
                        level[k, c] += weight * now[b * n + i, c]
            continue
        for i in range(tables.modes[slot]):
            weight = orientation * mode[i]
            for c in range(m):
                level[k, c] += weight * now[i, c]


@njit_inner()
def _gap_function_of_coupled(
    tables: Tables, slot: int, k: int, theta: ComplexArray, q: FloatArray, v: FloatArray, rates: FloatArray
) -> tuple[float, float]:
    """`_gap_function` of a joint with damped stops; `rates`, ``(2 N,)``, are those of `_write_rates`."""
    u, n, gradient = tables.position[k], tables.modes[slot], tables.gradient[slot, tables.position[k]]
    z, z1 = tables.constant[slot, u], 0.0
    for i in range(n):
        z += gradient[0, i] * q[i] + gradient[1, i] * v[i]
        z1 += gradient[0, i] * rates[i] + gradient[1, i] * rates[n + i]
    for h in range(theta.size):
        wave: complex = tables.forced[slot, u, h]
        for i in range(n):
            wave -= complex(gradient[0, i], tables.omega[h] * gradient[1, i]) * tables.harmonic[slot, h, i]
        wave *= theta[h]
        z += wave.imag
        z1 += tables.omega[h] * wave.real
    if tables.closed[slot, k]:
        return tables.gap[k] - tables.sign[k] * z, -tables.sign[k] * z1
    return tables.sign[k] * z - tables.gap[k], tables.sign[k] * z1


@njit_inner()
def _gap_function(
    tables: Tables, slot: int, k: int, theta: ComplexArray, q: FloatArray, v: FloatArray
) -> tuple[float, float]:
    """The gap function of a stop, m, and its rate, m/s; see `analytic.march.segment`."""
    u = tables.position[k]
    z, z1 = tables.constant[slot, u], 0.0
    for i in range(tables.modes[slot]):
        z += tables.weight[slot, u, i] * q[i]
        z1 += tables.weight[slot, u, i] * v[i]
    for h in range(theta.size):
        wave: complex = tables.forced[slot, u, h]
        for i in range(tables.modes[slot]):
            wave -= tables.weight[slot, u, i] * tables.harmonic[slot, h, i]
        wave *= theta[h]
        z += wave.imag
        z1 += tables.omega[h] * wave.real
    if tables.closed[slot, k]:
        return tables.gap[k] - tables.sign[k] * z, -tables.sign[k] * z1
    return tables.sign[k] * z - tables.gap[k], tables.sign[k] * z1


@njit_inner()
def _project(S: FloatArray, now: FloatArray, then: FloatArray) -> None:
    """Write S times deviations `now`, ``(N_old, m)``, to `then`, ``(N_new, m)``.

    For one deviation loops over so few modes take less time than a call of a matrix product.
    """
    if now.shape[1] > 1:
        np.dot(S, now, then)
        return
    for j in range(S.shape[0]):
        x = 0.0
        for i in range(S.shape[1]):
            x += S[j, i] * now[i, 0]
        then[j, 0] = x
