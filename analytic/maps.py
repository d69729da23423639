"""The maps of a section over half periods, whose fixed points are the periodic motions; see `analytic.steady`."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march import Coordinates, Joint, March, march
from analytic.start import translated
from analytic.tables import mirrored
from analytic.tangent import monodromy
from lapjoint.problem import FloatArray, StepLoad


@dataclass(frozen=True)
class Shot:
    """What becomes of a section after some turns."""

    motion: March
    end: Coordinates
    """Mirrored after an odd number of turns."""
    residual: float
    """Distance from the start, relative to the size of the motion; infinite in another contact state."""


class Map:
    """The maps of a section over half periods."""

    def __init__(self, joint: Joint, period: float) -> None:
        self.joint, self.period = joint, period
        self.symmetric = is_symmetric(joint)
        self.circled = False
        """Whether an unstable periodic motion with complex multipliers outside the unit circle has been met."""

    def norm(self, y: FloatArray) -> float:
        """Size of a deviation: displacements, and velocities times period / 2 pi."""
        q, v = np.split(y, 2)
        return float(np.linalg.norm(q) + np.linalg.norm(v) * self.period / (2 * np.pi))

    def shoot(self, begin: Coordinates, turns: int) -> Shot:
        """March over some turns, and compare the end with the start."""
        motion = march(self.joint, begin, 0.0, turns * self.period / 2)
        end = motion.end if turns % 2 == 0 else self._mirrored(motion.end)
        if end.state != begin.state:
            return Shot(motion, end, np.inf)
        return Shot(motion, end, self.norm(end.y - begin.y) / (self.norm(begin.y) + 1e-300))

    def returns(self, begin: Coordinates, turns: int) -> FloatArray:
        """The residuals after 1, 2, ... `turns` turns of one march, shape ``(turns,)``; odd ones only if symmetric."""
        half, now, residuals = self.period / 2, begin, np.full(turns, np.inf)
        for i in range(turns):
            now = march(self.joint, now, i * half, (i + 1) * half, record=False).end
            odd = i % 2 == 0
            end = self._mirrored(now) if odd and self.symmetric else now
            if end.state == begin.state and (self.symmetric or not odd):
                residuals[i] = self.norm(end.y - begin.y) / (self.norm(begin.y) + 1e-300)
        return residuals

    def breadth(self, sections: list[Coordinates], max_order: int) -> float:
        """How far the sections, a period apart, are from repeating: the farthest of all returns, at the best order."""
        size = max(self.norm(section.y) for section in sections) + 1e-300
        orders = range(1, min(max_order, len(sections) - 1) + 1)
        return min(max(map(self.distance, sections[n:], sections[:-n])) for n in orders) / size

    def distance(self, one: Coordinates, other: Coordinates) -> float:
        """Size of the difference of two sections, whatever their contact states."""
        if one.state != other.state:
            other = translated(self.joint, other, one.state)
        return self.norm(one.y - other.y)

    def matrix(self, shot: Shot, turns: int) -> FloatArray:
        """d(end) / d(start) of a shot."""
        return monodromy(shot.motion) * (1 if turns % 2 == 0 else -1)

    def _mirrored(self, section: Coordinates) -> Coordinates:
        state = mirrored(self.joint.problem, section.state)
        assert state is not None
        return Coordinates(state, -section.q, -section.v)


def is_symmetric(joint: Joint) -> bool:
    """Whether z -> -z and half a period later is the same problem again."""
    problem, omega = joint.problem, joint.harmonics.omega
    if any(isinstance(load, StepLoad) and load.force for load in problem.point_loads) or np.ptp(omega) > 0:
        return False
    whole = joint.every_stop_closed
    return mirrored(problem, whole) == whole
