"""The motion of a curve whose extremum has a given value, by multiple shooting.

Beyond a graze the map changes as a root of the penetration, or by a jump of its derivative.  Where multipliers are a
thousand or more, what that makes of the motion before the graze closes by far too little for `on_extremum`, which goes
on from one section point.  From several, as `lapjoint.orbits.branches.shooting` has it, a deviation grows by a root of
the multiplier between two.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import accumulate

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, place_from
from lapjoint.orbits.branches.extremum_search import OnExtremum, on_extremum
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum, derivatives_of, same_extremum
from lapjoint.orbits.branches.shooting import Round, stretches_of

_STEPS = 10
"""Most steps: six are enough in most cases."""
_FAR, _LONG = 0.3, 0.1
"""Largest residual over the size of the motion from which a step is made, and largest arc length to the target."""
_CLOSED, _ON_TARGET = 1e-10, 0.5
"""Residual over the size of the motion, and distance from the target over it, at which the rest is left to
`on_extremum`."""


def by_stretches(family: Family, place: Place, extremum: Extremum, target: float, scale: float) -> OnExtremum | None:
    """The motion near a place whose extremum has about a given value.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        A motion, in several stretches.
    extremum : Extremum
        Its extremum; no turning point.
    target : float
        The value, m.
    scale : float
        Change of the value with the arc length, m, above zero.

    Returns
    -------
    OnExtremum, or None
        None if Newton's method finds none, or the derivatives of extrema by the number are not known.
    """
    if extremum.segment is not None:
        return None
    try:
        return _found(family, place, extremum, target, scale)
    except (SolverError, InputError, np.linalg.LinAlgError):  # a step led out of what can be marched
        return None


def _found(family: Family, place: Place, extremum: Extremum, target: float, scale: float) -> OnExtremum | None:
    stretches = stretches_of(place)
    if len(stretches) == 1:
        return None
    now = Round.along(family, place.value, stretches)
    its, like, duration = _within(place, now.lengths, extremum)
    for _ in range(_STEPS):
        here = same_extremum(now.found[its], like, duration) if now.in_one_state else None
        if here is None or not (now.residual <= _FAR and abs(target - here.value) <= _LONG * scale):
            return None
        if now.residual <= _CLOSED and abs(target - here.value) <= _ON_TARGET * abs(target):
            return _closed(now, place, extremum, target, scale)
        row, slope = derivatives_of(now.found[its], here)
        if slope is None:
            return None
        J, missed = now.system()
        whole, by_number, left = now.carried(its)
        by_first, number = row @ whole / now.weights, (row @ by_number + slope) * family.scale(now.value)
        bordered = np.vstack([J, np.append(by_first, number) / scale])
        wanted = (target - here.value - row @ left) / scale
        like, duration = here, now.lengths[its] * now.half.map.period / 2
        now = now.stepped(np.linalg.solve(bordered, np.append(-missed, wanted)))
    return None


def _within(place: Place, lengths: Sequence[int], extremum: Extremum) -> tuple[int, Extremum, float]:
    """The stretch of a motion that has an extremum, the extremum as it has it, and its length, s.

    From an odd number of half periods on it goes on mirrored, and the stop is its twin.
    """
    half = place.half_periods
    period, starts = half.map.period / 2, [0, *accumulate(lengths)]
    its = max(k for k, start in enumerate(starts[:-1]) if start * period <= extremum.time)
    at = extremum.at if half.twins is None or starts[its] % 2 == 0 else half.twins[extremum.at]
    return its, replace(extremum, at=at, time=extremum.time - starts[its] * period), lengths[its] * period


def _closed(now: Round, place: Place, extremum: Extremum, target: float, scale: float) -> OnExtremum | None:
    """The motion of a round that closes, from its first point alone."""
    point, family = now.points[0], now.family
    found = family.linearised(now.value, point, place.count)
    mine = same_extremum(found, extremum, place.extrema.duration)
    if mine is None:
        return None
    half = found.half_periods
    residual = half.relative(half.map.difference(found.end, point), point)
    J, _ = now.system()
    near = place_from(now.value, point, residual, found, J, now.weights)
    return on_extremum(family, near, mine, target, scale)
