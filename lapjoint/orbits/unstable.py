"""A march that stays at an unstable motion, and how it is pushed off.

Deviations from an unstable motion grow, but a march may have none.  A march from rest keeps a symmetry of the problem,
for example of left and right, though the motion may be unstable to deviations that break the symmetry.  Truncation to
some modes, too, can keep a march near an unstable motion: where two stops switch together, their order decides which
part of the motion the modes of the state between the switches lose.  The map jumps there by some c.  Where the jump
points back, a deviation d grows only if (mu - 1) |d| > c, with the multiplier mu.  No motion of a real joint stays near
an unstable motion for these reasons.

A march that repeats, but whose deviations grow, is therefore pushed in the direction in which they grow most, to the
side on which the march already is, well beyond the distance by which it has been seen to wander.
"""

from __future__ import annotations

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import GROWS
from lapjoint.problem import FloatArray

REPEATS = 1e-4
"""A march that comes back within this distance, as a fraction of the size of the motion, repeats; with ten or more
modes the map may jump by this much."""
NARROW = 1e-2
"""Largest distance from an unstable motion, as a fraction of its size, at which truncation may keep a march."""
PUSHES = 3
"""Most pushes of one march, each ten times as long as the push before: at least 1e-4 of the motion's size, then 1e-2 at
the third."""
_BEYOND = 10.0
"""Length of the first push divided by the breadth of the march, and of each later push divided by the push before."""
_FARTHEST = 3e-2
"""Longest push, as a fraction of the size of the motion: after a longer one the march would begin anew."""
_DISTURBANCE = 1e-3
"""Length of the disturbance of a chaotic march, as a fraction of its size: far above rounding, too little to end
chaos."""


def pushed_off(half_periods: HalfPeriods, now: SectionPoint, count: int, times: int) -> SectionPoint | None:
    """The point at which a march that cannot leave an unstable motion continues, pushed off it; None if it is at none.

    After `count` half periods the march comes back most closely, and it has been pushed `times` before.  The answer is
    None, too, if the derivative is beyond double precision, and gives no direction.
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
    """The point of an aperiodic march, moved along a unit deviation, (n,), that has grown with it: chaos must persist.

    `wander` is the distance of the march from repeating, as a fraction of its size.  Up to `NARROW` the march may be
    unable to leave an unstable motion, and is pushed as far as in `pushed_off`; it has been pushed `times` before.
    """
    length = _length(wander, times) if wander <= NARROW else _DISTURBANCE
    return _moved(half_periods, now, length * deviation)


def _length(wander: float, times: int) -> float:
    """Length of the next push of a march that wanders by `wander`; both as fractions of its size."""
    return min(max(REPEATS, _BEYOND * wander) * _BEYOND**times, _FARTHEST)


def _moved(half_periods: HalfPeriods, now: SectionPoint, part: FloatArray) -> SectionPoint:
    """A section point moved by `part`, a deviation divided by the point's size, shape ``(n,)``."""
    return half_periods.map.moved(now, half_periods.map.size(now) * part)


def _growing(half_periods: HalfPeriods, matrix: FloatArray, step: FloatArray) -> FloatArray | None:
    """The direction in which deviations grow most, to the side of the march's last step; None if no deviation grows."""
    values, vectors = np.linalg.eig(matrix)
    leading = int(np.argmax(np.abs(values)))
    if abs(values[leading]) <= 1 + GROWS:
        return None
    direction = np.real(vectors[:, leading])
    direction = direction / half_periods.map.norm(direction)
    # A step is (mu - 1) times the deviation.  With a complex pair, or mu below -1, the march sees both sides.
    side = np.real(np.linalg.solve(vectors, step.astype(vectors.dtype))[leading])
    return direction if side >= 0 else -direction
