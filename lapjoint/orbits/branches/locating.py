"""What tells that a bifurcation lies between two places of a curve, and where it is: the root of a test function."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass
from typing import Literal

import numpy as np

from lapjoint.orbits.branches.corrector import STEEP, Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.newton import REAL
from lapjoint.problem import FloatArray

Kind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking"]
_STEPS = 40
"""Most steps of the search for the root of a test function."""
LOCATED = 1e-9
"""Change of the number over its scale, and of the motion over its size, at which a bifurcation is located; and the
value of a test function there."""
_ALONE = 1e-8
"""Distance of the multiplier from where it must be up to which a small value of a test function tells that it is there:
det(1 + M) is small, too, where two multipliers are near -1, and had a flip 3e-5 of the number off so."""
_SURE = 0.01
"""Share of that at which it is located, too, if a straight line between the ends has it so near to one of them."""
_STUCK = 3
"""Number of steps in turn that leave most of what was left, after which it is halved."""
_MOST = 0.6
"""Share of what was left from which on it is most: of a curve, half the way is not half the distance."""


def lies_between(family: Family, first: Place, last: Place, place: Place) -> bool:
    """Whether a place of a curve lies between two others that are near it.

    Parameters
    ----------
    family : Family
        The period maps.
    first, last : Place
        The two others.
    place : Place
        The place.

    Returns
    -------
    bool
        Whether it sees them in opposite directions.
    """
    return float(place.chord(family, first) @ place.chord(family, last)) < 0


def flip_of(place: Place) -> Kind:
    """What it is called where a multiplier of a motion is -1.

    Parameters
    ----------
    place : Place
        The motion.

    Returns
    -------
    str
        ``flip`` or ``symmetry breaking``.
    """
    return "symmetry breaking" if place.count % 2 else "flip"


@dataclass(frozen=True)
class Criterion:
    """What tells where a bifurcation lies between two places."""

    count: Callable[[Place], int]
    """What changes there."""
    distance: Callable[[Place], float]
    """The size of a number that vanishes there, and grows with the distance on either side as far as it may."""
    left: Callable[[Place], float]
    """Distance of the multiplier that is nearest to where it must be, or for a fold of the tangent."""

    def changes(self, first: Place, last: Place) -> bool:
        """Whether a bifurcation of this kind lies between two places.

        Parameters
        ----------
        first, last : Place
            The two.

        Returns
        -------
        bool
            Whether what is counted differs.
        """
        return self.count(first) != self.count(last)


def criteria_of(place: Place) -> dict[Kind, Criterion]:
    """What changes, and what vanishes, at each kind of bifurcation that a branch may have.

    Parameters
    ----------
    place : Place
        A place of the branch.

    Returns
    -------
    dict
        By the kind of the bifurcation.
    """
    return {
        "fold": Criterion(goes_up, _steepness, _steepness),
        flip_of(place): Criterion(above_minus_one, _near_minus_one, _from_minus_one),
        "neimark-sacker": Criterion(outside, _from_circle, _from_circle),
    }


def located(family: Family, first: Place, last: Place, criterion: Criterion) -> Place | None:
    """The place between two at which something that is counted changes.

    Parameters
    ----------
    family : Family
        The period maps.
    first, last : Place
        Neighbours, between which the count changes.
    criterion : Criterion
        What is counted, and what vanishes where it changes.

    Returns
    -------
    Place, or None
        None if a place between the two is not found.
    """
    a, b, kept, slow, before = first, last, "", 0, math.inf
    at_a, at_b = criterion.distance(a), criterion.distance(b)
    fa, fb = at_a, at_b
    for _ in range(_STEPS):
        length = float(np.linalg.norm(b.chord(family, a)))
        if length * min(at_a, at_b) <= _SURE * LOCATED * (at_a + at_b):
            nearer = a if at_a <= at_b else b
            if criterion.left(nearer) <= _ALONE:
                return nearer
        if length <= LOCATED:
            return a if at_a <= at_b else b
        slow, before, least = slow + 1 if length > _MOST * before else 0, length, 0.5 * LOCATED / length
        share = 0.5 if slow >= _STUCK else min(max(fa / (fa + fb), least), 1 - least)
        here = between_two(family, a, b, share, length) or between_two(family, a, b, 0.5, length)
        if here is None:
            return None
        value = criterion.distance(here)
        if value <= LOCATED and criterion.left(here) <= _ALONE:
            return here
        if criterion.count(here) == criterion.count(first):
            fb = fb * _anderson(value, at_a) if kept == "b" else at_b
            a, at_a, fa, kept = here, value, value, "b"
        else:
            fa = fa * _anderson(value, at_b) if kept == "a" else at_a
            b, at_b, fb, kept = here, value, value, "a"
    return a


def _anderson(value: float, before: float) -> float:
    """What the other end's value is multiplied by where the root stays on its side: Anderson's and Bjoerck's rule."""
    share = 1 - value / before
    return share if share > 0 else 0.5


def between_two(
    family: Family,
    a: Place,
    b: Place,
    share: float,
    length: float,
    alike: Callable[[Place], bool] = lambda place: True,
    enough: Callable[[Place, float], bool] | None = None,
) -> Place | None:
    """A place between two neighbours.

    Parameters
    ----------
    family : Family
        The period maps.
    a, b : Place
        The two, with tangents in one direction.
    share : float
        How far from `a` towards `b`, 0 to 1.
    length : float
        Arc length between them.
    alike : callable, optional
        Whether a place will do.
    enough : callable, optional
        As `corrected` has it.

    Returns
    -------
    Place, or None
        None if Newton's method finds none.
    """
    near, far, share = (a, b, share) if share <= 0.5 else (b, a, 1 - share)
    fixed = abs(near.tangent[-1]) > STEEP and goes_up(near) == goes_up(far)  # no number is held across a fold
    step = length if near is a else -length
    bent = _bent(family, near, far, share, step)
    straight = (near, share * step * near.tangent), (far, (share - 1) * step * far.tangent)
    for start, way in ((near, bent), *straight, (near, -share * near.chord(family, far))):
        if way is None:
            continue
        found = corrected(family, *start.moved(family, way), near.count, fixed=fixed, enough=enough)
        if found is not None and (way is not bent or lies_between(family, a, b, found)) and alike(found):
            chord = found.chord(family, near)
            return found.along(chord if near is a else -chord)
    return None


def _bent(family: Family, near: Place, far: Place, share: float, step: float) -> FloatArray | None:
    """The way from a place to one between it and another along the cubic through both and along their tangents.

    In the coordinates of `near`, shape ``(n + 1,)``; `step` is the arc length between the two, negative against the
    tangents.  None where their coordinates are not the same.
    """
    if near.point.state != far.point.state or near.weights.shape != far.weights.shape:
        return None
    scales = np.append(near.weights / far.weights, family.scale(far.value) / family.scale(near.value))
    tangents = (1 - share) * near.tangent - share * scales * far.tangent
    return np.asarray(share * (1 - share) * step * tangents - share**2 * (3 - 2 * share) * near.chord(family, far))


def crosses_minus_one(place: Place) -> tuple[complex, np.ndarray]:
    """The real multiplier nearest to -1, and its eigenvector.

    Parameters
    ----------
    place : Place
        A place at a flip, or where a symmetry breaks.

    Returns
    -------
    tuple of complex and ndarray, shape (n,)
        The multiplier over the motion's half periods, and the vector in the coordinates of its section point.
    """
    values, vectors = place.orbit.spectrum
    k = int(np.argmin(np.abs(values + 1)))
    return complex(values[k]), np.real(vectors[:, k])


def goes_up(place: Place) -> int:
    """Whether the number grows along the curve.

    Parameters
    ----------
    place : Place
        A place of a curve.

    Returns
    -------
    int
        0 or 1.
    """
    return int(place.tangent[-1] > 0)


def _steepness(place: Place) -> float:
    """The size of the number's part in the tangent."""
    return abs(float(place.tangent[-1]))


def above_minus_one(place: Place) -> int:
    """Whether det(1 + M) is positive: it changes its sign where a real multiplier passes -1, and nowhere else.

    Parameters
    ----------
    place : Place
        A place of a curve.

    Returns
    -------
    int
        0 or 1.
    """
    return int(np.count_nonzero(place.orbit.real < -1) % 2 == 0)


def _near_minus_one(place: Place) -> float:
    """The size of det(1 + M), over that of multipliers which are far outside the circle."""
    return place.orbit.near_minus_one


def from_one(place: Place) -> float:
    """Distance from 1 of the multiplier that is nearest to it.

    Parameters
    ----------
    place : Place
        A place of a curve.

    Returns
    -------
    float
        1 at most.
    """
    return float(np.min(np.abs(place.orbit.values - 1), initial=1.0))


def _from_minus_one(place: Place) -> float:
    """Distance from -1 of the multiplier that is nearest to it."""
    return float(np.min(np.abs(place.orbit.values + 1), initial=1.0))


def outside(place: Place, by: float = 0.0) -> int:
    """Number of multipliers outside the unit circle.

    Parameters
    ----------
    place : Place
        A place of a curve.
    by : float
        Distance from the circle from which on they count.

    Returns
    -------
    int
        0 or more.
    """
    return int(np.count_nonzero(place.orbit.moduli > 1 + by))


def _from_circle(place: Place) -> float:
    """Distance from the circle of the complex multiplier that is nearest to it."""
    values, moduli = place.orbit.values, place.orbit.moduli
    pairs = moduli[np.abs(values.imag) > REAL * moduli]
    return float(np.min(np.abs(pairs - 1), initial=1.0))
