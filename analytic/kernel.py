"""The compiled march: each contact state in closed form up to the first switch, then on in the next state.

Between switches every stop sees a gap function

    h(s) = Re sum_t c_t exp(lambda_t s) + a0 + a1 s + a2 s^2,    h <= 0,

oriented so that h rising through 0 is the next switch (an open stop closes, a closed stop opens).  From h, h', h''
at s and the bound |h'''| <= B = sum |c_t exp(lambda_t s)| |lambda_t|^3, which holds from s on because no term
grows, the cubic

    h + h' tau + h'' tau^2 / 2 + B tau^3 / 6

lies above h(s + tau).  Up to the first root of the cubic no switch is possible: that is the step.  Close to a
switch the root converges to it cubically from below; elsewhere the steps are as long as the bound allows.  No
impact, rebound or graze can be stepped over.

Two things make it fast, and change nothing of this.  Far from a switch the high modes need not be summed: they
cannot move h by more than sum |c_t|, and with that added to h the cubic of the low modes alone is a bound.  And the
terms are turned from step to step by products with tabulated exp(lambda tau), tau = longest / 2^j; only the last,
shortest steps before a switch, and the end of the march, take a power series or exponentials.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from analytic.state import OSCILLATING, SPLIT

NO_SWITCH = -1
DONE, MISSING_STATE, LOG_FULL, TOO_MANY, STUCK = 0, 1, 2, 3, 4
_RESOLUTION = 1e-12  # s: a switch certified to lie within this time is there
_FRESH = 1e-9  # s: a stop that switched less than this ago must leave its gap before it can switch again
_CLOSE = 1e-9  # s
_MAX_STEPS = 10_000_000  # within one state
_FIRST_MODES = 5  # summed first; then twice as many, and so on
_SERIES = 0.25  # |lambda tau| up to which exp is summed as a series
_RECIPROCALS = 1.0 / np.maximum(np.arange(14), 1)  # 0.25^13 / 13! is below 1e-17
_BITS = 3  # of a step that are kept when it is rounded down to tabulated ones
_SUM = {"reassoc", "contract", "nsz"}  # lets sums be vectorised


class Log(NamedTuple):
    """Room for ``M`` segments of a motion, one row each."""

    slot: Any
    start: Any
    end: Any
    q: Any
    """Modal displacements at the start, shape ``(M, N)``."""
    v: Any
    q_end: Any
    v_end: Any
    stop: Any
    """The stop that switches at the end, or NO_SWITCH."""
    rate: Any
    """h' of that stop there, m/s."""
    area: Any
    """Time integral of the penetration of each closed stop, m s, shape ``(M, P)``."""
    deepest: Any
    """Deepest penetration of each closed stop, m, shape ``(M, P)``."""


def new_log(rows: int, modes: int, stops: int) -> Log:
    """An empty log."""
    return Log(
        slot=np.zeros(rows, dtype=np.int64),
        start=np.zeros(rows),
        end=np.zeros(rows),
        q=np.zeros((rows, modes)),
        v=np.zeros((rows, modes)),
        q_end=np.zeros((rows, modes)),
        v_end=np.zeros((rows, modes)),
        stop=np.full(rows, NO_SWITCH, dtype=np.int64),
        rate=np.zeros(rows),
        area=np.zeros((rows, stops)),
        deepest=np.zeros((rows, stops)),
    )


@njit(cache=True)
def amplitudes(
    q: Any, v: Any, theta: Any, omega: Any, kind: Any, roots: Any, static: Any, harmonic: Any
) -> tuple[Any, Any]:
    """Constants of (32) from the state at the start: complex ``(N, 2)``, and polynomials ``(N, 3)``."""
    n = q.size
    c = np.zeros((n, 2), dtype=np.complex128)
    poly = static.copy()
    for i in range(n):
        x, y = q[i] - static[i, 0], v[i] - static[i, 1]
        for h in range(theta.size):
            wave = harmonic[h, i] * np.exp(1j * theta[h])
            x -= wave.imag
            y -= (1j * omega[h] * wave).imag
        if kind[i] == OSCILLATING:
            root = roots[i, 0]
            c[i, 0] = complex(x, -(y - root.real * x) / root.imag)
        elif kind[i] == SPLIT:
            first, second = roots[i, 0].real, roots[i, 1].real
            c[i, 0] = (y - second * x) / (first - second)
            c[i, 1] = (first * x - y) / (first - second)
        else:
            poly[i, 0] += x
            poly[i, 1] += y
    return c, poly


@njit(cache=True)
def first_root_of_bound(h: float, h1: float, h2: float, b3: float, most: float) -> float:
    """A time just below the first tau where h + h1 tau + h2 tau^2/2 + b3 tau^3/6 rises through 0; `most` if none is
    before it; h <= 0."""
    # A glance first: on [0, most] the cubic stays below its positive parts.
    if h + most * (max(h1, 0.0) + most * (max(h2, 0.0) / 2 + most * b3 / 6)) < 0:
        return most
    lo, hi = 0.0, -1.0
    discriminant = h2 * h2 - 2 * b3 * h1
    if discriminant > 0:
        split = math.sqrt(discriminant)
        # the smaller and the larger root of the derivative, without cancellation
        if h2 > 0:
            r1 = (-h2 - split) / b3
            r2 = -2 * h1 / (h2 + split)
        else:
            r2 = (-h2 + split) / b3
            r1 = 2 * h1 / (-h2 + split)
        if r1 > 0 and h + r1 * (h1 + r1 * (h2 / 2 + r1 * b3 / 6)) >= 0:
            hi = r1
        elif r2 > 0:
            lo = r2
    # From `lo` to the root the cubic rises.  No third of |h| is made up for before this:
    third = -h / 3
    safe = most
    if h1 * safe > third:
        safe = third / h1
    if h2 * safe * safe > 2 * third:
        safe = math.sqrt(2 * third / h2)
    if b3 * safe * safe * safe > 6 * third:
        safe = (6 * third / b3) ** (1 / 3)
    lo = max(lo, 0.999 * safe)
    if lo >= most:
        return most
    if hi < 0:
        hi = lo + max(lo, 1e-12)
        while h + hi * (h1 + hi * (h2 / 2 + hi * b3 / 6)) < 0:
            lo = hi
            if lo >= most:
                return most
            hi = 2 * hi
    return min(_root_from_below(h, h1, h2, b3, lo, hi), most)


@njit(cache=True)
def _root_from_below(h: float, h1: float, h2: float, b3: float, lo: float, hi: float) -> float:
    """A time at most a thousandth below the root of a cubic that rises from `lo` to `hi`."""
    x = 0.5 * (lo + hi)
    for _ in range(60):
        value = h + x * (h1 + x * (h2 / 2 + x * b3 / 6))
        if value < 0:
            lo = x
        else:
            hi = x
        if hi - lo <= 1e-3 * hi:
            break
        slope = h1 + x * (h2 + x * b3 / 2)
        # Newton's step, or just below it, so that `lo` comes close to the root in the next one.
        newton = (x - value / slope) * (1 - 4e-4) if slope > 0 else lo
        x = newton if lo < newton < hi else 0.5 * (lo + hi)
        if value < 0 and 0 < newton - lo < 3e-4 * lo:
            break
    return lo


@njit(cache=True)
def start_terms(tables: Any, slot: int, theta: Any, q: Any, v: Any, term: Any, poly: Any) -> None:
    """Write the terms c_t and the polynomials of a state that starts from (q, v) at the phases theta."""
    n = tables.modes[slot]
    extra = n
    for i in range(n):
        for order in range(3):
            poly[i, order] = tables.static[slot, i, order]
        x, y = q[i] - poly[i, 0], v[i] - poly[i, 1]
        for h in range(theta.size):
            wave = tables.harmonic[slot, h, i] * theta[h]
            x -= wave.imag
            y -= tables.omega[h] * wave.real
        kind = tables.kind[slot, i]
        term[i] = 0.0
        if kind == OSCILLATING:
            root = tables.root[slot, i]
            term[i] = complex(x, -(y - root.real * x) / root.imag)
        elif kind == SPLIT:
            first, second = tables.root[slot, i].real, tables.root[slot, extra].real
            term[i] = (y - second * x) / (first - second)
            term[extra] = (first * x - y) / (first - second)
            extra += 1
        else:
            poly[i, 0] += x
            poly[i, 1] += y


@njit(cache=True)
def state_from_terms(tables: Any, slot: int, theta: Any, s: float, term: Any, poly: Any, q: Any, v: Any) -> None:
    """Write the modal displacements and velocities that belong to terms at the time `s` after the start."""
    n, terms = tables.modes[slot], tables.terms[slot]
    for i in range(n):
        q[i] = poly[i, 0] + s * (poly[i, 1] + s * poly[i, 2])
        v[i] = poly[i, 1] + 2 * s * poly[i, 2]
        for h in range(theta.size):
            wave = tables.harmonic[slot, h, i] * theta[h]
            q[i] += wave.imag
            v[i] += tables.omega[h] * wave.real
    for t in range(terms):
        i = tables.mode_of[slot, t]
        q[i] += term[t].real
        v[i] += (tables.root[slot, t] * term[t]).real


@njit(cache=True)
def _turn_by_table(tables: Any, slot: int, tau: float, term: Any, theta: Any) -> float:
    """Turn terms and phases by `tau` rounded down to three binary digits; returns the step made."""
    turned, terms = 0.0, tables.terms[slot]
    step, bits = tables.longest, 0
    for j in range(tables.turn.shape[1]):
        if turned + step <= tau:
            for t in range(terms):
                term[t] *= tables.turn[slot, j, t]
            for h in range(theta.size):
                theta[h] *= tables.harmonic_turn[j, h]
            turned += step
            bits += 1
        elif bits > 0:
            bits += 1
        if bits == _BITS:
            break
        step *= 0.5
    return turned


@njit(cache=True)
def _turn_by_series(tables: Any, slot: int, tau: float, fastest: float, term: Any, theta: Any) -> None:
    """Turn terms and phases by a `tau` so short that exp is a short series."""
    order, left = 1, fastest * tau
    while left > 1e-17 and order < _RECIPROCALS.size - 1:
        order += 1
        left *= fastest * tau * _RECIPROCALS[order]
    for t in range(tables.terms[slot]):
        a, b = tables.root[slot, t].real * tau, tables.root[slot, t].imag * tau
        x, y = 1.0, 0.0
        for n in range(order, 0, -1):
            r = _RECIPROCALS[n]
            x, y = 1.0 + r * (x * a - y * b), r * (x * b + y * a)
        term[t] *= complex(x, y)
    for h in range(theta.size):
        theta[h] *= complex(math.cos(tables.omega[h] * tau), math.sin(tables.omega[h] * tau))


@njit(cache=True)
def turn_exactly(tables: Any, slot: int, tau: float, term: Any, theta: Any) -> None:
    """Turn terms and phases by any `tau`."""
    for t in range(tables.terms[slot]):
        term[t] *= np.exp(tables.root[slot, t] * tau)
    for h in range(theta.size):
        theta[h] *= complex(math.cos(tables.omega[h] * tau), math.sin(tables.omega[h] * tau))


@njit(cache=True, fastmath=_SUM)
def _add_terms(weight: Any, term: Any, root: Any, lo: int, hi: int) -> tuple[float, float, float, float]:
    """z, z', z'' and the bound on |z'''| of the terms `lo` to `hi` at one position."""
    z, z1, z2, b3 = 0.0, 0.0, 0.0, 0.0
    for t in range(lo, hi):
        w, x, y = weight[t], term[t].real, term[t].imag
        a, b = root[t].real, root[t].imag
        x1, y1 = a * x - b * y, a * y + b * x
        z += w * x
        z1 += w * x1
        z2 += w * (a * x1 - b * y1)
        square = a * a + b * b
        b3 += abs(w) * square * math.sqrt(square * (x * x + y * y))
    return z, z1, z2, b3


@njit(cache=True)
def _at_position(tables: Any, slot: int, u: int, s: float, theta: Any, drift: Any, out: Any) -> None:
    """Write what does not depend on the modal terms: z, z', z'' and the bound, at one position."""
    out[u, 0] = drift[u, 0] + s * (drift[u, 1] + s * drift[u, 2])
    out[u, 1] = drift[u, 1] + 2 * s * drift[u, 2]
    out[u, 2] = 2 * drift[u, 2]
    out[u, 3] = 0.0
    for h in range(theta.size):
        wave, omega = tables.forced[slot, u, h] * theta[h], tables.omega[h]
        out[u, 0] += wave.imag
        out[u, 1] += omega * wave.real
        out[u, 2] -= omega * omega * wave.imag
        out[u, 3] += omega**3 * abs(wave)


@njit(cache=True)
def _sum_all(tables: Any, slot: int, s: float, theta: Any, term: Any, drift: Any, out: Any) -> None:
    for u in range(out.shape[0]):
        _at_position(tables, slot, u, s, theta, drift, out)
        z, z1, z2, b3 = _add_terms(tables.weight[slot, u], term, tables.root[slot], 0, tables.terms[slot])
        out[u, 0] += z
        out[u, 1] += z1
        out[u, 2] += z2
        out[u, 3] += b3


@njit(cache=True)
def _lowest_between(
    tables: Any,
    slot: int,
    k: int,
    lo: float,
    hi: float,
    start_theta: Any,
    start_term: Any,
    drift: Any,
) -> float:
    """h of a closed stop `k` at its minimum between `lo`, where h' < 0, and `hi`, where h' >= 0."""
    orientation, u = -tables.sign[k], tables.position[k]
    work_theta, work_term, out = start_theta.copy(), start_term.copy(), np.zeros((tables.forced.shape[1], 4))
    h, s = 0.0, 0.5 * (lo + hi)
    for _ in range(60):
        work_theta[:] = start_theta
        work_term[:] = start_term
        turn_exactly(tables, slot, s, work_term, work_theta)
        _sum_all(tables, slot, s, work_theta, work_term, drift, out)
        h = orientation * out[u, 0] + tables.gap[k]
        h1, h2 = orientation * out[u, 1], orientation * out[u, 2]
        if h1 < 0:
            lo = s
        else:
            hi = s
        newton = s - h1 / h2 if h2 > 0 else lo
        following = newton if lo < newton < hi else 0.5 * (lo + hi)
        if abs(following - s) < 1e-13 + 1e-9 * abs(s):
            break
        s = following
    return h


@njit(cache=True)
def follow(
    tables: Any,
    slot: int,
    horizon: float,
    fresh: Any,
    depth: bool,
    theta: Any,
    term: Any,
    poly: Any,
    deepest: Any,
    area: Any,
) -> tuple[float, int, float, int]:
    """Follow one state from given terms and phases up to its first switch, or for `horizon` seconds.

    ``theta`` holds exp(i theta_h), ``term`` the c_t; both are turned to the end.  ``fresh`` marks stops that switched
    a moment ago: one that does not leave 0 at once has to pass a threshold of rounding size before it can switch
    again.  ``deepest`` (only if `depth`) and ``area`` are written.  Returns the time, the stop (NO_SWITCH if none,
    -2 if the steps ran out), its h', and the number of steps.
    """
    stops, positions = tables.sign.size, tables.forced.shape[1]
    n, terms = tables.modes[slot], tables.terms[slot]
    root, weight = tables.root[slot], tables.weight[slot]
    drift = np.zeros((positions, 3))
    tail = np.zeros((positions, terms + 1))
    for u in range(positions):
        drift[u, 0] = tables.constant[slot, u]
        for i in range(n):
            for order in range(3):
                drift[u, order] += weight[u, i] * poly[i, order]
    for t in range(terms - 1, -1, -1):
        size = math.sqrt(term[t].real ** 2 + term[t].imag ** 2)
        for u in range(positions):
            tail[u, t] = tail[u, t + 1] + abs(weight[u, t]) * size
    start_theta, start_term = theta.copy(), term.copy()
    fastest = tables.fastest[slot]
    deepest[:] = 0.0
    shift, previous = np.zeros(stops), np.zeros(stops)
    out = np.zeros((positions, 4))
    s, s_previous, which, rate, step, close = 0.0, 0.0, NO_SWITCH, 0.0, 0, False
    while True:
        # Sum as many modes as it takes to tell that no stop is near its switch, or all of them.
        for u in range(positions):
            _at_position(tables, slot, u, s, theta, drift, out)
        summed, want = 0, terms if step == 0 or depth or close else min(_FIRST_MODES, terms)
        while True:
            far = True
            for u in range(positions):
                z, z1, z2, b3 = _add_terms(weight[u], term, root, summed, want)
                out[u, 0] += z
                out[u, 1] += z1
                out[u, 2] += z2
                out[u, 3] += b3
            summed = want
            if summed == terms:
                break
            for k in range(stops):
                u = tables.position[k]
                h = (-tables.sign[k] if tables.closed[slot, k] else tables.sign[k]) * out[u, 0]
                h += tables.gap[k] if tables.closed[slot, k] else -tables.gap[k]
                if h - shift[k] + 3 * tail[u, summed] > 0:
                    far = False
            if far:
                break
            want = min(2 * summed, terms)
        if stops > 0 and step == 0:
            _first_look(tables, slot, fresh, out, tail, theta, shift)
        tau, which = horizon - s, NO_SWITCH
        for k in range(stops):
            u, closed = tables.position[k], tables.closed[slot, k]
            orientation = -tables.sign[k] if closed else tables.sign[k]
            h = orientation * out[u, 0] + (tables.gap[k] if closed else -tables.gap[k])
            h1, h2 = orientation * out[u, 1], orientation * out[u, 2]
            if depth and closed:
                deepest[k] = max(deepest[k], -h)
                if step > 0 and previous[k] < 0 <= h1:
                    low = _lowest_between(
                        tables,
                        slot,
                        k,
                        s_previous,
                        s,
                        start_theta,
                        start_term,
                        drift,
                    )
                    deepest[k] = max(deepest[k], -low)
                previous[k] = h1
            value = min(h - shift[k] + tail[u, summed], 0.0)
            bound = first_root_of_bound(value, h1, h2, out[u, 3] + 1e-300, tau)
            if bound < tau:
                tau, which, rate = bound, k, h1
        if tau <= 0 and which == NO_SWITCH:
            break
        s_previous = s
        step += 1
        close = tau < _CLOSE  # the next look takes all modes: what the high ones may do is no longer small
        if which == NO_SWITCH:
            turn_exactly(tables, slot, tau, term, theta)
            s = horizon
            if not depth:
                break
        elif tau < _RESOLUTION and summed == terms:
            _turn_by_series(tables, slot, tau, fastest, term, theta)
            s += tau
            break
        elif tau * fastest <= _SERIES:
            _turn_by_series(tables, slot, tau, fastest, term, theta)
            s += tau
        else:
            s += _turn_by_table(tables, slot, tau, term, theta)
        if step >= _MAX_STEPS:
            which = -2
            break
    _areas(tables, slot, s, start_theta, start_term, theta, term, drift, area)
    return s, which, rate, step


@njit(cache=True)
def _first_look(tables: Any, slot: int, fresh: Any, out: Any, tail: Any, theta: Any, shift: Any) -> None:
    """How far each gap function starts above 0: the modes of two states differ by their truncation."""
    for k in range(shift.size):
        u, closed = tables.position[k], tables.closed[slot, k]
        orientation = -tables.sign[k] if closed else tables.sign[k]
        h = orientation * out[u, 0] + (tables.gap[k] if closed else -tables.gap[k])
        shift[k] = max(h, 0.0)
        size = tail[u, 0]
        for i in range(theta.size):
            size += abs(tables.forced[slot, u, i])
        threshold = 1e-13 * size + 1e-300
        if fresh[k] and h - shift[k] > -threshold and orientation * out[u, 1] >= 0:
            shift[k] += threshold


@njit(cache=True)
def _areas(
    tables: Any, slot: int, s: float, theta0: Any, term0: Any, theta: Any, term: Any, drift: Any, area: Any
) -> None:
    """Time integral of the penetration of each closed stop, from the antiderivative of every term."""
    for k in range(area.size):
        area[k] = 0.0
        if not tables.closed[slot, k]:
            continue
        u = tables.position[k]
        z = s * (drift[u, 0] + s * (drift[u, 1] / 2 + s * drift[u, 2] / 3))
        for t in range(tables.terms[slot]):
            change, over = term[t] - term0[t], tables.inverse[slot, t]
            z += tables.weight[slot, u, t] * (change.real * over.real - change.imag * over.imag)
        for h in range(theta.size):
            z += (tables.forced[slot, u, h] * (theta[h] - theta0[h]) / (1j * tables.omega[h])).imag
        area[k] = max(tables.sign[k] * z - tables.gap[k] * s, 0.0)


@njit(cache=True, fastmath=_SUM)
def switch(tables: Any, slot: int, stop: int, theta: Any, q: Any, v: Any) -> int:
    """Carry displacement (36) and velocity (41) over to the next state, in place; returns its slot."""
    target = tables.next_slot[slot, stop]
    n_old, n_new = tables.modes[slot], tables.modes[target]
    S, onto = tables.carry[slot, stop], tables.carry_residual[slot, stop]
    q_old, v_old = q.copy(), v.copy()
    q[:] = 0.0
    v[:] = 0.0
    for i in range(n_new):
        x, y = onto[0, i], 0.0
        for j in range(n_old):
            x += S[i, j] * q_old[j]
            y += S[i, j] * v_old[j]
        for h in range(theta.size):
            x += onto[1 + h, i] * theta[h].imag
            y += onto[1 + h, i] * tables.omega[h] * theta[h].real
        q[i], v[i] = x, y
    return int(target)


@njit(cache=True)
def march(
    tables: Any,
    slot: int,
    t: float,
    end: float,
    q: Any,
    v: Any,
    last_switch: Any,
    total: Any,
    pending: int,
    log: Any,
    depth: bool,
    most: int,
) -> tuple[int, int, float, int, int, int]:
    """March from `t` to `end`, switching from state to state.

    ``q``, ``v`` (shape ``(N,)``), ``last_switch`` and ``total`` (penetration times time, shape ``(P,)``) are changed in
    place.  `pending` is a stop that has yet to switch at `t`, or NO_SWITCH.  Every segment is written to `log` if
    it has room at all; `depth` asks for the deepest penetrations as well.  At most `most` switches.  Returns the
    status, the slot, the time, the pending stop, the number of segments logged, and of switches.
    """
    room, H = log.slot.size, tables.omega.size
    logged, switches = 0, 0
    n_most = q.size
    theta = np.zeros(H, dtype=np.complex128)
    term, poly = np.zeros(2 * n_most, dtype=np.complex128), np.zeros((n_most, 3))
    deepest, area = np.zeros(total.size), np.zeros(total.size)
    fresh = np.zeros(total.size, dtype=np.bool_)
    while True:
        for h in range(H):
            angle = tables.omega[h] * t + tables.phase[h]
            theta[h] = complex(math.cos(angle), math.sin(angle))
        if pending >= 0:
            if tables.next_slot[slot, pending] < 0:
                return MISSING_STATE, slot, t, pending, logged, switches
            slot = switch(tables, slot, pending, theta, q, v)
            last_switch[pending] = t
            pending = NO_SWITCH
        if room > 0:
            if logged == room:
                return LOG_FULL, slot, t, pending, logged, switches
            log.slot[logged], log.start[logged] = slot, t
            log.q[logged], log.v[logged] = q, v
        for k in range(fresh.size):
            fresh[k] = t - last_switch[k] < _FRESH
        start_terms(tables, slot, theta, q, v, term, poly)
        s, which, rate, _ = follow(tables, slot, end - t, fresh, depth, theta, term, poly, deepest, area)
        if which == -2:
            return STUCK, slot, t + s, pending, logged, switches
        state_from_terms(tables, slot, theta, s, term, poly, q, v)
        t = end if which == NO_SWITCH else t + s
        total += area
        if room > 0:
            log.end[logged], log.stop[logged], log.rate[logged] = t, which, rate
            log.q_end[logged], log.v_end[logged] = q, v
            log.area[logged], log.deepest[logged] = area, deepest
            logged += 1
        if which == NO_SWITCH:
            return DONE, slot, t, pending, logged, switches
        switches += 1
        pending = which
        if switches > most:
            return TOO_MANY, slot, t, pending, logged, switches
