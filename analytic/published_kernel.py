"""The compiled march of the scheme as published: `analytic.kernel.follow` within a state, another rule at a switch.

In coordinates q_i = (Phi_i, z) of the whole displacement the published modal equations (26) are those that the
kernel solves; see `analytic.published`.  What differs is the rest of the displacement, R = z - sum Phi_i q_i.  It does
not move until the next switch.  R is kept as coefficients over the modes of every state met, ``(S, N)``, so its
values at the stops are dot products.  They are summed in an order of the states that does not depend on which of them
was met first, perhaps by another motion of the same process: a motion that never settles shows the last bit.
"""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numba import njit

from analytic.kernel import (
    DONE,
    LOG_FULL,
    MISSING_STATE,
    NO_SWITCH,
    STUCK,
    TOO_MANY,
    follow,
    start_terms,
    state_from_terms,
    turn_exactly,
)

SETTLED, UNSETTLED = 10, 11
_FRESH = 1e-9  # s, as in `analytic.kernel`


class Carried(NamedTuple):
    """What is carried on from state to state, changed in place: ``N`` modes, ``P`` stops, ``S`` states."""

    q: Any
    """Modal displacements (Phi_i, z), shape ``(N,)``."""
    v: Any
    """Modal velocities, shape ``(N,)``."""
    rest: Any
    """Coefficients of R over the modes of all states, shape ``(S, N)``."""
    last_switch: Any
    """Time of each stop's last switch, s, shape ``(P,)``."""
    total: Any
    """Time integral of each stop's penetration, m s, shape ``(P,)``."""


@njit(cache=True)
def freeze(tables: Any, slot: int, rest: Any) -> None:
    """Write the values of R at the stops where `follow` looks for a constant part of z."""
    for u in range(tables.constant.shape[1]):
        z = 0.0
        for other in tables.order:
            for j in range(tables.modes[other]):
                z += tables.weight[other, u, j] * rest[other, j]
        tables.constant[slot, u] = z


@njit(cache=True)
def switch(tables: Any, cross: Any, slot: int, target: int, carried: Any) -> None:
    """From one state to another: displacement (36), of which R keeps what is left over, and velocity (44)."""
    n_old, n_new, rest = tables.modes[slot], tables.modes[target], carried.rest
    v_old = carried.v.copy()
    for j in range(n_old):
        rest[slot, j] += carried.q[j]
    carried.q[:] = 0.0
    carried.v[:] = 0.0
    for i in range(n_new):
        x, y = 0.0, 0.0
        for other in tables.order:
            for j in range(tables.modes[other]):
                x += cross[target, other, i, j] * rest[other, j]
        for j in range(n_old):
            y += cross[target, slot, i, j] * v_old[j]
        carried.q[i], carried.v[i] = x, y
    for i in range(n_new):
        rest[target, i] -= carried.q[i]


@njit(cache=True)
def march(
    tables: Any,
    cross: Any,
    slot: int,
    t: float,
    end: float,
    carried: Any,
    pending: int,
    log: Any,
    depth: bool,
    shortest: float,
    most: int,
) -> tuple[int, int, float, int, int, int]:
    """March from `t` to `end`; arguments and results as those of `analytic.kernel.march`.

    No state lasts less than `shortest`, s: see `analytic.published` on switches that follow each other at once.
    """
    room, H, n_most, stops = log.slot.size, tables.omega.size, carried.q.size, carried.total.size
    logged, switches = 0, 0
    theta = np.zeros(H, dtype=np.complex128)
    term, poly = np.zeros(2 * n_most, dtype=np.complex128), np.zeros((n_most, 3))
    deepest, area, fresh = np.zeros(stops), np.zeros(stops), np.zeros(stops, dtype=np.bool_)
    while True:
        if pending >= 0:
            target = tables.next_slot[slot, pending]
            if target < 0:
                return MISSING_STATE, slot, t, pending, logged, switches
            switch(tables, cross, slot, target, carried)
            slot = target
            carried.last_switch[pending] = t
            pending = NO_SWITCH
        if room > 0:
            if logged == room:
                return LOG_FULL, slot, t, pending, logged, switches
            log.slot[logged], log.start[logged] = slot, t
            log.q[logged], log.v[logged] = carried.q, carried.v
        for h in range(H):
            angle = tables.omega[h] * t + tables.phase[h]
            theta[h] = complex(math.cos(angle), math.sin(angle))
        for k in range(stops):
            fresh[k] = t - carried.last_switch[k] < _FRESH
        freeze(tables, slot, carried.rest)
        start_terms(tables, slot, theta, carried.q, carried.v, term, poly)
        s, which, rate, _ = follow(tables, slot, end - t, fresh, depth, theta, term, poly, deepest, area)
        if which == -2:
            return STUCK, slot, t + s, NO_SWITCH, logged, switches
        wait = min(shortest, end - t) - s
        if which != NO_SWITCH and wait > 0:
            turn_exactly(tables, slot, wait, term, theta)
            s += wait
        state_from_terms(tables, slot, theta, s, term, poly, carried.q, carried.v)
        t = end if which == NO_SWITCH else t + s
        for k in range(stops):
            carried.total[k] += area[k]
        if room > 0:
            log.end[logged], log.stop[logged], log.rate[logged] = t, which, rate
            log.q_end[logged], log.v_end[logged] = carried.q, carried.v
            log.area[logged], log.deepest[logged] = area, deepest
            logged += 1
        if which == NO_SWITCH:
            return DONE, slot, t, pending, logged, switches
        switches += 1
        pending = which
        if switches > most:
            return TOO_MANY, slot, t, pending, logged, switches


@njit(cache=True)
def settle(
    tables: Any,
    cross: Any,
    slot: int,
    t: float,
    pending: int,
    period: float,
    carried: Any,
    log: Any,
    rows: Any,
    agree: Any,
    count: Any,
    repeats: int,
    tolerance: float,
    shortest: float,
    most: int,
) -> tuple[int, int, float, int, int]:
    """March cycle by cycle until the impulses and the displacements at the stops repeat, or `rows` is full.

    ``rows``, shape ``(cycles, P + U)``, takes the penetration times of each stop over every cycle, m s, and the
    displacements at the ``U`` positions at its end, m.  ``agree``, shape ``(orders,)``, counts the cycles in a row that
    repeated those 1, 2, ... cycles before.  ``count`` holds the cycles done and the switches made; the march has its
    time counted from the start of the cycle.  Returns the status, the slot, the time, the pending stop and the order.
    """
    stops = carried.total.size
    while count[0] < rows.shape[0]:
        status, slot, t, pending, _, switches = march(
            tables, cross, slot, t, period, carried, pending, log, False, shortest, most
        )
        count[1] += switches
        if status != DONE:
            return status, slot, t, pending, 0
        n = count[0]
        rows[n, :stops] = carried.total
        freeze(tables, slot, carried.rest)
        for u in range(tables.constant.shape[1]):
            z = tables.constant[slot, u]
            for j in range(tables.modes[slot]):
                z += tables.weight[slot, u, j] * carried.q[j]
            rows[n, stops + u] = z
        carried.total[:] = 0.0
        carried.last_switch[:] -= period
        t = 0.0
        count[0] += 1
        for p in range(1, agree.size + 1):
            agree[p - 1] = agree[p - 1] + 1 if n >= p and _same(rows[n], rows[n - p], stops, tolerance) else 0
            if agree[p - 1] >= repeats * p and _same(rows[n], rows[n - repeats * p], stops, tolerance):
                return SETTLED, slot, t, pending, p
    return UNSETTLED, slot, t, pending, 0


@njit(cache=True)
def _same(one: Any, other: Any, stops: int, tolerance: float) -> bool:
    """Whether the largest differences of penetration times and of displacements are within `tolerance`, relatively."""
    return _close(one[:stops], other[:stops], tolerance) and _close(one[stops:], other[stops:], tolerance)


@njit(cache=True)
def _close(one: Any, other: Any, tolerance: float) -> bool:
    size, apart = 0.0, 0.0
    for k in range(one.size):
        size = max(size, abs(one[k]))
        apart = max(apart, abs(one[k] - other[k]))
    return apart <= tolerance * size
