r"""Across a graze, where the sequence of contacts changes and the map is not smooth.

An extremum h* of a stop's gap function passes zero there.  On one side of a graze the map is smooth; on the other,
where the stop is touched, its derivative may grow without bound (as 1 / sqrt(h*) where the damping forces jump with the
state).  So the curve is not stepped across: with the section point x and the number p as unknowns,

    P(x, p) - x = 0,        h*(x, p) = target

is solved for targets ever nearer to zero, from the side where the curve comes from, and then for one beyond.  As the
target holds the penetration fixed, the derivative hardly changes in a step of Newton's method, on either side.

The number at the graze is p - (dp/dh*) h* from the nearest motion.  On the smooth side that leaves the square of the
arc length.  On the other p - p* goes as a power q < 1 of h*, and (1/q - 1) times what is taken off is left, as much
again where q = 1/2; every solver leaves about the same, so that no refinement shows it.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, jacobian, place_from, scaling
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum, derivatives_of, same_extremum, turning_points
from lapjoint.orbits.branches.passings import Coming
from lapjoint.orbits.half_periods import HalfPeriods, Return, gives
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.orbits.period_map import Tangent
from lapjoint.orbits.refinement import SAFETY
from lapjoint.orbits.segments import Segment, Segments
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
_CLOSE = 1e-6
"""Arc length to the graze, as the extremum's rate has it, at which it counts as located; the rest is taken off along
the tangent, and leaves the square of this.  Light contacts of a stiff stop are far less deep than its gap is wide, and
so no length of the problem is what an extremum can be compared with."""
_CLOSE_ENOUGH = 2e-5
"""The same where no motion nearer to the graze is found."""
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
_BEYOND = (3e-5, 3e-6, 1e-4, 1e-3)
"""Distances beyond a graze, as such arc lengths, at which the curve is looked for."""
_BEYOND_ROOT = (3e-5, 1e-5, 3e-6, 1e-4, 3e-4, 1e-3, 1e-6, 1e-7)
"""The same where the map changes as a root: other grazes may lie beside this one, or the curve go far away at once."""
_SLOW = 1e-3
"""Arc length within which a switch is about to vanish, as the rate of its turning point has it: half of what is left,
as that goes as the square."""
_JUST_BEYOND = 1e-5
"""The same at which it is seen whether a motion comes back."""
_SAME, _LEFT_AT_MOST = 2e-4, 10.0
"""Arc length between the motions on both sides of a graze, and distance of its numbers as both have it over what the
one may leave: where both are larger, it is a neighbour.  Of 93, most have 1e-5 and 0.2; two neighbours had 7e-4 at
least, and 140."""
_NEAR = 0.05
"""Arc length from the graze within which the motion beyond it must lie."""


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

    @property
    def value(self) -> float:
        """The number at the graze, along the tangent, in its SI unit."""
        return float(self.place.value - self.rate * self.extremum.value)

    @property
    def left(self) -> float:
        """What may be left of the way to there, in the same unit: nothing on the smooth side of the graze."""
        touched = (self.extremum.value > 0) == self.extremum.highest
        return SAFETY * abs(self.rate * self.extremum.value) if touched else 0.0


def sharper(family: Family, graze: OnExtremum, beyond: OnExtremum | None, rate: float) -> OnExtremum:
    """The motion from which the number at a graze is best known: on its other side, if that is the smooth one.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.
    beyond : OnExtremum or None
        A motion beyond it, if there is one.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    OnExtremum
        The motion before it, unless that leaves something, and there is one of the same graze that leaves less.
    """
    if beyond is None or graze.left == 0.0:
        return graze
    other = located_graze(family, beyond.place, beyond.extremum, rate)
    if other is None or other.left >= graze.left:
        return graze
    way = float(np.linalg.norm(other.place.chord(family, graze.place)))
    return other if way <= _SAME or abs(other.value - graze.value) <= _LEFT_AT_MOST * graze.left else graze


def located_graze(family: Family, place: Place, extremum: Extremum, rate: float) -> OnExtremum | None:
    """The motion just before a graze, on the side of a place.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        A motion near the graze.
    extremum : Extremum
        Its extremum that vanishes there.
    rate : float
        Change of its value with the arc length, m.

    Returns
    -------
    OnExtremum, or None
        Within `_CLOSE` of the graze, or else within `_CLOSE_ENOUGH`; None if Newton's method does not lead there.
    """
    scale = abs(rate)
    end = float(np.copysign(_CLOSE * scale, extremum.value))
    if abs(extremum.value) <= abs(end):
        end = extremum.value
    found = on_extremum(family, place, extremum, end, scale, towards=True)
    return found if found is not None and found.place.extrema.closings == place.extrema.closings else None


def beyond_graze(family: Family, graze: OnExtremum, rate: float) -> OnExtremum | None:
    """The motion on the other side of a graze, a little beyond it.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    OnExtremum, or None
        None if Newton's method finds none: the branch ends at the graze.
    """

    def found(share: float, patiently: bool) -> OnExtremum | None:
        target = -float(np.copysign(share * abs(rate), graze.extremum.value))
        there = on_extremum(family, graze.place, graze.extremum, target, abs(rate), patiently=patiently)
        if there is None or float(np.linalg.norm(there.place.chord(family, graze.place))) > _NEAR:
            return None
        changed = np.abs(np.subtract(there.place.extrema.closings, graze.place.extrema.closings)).sum()
        return there if changed == 1 or (changed and not patiently) else None

    if graze.extremum.segment is not None and leaves_at(family, graze, rate):
        return None
    there = next((one for share in _BEYOND if (one := found(share, False))), None)
    if there is None and graze.close:
        there = next((one for share in _BEYOND_ROOT if (one := found(share, True))), None)
    return there


def slow_switch(family: Family, place: Place) -> Coming | None:
    """The graze at which the next switch of a motion vanishes, because the motion comes to it ever more slowly.

    Beyond that switch it need not turn, see `same_turning_point`; so no extremum of the motion itself shows this graze.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        A motion near the graze, with its tangent towards it.

    Returns
    -------
    Coming, or None
        With the turning point just beyond the switch; None if there is none within `_SLOW`, or the solver does not give
        its motions in closed form.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    found = place.orbit.last
    if not gives(place.half_periods.map, Tangent) or not place.half_periods.map.problem.stops:
        return None
    there = list[Coming]()
    for one in turning_points(found):
        row, slope = derivatives_of(place.half_periods, found.linearised.segments, one)
        if slope is None:
            r = place.half_periods.map.difference(found.end, place.point)
            own = _Try(place.value, place.point, found, r, place.orbit.residual, one)
            slope = _by_number(family, own, place.count)[1]
        rate = float(np.append(row / place.weights, slope * family.scale(place.value)) @ place.tangent)
        if rate * one.value < 0 and abs(one.value) <= _SLOW * abs(rate):
            there.append(Coming(one, rate))
    return min(there, key=lambda one: one.length) if there else None


def leaves_at(family: Family, graze: OnExtremum, rate: float) -> bool:
    """Whether a motion just beyond a graze does not come back from it: the map jumps, and a branch does end.

    It is so where the damping forces jump by so much with the contact state that the stop's gap function is bent the
    other way in the other state: what has crossed goes on, and is not turned back.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    bool
        Whether it is; False where the solver does not give its motions in closed form.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    place, one = graze.place, graze.extremum
    half, last = place.half_periods, place.orbit.last
    if not gives(half.map, Tangent):
        return False
    if (one.value > 0) == one.highest:  # it has crossed
        return _is_driven_on(last.linearised.motion, one)
    row = derivatives_of(half, last.linearised.segments, one)[0] / place.weights
    across = -float(np.copysign(_JUST_BEYOND * abs(rate), one.value)) - one.value
    point = half.map.moved(place.point, across * row / float(row @ row) / place.weights)
    return _is_driven_on(family.linearised(place.value, point, place.count).linearised.motion, one)


def _is_driven_on(segments: Segments, one: Extremum) -> bool:
    """Whether a motion that has crossed a graze does not turn in the state beyond, though it would in that before."""
    switches = np.flatnonzero(segments.switched[:-1] == one.at)
    if not switches.size:
        return False
    i = int(switches[np.argmin(np.abs(segments.end[switches] - one.time))])
    before, after = (_acceleration(segments[k], one.at, float(segments.end[i])) for k in (i, i + 1))
    return before * after < 0


def _acceleration(segment: Segment, k: int, t: float) -> float:
    """That of stop `k` at a time of a segment, m/s2."""
    wave = segment.weights[k] * segment.amplitudes * np.exp(segment.rates * (t - segment.start))
    return float((wave @ segment.rates**2).real) + 2 * float(segment.polynomial[k, 2])


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
class _Try:
    """A guess of Newton's method, and how far it is from a motion whose extremum has the value."""

    value: float
    point: SectionPoint
    found: Return
    r: FloatArray
    residual: float
    extremum: Extremum

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

    def run(self, extremum: Extremum) -> OnExtremum | None:
        """Find it from the extremum of the place where it begins."""
        place, near = self._place, None
        good = _Try(
            place.value,
            place.point,
            place.orbit.last,
            place.half_periods.map.difference(place.orbit.last.end, place.point),
            place.orbit.residual,
            extremum,
        )
        while True:
            on_target = abs(good.extremum.value - self._target) <= _ON_TARGET * abs(self._target)
            on_target &= good.residual <= RESIDUAL
            J, bordered = self._bordered(good, on_target)
            if on_target:
                return self._found(good, J, bordered)
            if self._tries and good.residual <= RESIDUAL and self._way(good) <= _CLOSE_ENOUGH and self._towards:
                near = replace(self._found(good, J, bordered), close=False)
            better = self._stepped(good, bordered)
            if better is None:
                return near
            good = better

    def _way(self, one: _Try) -> float:
        """Arc length to the graze, as the extremum's rate has it."""
        return abs(one.extremum.value) / self._scale

    def _aim(self, good: _Try) -> float:
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

    def _stepped(self, good: _Try, bordered: FloatArray) -> _Try | None:
        """The guess after a step; after a shorter one where that leads too far, or is not better."""
        share = 1.0
        for _ in range(_HALVINGS + 1):
            misses = (self._aim(good) - good.extremum.value) / self._scale
            step = share * np.linalg.solve(bordered, np.append(-good.weights * good.r, misses))
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

    def _guess(self, good: _Try, step: FloatArray) -> _Try | None:
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

    def _is_better(self, now: _Try, good: _Try) -> bool:
        """Whether a guess is as near to a motion as Newton's method must come, and has not crossed the graze back."""
        if (good.extremum.value > 0) == (self._target > 0) != (now.extremum.value > 0):
            return False
        return now.residual <= min(_FAR, max(_WORSE * good.residual, _ALLOWED))

    def _bordered(self, now: _Try, last: bool) -> tuple[FloatArray, FloatArray]:
        """`jacobian`, and the same with the derivatives of the extremum over the scale, shape ``(n + 1, n + 1)``."""
        found, scale = now.found, self._family.scale(now.value)
        row, slope = derivatives_of(now.half_periods, found.linearised.segments, now.extremum)
        miss = math.hypot(now.residual, self._way(now))
        if found.by_number is not None and slope is not None:
            self._column, self._slope = found.by_number, slope
        elif last or miss > _QUICK * self._miss or self._column.size != now.r.size:
            self._column, self._slope = _by_number(self._family, now, self._place.count)
        self._miss = miss
        J = jacobian(found.matrix, self._column * scale, now.weights)
        bordered = np.empty((row.size + 1, row.size + 1))
        bordered[:-1], bordered[-1, :-1] = J, row / now.weights / self._scale
        bordered[-1, -1] = self._slope * scale / self._scale
        return J, bordered

    def _found(self, now: _Try, J: FloatArray, bordered: FloatArray) -> OnExtremum:
        """The motion of a guess that closes."""
        unit = np.append(np.zeros(now.r.size), 1 / self._scale)
        rate = float(np.linalg.solve(bordered, unit)[-1]) * self._family.scale(now.value)
        place = place_from(now.value, now.point, now.residual, now.found, J, now.weights)
        return OnExtremum(place, now.extremum, rate)


class _Patient(_Search):
    """The same from the other side of a graze at which the map changes as a root.

    The first guess, at which the extremum has the value, misses the motion by what that root makes of the way to there.
    From then on each step must come nearer to both at once; shorter ones are tried until one does.
    """

    def _stepped(self, good: _Try, bordered: FloatArray) -> _Try | None:
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

    def _amiss(self, one: _Try) -> float:
        """How far a guess is from a motion whose extremum has the value, over the size of the motion."""
        return math.hypot(one.residual, (one.extremum.value - self._target) / self._scale)


def _tried(family: Family, value: float, point: SectionPoint, count: int, last: _Try) -> _Try | None:
    """A guess; None if it has no extremum like that of the last one."""
    found = family.linearised(value, point, count)
    now = same_extremum(found, last.extremum, last.duration)
    r = found.half_periods.map.difference(found.end, point)
    residual = found.half_periods.relative(r, point)
    if now is None or not (np.isfinite(residual) and np.isfinite(now.value)):
        return None
    return _Try(value, point, found, r, residual, now)


def _by_number(family: Family, now: _Try, count: int) -> tuple[FloatArray, float]:
    """Derivatives of the point's image and of an extremum by the number, while the point stays where it is."""
    map_, column, slope = now.half_periods.map, np.zeros(now.r.size), 0.0
    for other in family.beside(now.value, _STEP):
        beside = family.at(other)
        found = beside.linearised(beside.map.adopted(now.point), count)
        match = same_extremum(found, now.extremum, now.duration)
        column = (map_.difference(map_.adopted(found.end), now.point) - now.r) / (other - now.value)
        slope = 0.0 if match is None else (match.value - now.extremum.value) / (other - now.value)
        if match is not None and (match.value > 0) == (now.extremum.value > 0):
            break  # else the graze lies between the two
    return column, slope
