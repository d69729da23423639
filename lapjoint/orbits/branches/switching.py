r"""From a branch to the one that springs from it where a multiplier is -1: a flip, or the breaking of a symmetry.

There the map M over the motion's half periods sends its vector v to -v, so the map over twice as many has a branch of
fixed points that leaves the motion along v: x = x0 + eps v + O(eps^2), p = p0 + O(eps^2).  For a flip it is the motion
of twice the period; where a symmetry breaks, its half periods being odd, it is the motion that its mirror image does
not repeat.  Both signs of eps give one motion, or a motion and its mirror image.

A motion of that branch is told by M x - x = -2 eps v + O(eps^2), which is zero all along the old one.  How far it lies
along v from where it springs tells the two apart less well: the old one goes along v, too, and beside a graze by more.
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import suppress

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected, place_from, scaling, settled
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import smooth_finder
from lapjoint.orbits.branches.locating import criteria_of, crosses_minus_one, flip_of, located
from lapjoint.orbits.branches.newton_steps import jacobian
from lapjoint.orbits.branches.run import Limits, Run
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.problem import FloatArray

_LENGTHS = (3e-3, 3e-4, 3e-5, 3e-6, 1e-6)
"""Arc lengths eps, tried in turn: a branch is followed faster from far, but one bifurcation in four is so near to a
graze that only motions within 1e-5 of it are smooth."""
_FEW, _LONGER = 50, 2.0
"""Most points of a branch back to where it springs, and the largest ratio of its length and of the way to there."""
_BESIDE, _MOST = 5e-3, 40
"""Arc length, and points, of a branch along which it is looked for where another springs: beside a graze two solvers
may have that 2e-3 apart."""
_NEARLY = 3e-3
"""Most by which a motion may miss to repeat in half the time, over its size, where one that does is looked for near it:
solvers are about as far apart."""
_STEPS = 10
"""Most steps of Newton's method."""


def switched(family: Family, bifurcation: Place, sign: int = 1) -> Place | None:
    """A motion of the branch that springs from a bifurcation, near it.

    Parameters
    ----------
    family : Family
        The period maps.
    bifurcation : Place
        The motion at which a multiplier is -1.
    sign : int
        1 or -1: which way along the vector to look.  Both lead to one branch, but beside a graze, which the motion
        comes to sooner on one of them, Newton's method may find it on the other alone.

    Returns
    -------
    Place, or None
        Of twice as many half periods; its tangent points away from the bifurcation.  None if none is found.
    """
    _, vector = crosses_minus_one(bifurcation)
    direction = vector * bifurcation.weights
    direction = sign * direction / np.linalg.norm(direction)
    for length in _LENGTHS:
        with suppress(SolverError, InputError, np.linalg.LinAlgError):
            found = _beside(family, bifurcation, direction, length)
            if found is not None:
                return found.along(found.chord(family, bifurcation))
    return None


def repeated_near(family: Family, near: Place) -> Place | None:
    """The motion that repeats in half the time of one that almost does.

    It is, almost, half way between that and what that is after half of its period.

    Parameters
    ----------
    family : Family
        The period maps.
    near : Place
        The motion, by this solver or another self of it.

    Returns
    -------
    Place, or None
        Of half as many half periods; None if it is not found.
    """
    if near.missed is None or float(np.linalg.norm(near.missed)) > _NEARLY:
        return None
    half = near.half_periods
    middle = half.map.moved(near.point, near.missed / near.weights / 2)
    return corrected(family, near.value, family.adopted(near.value, middle), near.count // 2)


def sprung_from(family: Family, near: Place) -> Place | None:
    """The bifurcation near a motion from which its branch springs.

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
    middle = repeated_near(family, near)
    found = None if middle is None else smooth_finder(flip_of(middle))(family, middle)
    return None if found is None else found.place


def springs_beside(family: Family, mother: Place) -> Iterator[Place]:
    """Bifurcations at which other branches spring from one near a motion of it.

    Parameters
    ----------
    family : Family
        The period maps.
    mother : Place
        The motion.

    Yields
    ------
    Place
        The motion at each of them.
    """
    for side in (mother, mother.turned()):
        for _, a, b in follow(family, side, Limits(most=_MOST, length=_BESIDE)).smooth_parts:
            criterion = criteria_of(a)[flip_of(a)]
            found = located(family, a, b, criterion) if criterion.changes(a, b) else None
            if found is not None:
                yield found


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


def _beside(family: Family, bifurcation: Place, direction: FloatArray, length: float) -> Place | None:
    """The motion of twice the half periods that is off by twice a length, along a direction, after half of them."""
    value, point = bifurcation.moved(family, length * np.append(direction, 0.0))
    residual, closed = np.inf, None
    for i in range(_STEPS):
        half, scale = family.at(value), family.scale(value)
        once, found = (family.linearised(value, point, n * bifurcation.count) for n in (1, 2))
        r = half.map.difference(found.end, point)
        left = half.relative(r, point)
        if r.size != direction.size or left > max(0.5 * residual, 1e-2 if i < 3 else 0.0):
            return closed
        residual, weights = left, scaling(half, point, r.size)
        off = -2 * length - float(direction @ (half.map.difference(once.end, point) * weights))
        K, J = (jacobian(one.matrix, family.column(value, one) * scale, weights) for one in (once, found))
        step = np.linalg.solve(np.vstack([J, direction @ K]), np.append(-weights * r, off))
        if residual <= RESIDUAL:
            closed = place_from(value, point, residual, found, J, weights)
            if settled(step, weights * r):
                return closed
        point = half.map.moved(point, step[:-1] / weights)
        value += float(step[-1]) * scale
        point = family.adopted(value, point)
    return closed
