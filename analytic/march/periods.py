"""The march over many whole periods in one compiled call, for the transients of a search."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.carried import advance_periods
from analytic.march.compiled import DONE, MISSING_SWITCH, SWITCHES, new_work
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.march import MOST_SWITCHES, begun, ended, next_switches, settle_status
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
    slots: IntArray
    """State at the end of each period, as its slot, shape ``(count,)``; ``(0,)`` if not recorded."""
    coordinates: FloatArray
    """q, kg^1/2 m, and v, kg^1/2 m/s, there, padded with 0, shape ``(count, 2, N)``; ``(0, 2, N)`` if not recorded."""

    @property
    def sections(self) -> tuple[Coordinates, ...]:
        """The section points at the end of each period, if recorded."""
        return tuple(self.section(i) for i in range(self.slots.size))

    def section(self, i: int) -> Coordinates:
        """A copy of the section point at the end of period `i`, counted from 0, of a motion that was recorded."""
        state = self.joint.state_in(int(self.slots[i]))
        n = self.joint.count(state)
        return Coordinates(state, self.coordinates[i, 0, :n].copy(), self.coordinates[i, 1, :n].copy())


def march_periods(
    joint: Joint,
    begin: Coordinates,
    period: float,
    count: int,
    record: bool = False,
    *,
    max_switches: int = MOST_SWITCHES,
) -> Periods:
    """March over `count` periods, s, from the time 0, to the bits of as many calls of `march` from 0 to `period`.

    `record` keeps the section point at the end of every period.  `SolverError` is raised where more than `max_switches`
    switches occur, or the march makes no progress.
    """
    motion, work = begun(joint, begin, 0.0), new_work(joint.tables)
    rows, size = count if record else 0, motion.q.size
    penetration, slots = np.zeros((1, motion.total.size)), np.zeros(rows, dtype=np.int64)
    coordinates, status = np.zeros((rows, 2, size)), MISSING_SWITCH
    now, level, sizes = np.zeros((2 * size, 0)), np.zeros((motion.total.size, 0)), np.zeros(0)
    while status != DONE:
        most = next_switches(motion, max_switches)
        status, now = advance_periods(
            joint.tables, motion, work, period, count, penetration, slots, coordinates, now, level, sizes, most
        )
        settle_status(joint, motion, status, max_switches)
    end = ended(joint, motion)
    return Periods(joint, end, penetration[0], int(motion.counts[SWITCHES]), slots, coordinates)
