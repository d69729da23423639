r"""The motion of a curve at which a function of it vanishes, by Newton's method.

With the section point x and the number p as unknowns,

    P(x, p) - x = 0,        g(x, p) = 0

is solved: to `corrected`'s shortest way back to the curve, each step adds what is left to where g vanishes along the
tangent, -g / g'.  The change g' of g with the arc length comes from two motions, as in the method of secants.  So a
motion is not brought to the curve at each of the places that secants would try.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, jacobian, scaling, settled, shortest, tangent_and_step
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.newton import RESIDUAL, Orbit
from lapjoint.problem import FloatArray

LOCATED = 1e-9
"""Length of a step along the curve at which the motion is found; or value of what vanishes, twice in turn, where that
hardly changes."""
_STEPS = 15
"""Most steps: five are enough where a multiplier is smooth; beside a graze it changes as a square root."""
_FAR = 0.5
"""Largest residual of the first guess over the size of the motion."""
_SLOWEST = 0.7
"""Least share of the residual that a step must take off, or:"""
_ASIDE = 0.5
"""Largest residual over the length of the step that led there: a step along a curve that turns leads away from it."""
_REACH = 1e-2
"""Arc length within which the motion is looked for."""
_TRIED = (1e-5, 1e-7)
"""Arc lengths of a step to find out how fast g changes, in turn: most bifurcations of two solvers are about as far
apart as the first; a hairpin beside a graze may be shorter."""
_GROWS = 30.0
"""By how much a step along the curve is longer than the one at which g' was found, at most."""
_OFF = 0.1
"""Distance from the curve over the length of a step along it up to which the change of g is due to that length."""


class Critical(NamedTuple):
    """A motion at which something vanishes."""

    place: Place
    """The motion."""
    rate: float | None
    """Change of what vanishes with the arc length along the tangent of `place`; None if it is not known."""


def critical_motion(
    family: Family,
    value: float,
    guess: SectionPoint,
    count: int,
    vanishes: Callable[[Place], float],
    like: Critical | None = None,
) -> Critical | None:
    """The motion near a guess at which something vanishes.

    Parameters
    ----------
    family : Family
        The period maps.
    value : float
        The number at the guess, in its SI unit.
    guess : SectionPoint
        On the map there.
    count : int
        Number of half periods; an odd number for a symmetric motion.
    vanishes : callable
        Takes a place, which need not close; gives a number that changes its sign with the direction of the place's
        tangent, or does not depend on it.
    like : Critical, optional
        A motion near it, be it of another solver, and how fast the number changes there.

    Returns
    -------
    Critical, or None
        None if Newton's method finds none within `_REACH`.
    """
    for tried in _TRIED if like is None or like.rate is None else (0.0,):
        try:
            found = _Search(family, count, vanishes, tried).run(value, guess, like)
        except (SolverError, InputError, np.linalg.LinAlgError):  # a step led out of what can be marched
            found = None
        if found is not None:
            return found
    return None


def change_beside(family: Family, place: Place, vanishes: Callable[[Place], float]) -> Critical | None:
    """How fast something changes along the curve at a place, by one march beside it.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        The place.
    vanishes : callable
        As `critical_motion` has it.

    Returns
    -------
    Critical, or None
        The place with the rate; None if what is beside it cannot be marched.
    """
    step = _TRIED[0] if family.covers(place.moved(family, _TRIED[0] * place.tangent)[0]) else -_TRIED[0]
    try:
        seen = _Search(family, place.count, vanishes, step).seen(*place.moved(family, step * place.tangent), _FAR)
    except (SolverError, InputError, np.linalg.LinAlgError):
        return None
    if seen is None or float(np.linalg.norm(seen[1])) > _OFF * abs(step):
        return None
    return Critical(place, (vanishes(_going_on(seen[0], place)) - vanishes(place)) / step)


class _Search:
    """Newton's method for a motion at which something vanishes."""

    def __init__(self, family: Family, count: int, vanishes: Callable[[Place], float], tried: float) -> None:
        self._family, self._count, self._vanishes, self._tried = family, count, vanishes, tried
        self._column = np.zeros(0)

    def run(self, value: float, point: SectionPoint, like: Critical | None) -> Critical | None:
        """Find it from a guess, and what is known of a motion near it."""
        rate, longest, allowed, way = (None, _REACH, _FAR, 0.0) if like is None else (like.rate, _REACH, _FAR, 0.0)
        before: tuple[Place, float, float] | None = None  # the last guess, g there, and the step along the curve
        was_off = np.inf
        for _ in range(_STEPS):
            seen = self.seen(value, point, allowed)
            if seen is None:
                return None
            here, back, left = seen
            if before is not None:
                here = _going_on(here, before[0])
            elif like is not None and rate is not None:
                here = here.going_on_from(like.place)
            g = self._vanishes(here)
            off = float(np.linalg.norm(back))
            if before is not None and max(off, was_off) <= _OFF * abs(before[2]):
                rate, longest = (g - before[1]) / before[2], _GROWS * abs(before[2])
            closes = here.orbit.residual <= RESIDUAL and settled(back, left)
            if closes and abs(g) <= LOCATED and (g == 0.0 or (before is not None and abs(before[1]) <= LOCATED)):
                return Critical(here, rate)
            along = self._along(g, rate, longest, off)
            if along is None or abs(way := way + along) > _REACH:
                return None
            if closes and rate is not None and abs(along) <= LOCATED:
                return Critical(here, rate)
            step = back + along * here.tangent
            value, point = here.moved(self._family, step)
            if not self._family.covers(value):
                return None
            allowed = max(_SLOWEST * here.orbit.residual, _ASIDE * float(np.linalg.norm(step)), 10 * RESIDUAL)
            before, was_off = (here, g, along), off
        return None

    def _along(self, g: float, rate: float | None, longest: float, off: float) -> float | None:
        """The next step along the curve from so far beside it; None if g does not change there."""
        if rate is None:
            return self._tried if off <= _OFF * self._tried else 0.0
        return float(np.clip(-g / rate, -longest, longest)) if rate and np.isfinite(rate) else None

    def seen(self, value: float, point: SectionPoint, allowed: float) -> tuple[Place, FloatArray, FloatArray] | None:
        """The place of a guess, the shortest way from it to the curve, and what it misses, both scaled."""
        found = self._family.linearised(value, point, self._count)
        half = found.half_periods
        r = half.map.difference(found.end, point)
        residual = half.relative(r, point)
        if not residual <= allowed:
            return None
        weights = scaling(half, point, r.size)
        if found.by_number is not None or self._column.size != r.size or residual <= RESIDUAL:
            self._column = self._family.column(value, found)
        J = jacobian(found.matrix, self._column * self._family.scale(value), weights)
        tangent, step = tangent_and_step(J, -weights * r)
        here = Place(value, Orbit(self._count, point, residual, found), weights, tangent, half)
        return here, shortest(step, tangent), weights * r


def _going_on(here: Place, before: Place) -> Place:
    """A place with its tangent in the direction of one just beside it."""
    same = here.point.state == before.point.state and here.weights.shape == before.weights.shape
    return here.along(before.tangent) if same else here.going_on_from(before)
