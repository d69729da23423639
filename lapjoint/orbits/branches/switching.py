r"""From a branch to the one that springs from it where a multiplier is -1: a flip, or the breaking of a symmetry.

There the map M over the motion's half periods sends its vector v to -v, so the map over twice as many has a branch of
fixed points that leaves the motion along v: x = x0 + eps v + O(eps^2), p = p0 + O(eps^2).  For a flip it is the motion
of twice the period; where a symmetry breaks, its half periods being odd, it is the motion that its mirror image does
not repeat.  Both signs of eps give one motion, or a motion and its mirror image.
"""

from __future__ import annotations

from itertools import product

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import crosses_minus_one, flip_of
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected, jacobian, place_from, scaling, settled
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import smooth_finder
from lapjoint.orbits.branches.run import Limits, Run
from lapjoint.orbits.newton import RESIDUAL

_LENGTHS = (3e-3, 1e-3, 3e-4, 1e-4, 3e-5, 1e-2)
"""Arc lengths eps, tried in turn: from long ones Newton's method leads back to the old branch.  With light damping one
bifurcation in four is so near to a graze that only motions within 3e-4 of it are smooth."""
_FEW, _LONGER = 50, 2.0
"""Most points of a branch back to where it springs, and the largest ratio of its length and of the way to there."""
_STEPS = 10
"""Most steps of Newton's method."""


def switched(family: Family, bifurcation: Place) -> Place | None:
    """A motion of the branch that springs from a bifurcation, near it.

    Parameters
    ----------
    family : Family
        The period maps.
    bifurcation : Place
        The motion at which a multiplier is -1.

    Returns
    -------
    Place, or None
        Of twice as many half periods; its tangent points away from the bifurcation.  None if none is found.
    """
    _, vector = crosses_minus_one(bifurcation)
    direction = vector * bifurcation.weights
    direction = direction / np.linalg.norm(direction)
    for sign, length in product((1.0, -1.0), _LENGTHS):
        try:
            found = _beside(family, bifurcation, sign * direction, length)
        except (SolverError, InputError, np.linalg.LinAlgError):
            continue
        if found is None:
            continue
        half = found.half_periods
        if half.apart(half.marched(found.point, bifurcation.count), found.point) > length / 2:
            return found.along(found.chord(family, bifurcation))
    return None


def sprung_from(family: Family, near: Place) -> Place | None:
    """The bifurcation near a motion from which its branch springs.

    Half way between the motion and what it is after half of its period lies a motion, almost, that repeats then.

    Parameters
    ----------
    family : Family
        The period maps.
    near : Place
        The last place of a branch that comes to a motion that repeats in half the time.

    Returns
    -------
    Place, or None
        Of half as many half periods; None if it is not found.
    """
    half, count = near.half_periods, near.count // 2
    later = half.map.difference(half.marched(near.point, count), near.point)
    middle = corrected(family, near.value, half.map.moved(near.point, later / 2), count)
    found = None if middle is None else smooth_finder(flip_of(middle))(family, middle)
    return None if found is None else found.place


def back_to_where_it_springs(family: Family, place: Place, length: float) -> Run:
    """A branch from one of its first motions back to the bifurcation from which it springs.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        The motion, with its tangent towards the bifurcation.
    length : float
        Arc length to there.

    Returns
    -------
    Run
        The motion alone, if it does not lead there.
    """
    found = follow(family, place, Limits(most=_FEW, length=_LONGER * length, first=0.5 * length))
    return found if found.end == "bifurcation" else Run([place], [], [], "bifurcation")


def sprung(family: Family, finer: Family, near: Place) -> tuple[Place, float] | None:
    """A motion beside the bifurcation from which a branch springs, as a finer solver has both.

    Parameters
    ----------
    family : Family
        The period maps.
    finer : Family
        Those of the finer solver.
    near : Place
        A place of the branch near the bifurcation.

    Returns
    -------
    tuple of Place and float, or None
        The motion, with its tangent away from the bifurcation, and the arc length from there; of its section points
        half of its period apart, it is at the one that is nearer to the place.  None if the finer solver has no such
        bifurcation.
    """
    mother = sprung_from(family, near)
    known = None if mother is None else smooth_finder(flip_of(mother))(finer, mother)
    new = None if known is None else switched(finer, known.place)
    if known is None or new is None:
        return None
    later = corrected(finer, new.value, new.half_periods.marched(new.point, known.place.count), new.count, fixed=True)
    both = [new] if later is None else [new, later.along(later.chord(finer, known.place))]
    nearer = min(both, key=lambda one: float(np.linalg.norm(one.chord(finer, near))))
    return nearer, float(np.linalg.norm(new.chord(finer, known.place)))


def _beside(family: Family, bifurcation: Place, direction: np.ndarray, length: float) -> Place | None:
    """The motion of twice the half periods whose distance along a direction is `length`."""
    count, value = 2 * bifurcation.count, bifurcation.value
    border = np.append(direction, 0.0)
    value, point = bifurcation.moved(family, length * border)
    residual, closed = np.inf, None
    for i in range(_STEPS):
        half = family.at(value)
        found = family.linearised(value, point, count)
        r = half.map.difference(found.end, point)
        left = half.relative(r, point)
        if r.size != direction.size or left > max(0.5 * residual, 1e-2 if i < 3 else 0.0):
            return closed
        residual = left
        weights = scaling(half, point, r.size)
        column = family.derivative(value, point, count) if found.by_number is None else found.by_number
        J = jacobian(found.matrix, column * family.scale(value), weights)
        away = half.map.difference(point, half.map.adopted(bifurcation.point)) * weights
        step = np.linalg.solve(np.vstack([J, border]), np.append(-weights * r, length - float(direction @ away)))
        if residual <= RESIDUAL:
            closed = place_from(value, point, residual, found, J, weights)
            if settled(step, weights * r):
                return closed
        point = half.map.moved(point, step[:-1] / weights)
        value += float(step[-1]) * family.scale(value)
        point = family.adopted(value, point)
    return closed
