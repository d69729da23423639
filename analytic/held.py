r"""A march that is held at an unstable motion, and how it is made to leave it.

Deviations from an unstable motion grow, but a march need not have any.  One from rest stays in the subspace of a
symmetry of the problem, of left and right for instance, though the motion there may be unstable to everything outside.
And truncation holds a march that has left it: where two stops switch together, the order in which they do decides
what the modes of the state between them lose.  The map jumps there by some c, and where the jump points back, a
deviation d grows only if (mu - 1) |d| > c, mu being the multiplier.  No motion of a joint is held in either way.

So a march that repeats, but whose deviations grow, is pushed off in the direction in which they grow most, to the
side on which it is already, well beyond what it has been seen to wander by.  One that is leaving anyway is hastened.

Where jumps keep Newton's method from a stable motion, they part it into several, less than c / (1 - |mu|) apart, and
a march visits them in turn.  `parted_by_a_jump` tells them from a true motion of several periods.
"""

from __future__ import annotations

import numpy as np

from analytic.maps import Map
from analytic.march import Coordinates
from analytic.start import resumed
from lapjoint.answers.steady_state import Section
from lapjoint.problem import FloatArray

REPEATS = 1e-4  # of the size of the motion: what comes back so closely repeats, to the jumps of ten or more modes
NARROW = 1e-2  # of the size: so far a march may be held away from the motion at which it is held
PUSHES = 3
_BEYOND = 10.0  # times what a march wanders by: how far it is pushed, and how much farther each time
_FARTHEST = 3e-2
_DISTURBANCE = 1e-3
_GROWS = 1e-6  # a multiplier above 1 by this is more than rounding
_JUMP = 0.05  # of a step: what the linearised map may miss the next one by; and more for longer steps:
_BENDS = 500.0  # by so many times their length, over the size of the motion, a smooth map may bend
_PARTED = 1e-3  # of the size: beyond, bends and jumps cannot be told apart


def pushed(maps: Map, now: Coordinates, returns: FloatArray, times: int) -> Coordinates | None:
    """The march pushed off the unstable motion at which it is held; None if it is not held at one.

    Parameters
    ----------
    returns : FloatArray
        The residuals after 1, 2, ... turns.
    times : int
        How often it has been pushed before.
    """
    turns = int(np.argmin(returns)) + 1
    closest = float(returns[turns - 1])
    if times >= PUSHES or closest > REPEATS:
        return None
    shot = maps.shoot(now, turns)
    growing = _growing(maps, maps.matrix(shot, turns), shot.end.y - now.y)
    return None if growing is None else moved(maps, now, _length(closest, times) * growing)


def disturbed(maps: Map, now: Coordinates, wander: float, deviation: FloatArray, times: int) -> Coordinates:
    """An aperiodic march, moved along a deviation that has grown with it: what is chaos must remain so after.

    Parameters
    ----------
    wander : float
        How far it wanders from repeating.  If it is narrow it may be held, and is pushed as far as one that is.
    deviation : FloatArray
        Of unit size.
    times : int
        How often it has been pushed before.
    """
    length = _length(wander, times) if wander <= NARROW else _DISTURBANCE
    return moved(maps, now, length * deviation)


def _length(wander: float, times: int) -> float:
    """How far to push a march that wanders so far, of its size."""
    return min(max(REPEATS, _BEYOND * wander) * _BEYOND**times, _FARTHEST)


def moved(maps: Map, now: Coordinates, part: FloatArray) -> Coordinates:
    """A section moved by some `part` of its size; stops are open or closed as they then are."""
    y = now.y + maps.norm(now.y) * part
    return resumed(maps.joint, Section(now.state, y.reshape(2, -1)))


def _growing(maps: Map, matrix: FloatArray, step: FloatArray) -> FloatArray | None:
    """The direction in which deviations grow most, to the side of `step`, the last one made; None if none grows."""
    values, vectors = np.linalg.eig(matrix)
    leading = int(np.argmax(np.abs(values)))
    if abs(values[leading]) <= 1 + _GROWS:
        return None
    direction = np.real(vectors[:, leading])
    direction = direction / maps.norm(direction)
    # A step is (mu - 1) times the deviation.  Of a complex pair, and of a mu below -1, the march sees both sides.
    side = np.real(np.linalg.solve(vectors, step.astype(vectors.dtype))[leading])
    return direction if side >= 0 else -direction


def parted_by_a_jump(maps: Map, begin: Coordinates, turns: int, times: int) -> tuple[float, FloatArray] | None:
    """Whether what repeats after `times` times `turns` would repeat after these but for a jump of the map.

    It would if a smooth map could not tell it from a stable fixed point: it goes not far, all multipliers lie within
    the unit circle, and yet some step is not the one before it, carried by the linearised map.  Returns the residual
    of the first return, and the moduli of the multipliers, descending.
    """
    shot = maps.shoot(begin, turns)
    first, step = shot.residual, shot.end.y - begin.y
    if not 0 < first <= _PARTED:
        return None
    matrix = maps.matrix(shot, turns)
    moduli = np.sort(np.abs(np.linalg.eigvals(matrix)))[::-1]
    if moduli[0] >= 1:
        return None
    jumps, residual = False, first
    for _ in range(times - 1):
        before, linearised = shot.end, matrix @ step
        shot = maps.shoot(before, turns)
        if not shot.residual <= 2 * _PARTED:
            return None
        length, step = maps.norm(step), shot.end.y - before.y
        bend = max(_JUMP, _BENDS * residual)
        jumps |= maps.norm(step - linearised) > bend * length
        matrix, residual = maps.matrix(shot, turns), shot.residual
    return (first, moduli) if jumps else None
