"""Pushing a march off an unstable motion that it cannot leave.

Deviations from an unstable motion grow, but a march may have no deviation.  A march from rest keeps a symmetry of the
problem, for example of left and right, although the motion may be unstable to deviations that break this symmetry.
Truncation can also keep a march near an unstable motion.  If two stops switch nearly together, their order decides
which part of the motion is lost by the modes of the state between the two switches, so the map jumps by some c.  If the
jump points back to the unstable motion, a deviation d grows only if (mu - 1) |d| > c, with the multiplier mu.  No
motion of a real joint remains near an unstable motion for these reasons.

If a march repeats while deviations from it grow, it is therefore pushed in the direction in which deviations grow most,
to the side on which the march already is, and well beyond the distance by which the march wanders.
"""

from __future__ import annotations

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import GROWS
from lapjoint.problem import FloatArray

REPEATS = 1e-4
"""Largest distance between start and end of a march that counts as repeating, divided by the size of the motion; with
ten or more modes the map may jump by this distance."""
NARROW = 1e-2
"""Largest distance from an unstable motion, divided by its size, at which truncation may keep a march."""
PUSHES = 3
"""Largest number of pushes of one march, each ten times as long as the previous one: at least 1e-4 of the motion's size
for the first, and 1e-2 for the third."""
_BEYOND = 10.0
"""Length of the first push, divided by the distance by which the march wanders; also the ratio of each later push to
the previous one."""
_FARTHEST = 3e-2
"""Longest push, divided by the size of the motion: after a longer push the march would begin anew."""
_DISTURBANCE = 1e-3
"""Length of the disturbance of a chaotic march, divided by its size: far above rounding, and too small to end chaos."""


def pushed_off(half_periods: HalfPeriods, now: SectionPoint, count: int, times: int) -> SectionPoint | None:
    """The point `now` of a march, pushed off an unstable motion that the march cannot leave; None if there is none.

    The march returns most closely after `count` half periods, and was pushed `times` times before.  The answer is also
    None if the derivative overflows double precision, so that no direction is known.
    """
    if times >= PUSHES:
        return None
    found = half_periods.linearised(now, count)
    step = half_periods.map.difference(found.end, now)
    closest = half_periods.relative(step, now)
    if closest > REPEATS or not np.isfinite(found.matrix).all():
        return None
    growing = _growing(half_periods, found.matrix, step)
    return None if growing is None else _moved(half_periods, now, _length(closest, times) * growing)


def disturbed(
    half_periods: HalfPeriods, now: SectionPoint, wander: float, deviation: FloatArray, times: int
) -> SectionPoint:
    """The point `now` of an aperiodic march, moved along a unit deviation, (n,), carried with it: chaos must persist.

    `wander` is the distance of the march from repeating, divided by its size.  If it is at most `NARROW`, the march may
    be unable to leave an unstable motion, and the displacement is as long as in `pushed_off` after `times` pushes.
    """
    length = _length(wander, times) if wander <= NARROW else _DISTURBANCE
    return _moved(half_periods, now, length * deviation)


def _length(wander: float, times: int) -> float:
    """Length of the next push of a march that wanders by `wander`; both divided by the size of the motion."""
    return min(max(REPEATS, _BEYOND * wander) * _BEYOND**times, _FARTHEST)


def _moved(half_periods: HalfPeriods, now: SectionPoint, part: FloatArray) -> SectionPoint:
    """A section point moved by a deviation; `part`, shape ``(n,)``, is the deviation divided by the point's size."""
    return half_periods.map.moved(now, half_periods.map.size(now) * part)


def _growing(half_periods: HalfPeriods, matrix: FloatArray, step: FloatArray) -> FloatArray | None:
    """The direction in which deviations grow most, to the side of the march's last step; None if no deviation grows."""
    values, vectors = np.linalg.eig(matrix)
    leading = int(np.argmax(np.abs(values)))
    if abs(values[leading]) <= 1 + GROWS:
        return None
    direction = np.real(vectors[:, leading])
    direction = direction / half_periods.map.norm(direction)
    # A step is (mu - 1) times the deviation.  With a complex pair, or mu below -1, the march visits both sides.
    side = np.real(np.linalg.solve(vectors, step.astype(vectors.dtype))[leading])
    return direction if side >= 0 else -direction
