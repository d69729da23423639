r"""The motion of a curve at which a function of it vanishes, by Newton's method.

With the section point x and the number p as unknowns,

    P(x, p) - x = 0,        g(x, p) = 0

is solved: to `corrected`'s shortest way back to the curve, each step adds what is left to where g vanishes along the
tangent, -g / g'.  The change g' of g with the arc length comes from two motions, as in the method of secants.  So a
motion is not brought to the curve at each of the places that secants would try.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, scaling, settled
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.newton_steps import jacobian, shortest, tangent_and_step
from lapjoint.orbits.newton import RESIDUAL, Orbit
from lapjoint.problem import FloatArray

_LOCATED = 1e-9
"""Length of a step along the curve at which the motion is found."""
_STEPS = 15
"""Most steps: five are enough where a multiplier is smooth; beside a graze it changes as a square root."""
_FAR = 0.5
"""Largest residual of a guess over the size of the motion: multipliers of 1e4 make it large just beside the curve."""
_SLOWEST = 0.7
"""Least share of the distance from the curve that a step must take off, or:"""
_ASIDE = 0.5
"""Largest distance from the curve over the length of the step that led there: where it turns, a step leads off it."""
_REACH = 1e-2
"""Arc length within which the motion is looked for."""
_TOLD, _ROUNDED = 1e-8, 1e-7
"""Length of a step along the curve from which on the change of g tells how fast it changes, and up to which a step that
does not bring g nearer to zero shows that rounding is all that is left of it: beside a fold, that is 1e-8."""
_TRIED = (1e-5, 1e-7)
"""Arc lengths of a step to find out how fast g changes, in turn: most bifurcations of two solvers are about as far
apart as the first; a hairpin beside a graze may be shorter."""
_GROWS = 30.0
"""By how much a step along the curve is longer than the one at which g' was found, at most."""
_BESIDE = 0.5
"""Distance from the curve over the next step along it from which on a step leads to the curve alone."""
_OFF = 0.1
"""Distance from the curve over the length of a step along it up to which the change of g is due to that length."""


class Critical(NamedTuple):
    """A motion at which something vanishes."""

    place: Place
    """The motion."""
    rate: float | None
    """Change of what vanishes with the arc length along the tangent of `place`; None if it is not known."""
    left: float = 0.0
    """Arc length that may be left of the way there, where rounding lets no step come nearer."""


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
        there = _Search(family, place.count, vanishes, step).seen(*place.moved(family, step * place.tangent), place)
    except (SolverError, InputError, np.linalg.LinAlgError):
        return None
    if there is None or there.off > _OFF * abs(step):
        return None
    return Critical(place, (there.g - vanishes(place)) / step)


class Ahead(NamedTuple):
    """Where a step leads."""

    value: float
    """The number, in its SI unit."""
    point: SectionPoint
    """The section point, on the map there."""


def one_step(family: Family, at: Critical, vanishes: Callable[[Place], float]) -> Ahead | None:
    """About where a solver has a motion that another one has: by one march, and one step of Newton's method.

    It misses by some share of the way between both motions, be it along the curve or off it.

    Parameters
    ----------
    family : Family
        The period maps of the solver, which can adopt motions of the other.
    at : Critical
        The motion by the other, and how fast what vanishes there changes.
    vanishes : callable
        As `critical_motion` has it.

    Returns
    -------
    Ahead, or None
        None if the motion from there has other contacts, or cannot be marched, or the rate is not known.
    """
    place = at.place
    if not at.rate:
        return None
    try:
        guess = family.adopted(place.value, place.point)
        here = _Search(family, place.count, vanishes, 0.0).seen(place.value, guess, place)
        if here is None or here.place.closings != place.closings:
            return None
        return Ahead(*here.place.moved(family, here.back - here.g / at.rate * here.place.tangent))
    except (SolverError, InputError, np.linalg.LinAlgError):  # the step leads out of what can be marched
        return None


class _Guess(NamedTuple):
    """A guess of Newton's method."""

    place: Place
    """The motion, which need not close."""
    g: float
    """What is to vanish."""
    back: FloatArray
    """The shortest way to the curve (u, w), scaled, shape ``(n + 1,)``."""
    closes: bool
    """Whether the motion closes."""

    @property
    def off(self) -> float:
        """Distance from the curve."""
        return float(np.linalg.norm(self.back))


class _Search:
    """Newton's method for a motion at which something vanishes."""

    def __init__(self, family: Family, count: int, vanishes: Callable[[Place], float], tried: float) -> None:
        self._family, self._count, self._vanishes, self._tried = family, count, vanishes, tried
        self._column = np.zeros(0)
        self._rate: float | None = None
        self._longest = _REACH

    def run(self, value: float, point: SectionPoint, like: Critical | None) -> Critical | None:
        """Find it from a guess, and what is known of a motion near it."""
        self._rate = None if like is None else like.rate
        before: _Guess | None = None
        came = gone = aimed = 0.0  # steps along the curve: the last one, all together, and the last one by a rate
        for _ in range(_STEPS):
            now = self.seen(value, point, before.place if before else None if like is None else like.place)
            if now is None:
                return None
            if before is not None:
                if now.off > max(_SLOWEST * before.off, _ASIDE * math.hypot(before.off, came), _LOCATED):
                    return None
                self._learn(before, now, came)
            known = self._rate is not None
            along = self._along(now)
            if along is None:
                return None
            if now.closes and known and abs(along) <= _LOCATED:
                return Critical(now.place, self._rate)
            if before is not None and self._stays(before, now, aimed, along):
                return Critical(now.place, self._rate, abs(along))
            if before is not None and now.off > max(_BESIDE * abs(along), _LOCATED):
                along = 0.0
            gone += along
            value, point = now.place.moved(self._family, now.back + along * now.place.tangent)
            if abs(gone) > _REACH or not self._family.covers(value):
                return None
            before, came, aimed = now, along, along if known else 0.0
        return None

    def _stays(self, before: _Guess, now: _Guess, aimed: float, along: float) -> bool:
        """Whether a guess is as near as rounding lets it come: the last step did not bring g nearer to zero."""
        short = 0 < abs(aimed) <= _ROUNDED and abs(along) <= _ROUNDED
        return now.closes and short and abs(now.g) >= _SLOWEST * abs(before.g)

    def _learn(self, before: _Guess, now: _Guess, came: float) -> None:
        """Learn how fast g changes from the step that led from one guess to the next, if both are on the curve."""
        if abs(came) >= _TOLD and max(before.off, now.off) <= _OFF * abs(came):
            self._rate, self._longest = (now.g - before.g) / came, _GROWS * abs(came)

    def _along(self, now: _Guess) -> float | None:
        """The next step along the curve; None if g does not change there."""
        rate, longest = self._rate, self._longest
        if rate is None:
            return self._tried if now.off <= _OFF * self._tried else 0.0
        return float(np.clip(-now.g / rate, -longest, longest)) if rate and np.isfinite(rate) else None

    def seen(self, value: float, point: SectionPoint, near: Place | None) -> _Guess | None:
        """A guess, with its tangent in the direction of a place near it; None if it is far from closing."""
        found = self._family.linearised(value, point, self._count)
        half = found.half_periods
        r = half.map.difference(found.end, point)
        residual = half.relative(r, point)
        if not residual <= _FAR:
            return None
        weights = scaling(half, point, r.size)
        if found.by_number is not None or self._column.size != r.size or residual <= RESIDUAL:
            self._column = self._family.column(value, found)
        J = jacobian(found.matrix, self._column * self._family.scale(value), weights)
        tangent, step = tangent_and_step(J, -weights * r)
        here = Place(value, Orbit(self._count, point, residual, found), weights, tangent, half)
        if near is not None:
            here = _going_on(here, near)
        back = shortest(step, tangent)
        return _Guess(here, self._vanishes(here), back, residual <= RESIDUAL and settled(back, weights * r))


def _going_on(here: Place, near: Place) -> Place:
    """A place with its tangent in the direction of one near it."""
    same = here.point.state == near.point.state and here.weights.shape == near.weights.shape
    return here.along(near.tangent) if same else here.going_on_from(near)
