"""The compiled march of many motions over whole periods, in one call."""

from __future__ import annotations

from analytic.march.carried import advance_periods
from analytic.march.compiled import DONE
from analytic.march.motion import NO_SWITCH, PENDING, PERIODS, SLOT, SWITCHES, Motion, Work
from analytic.march.tables import IntArray, Tables
from lapjoint.compiled.arrays import int_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.problem import FloatArray


@njit_called()
def advance_many(
    tables: Tables,
    begin: tuple[int, int],
    which: IntArray,
    slots: IntArray,
    q: FloatArray,
    v: FloatArray,
    period: float,
    count: int,
    most: int,
    motion: Motion,
    work: Work,
) -> tuple[int, int]:
    """March many motions over `count` periods each, as `advance_periods` does, without deviations.

    `which`, ``(k,)``, holds the rows that are marched.  `begin` holds the index of `which` to begin with, and 1 if
    `motion` is already part of the way through this march, else 0.  `slots`, ``(S,)``, `q`, kg^1/2 m, and `v`, kg^1/2
    m/s, ``(S, N)``, are the states and coordinates of all motions, changed in place.  `period` is in s.  The function
    returns early when one march has made `most` switches, or when a march ends and all together have made more than
    `most`.  `motion` is room for one march; if the march needs something of Python, `motion` holds it on return.

    Returned are the reason for returning, see `DONE`, and the index of the march concerned; if the reason is DONE, the
    index to begin with next.
    """
    n = motion.q.size
    penetration, slot = zeros((1, motion.total.size)), int_zeros(0)
    section, deviations, sizes = zeros((0, 2, n)), zeros((2 * n, 0)), zeros(0)
    level, goes_on, made = zeros((motion.total.size, 0)), begin[1] == 1, 0
    for i in range(begin[0], which.size):
        row = which[i]
        if not goes_on:
            motion.counts[SLOT], motion.counts[PENDING] = slots[row], NO_SWITCH
            motion.counts[SWITCHES], motion.counts[PERIODS] = 0, 0
            motion.time[0], motion.time[1] = 0.0, 0.0
            put(motion.q, q[row])
            put(motion.v, v[row])
            for k in range(motion.total.size):
                motion.last_switch[k], motion.total[k] = 0.0, 0.0
        goes_on = False
        status, deviations = advance_periods(
            tables, motion, work, period, count, penetration, slot, section, deviations, level, sizes, most
        )
        if status != DONE:
            return status, i
        slots[row] = motion.counts[SLOT]
        put(q[row], motion.q)
        put(v[row], motion.v)
        made += motion.counts[SWITCHES]
        if made > most:
            return DONE, i + 1
    return DONE, which.size
