r"""Across a graze, where the sequence of contacts changes and the map is not smooth.

An extremum h* of a stop's gap function passes zero there.  On one side of a graze the map is smooth; on the other,
where the stop is touched, its derivative may grow without bound (as 1 / sqrt(h*) where the damping forces jump with the
state).  So the curve is not stepped across: with the section point x and the number p as unknowns,

    P(x, p) - x = 0,        h*(x, p) = target

is solved for targets ever nearer to zero, from the side where the curve comes from, and then for one beyond.  As the
target holds the penetration fixed, the derivative hardly changes in a step of Newton's method, on either side.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, jacobian, place_from, scaling
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extrema, Extremum, extrema_of, gradient_of, polished
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.problem import FloatArray

_STEPS = 10
"""Most steps of Newton's method."""
_FAR = 0.5
"""Largest residual of a guess over the size of the motion."""
_SLOWEST = 0.7
"""Least share of the residual that a later step of Newton's method must take off."""
_CLOSE = 1e-6
"""Distance from the graze, over the stop's gap or what the motion goes beyond it, at which it counts as located; the
rest is taken off along the tangent, and leaves the square of this."""
_ON_TARGET = 1e-9
"""Distance from the target, over the same, within which Newton's method ends."""
_APPROACH = 0.2
"""Share of the distance that is left after a step towards a graze that cannot be reached in one."""
_BEYOND = (1e-5, 3e-6, 1e-4, 1e-3)
"""Distances beyond a graze, over the same, at which the curve is looked for: a stiff stop is pressed by little."""
_NEAR = 0.05
"""Arc length from the graze within which the motion beyond it must lie."""
_FREE_STEPS = 4
"""Steps of Newton's method within which the residual may grow, for the map has another derivative beyond a graze."""
_APPROACHES = 10
"""Most steps towards a graze."""


@dataclass(frozen=True)
class OnExtremum:
    """A motion whose extremum has a given value."""

    place: Place
    """The motion."""
    extremum: Extremum
    """Its extremum."""
    rate: float
    """Derivative of the number along the curve by the extremum's value, SI unit over m."""


def extremum_scale(place: Place, extremum: Extremum) -> float:
    """What the value of an extremum is compared with: the stop's gap, and where that is small, the motion.

    Parameters
    ----------
    place : Place
        A motion of the branch.
    extremum : Extremum
        One of its extrema.

    Returns
    -------
    float
        m.
    """
    mine = np.abs(place.extrema.value[place.extrema.stop == extremum.stop])
    return max(place.half_periods.map.problem.stops[extremum.at].gap, float(mine.max(initial=0.0)))


def flipped(before: Extrema, after: Extrema) -> list[Extremum]:
    """The extrema of a motion that have the other sign in a neighbouring motion.

    Parameters
    ----------
    before, after : Extrema
        Of the two motions.

    Returns
    -------
    list of Extremum
        Those of `before`.
    """
    found = []
    for i in range(before.time.size):
        one = before[i]
        other = after.matching(one, before.duration)
        if other is None or (other.value > 0) == (one.value > 0):
            continue
        back = before.matching(other, after.duration)
        if back is not None and back.time == one.time:
            found.append(one)
    return found


def approaching(before: Place, now: Place) -> Extremum | None:
    """The extremum that vanishes first if all go on changing as they did between two places.

    Parameters
    ----------
    before, now : Place
        Two places of a branch, in the sequence in which it is followed.

    Returns
    -------
    Extremum, or None
        Of `now`; None if none goes towards zero.
    """
    best, soonest = None, np.inf
    for i in range(now.extrema.time.size):
        one = now.extrema[i]
        other = before.extrema.matching(one, now.extrema.duration)
        if other is None or (other.value > 0) != (one.value > 0):
            continue
        change = abs(other.value) - abs(one.value)
        if change > 0 and abs(one.value) / change < soonest:
            best, soonest = one, abs(one.value) / change
    return best


def located_graze(family: Family, place: Place, extremum: Extremum) -> OnExtremum | None:
    """The motion just before a graze, on the side of a place.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        A motion near the graze.
    extremum : Extremum
        Its extremum that vanishes there.

    Returns
    -------
    OnExtremum, or None
        Within `_CLOSE` of the graze; None if Newton's method does not lead there.
    """
    scale = extremum_scale(place, extremum)
    end = float(np.copysign(_CLOSE * scale, extremum.value))
    if abs(extremum.value) <= abs(end):
        end = extremum.value
    now, share = OnExtremum(place, extremum, 0.0), 0.0
    for _ in range(_APPROACHES):
        target = end + share * (now.extremum.value - end)
        found = on_extremum(family, now.place, now.extremum, target, scale)
        if found is None or (found.extremum.value > 0) != (extremum.value > 0):
            if share > 0.95:
                return None
            share = _APPROACH if share == 0.0 else 0.5 * (1 + share)
            continue
        now = found
        if target == end:
            return now
        share = 0.0 if abs(now.extremum.value) < 30 * abs(end) else share
    return None


def beyond_graze(family: Family, graze: OnExtremum) -> OnExtremum | None:
    """The motion on the other side of a graze, a little beyond it.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.

    Returns
    -------
    OnExtremum, or None
        None if Newton's method finds none: the branch ends at the graze.
    """
    scale = extremum_scale(graze.place, graze.extremum)
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
        What the value is compared with, m.

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
    value, point, duration = place.value, place.point, place.extrema.duration
    allowed = _FAR
    for i in range(_STEPS):
        half = family.at(value)
        found = half.linearised(point, place.count)
        now = extrema_of(found).matching(extremum, duration)
        if now is None:
            return None
        now, duration = polished(found, now), found.count * half.map.period / 2
        r = half.map.difference(found.end, point)
        residual, misses = half.relative(r, point), (target - now.value) / scale
        if not residual <= allowed or not np.isfinite(misses):
            return None
        column, slope = _by_number(family, value, point, now, place.count)
        weights = scaling(half, point, r.size)
        J = jacobian(found, column * family.scale(value), weights)
        row = gradient_of(half, found.linearised.segments, now) / weights / scale
        bordered = np.vstack([J, np.append(row, slope * family.scale(value) / scale)])
        extremum = now
        if residual <= RESIDUAL and abs(misses) <= max(_ON_TARGET, 1e-3 * abs(target) / scale):
            rate = float(np.linalg.solve(bordered, np.append(np.zeros(r.size), 1 / scale))[-1]) * family.scale(value)
            return OnExtremum(place_from(value, point, residual, found, J, weights), now, rate)
        step = np.linalg.solve(bordered, np.append(-weights * r, misses))
        length = float(np.linalg.norm(step))
        if not length < 1.0:
            return None
        point = half.map.moved(point, step[:-1] / weights)
        value += float(step[-1]) * family.scale(value)
        point = family.adopted(value, point)
        if i >= _FREE_STEPS:
            allowed = max(_SLOWEST * residual, 10 * RESIDUAL)
    return None


def _by_number(
    family: Family, value: float, point: SectionPoint, extremum: Extremum, count: int
) -> tuple[FloatArray, float]:
    """Derivatives of the point's image and of an extremum by the number, while the point stays where it is."""
    half, step = family.at(value), 1e-6 * family.scale(value)
    other = value - step if value + step > family.high else value + step
    beside = family.at(other)
    found = beside.linearised(beside.map.adopted(point), count)
    match = extrema_of(found).matching(extremum, count * half.map.period / 2)
    slope = 0.0 if match is None else (polished(found, match).value - extremum.value) / (other - value)
    end, here = found.end, half.marched(point, count)
    column = half.map.difference(half.map.adopted(end), point) - half.map.difference(here, point)
    return column / (other - value), slope
