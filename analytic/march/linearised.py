"""A recorded march with all deviations from it, and with its derivative by a number of the problem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.change import (
    Change,
    add_end_change,
    add_forced_change,
    add_switch_change,
    changes_of_answers,
    own_changes,
)
from analytic.march.compiled import Log
from analytic.march.march import WITH_ALL_AT_ONCE, March
from analytic.march.tables import Tables
from analytic.march.tangent import flow, new_switching, saltation, set_levels
from analytic.march.terms import set_phases
from lapjoint.compiled_arrays import complex_zeros, put, zeros
from lapjoint.compiling import njit_called, njit_inner
from lapjoint.memory import require
from lapjoint.problem import FloatArray

_ALL = slice(None)
_FEWER, _WORTH_IT = 0.75, 4
"""Largest share of the columns that units of what is left may be, and the least number of segments that follow, where
they are carried instead: to have all of them again takes as long as two switches."""


@dataclass(frozen=True)
class Carried:
    """Deviations along a march of ``M`` segments, as columns (dq, dv): ``n`` of them, and by the number."""

    motion: March
    """The march, recorded."""
    change: Change | None
    """How the joint's tables change with the number; None without one."""
    starts: FloatArray
    """The deviations at the start of each segment, kg^1/2 m and kg^1/2 m/s, shape ``(M, 2 N, n + 1)``, or, without a
    number, ``(M, 2 N, n)``; of a state with fewer modes than ``N`` the first rows, and anything in the others.  By the
    number, they are those of the free motion: without what it does to the forced one.  Of one segment or of none, where
    no more was to be kept."""
    end: FloatArray
    """The deviations at the end of the march, shape ``(2 N_end, n + 1)`` or ``(2 N_end, n)``."""
    factors: tuple[FloatArray, FloatArray] | None
    """Two matrices of shapes ``(2 N_end, r)`` and ``(r, n)``, whose product the first ``n`` of these are, where fast
    modes died out on the way, so that r is less than n; else None."""
    first: int = 0
    """Index of the segment at whose start the first ones are."""


def carried_along(
    motion: March,
    change: Change | None = None,
    later: float = 0.0,
    deviations: FloatArray | None = None,
    *,
    kept: slice = _ALL,
) -> Carried:
    """Deviations along a march, and last its derivative by a number of the problem, if there is one.

    Parameters
    ----------
    motion : March
        A march from the time 0, recorded.
    change : Change, optional
        How the joint's tables change with the number.
    later : float
        Derivative of the duration by the number, s over the number's unit.
    deviations : FloatArray, shape (2 N, n), optional
        Those at the start, as columns, kg^1/2 m and kg^1/2 m/s; a unit of each coordinate by default.
    kept : slice
        The segments that follow each other at whose start they are kept; by default all: of a long march, that is more
        than a processor holds near at hand.

    Returns
    -------
    Carried
        The number leaves the start of the march where it is.
    """
    tables, log = motion.joint.tables, motion.log
    rows, most = 2 * int(tables.modes[log.slot[0]]), 2 * tables.kind.shape[1]
    n = rows if deviations is None else deviations.shape[1]
    columns = n if change is None else n + 1
    now, since, level = np.zeros((most, columns)), np.zeros((0, n)), np.zeros((tables.sign.size, columns))
    now[:rows] = np.eye(rows, columns) if deviations is None else 0.0
    if deviations is not None:
        now[:rows, :n] = deviations
    first, last, _ = kept.indices(log.slot.size)
    what = f"the deviations at {last - first} switches, of {most // 2} modes each,"
    require(8.0 * (last - first) * most * columns, what, "take fewer modes (n_modes)")
    starts, end = np.empty((last - first, most, columns)), np.empty((most, columns))
    for begin in range(0, log.slot.size, WITH_ALL_AT_ONCE):
        piece = begin, min(begin + WITH_ALL_AT_ONCE, log.slot.size)
        now, n, since, level = _carry(tables, change, log, later, piece, now, n, since, level, first, starts, end)
    rows = 2 * int(tables.modes[log.slot[-1]])
    factors = (now[:rows, :n], since) if since.size else None
    return Carried(motion, change, starts, end[:rows], factors, first)


@njit_called(vectorised=True)
def _carry(
    tables: Tables,
    change: Change | None,
    log: Log,
    later: float,
    piece: tuple[int, int],
    here: FloatArray,
    units: int,
    since: FloatArray,
    level: FloatArray,
    first: int,
    starts: FloatArray,
    end: FloatArray,
) -> tuple[FloatArray, int, FloatArray, FloatArray]:
    """Carry deviations, `here`, ``(2 N, m)``, over a `piece` of a march: from one of its segments on to before another.

    The first `units` of them are by the start of the march and the other by the number; `starts`, ``(K, 2 N, m)``,
    takes those at the start of the segment `first`, and of others after it, and `end`, ``(2 N, m)``, those at the end
    of the march.  At `level`, ``(P, m)``, each stop switches next with them.

    Where fast modes have died out, those of the others are all that is left, and the level at which the next stop
    switches.  Then a unit of each of these is carried on instead, which are fewer columns, and is multiplied by what
    there was of them, `since`, ``(r, n)``, where it is wanted; none has been left out where that has no rows.

    Returned are the deviations, how many are `units`, `since` and `level`, with which the next piece begins.
    """
    begin, stop = piece
    changes, then = complex_zeros((0, 0, 0)), zeros(here.shape)
    now, theta, own = zeros(here.shape), complex_zeros(tables.omega.size), zeros(0)
    work = new_switching(level, tables.kind.shape[1])
    set_phases(tables, log.start[begin], theta)
    if change is not None:
        changes = changes_of_answers(tables, change, log.slot[begin:stop])
        own = own_changes(tables, change, log.slot[begin], log.start[begin], theta)
    if begin == 0:
        set_levels(tables, log.slot[0], False, theta, log.q[0], log.v[0], here, own, work)
    for i in range(begin, stop):
        slot, n, left = log.slot[i], tables.modes[log.slot[i]], log.slot.size - 1 - i
        if change is not None:  # what it does to the forced motion does not flow
            add_forced_change(tables, change, changes, slot, log.start[i], theta, -1.0, here)
        if first <= i < first + starts.shape[0]:
            _write(here[: 2 * n], units, since, starts[i - first])
        live = flow(tables, slot, log.end[i] - log.start[i], here, now)
        if left >= _WORTH_IT and 2 * live + 1 <= _FEWER * units:
            reached = work.level[log.stop[i]] if log.stop[i] >= 0 else zeros(now.shape[1])
            since, unit = _left_of(now, reached, units, since, n, live), _units(now, units, n, live)
            work = new_switching(zeros((tables.sign.size, unit.shape[1])), tables.kind.shape[1])
            if log.stop[i] >= 0:
                work.level[log.stop[i], 2 * live] = 1.0
                put(work.level[log.stop[i], 2 * live + 1 :], reached[units:])
            now, units = unit, 2 * live + 1
            here, then = zeros(now.shape), zeros(now.shape)
        set_phases(tables, log.end[i], theta)  # when the next segment starts
        if change is not None:
            add_forced_change(tables, change, changes, slot, log.end[i], theta, 1.0, now)
        if left > 0 and log.stop[i] >= 0:
            t, k, rate = log.end[i], log.stop[i], log.rate[i]
            q_old, v_old, q_new, v_new = log.q_end[i], log.v_end[i], log.q[i + 1], log.v[i + 1]
            saltation(tables, slot, k, theta, rate, q_old, v_old, q_new, v_new, live, units, now, then, work)
            if change is not None:
                add_switch_change(tables, change, slot, k, t, theta, rate, work, then)
            here, then = then, here
        elif left > 0:
            for j in range(2 * n):
                put(here[j], now[j])
        if left > 0:
            if change is not None:
                own = own_changes(tables, change, log.slot[i + 1], log.end[i], theta)
            q, v = log.q[i + 1], log.v[i + 1]
            set_levels(tables, log.slot[i + 1], log.stop[i] >= 0, theta, q, v, here, own, work)
    if stop < log.slot.size:
        return here, units, since, work.level
    i = stop - 1
    if change is not None:
        add_end_change(tables, log.slot[i], theta, later, log.q_end[i], log.v_end[i], now)
    _write(now[: 2 * tables.modes[log.slot[i]]], units, since, end)
    return now, units, since, work.level


@njit_inner()
def _left_of(now: FloatArray, level: FloatArray, units: int, since: FloatArray, n: int, live: int) -> FloatArray:
    """What there is of deviations of the first `live` modes, and of their `level`, ``(m,)``: ``(2 live + 1, m)``."""
    left = zeros((2 * live + 1, units))
    put(left[2 * live], level[:units])
    for j in range(live):
        put(left[j], now[j, :units])
        put(left[live + j], now[n + j, :units])
    return _times(left, since)


@njit_inner()
def _times(left: FloatArray, since: FloatArray) -> FloatArray:
    """Deviations of units times what there was of these, if they are not those from the start."""
    if since.shape[0] == 0:
        return left
    whole = zeros((left.shape[0], since.shape[1]))
    np.dot(left, since, whole)
    return whole


@njit_inner()
def _units(now: FloatArray, units: int, n: int, live: int) -> FloatArray:
    """Units of the first `live` modes' deviations as columns, none for the level, then `now` behind its `units`."""
    begin = zeros((now.shape[0], 2 * live + 1 + now.shape[1] - units))
    for j in range(live):
        begin[j, j] = begin[n + j, live + j] = 1.0
    for j in range(2 * n):
        put(begin[j, 2 * live + 1 :], now[j, units:])
    return begin


@njit_inner()
def _write(now: FloatArray, units: int, since: FloatArray, whole: FloatArray) -> None:
    """Write deviations, ``(2 N, m)``: the first `units` times what there was of them, and the others."""
    first = zeros((now.shape[0], units))
    for j in range(now.shape[0]):
        put(first[j], now[j, :units])
    first = _times(first, since)
    behind = first.shape[1]
    for j in range(now.shape[0]):
        put(whole[j, :behind], first[j])
        put(whole[j, behind:], now[j, units:])
