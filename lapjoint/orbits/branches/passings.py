r"""What happens to the contacts of a motion on the way to a neighbouring one: nothing, or a graze, or several.

Along the curve each extremum h* of a gap function, and each switch, moves in phase, and h* changes its value: `Rates`,
per unit of arc length, in closed form, or from the motion a little further along the tangent.  By these an extremum of
one motion finds itself in the next, however many there are, and the curve sees a graze before it comes to it.

Between two neighbours nothing happens if the switches of one are those of the other, each found where its rate leads,
and if no extremum passes zero: one that is found again neither with another sign at the end, nor on the way and back,
by the cubic that has its values and rates at both ends; one that arises or vanishes on the way not by its rate.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.branches.compiled_extrema import moved_events
from lapjoint.orbits.branches.compiled_passings import Events, met, nearest
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extrema, Extremum, extrema_of, motion_of, stops_of
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.orbits.half_periods import Return
from lapjoint.orbits.parameters import frequency_change
from lapjoint.problem import FloatArray

_BESIDE = 3e-6
"""Largest arc length to the motion by which rates are found: curvature leaves five digits or more."""
_SAME = 1e-4
"""Change of phase on that way beyond which an event is another one: what moves so fast cannot be followed."""


@dataclass(frozen=True)
class Rates:
    """How the extrema and switches of a motion move along the curve, per unit of arc length."""

    phase: FloatArray
    """Of the phase of each extremum, shape ``(m,)``; 0 where it is not known."""
    value: FloatArray
    """Of the value of each extremum, m, shape ``(m,)``; 0 where it is not known."""
    switch: FloatArray
    """Of the phase of each switch, shape ``(J,)``; 0 where it is not known."""


def rates_of(family: Family, place: Place) -> Rates:
    """How the extrema and switches of a motion move along its tangent.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        The motion.

    Returns
    -------
    Rates
        In the direction of the tangent: in closed form where the solver knows its derivative by the number.

    Raises
    ------
    SolverError
        If the march beside it cannot go on.
    """
    if place.orbit.last.by_number is not None and place.extrema.time.size:
        return _exact(family, place)
    return _by_difference(family, place)


def _exact(family: Family, place: Place) -> Rates:
    """Rates from the motion's own derivatives."""
    found, here, half_periods = place.orbit.last, place.extrema, place.half_periods
    motion, (stops, first) = motion_of(found), stops_of(half_periods.structure)
    by_number = place.tangent[-1] * family.scale(place.value)
    change = change_along(found, first, place.tangent[:-1] / place.weights, by_number)
    segments = found.linearised.motion
    which = np.flatnonzero(segments.switched >= 0)
    segment = np.searchsorted(motion.start, here.time, side="right") - 1
    at = np.concatenate([here.at, segments.switched[which]])
    tau = np.concatenate([here.time - motion.start[segment], motion.duration[which]])
    moved = moved_events(motion, *change, np.concatenate([segment, which]), stops.place[at], tau)
    m = here.time.size
    longer = -frequency_change(family.path, place.value) * by_number  # of the logarithm of the duration
    with np.errstate(divide="ignore", invalid="ignore"):
        later = -np.concatenate([moved[:m, 1] / moved[:m, 3], moved[m:, 0] / moved[m:, 2]]) / here.duration
    later -= np.concatenate([here.phase, here.switch_phase]) * longer
    known = np.abs(later) <= _SAME / _BESIDE
    later = np.where(known, later, 0.0)
    return Rates(later[:m], np.where(known[:m], stops.sign[here.at] * moved[:m, 0], 0.0), later[m:])


def change_along(
    found: Return, first: IndexArray, point: FloatArray, number: float
) -> tuple[ComplexArray, ComplexArray, FloatArray]:
    """How a motion changes between its switches with its start and with the number.

    Parameters
    ----------
    found : Return
        The march over its half periods, with the derivative by the number.
    first : ndarray, shape (U,)
        A stop at each of the places at which it is wanted.
    point : FloatArray, shape (n,)
        Change of the start.
    number : float
        Change of the number, in its SI unit.

    Returns
    -------
    waves, secular : ComplexArray, shape (S, U, K)
        See `lapjoint.orbits.branches.compiled_extrema.moved_events`.
    polynomial : FloatArray, shape (S, U, 3)
        The same.
    """
    segments = found.linearised.with_one(point)
    change, own = segments.change, segments.deviations[:, :, 0]
    assert change is not None
    # Taken so, and not by an index, they are laid out the same way whatever the number of switches: compiled once.
    waves, secular = (number * part.take(first, axis=1) for part in (change.waves, change.secular))
    polynomial = number * change.polynomial.take(first, axis=1)
    waves[:, :, : own.shape[1]] += segments.weights[:, first, : own.shape[1]] * own[:, None]
    polynomial[:, :, :2] += segments.drift[:, first][..., 0]
    return waves, secular, polynomial


def _by_difference(family: Family, place: Place) -> Rates:
    """Rates from the motion a little further along the tangent."""
    share, here = place.tangent[-1] * family.scale(place.value), place.extrema
    for value in family.beside(place.value):
        length = (value - place.value) / (share or 1e-300)
        if abs(length) > _BESIDE:  # the curve is about to fold
            length = math.copysign(_BESIDE, length)
            value = place.value + length * share
        moved = place.half_periods.map.moved(place.point, length * place.tangent[:-1] / place.weights)
        there = extrema_of(family.at(value).linearised(family.adopted(value, moved), place.count))
        if there.closings == here.closings:
            break
    match = nearest(here.kind, here.phase, there.kind, there.phase)
    switch = nearest(here.switch_kind, here.switch_phase, there.switch_kind, there.switch_phase)
    shifted, same = _moved(here.phase, there.phase, match)
    turned, _ = _moved(here.switch_phase, there.switch_phase, switch)
    rise = np.zeros(here.time.size)
    rise[same] = there.value[match[same]] - here.value[same]
    return Rates(shifted / length, rise / length, turned / length)


def _moved(phase: FloatArray, there: FloatArray, match: IndexArray) -> tuple[FloatArray, npt.NDArray[np.bool_]]:
    """How far events have moved in phase, and which of them have been found again."""
    moved = np.zeros(phase.size)
    found = match >= 0
    moved[found] = _apart(there[match[found]], phase[found])
    same = found & (np.abs(moved) <= _SAME)
    return np.where(same, moved, 0.0), same


@dataclass(frozen=True)
class Coming:
    """A graze that the curve comes to, as the rates have it."""

    extremum: Extremum
    """The extremum that vanishes there."""
    rate: float
    """Change of its value with the arc length, m."""

    @property
    def length(self) -> float:
        """Arc length to it."""
        return abs(self.extremum.value / self.rate)


def coming(place: Place, rates: Rates) -> Coming | None:
    """The graze that the curve comes to first if all extrema go on changing as they do.

    Parameters
    ----------
    place : Place
        A motion.
    rates : Rates
        Its rates.

    Returns
    -------
    Coming, or None
        None if no extremum goes towards zero.
    """
    value = place.extrema.value
    towards = np.flatnonzero(value * rates.value < 0)
    if not towards.size:
        return None
    lengths = -value[towards] / rates.value[towards]
    first = int(towards[np.argmin(lengths)])
    return Coming(place.extrema[first], float(rates.value[first]))


@dataclass(frozen=True)
class Passed:
    """What happens between two neighbouring motions."""

    nothing: bool
    """Whether the contacts of one become those of the other, and nothing else."""
    grazes: tuple[Coming, ...]
    """Extrema of the first motion that pass zero on the way, the first first; more may, where not nothing happens."""


def passed(here: Place, rates: Rates, new: Place, new_rates: Rates | None, length: float) -> Passed:
    """What happens to the contacts between two neighbouring motions.

    Parameters
    ----------
    here : Place
        The first of the two.
    rates : Rates
        Its rates.
    new : Place
        The second, with its tangent in the same direction.
    new_rates : Rates or None
        Its rates; without them nothing is seen that passes and comes back.
    length : float
        Arc length from one to the other.

    Returns
    -------
    Passed
        What happens.
    """
    a = _events(here.extrema, rates)
    b = _events(new.extrema, rates if new_rates is None else new_rates)  # those of `here` are not looked at there
    same, through, passes, partner = met(a, b, length, new_rates is not None)
    crossed = np.flatnonzero(passes)
    nothing = same and not through and not crossed.size and here.closings == new.closings
    if not crossed.size:
        return Passed(nothing, ())
    h0, h1, rate = a.value[crossed], b.value[partner[crossed]], a.value_rate[crossed]
    order = np.argsort(np.abs(h0) / np.maximum(np.abs(length * rate), 1e-300), kind="stable")
    rate = np.where(rate == 0.0, (h1 - h0) / max(length, 1e-300), rate)  # a graze may be where the curve is
    grazes = (Coming(here.extrema[int(crossed[i])], float(rate[i])) for i in order if rate[i] != 0.0)
    return Passed(nothing, tuple(grazes))


def _events(extrema: Extrema, rates: Rates) -> Events:
    """The events of a motion as compiled functions take them."""
    known = extrema.kind, extrema.phase, extrema.value, rates.phase, rates.value
    return Events(*known, extrema.switch_kind, extrema.switch_phase, rates.switch)


def _apart(phase: FloatArray, origin: FloatArray) -> FloatArray:
    """The shorter way from one phase to another."""
    return np.asarray(phase - origin - np.round(phase - origin))
