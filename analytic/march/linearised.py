"""A recorded march with all deviations from it, and with its derivative by a number of the problem."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.change import Change, add_end_change, add_forced_change, add_switch_change, changes_of_answers
from analytic.march.compiled import Log
from analytic.march.march import March
from analytic.march.tables import Tables
from analytic.march.tangent import flow, saltation
from lapjoint.compiled_arrays import complex_zeros
from lapjoint.compiling import njit_called
from lapjoint.problem import FloatArray

_AT_A_TIME = 2  # starts of segments that are needed to carry deviations on from one to the next


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
    number, they are those of the free motion: without what it does to the forced one.  Of two of them, where no more
    was to be kept."""
    end: FloatArray
    """The deviations at the end of the march, shape ``(2 N_end, n + 1)`` or ``(2 N_end, n)``."""


def carried_along(
    motion: March,
    change: Change | None = None,
    later: float = 0.0,
    deviations: FloatArray | None = None,
    *,
    on_the_way: bool = True,
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
    on_the_way : bool
        Whether to keep what they are at the start of each segment: of a long march, that is more than a processor holds
        near at hand.

    Returns
    -------
    Carried
        The number leaves the start of the march where it is.
    """
    tables, log = motion.joint.tables, motion.log
    rows = 2 * int(tables.modes[log.slot[0]])
    n = rows if deviations is None else deviations.shape[1]
    kept = log.slot.size if on_the_way else min(log.slot.size, _AT_A_TIME)
    starts = np.empty((kept, 2 * tables.kind.shape[1], n if change is None else n + 1))
    starts[0, :rows] = np.eye(rows, starts.shape[2]) if deviations is None else 0.0
    if deviations is not None:
        starts[0, :rows, :n] = deviations
    end = np.empty(starts.shape[1:])
    _carry(tables, change, log, later, starts, end)
    return Carried(motion, change, starts, end[: 2 * int(tables.modes[log.slot[-1]])])


@njit_called(vectorised=True)
def _carry(tables: Tables, change: Change | None, log: Log, later: float, starts: FloatArray, end: FloatArray) -> None:
    """Carry deviations from the start of a march on to its `end`, ``(2 N, m)``.

    `starts`, ``(K, 2 N, m)``, takes them at the start of each of the ``M`` segments, in turn if these are more.
    """
    now, changes = end, complex_zeros((0, 0, 0))
    if change is not None:
        changes = changes_of_answers(tables, change, log.slot)
    for i in range(log.slot.size):
        slot, here, then = log.slot[i], starts[i % starts.shape[0]], starts[(i + 1) % starts.shape[0]]
        if change is not None:  # what it does to the forced motion does not flow
            add_forced_change(tables, change, changes, slot, log.start[i], -1.0, here)
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
                for c in range(starts.shape[2]):
                    then[j, c] = now[j, c]
    i = log.slot.size - 1
    if change is not None:
        add_end_change(tables, log.slot[i], log.end[i], later, log.q_end[i], log.v_end[i], now)
