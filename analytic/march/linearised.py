"""All deviations along a recorded march."""

from __future__ import annotations

import numpy as np

from analytic.march.march import WITH_ALL_AT_ONCE, March
from analytic.march.motion import Log
from analytic.march.tables import Tables
from analytic.march.tangent import flow, new_switching, saltation, set_levels
from analytic.march.terms import set_phases
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.machine.memory import require
from lapjoint.problem import FloatArray

_FEWER, _WORTH_IT = 0.75, 4
"""Limits within which the deviations are replaced by units of the living modes: the largest number of units, as a
fraction of the number of deviations, and the least number of segments that follow.  To multiply the units out again
takes as long as two switches."""


def carried_along(motion: March) -> FloatArray:
    """Deviations at the start of each of the ``M`` segments of a recorded march from the time 0, shape ``(M, 2 N, n)``.

    The columns are (dq, dv), kg^1/2 m and kg^1/2 m/s, for a unit of each of the ``n`` coordinates at the start of the
    march.  A state with fewer modes than ``N`` has the first rows, and anything in the others.
    """
    tables, log = motion.joint.tables, motion.log
    segments, n, rows = log.slot.size, 2 * int(tables.modes[log.slot[0]]), 2 * tables.kind.shape[1]
    what = f"the deviations at {segments} switches, of {rows // 2} modes each,"
    require(8.0 * segments * rows * n, what, "take fewer modes (n_modes)")
    starts = np.empty((segments, rows, n))
    now, since, level = np.eye(rows, n), np.zeros((0, n)), np.zeros((tables.sign.size, n))
    for begin in range(0, segments, WITH_ALL_AT_ONCE):
        piece = begin, min(begin + WITH_ALL_AT_ONCE, segments)
        now, since, level = _carry(tables, log, piece, now, since, level, starts)
    return starts


@njit_called(vectorised=True)
def _carry(
    tables: Tables,
    log: Log,
    piece: tuple[int, int],
    here: FloatArray,
    since: FloatArray,
    level: FloatArray,
    starts: FloatArray,
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Carry deviations `here`, ``(2 N, m)``, over a `piece` of a march: from one of its segments to before another.

    `starts`, ``(M, 2 N, n)``, takes those at the start of each segment.  `level`, m, ``(P, m)``, says at which level
    each stop switches next with the deviations.

    Where fast modes have died out, only the deviations of the slower ones are left, and the level at which the next
    stop switches.  From there on a unit of each of these is carried, which are fewer columns.  Deviations are these
    units times `since`, ``(m, n)``, the amounts at that moment; a `since` without rows says that no unit has been
    taken.

    Returned are the deviations, `since` and `level`, with which the next piece begins.
    """
    begin, stop = piece
    then, now, theta = zeros(here.shape), zeros(here.shape), complex_zeros(tables.omega.size)
    work = new_switching(level, tables.kind.shape[1])
    set_phases(tables, log.start[begin], theta)
    goes_on = begin > 0
    if not goes_on:  # a constant in the call would compile another function
        set_levels(tables, log.slot[0], goes_on, theta, log.q[0], log.v[0], here, work)
    for i in range(begin, stop):
        slot, n, k, left = log.slot[i], tables.modes[log.slot[i]], log.stop[i], log.slot.size - 1 - i
        _write(here[: 2 * n], since, starts[i])
        if left == 0:
            break
        live = flow(tables, slot, log.end[i] - log.start[i], here, now)
        if left >= _WORTH_IT and 2 * live + 1 <= _FEWER * here.shape[1]:
            since = _left_of(now, work.level[k] if k >= 0 else zeros(now.shape[1]), since, n, live)
            now = _units(now.shape[0], n, live)
            work = new_switching(zeros((tables.sign.size, now.shape[1])), tables.kind.shape[1])
            if k >= 0:
                work.level[k, 2 * live] = 1.0
            here, then = zeros(now.shape), zeros(now.shape)
        set_phases(tables, log.end[i], theta)  # when the next segment starts
        q, v = log.q[i + 1], log.v[i + 1]
        if k >= 0:
            saltation(tables, slot, k, theta, log.rate[i], log.q_end[i], log.v_end[i], q, v, live, now, then, work)
            here, then = then, here
        else:
            for j in range(2 * n):
                put(here[j], now[j])
        set_levels(tables, log.slot[i + 1], k >= 0, theta, q, v, here, work)
    return here, since, work.level


@njit_inner()
def _left_of(now: FloatArray, level: FloatArray, since: FloatArray, n: int, live: int) -> FloatArray:
    """Amounts of the first `live` modes in the deviations, and then their `level`, ``(m,)``, shape ``(2 live + 1,
    n)``."""
    left = zeros((2 * live + 1, now.shape[1]))
    put(left[2 * live], level)
    for j in range(live):
        put(left[j], now[j])
        put(left[live + j], now[n + j])
    return _times(left, since)


@njit_inner()
def _times(left: FloatArray, since: FloatArray) -> FloatArray:
    """Units times the amounts `since`, ``(m, n)``; units alone if `since` has no rows."""
    if since.shape[0] == 0:
        return left
    whole = zeros((left.shape[0], since.shape[1]))
    np.dot(left, since, whole)
    return whole


@njit_inner()
def _units(rows: int, n: int, live: int) -> FloatArray:
    """Units of the deviations of the first `live` of ``n`` modes as columns, and a zero column for the level."""
    begin = zeros((rows, 2 * live + 1))
    for j in range(live):
        begin[j, j] = begin[n + j, live + j] = 1.0
    return begin


@njit_inner()
def _write(now: FloatArray, since: FloatArray, whole: FloatArray) -> None:
    """Write deviations, ``(2 N, m)``, times `since`, to `whole`, ``(2 N, n)``."""
    made = _times(now, since)
    for j in range(made.shape[0]):
        put(whole[j], made[j])
