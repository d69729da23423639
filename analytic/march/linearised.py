"""A recorded march with all deviations from it, and with its derivative by a number of the problem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.change import Change, add_end_change, add_forced_change, add_switch_change, changes_of_answers
from analytic.march.compiled import Log
from analytic.march.march import March
from analytic.march.tables import Tables
from analytic.march.tangent import flow, saltation
from lapjoint.compiled_arrays import complex_zeros, put
from lapjoint.compiling import njit_called
from lapjoint.problem import FloatArray

_ALL = slice(None)


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
    rows = 2 * int(tables.modes[log.slot[0]])
    n = rows if deviations is None else deviations.shape[1]
    now = np.empty((2, 2 * tables.kind.shape[1], n if change is None else n + 1))
    now[0, :rows] = np.eye(rows, now.shape[2]) if deviations is None else 0.0
    if deviations is not None:
        now[0, :rows, :n] = deviations
    first, last, _ = kept.indices(log.slot.size)
    starts, end = np.empty((last - first, *now.shape[1:])), np.empty(now.shape[1:])
    _carry(tables, change, log, later, now, first, starts, end)
    return Carried(motion, change, starts, end[: 2 * int(tables.modes[log.slot[-1]])], first)


@njit_called(vectorised=True)
def _carry(
    tables: Tables,
    change: Change | None,
    log: Log,
    later: float,
    both: FloatArray,
    first: int,
    starts: FloatArray,
    end: FloatArray,
) -> None:
    """Carry deviations from the start of a march on to its `end`, ``(2 N, m)``.

    `both`, ``(2, 2 N, m)``, has them at the start, and takes those at the start of each of the ``M`` segments in turn;
    `starts`, ``(K, 2 N, m)``, those of the segment `first`, and of others after it.
    """
    now, changes = end, complex_zeros((0, 0, 0))
    if change is not None:
        changes = changes_of_answers(tables, change, log.slot)
    for i in range(log.slot.size):
        slot, here, then = log.slot[i], both[i % 2], both[(i + 1) % 2]
        if change is not None:  # what it does to the forced motion does not flow
            add_forced_change(tables, change, changes, slot, log.start[i], -1.0, here)
        if first <= i < first + starts.shape[0]:
            for j in range(2 * tables.modes[slot]):
                put(starts[i - first, j], here[j])
        flow(tables, slot, log.end[i] - log.start[i], here, now)
        if change is not None:
            add_forced_change(tables, change, changes, slot, log.end[i], 1.0, now)
        if log.stop[i] >= 0 and i + 1 < log.slot.size:
            t, k, rate = log.end[i], log.stop[i], log.rate[i]
            q_old, v_old, q_new, v_new = log.q_end[i], log.v_end[i], log.q[i + 1], log.v[i + 1]
            jump = saltation(tables, slot, k, t, rate, q_old, v_old, q_new, v_new, now, then)
            if change is not None:
                add_switch_change(tables, change, slot, k, t, rate, jump, then)
        elif i + 1 < log.slot.size:
            for j in range(2 * tables.modes[slot]):
                for c in range(end.shape[1]):
                    then[j, c] = now[j, c]
    i = log.slot.size - 1
    if change is not None:
        add_end_change(tables, log.slot[i], log.end[i], later, log.q_end[i], log.v_end[i], now)
