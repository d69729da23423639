"""Deviations carried along with a march in one compiled call.

All deviations over one march serve Newton's method; one deviation and its growth over many periods serve Lyapunov
exponents.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.carried import advance_periods, size_of
from analytic.march.compiled import DONE, MISSING_SWITCH, SWITCHES, new_work
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.march import MOST_SWITCHES, WITH_ALL_AT_ONCE, begun, ended, next_switches, settle_status
from analytic.march.periods import Periods
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Growth(Periods):
    """A motion over whole periods, and what became of a deviation from it."""

    penetrations: FloatArray
    """Time integral of each stop's penetration over each period, m s, shape ``(count, P)``."""
    growth: FloatArray
    """Natural logarithm of the growth of the deviation in each period, at least that of `LEAST_GROWTH`, without unit,
    shape ``(count,)``."""
    deviation: FloatArray
    """The deviation (dq, dv) at the end, kg^1/2 m and kg^1/2 m/s, scaled to a size of 1 kg^1/2 m, shape ``(2 N,)``."""


def march_linearised(
    joint: Joint, begin: Coordinates, end: float, deviations: FloatArray
) -> tuple[Coordinates, FloatArray]:
    """March from the time 0 to `end`, s, and carry deviations, ``(2 N_start, m)``, along; they end as ``(2 N_end, m)``.

    Deviations (dq, dv), kg^1/2 m and kg^1/2 m/s, are columns.  The motion ends where `march` does, to the bit, but no
    log is kept.
    """
    motion, work, now, status = begun(joint, begin, 0.0), new_work(joint.tables), deviations.copy(), MISSING_SWITCH
    total, none = np.zeros((1, motion.total.size)), (np.zeros(0, dtype=np.int64), np.zeros((0, 2, motion.q.size)))
    level, sizes = np.zeros((motion.total.size, now.shape[1])), np.zeros(0)
    while status != DONE:
        most = next_switches(motion, MOST_SWITCHES, WITH_ALL_AT_ONCE)
        status, now = advance_periods(joint.tables, motion, work, end, 1, total, *none, now, level, sizes, most)
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
    """March over whole periods, as `march_periods` does, and carry a deviation (dq, dv), ``(2 N_start,)``, along.

    The deviation, of any size but 0, is scaled to unit size, |dq| + |dv| period / 2 pi = 1 kg^1/2 m, at the start and
    at the end of each period.  `period` is in s.
    """
    motion, work = begun(joint, begin, 0.0), new_work(joint.tables)
    penetration, slots = np.zeros((count, motion.total.size)), np.zeros(count, dtype=np.int64)
    coordinates, growth, status = np.zeros((count, 2, motion.q.size)), np.zeros(count), MISSING_SWITCH
    now = deviation.reshape(-1, 1) / size_of(deviation.reshape(-1, 1), period)
    level = np.zeros((motion.total.size, 1))
    while status != DONE:
        most = next_switches(motion, max_switches)
        status, now = advance_periods(
            joint.tables, motion, work, period, count, penetration, slots, coordinates, now, level, growth, most
        )
        settle_status(joint, motion, status, max_switches)
    march = joint, ended(joint, motion), penetration.sum(axis=0), int(motion.counts[SWITCHES]), slots, coordinates
    return Growth(*march, penetration, growth, now[:, 0].copy())
