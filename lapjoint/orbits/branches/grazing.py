r"""Across a graze, where the sequence of contacts changes and the map is not smooth.

An extremum h* of a stop's gap function passes zero there.  On one side of a graze the map is smooth; on the other,
where the stop is touched, its derivative may grow without bound (as 1 / sqrt(h*) where the damping forces jump with the
state).  So the curve is not stepped across: with the section point x and the number p as unknowns,

    P(x, p) - x = 0,        h*(x, p) = target

is solved for targets ever nearer to zero, from the side where the curve comes from, and then for one beyond.  As the
target holds the penetration fixed, the derivative hardly changes in a step of Newton's method, on either side.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, jacobian, place_from, scaling
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum, gradient_of, same_extremum
from lapjoint.orbits.half_periods import Return
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.problem import FloatArray

_STEPS = 12
"""Most steps of Newton's method, and of halves of them."""
_HALVINGS = 3
"""How often a step is halved that leads past the graze, or away."""
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
_ON_TARGET = 1e-9
"""Distance from the target, as such an arc length, within which Newton's method ends."""
_APPROACH = 0.2
"""Share of the distance that is left after a step towards a graze that cannot be reached in one."""
_BEYOND = (3e-5, 3e-6, 1e-4, 1e-3)
"""Distances beyond a graze, as such arc lengths, at which the curve is looked for."""
_NEAR = 0.05
"""Arc length from the graze within which the motion beyond it must lie."""
_APPROACHES = 7
"""Most steps towards a graze."""
_FAILURES = 2
"""Number of steps in turn that come to nothing after which one must be nearer to begin with."""


@dataclass(frozen=True)
class OnExtremum:
    """A motion whose extremum has a given value."""

    place: Place
    """The motion."""
    extremum: Extremum
    """Its extremum."""
    rate: float
    """Derivative of the number along the curve by the extremum's value, SI unit over m."""


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
        Within `_CLOSE` of the graze; None if Newton's method does not lead there.
    """
    scale = abs(rate)
    end = float(np.copysign(_CLOSE * scale, extremum.value))
    if abs(extremum.value) <= abs(end):
        end = extremum.value
    now, share, failures = OnExtremum(place, extremum, 0.0), 0.0, 0
    for _ in range(_APPROACHES):
        target = end + share * (now.extremum.value - end)
        found = on_extremum(family, now.place, now.extremum, target, scale)
        if found is None or (found.extremum.value > 0) != (extremum.value > 0):
            failures += 1
            if failures == _FAILURES:
                return None
            share = _APPROACH if share == 0.0 else 0.5 * (1 + share)
            continue
        now, failures = found, 0
        if target == end:
            return now
        share = 0.0 if abs(now.extremum.value) < 30 * abs(end) else share**2
    return None


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
    scale = abs(rate)
    for share in _BEYOND:
        target = -float(np.copysign(share * scale, graze.extremum.value))
        found = on_extremum(family, graze.place, graze.extremum, target, scale)
        if found is None or found.place.extrema.closings == graze.place.extrema.closings:
            continue
        if float(np.linalg.norm(found.place.chord(family, graze.place))) <= _NEAR:
            return found
    return None


def on_extremum(family: Family, place: Place, extremum: Extremum, target: float, scale: float) -> OnExtremum | None:
    """The motion near a place whose extremum has a given value.

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

    Returns
    -------
    OnExtremum, or None
        None if Newton's method finds none.
    """
    try:
        return _on_extremum(family, place, extremum, target, scale)
    except (SolverError, InputError, np.linalg.LinAlgError):
        return None


def _on_extremum(family: Family, place: Place, extremum: Extremum, target: float, scale: float) -> OnExtremum | None:
    last: _Try | None = None
    value, point, step, halved = place.value, place.point, np.zeros(0), 0
    duration, before, column, slope = place.extrema.duration, np.inf, np.zeros(0), 0.0
    for _ in range(_STEPS):
        now = _tried(family, value, point, place.count, extremum, duration)
        if now is None or (last is not None and not _is_better(now, last, target)):
            halved += 1
            if last is None or halved > _HALVINGS:
                return None
            step = 0.5 * step
        else:
            halved, misses = 0, (target - now.extremum.value) / scale
            if not (np.isfinite(misses) and now.residual <= _FAR):
                return None
            half, found, weights = family.at(value), now.found, scaling(family.at(value), point, now.r.size)
            on_target = now.residual <= RESIDUAL and abs(misses) <= max(_ON_TARGET, 1e-3 * abs(target) / scale)
            size = math.hypot(now.residual, misses)
            if on_target or size > _QUICK * before or column.size != now.r.size:
                column, slope = _by_number(family, value, point, now, place.count)
            before = size
            J = jacobian(found, column * family.scale(value), weights)
            row = gradient_of(half, found.linearised.segments, now.extremum) / weights / scale
            bordered = np.vstack([J, np.append(row, slope * family.scale(value) / scale)])
            if on_target:
                unit = np.append(np.zeros(now.r.size), 1 / scale)
                rate = float(np.linalg.solve(bordered, unit)[-1]) * family.scale(value)
                there = place_from(value, point, now.residual, found, J, weights)
                return OnExtremum(there, now.extremum, rate)
            step = np.linalg.solve(bordered, np.append(-weights * now.r, misses))
            last, extremum, duration = now, now.extremum, found.count * half.map.period / 2
        if not float(np.linalg.norm(step)) < 1.0:
            return None
        half = family.at(last.value)
        point = half.map.moved(last.point, step[:-1] / scaling(half, last.point, last.r.size))
        value = last.value + float(step[-1]) * family.scale(last.value)
        point = family.adopted(value, point)
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


def _tried(
    family: Family, value: float, point: SectionPoint, count: int, extremum: Extremum, duration: float
) -> _Try | None:
    """A guess; None if it has no such extremum."""
    half = family.at(value)
    found = half.linearised(point, count)
    now = same_extremum(found, extremum, duration)
    r = half.map.difference(found.end, point)
    residual = half.relative(r, point)
    if now is None or not np.isfinite(residual):
        return None
    return _Try(value, point, found, r, residual, now)


def _is_better(now: _Try, last: _Try, target: float) -> bool:
    """Whether a guess is as near to a motion as Newton's method must come, and has not gone past the graze again."""
    if (last.extremum.value > 0) == (target > 0) != (now.extremum.value > 0):
        return False
    return now.residual <= max(_WORSE * last.residual, _ALLOWED)


def _by_number(family: Family, value: float, point: SectionPoint, now: _Try, count: int) -> tuple[FloatArray, float]:
    """Derivatives of the point's image and of an extremum by the number, while the point stays where it is."""
    half, column, slope = family.at(value), np.zeros(now.r.size), 0.0
    for other in family.beside(value, _STEP):
        beside = family.at(other)
        found = beside.linearised(beside.map.adopted(point), count)
        match = same_extremum(found, now.extremum, count * half.map.period / 2)
        column = (half.map.difference(half.map.adopted(found.end), point) - now.r) / (other - value)
        slope = 0.0 if match is None else (match.value - now.extremum.value) / (other - value)
        if match is not None and (match.value > 0) == (now.extremum.value > 0):
            break  # else the graze lies between the two
    return column, slope
