r"""The motion of a curve whose extremum of a gap function has a given value, by Newton's method.

With the section point x and the number p as unknowns,

    P(x, p) - x = 0,        h*(x, p) = target

is solved.  As the target holds the penetration fixed, the derivative hardly changes in a step of Newton's method, on
either side of a graze, where h* = 0.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, place_from, scaling
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum, derivatives_of, same_extremum
from lapjoint.orbits.branches.newton_steps import jacobian
from lapjoint.orbits.half_periods import HalfPeriods, Return
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.orbits.refinement import SAFETY
from lapjoint.problem import FloatArray

_STEPS = 12
"""Most steps of Newton's method, and of halves of them."""
_HALVINGS = 1
"""How often a step is made shorter that leads past the graze, or away: what is not found so is looked for again from
the next place of the curve."""
_STEP = 1e-8
"""Step of the differences over the scale of the number: nearer than any graze that is looked for."""
_FAR = 0.5
"""Largest residual of a guess over the size of the motion."""
_WORSE = 2.0
"""Most by which a step may make the residual worse: beyond a graze the map has another derivative."""
_QUICK = 0.1
"""Share of its misses that Newton's method has left after a step so good that derivatives by the number may stay."""
_ALLOWED = 1e-3
"""Residual over the size of the motion up to which a guess is near enough."""
_CLOSE_ENOUGH = 2e-5
"""Arc length to a graze, as the extremum's rate has it, at which it counts as located if no nearer motion is found."""
_ON_TARGET = 0.5
"""Distance from the target over the target within which Newton's method ends."""
_LEFT = 0.1
"""Share of the way to a graze that is left by the first step of Newton's method towards it."""
_AMISS = 3.0
"""Way that a step leaves, over the way by which it is expected to miss: by the last step's miss, with its square."""
_SMOOTH = 3.0
"""Largest ratio of what a step misses by and its length, from which the next one's miss can be expected: beyond it, the
extremum is another one."""
_HELD = 0.5
"""Residual over the way to a graze from which on the extremum is held until the motion closes: where damping forces
jump with the state, the map changes as the root of the penetration, and a step towards the graze leaves a residual."""
_SHARES = (1.0, 0.5, 0.25, 0.1)
"""Shares of a step of Newton's method that are tried in turn where the map changes as a root on its way."""
_PATIENT = 40
"""Most steps there, and shares of them: twelve steps are enough in most cases."""
_JUMP = 0.2
"""Residual over the size of the motion up to which a guess across a graze is near enough there: some 0.1 sqrt(s / 1e-3)
at a distance s, where contacts are lightly damped and motions unstable."""


@dataclass(frozen=True)
class OnExtremum:
    """A motion whose extremum has a given value."""

    place: Place
    """The motion."""
    extremum: Extremum
    """Its extremum."""
    rate: float
    """Derivative of the number along the curve by the extremum's value, SI unit over m."""
    close: bool = True
    """Whether it is as near to its target as is aimed at."""
    bent: float = 0.0
    """By how much the tangent misses the way to the graze, over that way, on the smooth side."""

    @property
    def value(self) -> float:
        """The number at the graze, along the tangent, in its SI unit."""
        return float(self.place.value - self.rate * self.extremum.value)

    @property
    def touched(self) -> bool:
        """Whether it has the contact that comes at the graze, or the gap that splits one there."""
        return (self.extremum.value > 0) == self.extremum.highest

    @property
    def closings_of_sides(self) -> tuple[tuple[int, ...], tuple[int, ...]]:
        """How often each stop closes on either side of the graze: as here, and with one contact more or less."""
        here, stop = self.place.closings, self.extremum.stop
        there = here[stop] + (-1 if self.touched else 1)
        return here, (*here[:stop], there, *here[stop + 1 :])

    @property
    def left(self) -> float:
        """What may be left of the way to there, in the same unit: as much as the way, or a share on the smooth side."""
        share = 1.0 if self.touched else self.bent
        return SAFETY * abs(self.rate * self.extremum.value) * share


def on_extremum(
    family: Family,
    place: Place,
    extremum: Extremum,
    target: float,
    scale: float,
    *,
    towards: bool = False,
    patiently: bool = False,
) -> OnExtremum | None:
    """The motion near a place whose extremum has about a given value.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        Where Newton's method begins.
    extremum : Extremum
        Its extremum.
    target : float
        The value, m.
    scale : float
        Change of the value with the arc length, m, above zero.
    towards : bool
        Whether the target lies just before a graze, which no step is to cross.
    patiently : bool
        Whether the target lies beyond a graze where the map changes as a root, so that the first guess misses by far.

    Returns
    -------
    OnExtremum, or None
        None if Newton's method finds none.
    """
    try:
        return (_Patient if patiently else _Search)(family, place, target, scale, towards).run(extremum)
    except (SolverError, InputError, np.linalg.LinAlgError):
        return None


@dataclass(frozen=True)
class _Guess:
    """A guess of Newton's method, and how far it is from a motion whose extremum has the value."""

    value: float
    """The number, in its SI unit."""
    point: SectionPoint
    """Where it begins."""
    found: Return
    """The march from there."""
    r: FloatArray
    """By how much it does not close, shape ``(n,)``."""
    residual: float
    """The same over the size of the motion."""
    extremum: Extremum
    """Its extremum."""

    @property
    def half_periods(self) -> HalfPeriods:
        """The map there."""
        return self.found.half_periods

    @cached_property
    def weights(self) -> FloatArray:
        """`scaling` there, shape ``(n,)``."""
        return scaling(self.half_periods, self.point, self.r.size)

    @property
    def duration(self) -> float:
        """Length of the march, s."""
        return self.found.count * self.half_periods.map.period / 2


class _Search:
    """Newton's method for a motion whose extremum has a given value."""

    def __init__(self, family: Family, place: Place, target: float, scale: float, towards: bool) -> None:
        self._family, self._place, self._target, self._scale = family, place, target, scale
        self._towards = towards
        self._column, self._slope = np.zeros(0), 0.0
        self._tries, self._miss = 0, np.inf
        self._bend: float | None = None
        self._first: tuple[float, float] | None = None

    def run(self, extremum: Extremum) -> OnExtremum | None:
        """Find it from the extremum of the place where it begins."""
        place, near = self._place, None
        r = place.half_periods.map.difference(place.orbit.last.end, place.point)
        good = _Guess(place.value, place.point, place.orbit.last, r, place.orbit.residual, extremum)
        while True:
            on_target = abs(good.extremum.value - self._target) <= _ON_TARGET * abs(self._target)
            on_target &= good.residual <= RESIDUAL
            J, bordered = self._bordered(good, on_target)
            if self._towards and self._first is None:
                self._first = good.extremum.value, float(np.linalg.norm(self._along(good, bordered)))
            if on_target:
                return self._found(good, J, bordered)
            if self._tries and self._way(good) <= _CLOSE_ENOUGH and self._towards and good.residual <= RESIDUAL:
                near = replace(self._found(good, J, bordered), close=False)
            better = self._stepped(good, bordered)
            if better is None:
                return near
            good = better

    def _way(self, one: _Guess) -> float:
        """Arc length to the graze, as the extremum's rate has it."""
        return abs(one.extremum.value) / self._scale

    def _aim(self, good: _Guess) -> float:
        """The value that the next step is for: the target, or as near to it as no step is expected to miss it by."""
        way, end = self._way(good), abs(self._target) / self._scale
        if not self._towards or way <= end:
            return self._target
        if good.residual > _HELD * way:
            return good.extremum.value
        left = _LEFT * way
        if self._bend is not None:  # the root of left = bend (way - left)^2
            left = way - 2 * way / (1 + math.sqrt(1 + 4 * self._bend * way))
        return math.copysign(max(left, end) * self._scale, self._target)

    def _stepped(self, good: _Guess, bordered: FloatArray) -> _Guess | None:
        """The guess after a step; after a shorter one where that leads too far, or is not better."""
        share = 1.0
        for _ in range(_HALVINGS + 1):
            misses = (self._aim(good) - good.extremum.value) / self._scale
            step = np.asarray(share * np.linalg.solve(bordered, np.append(-good.weights * good.r, misses)))
            self._tries += 1
            if self._tries > _STEPS or not float(np.linalg.norm(step)) < 1.0:
                return None
            now = self._guess(good, step)
            learned = now is not None and self._learns(share * misses, now.extremum.value - good.extremum.value)
            if now is not None and self._is_better(now, good):
                return now
            if not (learned and self._towards):  # else the aim is another one
                share *= 0.5
        return None

    def _guess(self, good: _Guess, step: FloatArray) -> _Guess | None:
        """The guess some way from another, scaled, shape ``(n + 1,)``; None if it has no extremum like that."""
        point = good.half_periods.map.moved(good.point, step[:-1] / good.weights)
        value = good.value + float(step[-1]) * self._family.scale(good.value)
        return _tried(self._family, value, self._family.adopted(value, point), self._place.count, good)

    def _learns(self, meant: float, gone: float) -> bool:
        """Learn how the extremum's way bends from a step towards it and the change of its value; whether that tells."""
        amiss = abs(gone / self._scale - meant)
        if not 0 < amiss <= _SMOOTH * abs(meant):
            return False
        self._bend = _AMISS * amiss / meant**2
        return True

    def _is_better(self, now: _Guess, good: _Guess) -> bool:
        """Whether a guess is as near to a motion as Newton's method must come, and has not crossed the graze back."""
        if (good.extremum.value > 0) == (self._target > 0) != (now.extremum.value > 0):
            return False
        return now.residual <= min(_FAR, max(_WORSE * good.residual, _ALLOWED))

    def _bordered(self, now: _Guess, last: bool) -> tuple[FloatArray, FloatArray]:
        """`jacobian`, and the same with the derivatives of the extremum over the scale, shape ``(n + 1, n + 1)``."""
        found, scale = now.found, self._family.scale(now.value)
        row, slope = derivatives_of(found, now.extremum)
        miss = math.hypot(now.residual, self._way(now))
        if found.by_number is not None and slope is not None:
            self._column, self._slope = found.by_number, slope
        elif last or miss > _QUICK * self._miss or self._column.size != now.r.size:
            self._column, self._slope = by_difference(self._family, now.value, found, now.extremum)
        self._miss = miss
        J = jacobian(found.matrix, self._column * scale, now.weights)
        bordered = np.empty((row.size + 1, row.size + 1))
        bordered[:-1], bordered[-1, :-1] = J, row / now.weights / self._scale
        bordered[-1, -1] = self._slope * scale / self._scale
        return J, bordered

    def _found(self, now: _Guess, J: FloatArray, bordered: FloatArray) -> OnExtremum:
        """The motion of a guess that closes."""
        along = self._along(now, bordered)
        rate = float(along[-1]) * self._family.scale(now.value)
        place = place_from(now.value, now.point, now.residual, now.found, J, now.weights)
        return OnExtremum(place, now.extremum, rate, bent=self._bent(now, float(np.linalg.norm(along))))

    def _along(self, now: _Guess, bordered: FloatArray) -> FloatArray:
        """How a motion of the curve changes with the extremum's value, scaled, per m, shape ``(n + 1,)``."""
        return np.asarray(np.linalg.solve(bordered, np.append(np.zeros(now.r.size), 1 / self._scale)))

    def _bent(self, now: _Guess, length: float) -> float:
        """By how much the tangent misses the way to the graze, over that way, given the arc length per m.

        With the value as h + h' s + c s^2, its rates here and where the search began give c; the value need not vanish.
        """
        here = now.extremum.value
        if self._first is None or abs(self._first[0]) <= abs(here):
            return 0.0
        there, before = self._first
        root = 1 - here / (there - here) * ((length / before) ** 2 - 1)
        return abs(2 / (1 + math.sqrt(root)) - 1) if root > 0 else math.inf


class _Patient(_Search):
    """The same from the other side of a graze at which the map changes as a root.

    The first guess, at which the extremum has the value, misses the motion by what that root makes of the way to there.
    From then on each step must come nearer to both at once; shorter ones are tried until one does.
    """

    def _stepped(self, good: _Guess, bordered: FloatArray) -> _Guess | None:
        misses = (self._target - good.extremum.value) / self._scale
        whole = np.linalg.solve(bordered, np.append(-good.weights * good.r, misses))
        crossed = self._tries > 0
        for share in _SHARES:
            self._tries += 1
            step = share * whole
            if self._tries > _PATIENT or not float(np.linalg.norm(step)) < 1.0:
                continue
            now = self._guess(good, step)
            if now is not None and (self._amiss(now) < self._amiss(good) if crossed else now.residual <= _JUMP):
                return now
        return None

    def _amiss(self, one: _Guess) -> float:
        """How far a guess is from a motion whose extremum has the value, over the size of the motion."""
        return math.hypot(one.residual, (one.extremum.value - self._target) / self._scale)


def _tried(family: Family, value: float, point: SectionPoint, count: int, last: _Guess) -> _Guess | None:
    """A guess; None if it has no extremum like that of the last one."""
    found = family.linearised(value, point, count)
    now = same_extremum(found, last.extremum, last.duration)
    r = found.half_periods.map.difference(found.end, point)
    residual = found.half_periods.relative(r, point)
    if now is None or not (np.isfinite(residual) and np.isfinite(now.value)):
        return None
    return _Guess(value, point, found, r, residual, now)


def by_difference(family: Family, value: float, found: Return, extremum: Extremum) -> tuple[FloatArray, float]:
    """Derivatives of the end of a march and of an extremum by the number, while the start stays where it is.

    Parameters
    ----------
    family : Family
        The period maps.
    value : float
        The number, in its SI unit.
    found : Return
        The march.
    extremum : Extremum
        One of its extrema.

    Returns
    -------
    FloatArray, shape (n,)
        Of the end, in the coordinates that belong to the start, over the unit of the number.
    float
        Of the extremum's value, m over that unit.

    Raises
    ------
    SolverError
        If the march beside it cannot go on.
    """
    map_, duration = found.half_periods.map, found.count * found.half_periods.map.period / 2
    end = map_.difference(found.end, found.start)
    column, slope = np.zeros(end.size), 0.0
    for other in family.beside(value, _STEP):
        beside = family.at(other)
        there = beside.linearised(beside.map.adopted(found.start), found.count)
        match = same_extremum(there, extremum, duration)
        column = (map_.difference(map_.adopted(there.end), found.start) - end) / (other - value)
        slope = 0.0 if match is None else (match.value - extremum.value) / (other - value)
        if match is not None and (match.value > 0) == (extremum.value > 0):
            break  # else the graze lies between the two
    return column, slope
