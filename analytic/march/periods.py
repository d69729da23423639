"""The march over many whole periods in one compiled call, for the transients of a search."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from analytic.march.carried import advance_periods
from analytic.march.compiled import DONE, MISSING_SWITCH
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.march import MOST_SWITCHES, begun, ended, next_switches, settle_status
from analytic.march.motion import SWITCHES, Motion, new_work
from analytic.march.tables import IntArray
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Periods:
    """A motion over whole periods, and where it ends."""

    joint: Joint
    end: Coordinates
    penetration: FloatArray
    """Time integral of each stop's penetration over all periods, m s, shape ``(P,)``."""
    switches: int
    """Switches made."""


class PeriodRecord(NamedTuple):
    """Arrays that `analytic.march.carried.advance_periods` writes, period by period."""

    penetration: FloatArray
    """Time integral of each stop's penetration, m s, shape ``(rows, P)``; periods beyond the rows are added to the last
    row."""
    slots: IntArray
    """State at the end of each period, as its slot, shape ``(count,)`` or ``(0,)``."""
    coordinates: FloatArray
    """q, kg^1/2 m, and v, kg^1/2 m/s, at the end of each period, shape ``(count, 2, N)`` or ``(0, 2, N)``."""


def room_for(motion: Motion, rows: int, count: int) -> PeriodRecord:
    """Arrays for the penetrations of `rows` periods, and for `count` section points."""
    slots, coordinates = np.zeros(count, dtype=np.int64), np.zeros((count, 2, motion.q.size))
    return PeriodRecord(np.zeros((rows, motion.total.size)), slots, coordinates)


def march_on(
    joint: Joint,
    motion: Motion,
    period: float,
    count: int,
    record: PeriodRecord,
    now: FloatArray,
    growth: FloatArray | None = None,
    *,
    max_switches: int = MOST_SWITCHES,
    at_once: int | None = None,
) -> FloatArray:
    """March until `count` periods of `period`, s, are done, and return the deviations `now`, ``(2 N, m)``, carried
    along.

    The arguments are those of `analytic.march.carried.advance_periods`; at most `at_once` switches are made in one
    compiled call.
    """
    work, level, status = new_work(joint.tables), np.zeros((motion.total.size, now.shape[1])), MISSING_SWITCH
    growth = np.zeros(0) if growth is None else growth
    while status != DONE:
        most = next_switches(motion, max_switches, at_once)
        status, now = advance_periods(joint.tables, motion, work, period, count, *record, now, level, growth, most)
        settle_status(joint, motion, status, max_switches)
    return now


def march_periods(
    joint: Joint, begin: Coordinates, period: float, count: int, *, max_switches: int = MOST_SWITCHES
) -> Periods:
    """March over `count` periods of `period`, s, from the time 0; the result has the bits of `count` calls of `march`.

    Each of these calls would march from 0 to `period`.  `SolverError` is raised where more than `max_switches` switches
    occur, or the march makes no progress.
    """
    motion = begun(joint, begin, 0.0)
    record, none = room_for(motion, 1, 0), np.zeros((2 * motion.q.size, 0))
    march_on(joint, motion, period, count, record, none, max_switches=max_switches)
    return Periods(joint, ended(joint, motion), record.penetration[0], int(motion.counts[SWITCHES]))
