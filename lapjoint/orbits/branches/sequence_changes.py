"""Changes of the contact sequence along a curve: contacts that appear, end, split or merge, and events out of order.

An arc ends where its duration passes zero.  If it lies between two events of one stop, the stop's contact or flight
vanishes with both events.  If it lies between events of two stops, the events change their order.  If an extremum of a
gap function passes zero, a contact is born while the stop is open, or split by a flight while the stop is closed.

A damped stop that may not pull has a graze of its own.  A touch at zero velocity begins three events, as the force ends
at once, and then the stop opens: their two arcs vanish together.  A contact that is split by a flight loses the moment
at which its force would begin again, because the touch after the flight begins the force.  The touch of another damped
stop, whose force jumps, bends the gap function of a force: at such a corner a force begins before and ends after the
touch, or ends before and begins after it.

The curves on both sides of a change meet where the arc's duration and the extremum are zero.  If a solver loses a part
of the motion at a change of contact state, the two curves miss each other by an error of truncation, see
`SequenceChange.offset`.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Literal, NamedTuple

import numpy as np
from scipy.optimize import toms748

from lapjoint.answers.contact_state import stop_of
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.bifurcations import beside, nearest_of
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.point import SAME, CurvePoint, holding, scale_of, solved
from lapjoint.orbits.branches.releases import acts, lets_go, vanishing, with_new_release
from lapjoint.problem import FloatArray

ChangeKind = Literal["birth", "end", "split", "merge", "exchange"]
"""A contact is born or ends at a graze, a contact splits or two contacts merge, or two events change their order."""
SECANTS = 12
"""Largest number of secant steps to a nearby zero; two to five are usually enough."""
_CLEARLY = 1e-7
"""Value of a monitor, without unit, that is above rounding.  Newton's method leaves an arclength of 1e-9; an extremum
changes by up to a hundred times an arclength."""
_MOST_AT_ONCE = 6
"""Largest number of changes that are located together; a motion of four periods has at most six similar parts."""
_ROUNDED = 1e-12
"""Distance of an extremum from an event, divided by the length of the motion, that is rounding."""
_ACROSS = 0.5
"""Fraction of a step's length by which a located change may lie outside the step."""


class Monitor(NamedTuple):
    """A function along a curve whose values above zero say that the contact sequence no longer fits the motion."""

    kind: Literal["duration", "extremum"]
    """The function: the duration of an arc, or an extremum of a gap function."""
    arc: int
    """The arc of the duration, or of the extremum."""
    stop: int
    """The switch of the extremum, k of a stop or ~k of a force; 0 for a duration."""
    time: float
    """Time of the extremum from the section, divided by the length of the motion; 0 for a duration."""
    value: float
    """The function: minus a duration, divided by the length of the motion, or `GapExtrema.violation`."""

    def is_of(self, other: Monitor) -> bool:
        """Whether a monitor, perhaps of another point of the curve, belongs to the same arc and stop."""
        return (self.kind, self.arc, self.stop) == (other.kind, other.arc, other.stop)


@dataclass(frozen=True)
class SequenceChange:
    """A change of the contact sequence, located on both sides."""

    kind: ChangeKind
    """The kind of change."""
    stops: tuple[int, ...]
    """The stop, or the two stops that change their order."""
    before: CurvePoint
    """The point with the sequence before the change, its tangent towards the change."""
    after: CurvePoint | None
    """The point with the sequence after the change, its tangent away from the change; None if there is none."""
    reverses: int | None = None
    """The new arc, if the jump of the damping force puts the beam on the wrong side of the stop while the arc is short;
    else None."""

    @property
    def value(self) -> float:
        """The parameter at the change, from the side with fewer events."""
        return self.fewer.value

    @property
    def fewer(self) -> CurvePoint:
        """The point with fewer events, or `before` if `after` is unknown; at a graze, the curve is smooth on its
        side."""
        if self.after is not None and self.after.problem.events < self.before.problem.events:
            return self.after
        return self.before

    @property
    def more(self) -> CurvePoint | None:
        """The point with more events, of which one arc has no duration; None if it is unknown."""
        return self.after if self.kind in ("birth", "split") else self.before

    @property
    def offset(self) -> float:
        """Difference of the parameter between both sides, in its unit; infinite if one side is unknown."""
        return np.inf if self.after is None else abs(self.after.value - self.before.value)


def violated(point: CurvePoint) -> list[Monitor]:
    """The monitors of a point that are above zero; none if the motion has the contact sequence of its equations."""
    shares = point.shares
    found = [
        Monitor("duration", i, 0, 0.0, float(-shares[i])) for i in point.problem.free[1:].tolist() if shares[i] < 0
    ]
    its, length = point.extrema, point.problem.length(point.u)
    for i in np.flatnonzero(its.violation > point.tolerance):
        found.append(
            Monitor("extremum", int(its.arc[i]), int(its.stop[i]), float(its.time[i]) / length, float(its.violation[i]))
        )
    return found


def same_monitor(point: CurvePoint, monitor: Monitor) -> Monitor | None:
    """A monitor with its value at another point of the curve; None if the motion there has no such extremum.

    Of several extrema in one arc, the one farthest beyond the stop counts.  An extremum of a stop's own gap function
    may pass to the next arc where a force begins.
    """
    if monitor.kind == "duration":
        return monitor._replace(value=float(-point.shares[monitor.arc]))
    its = point.extrema
    parts = np.arange(point.problem.events + 1)
    if monitor.stop >= 0:  # arcs of the same closed stops
        parts = np.cumsum([0, *(switch >= 0 for switch in point.problem.sequence.stops)])
    mine = np.flatnonzero((its.stop == monitor.stop) & (parts[its.arc] == parts[monitor.arc]))
    if not mine.size:
        return None
    best = int(mine[np.argmax(its.violation[mine])])
    time = float(its.time[best]) / point.problem.length(point.u)
    return monitor._replace(arc=int(its.arc[best]), time=time, value=float(its.violation[best]))


def first_change(start: CurvePoint, end: CurvePoint, length: float) -> tuple[Monitor, CurvePoint] | None:
    """The first monitor that passes zero in a step of a curve, and the point at its zero; None if the point is not
    found.

    `start` and `end` have one contact sequence, `end` violates a monitor, and `length` is the arclength between them.
    """
    there, upper, seen = violated(end), length, 0
    best: tuple[Monitor, CurvePoint] | None = None
    while there:
        # If an arc has ended, its neighbouring arcs overlap, and also have an extremum beyond the stop.
        ended = [one for one in there if one.kind == "duration"]
        monitor = min(ended or there, key=lambda one: _estimate(start, one, upper))
        located = _located(start, monitor, upper)
        if located is None:
            return None
        best, seen = located, seen + 1
        upper = start.arclength(located[1])
        beside = _together(located[1], located[0])
        there = [one for one in violated(located[1]) if not (located[0].is_of(one) or one.arc in beside)]
        if seen > end.problem.events + len(end.extrema.stop):
            return None
    return best


def _together(point: CurvePoint, monitor: Monitor) -> set[int]:
    """The arcs of no duration that vanish together with the arc of a monitor: of a damped stop's contact, or at a
    corner."""
    if monitor.kind == "extremum":
        return set()
    i, joining, corner = monitor.arc, point.problem.sequence.joining, _corner(point, monitor.arc)
    found = {k for j in (i, i + 1) if True in joining[j : j + 1] for k in (j - 1, j)}
    found |= set() if corner is None else {corner, corner + 1}
    return {k for k in found if abs(point.shares[k]) <= SAME}


def _corner(point: CurvePoint, arc: int) -> int | None:
    """The touch at whose corner a force begins and ends, or ends and begins, if its arcs beside have no duration."""
    stops, shares = point.problem.sequence.stops, np.abs(point.shares)
    for k in (arc - 1, arc):
        if 0 < k < len(stops) - 1 and stops[k - 1] == stops[k + 1] < 0 <= stops[k] and max(shares[k : k + 2]) <= SAME:
            return k
    return None


def _estimate(start: CurvePoint, monitor: Monitor, length: float) -> float:
    """Arclength at which a monitor passes zero if it is linear in the step."""
    before = same_monitor(start, monitor)
    if before is None or before.value >= 0:
        return 0.5 * length
    return length * before.value / (before.value - monitor.value)


def _located(start: CurvePoint, monitor: Monitor, length: float) -> tuple[Monitor, CurvePoint] | None:
    """A monitor at its zero, and the point there."""
    if monitor.kind == "duration":
        at, unknown = _estimate(start, monitor, length), start.problem.position(start.u, monitor.arc)
        guess = start.predicted(at)
        guess[unknown] = 0.0
        point = holding(start.problem, guess, unknown, start.scale)
        if point is None or abs(start.arclength(point) - at) > (1 + _ACROSS) * length:
            return None
        return monitor._replace(value=0.0), point if point.tangent @ start.tangent > 0 else point.turned()
    before = same_monitor(start, monitor)
    if before is None or before.value < 0:
        return zero_along(start, monitor, 0.0, length)
    for back in (0.1, 1.0, 10.0):  # the extremum was already beyond its stop, by less than the tolerance
        located = zero_along(start, before, -back * length, 0.0)
        if located is not None:
            return located
    return before, start


def at_once(change: SequenceChange) -> Iterator[SequenceChange]:
    """The changes that happen together with a change: monitors that are above zero at the point after the change.

    Each change starts from the point after the previous change.  If a motion nearly repeats, its similar parts change
    at nearly equal parameters, and the losses at changes of contact state may swap their order.
    """
    for _ in range(_MOST_AT_ONCE):
        here = change.after
        there = [] if here is None else [one for one in violated(here) if one.value > _CLEARLY]
        if here is None or not there:
            return
        monitor = min(there, key=lambda one: one.kind == "extremum")
        point: CurvePoint | None = here
        if monitor.kind == "duration":
            guess = here.u.copy()
            guess[here.problem.position(guess, monitor.arc)] = 0.0
            point = on_duration(here.problem, guess, monitor.arc)
        if point is None:
            return
        change = crossed(monitor, point)
        yield change


def zero_along(start: CurvePoint, monitor: Monitor, first: float, last: float) -> tuple[Monitor, CurvePoint] | None:
    """An extremum at its zero, and the point there, between two arclengths from a point of the curve.

    The extremum has different signs at the arclengths `first` and `last`.  None if Newton's method loses the curve.
    """
    known: dict[float, tuple[Monitor, CurvePoint]] = {}
    points = dict[float, CurvePoint]()

    def value(s: float) -> float:
        point = start if s == 0 else beside(start, s, nearest_of(points, s), exact=False)
        if point is None:
            raise _LostError
        points[s] = point
        its = same_monitor(point, monitor)
        if its is None:  # the extremum appears farther on, below zero
            return -1.0
        known[s] = its, point
        return its.value

    try:
        at = toms748(value, first, last, xtol=1e-13, rtol=1e-11)
        if at not in known:
            value(at)
    except (_LostError, ValueError):
        return None
    if at not in known or abs(known[at][0].value) > known[at][1].tolerance:
        return None  # the extremum appears beyond its stop
    its, point = known[at]
    if point.tangent @ start.tangent < 0:
        point = point.turned()
    return its, point


class _LostError(Exception):
    """Newton's method lost the curve."""


def crossed(monitor: Monitor, before: CurvePoint) -> SequenceChange:
    """The change of the contact sequence at the zero of a monitor; the tangent of `before` goes towards the change."""
    if monitor.kind == "extremum":
        return _with_new_events(monitor, before)
    stops, i = before.problem.sequence.stops, monitor.arc
    corner = _corner(before, i)
    if corner is not None:
        return _without_corner(before, corner)
    if stop_of(stops[i - 1]) != stop_of(stops[i]):
        return _exchanged(monitor, before)
    return _without_events(monitor, before)


def _with_new_events(monitor: Monitor, before: CurvePoint) -> SequenceChange:
    """The change in which two events appear at an extremum, or two groups of tied events if several stops touch
    together."""
    problem, i, n = before.problem, monitor.arc, before.coordinates
    sequence, shares, stops = problem.sequence, before.shares.tolist(), _touching(before, monitor)
    kind: ChangeKind = "split" if acts(sequence.states[i], monitor.stop) else "birth"
    if any(lets_go(before, stop) for stop in stops):
        its = None if len(stops) > 1 else with_new_release(before, monitor.stop, i, monitor.time)
        return SequenceChange(kind, (monitor.stop,), before, *_on_new_arc(its, monitor))
    began, more = sum(shares[:i]), len(stops) - 1
    if monitor.stop < 0 and i > 0 and abs(monitor.time - began) <= _ROUNDED:
        return SequenceChange(kind, (monitor.stop,), before, _with_new_corner(monitor, before))
    shares[i : i + 1] = [monitor.time - began, *[0.0] * (2 * more + 1), shares[i] - (monitor.time - began)]
    order = (*sequence.stops[:i], *stops, *reversed(stops), *sequence.stops[i:])
    tied = {k if k < i else k + 2 * len(stops) for k in problem.tied}
    tied |= {*range(i + 1, i + 1 + more), *range(i + 2 + more, i + 2 + 2 * more)}
    new = replace(problem, sequence=ContactSequence(sequence.first, order), tied=frozenset(tied))
    made = new, new.packed(before.u[:n], shares, before.value), i + 1 + more
    return SequenceChange(kind, (monitor.stop,), before, *_on_new_arc(made, monitor))


def _on_new_arc(
    made: tuple[BoundaryProblem, FloatArray, int] | None, monitor: Monitor
) -> tuple[CurvePoint | None, int | None]:
    """The point after a change with its new arc of no duration, and this arc if it is on the wrong side of the stop."""
    after = None if made is None else on_duration(*made)
    if made is None or after is None:
        return None, None
    return after, made[2] if after.entering(made[2], monitor.stop)[1] > 0 else None


def _with_new_corner(monitor: Monitor, before: CurvePoint) -> CurvePoint | None:
    """The point after a force has begun to switch before and after a touch; None if it is not found."""
    problem, i, shares = before.problem, monitor.arc, before.shares.tolist()
    sequence, stops = problem.sequence, problem.sequence.stops
    if {i - 1, i} & problem.tied:
        return None
    shares[i:i] = [0.0, 0.0]
    order = (*stops[: i - 1], monitor.stop, stops[i - 1], monitor.stop, *stops[i:])
    tied = frozenset(k if k < i else k + 2 for k in problem.tied)
    new = replace(problem, sequence=ContactSequence(sequence.first, order), tied=tied)
    return on_duration(new, new.packed(before.u[: before.coordinates], shares, before.value), i)


def _without_corner(before: CurvePoint, k: int) -> SequenceChange:
    """The change in which a force stops switching before and after event `k`, a touch."""
    problem, shares = before.problem, before.shares.tolist()
    sequence, stops = problem.sequence, problem.sequence.stops
    force, time = stops[k - 1], sum(shares[: k + 1])
    kind: ChangeKind = "end" if acts(sequence.states[k], force) else "merge"
    if {k - 1, k, k + 1, k + 2} & problem.tied:
        return SequenceChange(kind, (force,), before, None)
    shares[k - 1 : k + 3] = [shares[k - 1] + shares[k], shares[k + 1] + shares[k + 2]]
    order = (*stops[: k - 1], stops[k], *stops[k + 2 :])
    tied = frozenset(i if i < k else i - 2 for i in problem.tied)
    new = replace(problem, sequence=ContactSequence(sequence.first, order), tied=tied)
    guess = new.packed(before.u[: before.coordinates], shares, before.value)
    return SequenceChange(kind, (force,), before, at_graze(new, guess, Monitor("extremum", k, force, time, 0.0)))


def _touching(point: CurvePoint, monitor: Monitor) -> list[int]:
    """The stop of a monitor, and the stops that mirror this stop and have an extremum of zero at this time, too."""
    its = point.extrema
    alike = (its.arc == monitor.arc) & (np.abs(its.time / point.problem.length(point.u) - monitor.time) < SAME)
    beside = alike & (np.abs(its.violation - monitor.value) <= 10 * point.tolerance)
    return [monitor.stop, *(int(stop) for stop in its.stop[beside] if stop != monitor.stop)]


def _exchanged(monitor: Monitor, before: CurvePoint) -> SequenceChange:
    """The change in which two events of different stops, or two groups of tied events, exchange their order."""
    problem, i = before.problem, monitor.arc
    first, last, stops = problem.group(i - 1), problem.group(i), list(problem.sequence.stops)
    stops[first[0] : last[-1] + 1] = [*(stops[k] for k in last), *(stops[k] for k in first)]
    arc = first[0] + len(last)
    tied = problem.tied - {*first, *last} | set(range(first[0] + 1, last[-1] + 1)) - {arc}
    sequence = ContactSequence(problem.sequence.first, tuple(stops))
    new = replace(problem, sequence=sequence, tied=frozenset(tied))
    shares = before.shares.copy()
    shares[first[0] + 1 : last[-1] + 1] = 0.0
    after = on_duration(new, new.packed(before.u[: before.coordinates], shares, before.value), arc)
    return SequenceChange("exchange", (problem.sequence.stops[i - 1], problem.sequence.stops[i]), before, after)


def on_duration(problem: BoundaryProblem, guess: FloatArray, arc: int) -> CurvePoint | None:
    """The point near a guess, shape (n + F + 1,), at which an arc has no duration; None if Newton's method finds none.

    The tangent goes towards a longer arc.
    """
    at = problem.position(guess, arc)
    point = holding(problem, guess, at)
    return point if point is None or point.tangent[at] > 0 else point.turned()


def ended_arc(problem: BoundaryProblem, u: FloatArray) -> int:
    """The shortest arc between two events of one stop, of unknowns of shape (n + F + 1,)."""
    shares = np.abs(problem.shares(u))
    return min(_of_one_stop(problem.sequence), key=lambda i: float(shares[i]))


def _of_one_stop(sequence: ContactSequence) -> list[int]:
    """The arcs between two events of one stop."""
    returning, joining = sequence.returning, sequence.joining
    return [i for i in range(1, len(sequence.stops)) if returning[i] or True in joining[i + 1 : i + 2]]


def is_grazing(point: CurvePoint) -> bool:
    """Whether an arc between two events of one stop has no duration.

    The parameter is even in the duration of this arc, but for an odd part of higher order, so that its derivative along
    the curve is zero there, whether or not the branch folds.
    """
    return any(abs(point.shares[i]) <= SAME for i in _of_one_stop(point.problem.sequence))


def with_ended_arc(problem: BoundaryProblem, guess: FloatArray) -> SequenceChange | None:
    """The change where the shortest arc between two events of one stop has no duration, from the side with more events.

    The guess has shape (n + F + 1,).  None if Newton's method finds no such motion.
    """
    arc = ended_arc(problem, guess)
    point = on_duration(problem, guess, arc)
    return None if point is None else crossed(Monitor("duration", arc, 0, 0.0, 0.0), point)


def _without_events(monitor: Monitor, before: CurvePoint) -> SequenceChange:
    """The change in which the events of one stop vanish together with the arc between them."""
    problem, i, n = before.problem, monitor.arc, before.coordinates
    sequence, shares, events = problem.sequence, before.shares.tolist(), vanishing(problem.sequence, i)
    stop = sequence.stops[i] if sequence.stops[i] == sequence.stops[i - 1] else stop_of(sequence.stops[i])
    kind: ChangeKind = "end" if acts(sequence.states[i], stop) else "merge"
    if events is None:
        return SequenceChange(kind, (stop,), before, None)
    (gone, instead), time = events, sum(shares[:i])
    first, last = problem.group(gone[0]), problem.group(gone[-1])
    if {sequence.stops[k] for k in first} != {sequence.stops[k] for k in last} or (
        len(first) > 1 and lets_go(before, stop)
    ):
        return SequenceChange(kind, (stop,), before, None)
    gone = range(first[0], last[-1] + 1)
    kept = shares[gone[0] : gone[0] + len(instead)]
    shares[gone[0] : gone[-1] + 2] = [*kept, sum(shares[gone[0] + len(instead) : gone[-1] + 2])]
    order = (*sequence.stops[: gone[0]], *instead, *sequence.stops[gone[-1] + 1 :])
    fewer = len(gone) - len(instead)
    tied = frozenset(k if k < gone[0] else k - fewer for k in problem.tied if k not in gone)
    new = replace(problem, sequence=ContactSequence(sequence.first, order), tied=tied)
    monitor = Monitor("extremum", gone[0], stop, time, 0.0)
    guess = new.packed(before.u[:n], shares, before.value)
    return SequenceChange(kind, (stop,), before, at_graze(new, guess, monitor))


def at_graze(problem: BoundaryProblem, guess: FloatArray, monitor: Monitor) -> CurvePoint | None:
    """The point near a guess, shape (n + F + 1,), at which an extremum is zero; None if no zero is found.

    The tangent goes towards values of the extremum below zero.
    """
    near = nearest(problem, guess)
    its = None if near is None else same_monitor(near, monitor)
    if near is None or its is None:
        return None
    here, at, other = near, 0.0, SAME
    rate, widest = 0.0, 0.0  # rounding would decide between nearly equal values
    for _ in range(SECANTS):
        point = beside(near, other, exact=False)
        there = None if point is None else same_monitor(point, monitor)
        if point is None or (there is not None and there.value == its.value):
            return None
        if there is None:  # the extremum vanishes in this direction, at the start of its arc
            rate = -np.copysign(1.0, other)
            break
        slope = (there.value - its.value) / (other - at)
        if abs(other - at) > widest:
            rate, widest = slope, abs(other - at)
        if abs(there.value) < abs(its.value):
            here, at, its = point, other, there
        other = at - its.value / slope
        if abs(its.value) <= problem.resolution.options.grazing_tolerance or other == at:
            break
    if abs(its.value) > max(here.tolerance, abs(rate) * problem.resolution.options.newton_tolerance):
        return None
    return here if rate < 0 else here.turned()


def nearest(problem: BoundaryProblem, guess: FloatArray) -> CurvePoint | None:
    """The curve point nearest to a guess, shape (n + F + 1,), where no direction is known; None if Newton's method
    finds none."""
    scale = scale_of(problem, guess)
    J = problem.linearised(guess).jacobian * scale
    sizes = np.abs(J).max(axis=1)
    if not np.isfinite(sizes).all():  # in an arc of negative duration fast modes grow without bound
        return None
    row = np.linalg.svd(J / np.where(sizes > 0, sizes, 1.0)[:, None])[2][-1]
    return solved(problem, guess, scale, row)
