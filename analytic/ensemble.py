"""Many motions of one joint that march on in one compiled call; see `lapjoint.orbits.ensemble.Ensemble`."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from analytic.march import Coordinates, Joint
from analytic.march.compiled import DONE
from analytic.march.initial_state import carried_over
from analytic.march.many import advance_many
from analytic.march.march import MOST_SWITCHES, next_switches, settle_status
from analytic.march.motion import new_motion, new_work
from analytic.march.tables import IntArray
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray


class JointEnsemble:
    """Section points of one joint as flat arrays; `period` is the excitation period, s."""

    def __init__(self, joint: Joint, period: float, points: Sequence[Coordinates]) -> None:
        self._joint, self._period = joint, period
        size = max(joint.counts)
        self._slots: IntArray = np.array([joint.slot(point.state) for point in points], dtype=np.int64)
        self._q, self._v = np.zeros((2, len(points), size))
        for i, point in enumerate(points):
            self._q[i, : point.q.size], self._v[i, : point.v.size] = point.q, point.v

    def march(self, which: IntArray, periods: int) -> dict[int, str]:
        """March the members `which` over whole periods. See `lapjoint.orbits.ensemble.Ensemble.march`."""
        joint, failed = self._joint, dict[int, str]()
        motion = new_motion(0, 0.0, np.zeros(0), np.zeros(0), max(joint.counts), joint.stops)
        work = new_work(joint.tables)
        rows, begin = np.asarray(which, dtype=np.int64), (0, 0)
        arrays = self._slots, self._q, self._v
        while begin[0] < rows.size:
            most = next_switches(motion, MOST_SWITCHES)
            status, at = advance_many(joint.tables, begin, rows, *arrays, self._period, periods, most, motion, work)
            begin = (at, int(status != DONE))
            try:
                settle_status(joint, motion, status, MOST_SWITCHES)
            except SolverError as error:
                failed[int(rows[at])] = str(error)
                begin = (at + 1, 0)
        return failed

    def deviations(self, which: IntArray, origin: SectionPoint) -> FloatArray:
        """Deviations of members from a section point. See `lapjoint.orbits.ensemble.Ensemble.deviations`."""
        joint, n = self._joint, self._joint.count(origin.state)
        found: FloatArray = np.zeros((len(which), 2, n))
        slots = self._slots[which]
        for slot in np.unique(slots):
            here, state = np.flatnonzero(slots == slot), joint.state_in(int(slot))
            count = joint.count(state)
            q, v = self._q[which[here], :count], self._v[which[here], :count]
            if state != origin.state:
                q, v = carried_over(joint, state, origin.state, q, v)
            found[here, 0], found[here, 1] = q, v
        return np.asarray((found - origin.coordinates).reshape(len(which), 2 * n))

    def point(self, member: int) -> SectionPoint:
        """The section point of a member. See `lapjoint.orbits.ensemble.Ensemble.point`."""
        state = self._joint.state_in(int(self._slots[member]))
        n = self._joint.count(state)
        return SectionPoint(state, np.array((self._q[member, :n], self._v[member, :n])))
