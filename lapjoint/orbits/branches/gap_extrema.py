"""The extrema of a motion's distances from its stops: what a graze makes vanish.

Each stop has its gap function h(t) = sign z - gap, negative in a flight and positive in a contact.  A motion grazes a
stop where an extremum of h is zero: the highest point of a flight or of a contact, which is about to be made or lost,
or the lowest of a contact or of a flight, which is about to be parted in two, or to vanish between two contacts.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property, lru_cache
from typing import Any

import numpy as np
import numpy.typing as npt

from lapjoint.orbits.branches.compiled_extrema import gap_extrema, polished
from lapjoint.orbits.compiled_intervals import IndexArray, Motion, Stops
from lapjoint.orbits.half_periods import Return, gives
from lapjoint.orbits.period_map import Tangent
from lapjoint.orbits.segments import Segment, Segments
from lapjoint.orbits.watch import motion_at
from lapjoint.problem import FloatArray, Stop
from lapjoint.problem.structure import Structure

_MOST_BEYOND = 0.5
"""Time to a turning point beyond a switch over the length of the segment before, at most: farther on, it is another
motion's."""
_POLISHED = 4
"""Steps of Newton's method by which an extremum is found in a motion of which samples alone are known."""


@dataclass(frozen=True)
class Extremum:
    """An extremum of a gap function."""

    stop: int
    """The stop; of a stop and its twin the one with the lower index, where the motion goes on mirrored."""
    time: float
    """When, s from the start of the motion."""
    value: float
    """h, m."""
    highest: bool
    """Whether it is a maximum."""
    at: int
    """The stop at which it was found: `stop`, or its twin."""
    segment: int | None = None
    """Number of the segment that has it, of one that is a turning point; see `same_turning_point`."""


@dataclass(frozen=True)
class Extrema:
    """The extrema of all gap functions of a motion over its half periods, ``m`` of them."""

    stop: IndexArray
    """The stops, as in `Extremum.stop`, shape ``(m,)``."""
    at: IndexArray
    """The stops, as in `Extremum.at`, shape ``(m,)``."""
    time: FloatArray
    """When, s, shape ``(m,)``."""
    value: FloatArray
    """h, m, shape ``(m,)``."""
    highest: npt.NDArray[np.bool_]
    """Whether it is a maximum, shape ``(m,)``."""
    closings: tuple[int, ...]
    """How often each stop closes, a stop and its twin together where the motion goes on mirrored, ``P`` of them."""
    duration: float
    """Length of the motion, s."""
    switch_stop: IndexArray
    """The stop of each switch, as in `Extremum.stop`, shape ``(J,)``."""
    switch_time: FloatArray
    """When, s, shape ``(J,)``."""
    closes: npt.NDArray[np.bool_]
    """Whether a contact begins there, and does not end, shape ``(J,)``."""

    @cached_property
    def kind(self) -> IndexArray:
        """Stop and kind of each extremum as one number, shape ``(m,)``."""
        return np.asarray(2 * self.stop + self.highest)

    @cached_property
    def phase(self) -> FloatArray:
        """When each extremum is, over the length of the motion, shape ``(m,)``."""
        return self.time / self.duration

    @cached_property
    def switch_kind(self) -> IndexArray:
        """Stop and kind of each switch as one number, shape ``(J,)``."""
        return np.asarray(2 * self.switch_stop + self.closes)

    @cached_property
    def switch_phase(self) -> FloatArray:
        """When each switch is, over the length of the motion, shape ``(J,)``."""
        return self.switch_time / self.duration

    def __getitem__(self, i: int) -> Extremum:
        return Extremum(
            int(self.stop[i]), float(self.time[i]), float(self.value[i]), bool(self.highest[i]), int(self.at[i])
        )

    def matching(self, other: Extremum, duration: float) -> Extremum | None:
        """The extremum of the same stop and kind that is the nearest in phase to one of a neighbouring motion.

        Parameters
        ----------
        other : Extremum
            Of the neighbouring motion.
        duration : float
            Length of that motion, s.

        Returns
        -------
        Extremum, or None
            None if there is none.
        """
        mine = np.flatnonzero((self.stop == other.stop) & (self.highest == other.highest))
        if not mine.size:
            return None
        apart = self.time[mine] / self.duration - other.time / duration
        return self[int(mine[np.argmin(np.abs(apart - np.round(apart)))])]


def extrema_of(found: Return) -> Extrema:
    """The extrema of the gap functions of a motion.

    Parameters
    ----------
    found : Return
        The march over its half periods.

    Returns
    -------
    Extrema
        Over the same half periods.
    """
    half_periods, structure = found.half_periods, found.half_periods.structure
    duration = found.count * half_periods.map.period / 2
    if not structure.stops:
        none, index = np.zeros(0), np.zeros(0, dtype=np.intp)
        never = none.astype(bool)
        return Extrema(index, index, none, none, never, (), duration, index, none, never)
    segments, (stops, _) = found.linearised.motion, stops_of(structure)
    at, time, value, highest = gap_extrema(motion_of(found), stops)
    switched, closes = _switches(segments)
    when, stop, twins = segments.end[segments.switched >= 0], at, half_periods.twins
    if found.count % 2 and twins is not None:
        stop, switched = (np.minimum(one, np.array(twins)[one]) for one in (at, switched))
    return Extrema(stop, at, time, value, highest, closings_of(found), duration, switched, when, closes)


def closings_of(found: Return) -> tuple[int, ...]:
    """How often each stop closes in a motion.

    Parameters
    ----------
    found : Return
        The march over its half periods.

    Returns
    -------
    tuple of int
        As `Extrema.closings` has it.
    """
    half_periods = found.half_periods
    if not half_periods.structure.stops:
        return ()
    switched, closes = _switches(found.linearised.motion)
    closings = np.bincount(switched[closes], minlength=len(half_periods.structure.stops))
    twins = half_periods.twins
    if found.count % 2 and twins is not None:
        closings = closings + closings[list(twins)]
    return tuple(closings.tolist())


def _switches(segments: Segments) -> tuple[IndexArray, npt.NDArray[np.bool_]]:
    """The stop of each switch of a motion, and whether it closes there, each of shape ``(J,)``."""
    ends = np.flatnonzero(segments.switched >= 0)
    switched = segments.switched[ends]
    return switched, ~segments.closed[ends, switched]


@lru_cache(maxsize=64)  # problems of one branch, and of others that are followed at the same time, share theirs
def stops_of(structure: Structure) -> tuple[Stops, IndexArray]:
    """The stops of a structure as compiled functions take them.

    Parameters
    ----------
    structure : Structure
        That of the problem, with ``P`` stops at ``U`` places.

    Returns
    -------
    Stops
        Each of them its own twin; not to be written to.
    ndarray, shape (U,)
        A stop at each of the places; not to be written to.
    """
    stops = structure.stops
    _, first, place = np.unique([stop.x for stop in stops], return_index=True, return_inverse=True)
    flat = Stops(
        sign=np.array([stop.sign for stop in stops], dtype=float),
        gap=np.array([stop.gap for stop in stops], dtype=float),
        place=place,
        beyond=np.arange(len(stops)),
    )
    return flat, first


def motion_of(found: Return) -> Motion:
    """A motion as compiled functions take it.

    Parameters
    ----------
    found : Return
        The march over its half periods.

    Returns
    -------
    Motion
        At the places of the stops; the same object at every call.
    """
    kept: dict[str, Any] = found.__dict__
    if "_motion" not in kept:
        kept["_motion"] = motion_at(found.linearised.motion, stops_of(found.half_periods.structure)[1])
    motion: Motion = kept["_motion"]
    return motion


def same_extremum(found: Return, extremum: Extremum, duration: float) -> Extremum | None:
    """The extremum of a motion that is that of a neighbouring motion.

    Parameters
    ----------
    found : Return
        The march over the motion's half periods.
    extremum : Extremum
        Of the neighbouring motion.
    duration : float
        Length of that motion, s.

    Returns
    -------
    Extremum, or None
        The one that Newton's method finds from the same phase, or else the nearest of its kind; None if there is none.
    """
    if extremum.segment is not None:
        return same_turning_point(found, extremum, duration)
    if gives(found.half_periods.map, Tangent):
        t = extremum.time / duration * found.count * found.half_periods.map.period / 2
        near = _polished_between_switches(found.linearised.motion, extremum, t)
        if near is not None:
            sign, gap = (getattr(found.half_periods.structure.stops[extremum.at], name) for name in ("sign", "gap"))
            return replace(extremum, time=near[0], value=sign * near[1] - gap)
    match = extrema_of(found).matching(extremum, duration)
    return None if match is None else _polished(found, match)


def same_turning_point(found: Return, extremum: Extremum, duration: float) -> Extremum | None:
    """The turning point of a motion that is that of a neighbouring motion.

    A motion that comes to a switch slowly would turn just beyond it, if the state before went on: there, the gap
    function of that state has an extremum.  It is the same one that a neighbour has which turns before the switch, and
    so does not switch.  Beyond the switch the motion itself need not turn: where forces jump with the contact state it
    may be driven on, and modes that are left out shift it.

    Parameters
    ----------
    found : Return
        The march over the motion's half periods.
    extremum : Extremum
        Of the neighbouring motion, with `Extremum.segment`.
    duration : float
        Length of that motion, s.

    Returns
    -------
    Extremum, or None
        The nearest in time of those before a switch and those beyond; None if there is none.
    """
    segments, t = found.linearised.motion, extremum.time / duration * found.count * found.half_periods.map.period / 2
    i = int(np.searchsorted(segments.end, t))
    near = (_turning_point(found, k, extremum, t) for k in range(max(i - 1, 0), min(i + 2, len(segments))))
    there = [one for one in near if one is not None]
    return min(there, key=lambda one: abs(one.time - t)) if there else None


def _turning_point(found: Return, i: int, like: Extremum, t: float) -> Extremum | None:
    """The turning point near a time, in a segment or just beyond the switch at its end; None if there is none."""
    one, stop = found.linearised.motion[i], found.half_periods.structure.stops[like.at]
    if bool(one.closed[like.at]) == like.highest:
        return None
    beyond = _MOST_BEYOND * (one.end - one.start) if one.switched == like.at else 0.0
    near = _polished_in(one, like.at, min(max(t, one.start), one.end), beyond)
    if near is None or (stop.sign * near[2] < 0) != like.highest:
        return None
    return replace(like, time=near[0], value=stop.sign * (near[1] - _level(one, like.at, stop)), segment=i)


def _level(one: Segment, at: int, stop: Stop) -> float:
    """The displacement at which a stop switches in a segment, m: its gap, or where the segment begins beyond that.

    It does so by what the modes of one state cannot carry over to another, and goes back and forth over that.
    """
    wave, edge = one.weights[at] * one.amplitudes, stop.sign * stop.gap
    z = float(wave.real.sum()) + float(one.polynomial[at, 0])
    return z if (stop.sign * (z - edge) < 0) == bool(one.closed[at]) else edge


def turning_points(found: Return) -> list[Extremum]:
    """The turning points just beyond the switches of a motion.

    Parameters
    ----------
    found : Return
        The march over its half periods, by a solver that gives its motions in closed form between switches.

    Returns
    -------
    list of Extremum
        In the order of time; only of switches beyond which the state before would turn soon.
    """
    there, segments, half_periods = list[Extremum](), found.linearised.motion, found.half_periods
    twins = half_periods.twins if found.count % 2 else None
    for i, one in enumerate(segments):
        at = one.switched
        if at >= 0:
            stop = at if twins is None else min(at, twins[at])
            like = Extremum(stop, one.end, 0.0, not one.closed[at], at, i)
            near = _turning_point(found, i, like, one.end)
            if near is not None and near.time > one.end:
                there.append(near)
    return there


def _polished_between_switches(segments: Segments, extremum: Extremum, t: float) -> tuple[float, float] | None:
    """Time and displacement of an extremum near a time, s and m; None if it is not in the same segment."""
    near = _polished_in(segments.at(t), extremum.at, t, 0.0)
    return None if near is None else near[:2]


def _polished_in(one: Segment, at: int, t: float, beyond: float) -> tuple[float, float, float] | None:
    """Time, displacement and acceleration of an extremum near a time, s, m and m/s2, as a segment has it.

    None if it is not in the segment, or at most some time `beyond` it, s.
    """
    length = one.end - one.start
    found, tau, z, bend = polished(
        one.rates, one.weights[at] * one.amplitudes, one.polynomial[at], t - one.start, length, length + beyond
    )
    return (one.start + tau, z, bend) if found else None


def _polished(found: Return, extremum: Extremum) -> Extremum:
    """An extremum found more exactly, where a solver gives no motion in closed form between switches."""
    half_periods = found.half_periods
    if gives(half_periods.map, Tangent):
        return extremum
    history = half_periods.map.history(found.start, (found.count + 1) // 2)
    stop, t = history.problem.stops[extremum.at], extremum.time
    for _ in range(_POLISHED):
        v, a = (f(stop.x, history.start + t).item() for f in (history.velocity, history.acceleration))
        if a == 0.0:
            break
        t -= v / a
    value = stop.sign * history.displacement(stop.x, history.start + t).item() - stop.gap
    return replace(extremum, time=t, value=value)


def derivatives_of(found: Return, extremum: Extremum) -> tuple[FloatArray, float | None]:
    """Derivatives of an extremum's value by the start of the motion, and by the number.

    Parameters
    ----------
    found : Return
        The march.
    extremum : Extremum
        One of its extrema.

    Returns
    -------
    FloatArray, shape (n,)
        m over the unit of each coordinate of the section point.
    float or None
        m over the number's unit, while the start of the motion stays where it is; None if the segments do not know
        their change with a number.
    """
    its = found.linearised.motion.index_at(extremum.time) if extremum.segment is None else extremum.segment
    one, sign = found.linearised.segment(its), found.half_periods.structure.stops[extremum.at].sign
    tau, k, change = extremum.time - one.start, extremum.at, one.change
    count, wave = one.deviations.shape[0], np.exp(one.rates * tau)
    row = np.real((one.weights[k, :count] * wave[:count]) @ one.deviations) + one.drift[k, 0] + tau * one.drift[k, 1]
    if change is None:
        return np.asarray(sign * row), None
    first, second, third = change.polynomial[k].tolist()
    z = float(((change.waves[k] + tau * change.secular[k]) @ wave).real) + first + tau * (second + tau * third)
    return np.asarray(sign * row), sign * z
