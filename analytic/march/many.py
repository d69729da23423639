"""The compiled march of many motions over whole periods, in one call."""

from __future__ import annotations

from analytic.march.carried import advance_periods
from analytic.march.compiled import DONE, PENDING, PERIODS, SLOT, SWITCHES, Motion, Work
from analytic.march.segment import NO_SWITCH
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
    """March many motions over whole periods, each as `analytic.march.carried.advance_periods` does, without deviations.

    Parameters
    ----------
    tables : Tables
        The states of the joint.
    begin : tuple of int
        Which of the marches to begin with, as an index into `which`, and 1 if `motion` is on its way already, else 0.
    which : ndarray, shape (k,)
        The rows that are marched.
    slots : ndarray, shape (S,)
        The state of each motion, as its slot; changed in place.
    q, v : ndarray, shape (S, N)
        Its modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s; changed in place.
    period : float
        The period, s.
    count : int
        Periods that each is marched.
    most : int
        Most switches of each march until this comes back, and of all together until it comes back after one.
    motion : Motion
        Scratch room for one march; where the march is that needs something of Python.
    work : Work
        Scratch arrays.

    Returns
    -------
    int, int
        Why it came back, see `DONE`, and at which march; where it is done, with which march to begin next.
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
