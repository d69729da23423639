"""A march that is held at an unstable motion, and how it is made to leave it.

Deviations from an unstable motion grow, but a march need not have any.  One from rest stays in the subspace of a
symmetry of the problem, of left and right for instance, though the motion there may be unstable to everything outside.
And truncation holds a march that has left it: where two stops switch together, the order in which they do decides
what the modes of the state between them lose.  The map jumps there by some c, and where the jump points back, a
deviation d grows only if (mu - 1) |d| > c, mu being the multiplier.  No motion of a joint is held in either way.

So a march that repeats, but whose deviations grow, is pushed off in the direction in which they grow most, to the
side on which it is already, well beyond what it has been seen to wander by.  One that is leaving anyway is hastened.
"""

from __future__ import annotations

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray

REPEATS = 1e-4  # of the size of the motion: what comes back so closely repeats, to the jumps of ten or more modes
NARROW = 1e-2  # of the size: so far a march may be held away from the motion at which it is held
PUSHES = 3  # each ten times as far as the one before: from 1e-4 of the size to 1e-2
_BEYOND = 10.0  # times what a march wanders by: how far it is pushed, and how much farther each time
_FARTHEST = 3e-2  # of the size of the motion: farther off the march would begin anew
_DISTURBANCE = 1e-3  # of the size: moves a march that is chaotic well beyond its rounding, and not out of it
_GROWS = 1e-6  # a multiplier above 1 by this is more than rounding


def pushed_off(half_periods: HalfPeriods, now: SectionPoint, count: int, times: int) -> SectionPoint | None:
    """The march pushed off the unstable motion at which it is held; None if it is not held at one.

    Parameters
    ----------
    half_periods : HalfPeriods
        The map.
    now : SectionPoint
        Where the march is.
    count : int
        The number of half periods after which it comes back most closely.
    times : int
        How often it has been pushed before.
    """
    if times >= PUSHES:
        return None
    found = half_periods.linearised(now, count)
    step = half_periods.map.difference(found.end, now)
    closest = half_periods.relative(step, now)
    if closest > REPEATS:
        return None
    growing = _growing(half_periods, found.matrix, step)
    return None if growing is None else _moved(half_periods, now, _length(closest, times) * growing)


def disturbed(
    half_periods: HalfPeriods, now: SectionPoint, wander: float, deviation: FloatArray, times: int
) -> SectionPoint:
    """An aperiodic march, moved along a deviation that has grown with it: what is chaos must remain so after.

    Parameters
    ----------
    half_periods : HalfPeriods
        The map.
    now : SectionPoint
        Where the march is.
    wander : float
        How far it wanders from repeating.  If it is narrow it may be held, and is pushed as far as one that is.
    deviation : FloatArray
        Of unit size.
    times : int
        How often it has been pushed before.
    """
    length = _length(wander, times) if wander <= NARROW else _DISTURBANCE
    return _moved(half_periods, now, length * deviation)


def _length(wander: float, times: int) -> float:
    """How far to push a march that wanders so far, of its size."""
    return min(max(REPEATS, _BEYOND * wander) * _BEYOND**times, _FARTHEST)


def _moved(half_periods: HalfPeriods, now: SectionPoint, part: FloatArray) -> SectionPoint:
    """A section point moved by some `part` of its size."""
    return half_periods.map.moved(now, half_periods.map.size(now) * part)


def _growing(half_periods: HalfPeriods, matrix: FloatArray, step: FloatArray) -> FloatArray | None:
    """The direction in which deviations grow most, to the side of `step`, the last one made; None if none grows."""
    values, vectors = np.linalg.eig(matrix)
    leading = int(np.argmax(np.abs(values)))
    if abs(values[leading]) <= 1 + _GROWS:
        return None
    direction = np.real(vectors[:, leading])
    direction = direction / half_periods.map.norm(direction)
    # A step is (mu - 1) times the deviation.  Of a complex pair, and of a mu below -1, the march sees both sides.
    side = np.real(np.linalg.solve(vectors, step.astype(vectors.dtype))[leading])
    return direction if side >= 0 else -direction
