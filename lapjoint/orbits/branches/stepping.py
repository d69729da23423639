"""One step along a curve of periodic motions, and what shows that it has led too far."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.orbits.branches.corrector import STEEP, Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.problem import FloatArray

WIDEST = 0.45
"""Largest angle between a step and the tangent at its end, rad: a wider one may be due to another curve."""
_STRETCH = 1.4
"""Largest ratio of the step made and the step meant."""
_BOTH_SIDES = 3.0
"""Largest ratio of what two motions miss together and the way between them, where this leads past a motion that misses
nothing: 2 on a straight way."""


def stepped(family: Family, here: Place, step: float, bend: FloatArray | None) -> tuple[Place | None, float]:
    """The next place of a curve, and the angle between the step and the tangent there.

    Another orientation than here shows that it is of another curve, or that a graze spoils its tangent.

    Parameters
    ----------
    family : Family
        The period maps.
    here : Place
        A place of the curve.
    step : float
        Arc length to the next one.
    bend : FloatArray, shape (n + 1,), or None
        `bend_of` the last step, if it is known.

    Returns
    -------
    Place or None
        None if it is not found, or may be of another curve.
    float
        The angle, rad; NaN if no place is found.
    """
    ahead = step * here.tangent
    if bend is not None and step * float(np.linalg.norm(bend)) <= WIDEST:
        ahead = ahead + 0.5 * step**2 * bend
    value, guess = here.moved(family, ahead)
    steep = abs(here.tangent[-1]) > STEEP
    new = corrected(family, value, guess, here.count, fixed=steep and family.covers(value))
    if new is None:
        return None, math.nan
    chord = new.chord(family, here)
    length = float(np.linalg.norm(chord))
    new = new.along(chord)
    angle = math.acos(min(1.0, float(chord @ new.tangent) / max(length, 1e-300)))
    if angle > WIDEST or not 1 / _STRETCH < length / step < _STRETCH:
        return None, angle
    if new.orientation != here.orientation and share_to_shorter(family, here, new) is None:
        return None, angle
    return new, angle


def bend_of(family: Family, here: Place, new: Place) -> FloatArray | None:
    """Change of the tangent with the arc length from one place to the next.

    Parameters
    ----------
    family : Family
        The period maps.
    here, new : Place
        The two.

    Returns
    -------
    FloatArray, shape (n + 1,), or None
        In the coordinates of the next one; None where those of both are not the same.
    """
    if here.point.state != new.point.state or here.weights.shape != new.weights.shape:
        return None
    scales = np.append(new.weights / here.weights, family.scale(here.value) / family.scale(new.value))
    return np.asarray((new.tangent - here.tangent * scales) / float(np.linalg.norm(new.chord(family, here))))


def share_to_shorter(family: Family, here: Place, new: Place) -> float | None:
    """The share of the way from one place to another at which the branch comes to a motion that repeats sooner.

    It springs from a branch of half as many half periods there, and would be gone through again.  By how much its
    motions miss to repeat after these changes its sign, and twice the way there is what is missed: a motion and its
    image lie on either side.  So does the orientation change, as two curves meet there.

    Parameters
    ----------
    family : Family
        The period maps.
    here, new : Place
        The two places.

    Returns
    -------
    float or None
        From 0 to 1; None if it does not come to such a motion.
    """
    a, b = here.missed, new.missed
    if a is None or b is None or a.shape != b.shape or float(a @ (b * new.weights / here.weights)) >= 0:
        return None
    sizes = float(np.linalg.norm(a)), float(np.linalg.norm(b))
    if sum(sizes) > _BOTH_SIDES * float(np.linalg.norm(new.chord(family, here))):
        return None
    return sizes[0] / sum(sizes)


def at_boundary(family: Family, here: Place, new: Place, value: float) -> Place | None:
    """The place at an end of the range that the way from one place to another leads out of.

    Parameters
    ----------
    family : Family
        The period maps.
    here, new : Place
        The last place in the range, and another, behind its end or close before it.
    value : float
        The number at the end, in its SI unit.

    Returns
    -------
    Place, or None
        None if it is not found.
    """
    share = (value - here.value) / (new.value - here.value)
    length = float(np.linalg.norm(new.chord(family, here)))
    _, guess = here.moved(family, share * length * here.tangent)
    found = corrected(family, value, family.adopted(value, guess), here.count, fixed=True)
    return None if found is None else found.along(found.chord(family, here))
