"""Deviations carried along with a march in one compiled call: over one, for Newton's method; over many periods, one
deviation and its growth, for Lyapunov exponents."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numba import njit

from analytic.march.compiled import (
    DONE,
    MISSING_SWITCH,
    PENDING,
    PERIODS,
    SLOT,
    STUCK,
    SWITCHES,
    TOO_MANY,
    Motion,
    Work,
    enter,
    leave,
    new_work,
    next_period,
)
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.march import MOST_SWITCHES, begun, ended, settle_status
from analytic.march.periods import Periods
from analytic.march.segment import NO_SWITCH
from analytic.march.tables import IntArray, Tables
from analytic.march.tangent import flow, saltation
from analytic.march.terms import put
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Growth(Periods):
    """A motion over whole periods, and what became of a deviation from it."""

    penetrations: FloatArray
    """Time integral of each stop's penetration over each period, m s, shape ``(count, P)``."""
    growth: FloatArray
    """Natural logarithm of the growth of the deviation in each period, without unit, shape ``(count,)``."""
    deviation: FloatArray
    """The deviation (dq, dv) at the end, kg^1/2 m and kg^1/2 m/s, scaled to a size of 1 kg^1/2 m, shape ``(2 N,)``."""


@njit(cache=True)
def size_of(deviation: FloatArray, period: float) -> float:
    """The size of a deviation, |dq| + |dv| period / 2 pi.

    Parameters
    ----------
    deviation : FloatArray, shape (2 N,)
        dq, kg^1/2 m, and dv, kg^1/2 m/s.
    period : float
        The period of the excitation, s.

    Returns
    -------
    float
        kg^1/2 m.
    """
    n = deviation.size // 2
    q, v = 0.0, 0.0
    for i in range(n):
        q += deviation[i] * deviation[i]
        v += deviation[n + i] * deviation[n + i]
    return math.sqrt(q) + math.sqrt(v) * period / (2 * math.pi)


@njit(cache=True)
def _carry_to(
    tables: Tables, motion: Motion, work: Work, end: float, now: FloatArray, most: int
) -> tuple[int, FloatArray]:
    """March to the time `end`, s, with deviations `now`, columns ``(2 N, m)`` at the time of `motion`, in place.

    Gives why it came back, see `analytic.march.compiled.DONE`, and the deviations then, before a pending switch.
    """
    while True:
        slot, stop, t = motion.counts[SLOT], motion.counts[PENDING], motion.time[0]
        q_old, v_old = motion.q.copy(), motion.v.copy()
        if not enter(tables, None, None, motion, work):
            return MISSING_SWITCH, now
        if stop >= 0:
            now = saltation(tables, slot, stop, t, motion.time[1], q_old, v_old, motion.q, motion.v, now)
        if not leave(tables, None, None, motion, work, end, 0.0, False):
            return STUCK, now
        flow(tables, motion.counts[SLOT], motion.time[0] - t, now)
        if motion.counts[PENDING] == NO_SWITCH:
            return DONE, now
        if motion.counts[SWITCHES] > most:
            return TOO_MANY, now


@njit(cache=True)
def _grow(
    tables: Tables,
    motion: Motion,
    period: float,
    now: FloatArray,
    sizes: FloatArray,
    penetration: FloatArray,
    slots: IntArray,
    sections: FloatArray,
    most: int,
) -> tuple[int, FloatArray]:
    """As `analytic.march.compiled.advance_periods`, over as many periods as `sizes` has room for, with a deviation.

    `now`, shape ``(2 N, 1)``, is the deviation at the time of `motion`, before a pending switch; `sizes`, shape
    ``(count,)``, takes its size at the end of each period, after which it is scaled to 1; `penetration`, shape
    ``(count, P)``, takes each stop's penetration over time in each.  Gives why it came back, see
    `analytic.march.compiled.DONE`, and the deviation then.
    """
    work = new_work(tables)
    while motion.counts[PERIODS] < sizes.size:
        status, now = _carry_to(tables, motion, work, period, now, most)
        if status == DONE:
            done = motion.counts[PERIODS]
            slots[done] = motion.counts[SLOT]
            put(sections[done, 0], motion.q)
            put(sections[done, 1], motion.v)
            sizes[done] = size_of(now[:, 0], period)
            now /= sizes[done]
            next_period(motion, penetration[done])
        else:
            return status, now
    return DONE, now


@njit(cache=True)
def _carry(tables: Tables, motion: Motion, end: float, now: FloatArray, most: int) -> tuple[int, FloatArray]:
    """As `_carry_to`, with scratch arrays of its own."""
    return _carry_to(tables, motion, new_work(tables), end, now, most)


def march_linearised(
    joint: Joint, begin: Coordinates, end: float, deviations: FloatArray
) -> tuple[Coordinates, FloatArray]:
    """March from the time 0 on, and carry deviations along.

    It ends where `march` does, to the bit, but keeps no log.

    Parameters
    ----------
    joint : Joint
        The problem and its modes.
    begin : Coordinates
        Where the motion begins, at the time 0.
    end : float
        When the march ends, s.
    deviations : FloatArray, shape (2 N_start, m)
        Deviations (dq, dv) at the start, kg^1/2 m and kg^1/2 m/s, as columns.

    Returns
    -------
    Coordinates
        Where the motion ends.
    FloatArray, shape (2 N_end, m)
        The deviations there.

    Raises
    ------
    SolverError
        If `MOST_SWITCHES` switches do not suffice, or the march makes no progress.
    """
    motion, now, status = begun(joint, begin, 0.0), deviations.copy(), MISSING_SWITCH
    while status != DONE:
        status, now = _carry(joint.tables, motion, end, now, MOST_SWITCHES)
        settle_status(joint, motion, status, MOST_SWITCHES)
    return ended(joint, motion), now


def measure_growth(
    joint: Joint,
    begin: Coordinates,
    deviation: FloatArray,
    period: float,
    count: int,
    *,
    max_switches: int = MOST_SWITCHES,
) -> Growth:
    """March over whole periods, as `march_periods` does, and carry a deviation along.

    Parameters
    ----------
    joint : Joint
        The problem and its modes.
    begin : Coordinates
        Where the motion begins, at the time 0.
    deviation : FloatArray, shape (2 N_start,)
        (dq, dv) at the start, kg^1/2 m and kg^1/2 m/s, of any size but 0.  It is scaled to unit size,
        |dq| + |dv| period / 2 pi = 1, at the start and at the end of each period.
    period : float
        The period, s.
    count : int
        Number of periods.
    max_switches : int, optional
        Most switches in all.

    Returns
    -------
    Growth
        The motion, with a section point at the end of every period, and the growth of the deviation.

    Raises
    ------
    SolverError
        If more than `max_switches` switches occur, or the march makes no progress.
    """
    motion = begun(joint, begin, 0.0)
    penetration, slots = np.zeros((count, motion.total.size)), np.zeros(count, dtype=np.int64)
    coordinates, sizes, status = np.zeros((count, 2, motion.q.size)), np.zeros(count), MISSING_SWITCH
    now = (deviation / size_of(deviation, period)).reshape(-1, 1)
    while status != DONE:
        status, now = _grow(joint.tables, motion, period, now, sizes, penetration, slots, coordinates, max_switches)
        settle_status(joint, motion, status, max_switches)
    march = joint, ended(joint, motion), penetration.sum(axis=0), int(motion.counts[SWITCHES]), slots, coordinates
    return Growth(*march, penetration, np.log(sizes), now[:, 0].copy())
