"""The compiled march until a motion by the published scheme has settled; the rule is in `analytic.published.steady`."""

from __future__ import annotations

from analytic.march.compiled import DONE, advance
from analytic.march.motion import PERIODS, SLOT, Log, Motion, Work
from analytic.march.switching import Frozen, freeze
from analytic.march.tables import IntArray, Tables
from lapjoint.compiled.arrays import put
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray

SETTLED, UNSETTLED = 10, 11
"""Reasons for which `settle` returns, besides the reasons of `analytic.march.compiled`."""


@njit_called()
def settle(
    tables: Tables,
    frozen: Frozen,
    motion: Motion,
    work: Work,
    depth: bool,
    period: float,
    log: Log,
    rows: FloatArray,
    agree: IntArray,
    repeats: int,
    tolerance: float,
    shortest: float,
    most: int,
) -> tuple[int, int]:
    """March cycle by cycle until the impulses and the displacements at the stops repeat, or `rows` is full.

    `motion`, with its time counted from the start of the cycle, is changed in place; `log` has no room.  `depth` is
    False; it is an argument because a constant in the call would compile the march anew.  `rows`, ``(cycles, P + U)``,
    takes the penetration times of each stop over every cycle, m s, and the displacements at the positions at its end,
    m.  `agree`, ``(multiples,)``, counts the cycles in a row that repeated those 1, 2, ... cycles before.  A motion has
    to repeat `repeats` times to the fraction `tolerance`.  `period` is the length of a cycle, and `shortest` the least
    time spent in a state, s; `most` is the most switches in all.

    Returned are the reason to come back, and the number of cycles after which the motion repeats, or 0.
    """
    stops = motion.total.size
    while motion.counts[PERIODS] < rows.shape[0]:
        status, _ = advance(tables, frozen, None, motion, work, period, log, depth, shortest, most)
        if status != DONE:
            return status, 0
        n, slot = motion.counts[PERIODS], motion.counts[SLOT]
        put(rows[n, :stops], motion.total)
        freeze(tables, frozen, slot)
        for u in range(tables.constant.shape[1]):
            z = tables.constant[slot, u]
            for j in range(tables.modes[slot]):
                z += tables.weight[slot, u, j] * motion.q[j]
            rows[n, stops + u] = z
        motion.total[:] = 0.0
        for k in range(stops):
            motion.last_switch[k] -= period
        motion.time[0] = 0.0
        motion.counts[PERIODS] += 1
        for p in range(1, agree.size + 1):
            agree[p - 1] = agree[p - 1] + 1 if n >= p and _same(rows[n], rows[n - p], stops, tolerance) else 0
            if agree[p - 1] >= repeats * p and _same(rows[n], rows[n - repeats * p], stops, tolerance):
                return SETTLED, p
    return UNSETTLED, 0


@njit_inner()
def _same(one: FloatArray, other: FloatArray, stops: int, tolerance: float) -> bool:
    """Whether the largest relative differences of penetration times and of displacements are within `tolerance`."""
    return _close(one[:stops], other[:stops], tolerance) and _close(one[stops:], other[stops:], tolerance)


@njit_inner()
def _close(one: FloatArray, other: FloatArray, tolerance: float) -> bool:
    """Whether the largest difference of two arrays is within `tolerance` of the largest value of the first."""
    size, apart = 0.0, 0.0
    for k in range(one.size):
        size = max(size, abs(one[k]))
        apart = max(apart, abs(one[k] - other[k]))
    return apart <= tolerance * size
