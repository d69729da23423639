"""Pseudo-arclength continuation of periodic motions, from contact sequence to contact sequence.

A step predicts a point along the tangent; Newton's method then finds the curve in the hyperplane normal to the tangent.
Where the contact sequence becomes invalid within a step, the change is located, and the curve is continued with the
sequence after the change.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from lapjoint.orbits.branches.bifurcations import Stretch
from lapjoint.orbits.branches.halves import halves_exchange
from lapjoint.orbits.branches.point import CurvePoint, holding, resectioned, solved
from lapjoint.orbits.branches.sequence_changes import SequenceChange, at_once, crossed, first_change, nearest, violated


@dataclass(frozen=True)
class End:
    """Why a curve ends."""

    reason: str
    """``boundary`` at an end of the range, ``graze`` where the joint has no motion beyond a change of the contact
    sequence, ``contacts`` where contacts accumulate, ``lost`` where no step finds a further point."""


Step = Stretch | SequenceChange | End


def follow(start: CurvePoint) -> Iterator[Step]:
    """Follow a curve in the direction of a point's tangent: yield its steps and the changes between them, and finally
    its end.
    """
    options = start.problem.resolution.options
    here, step, last = start, options.first_step, None
    while step > options.smallest_step:
        new, at_boundary = _next(here, step)
        if new is None:
            step *= 0.5
            continue
        there = violated(new)
        if there and last is not None:  # monitors of the last change leave zero first
            step *= 0.5
            if step <= options.smallest_step:
                yield End("graze")
                return
            continue
        length = here.arclength(new)
        if there:
            located = first_change(here, new, length)
            if located is None:
                step *= 0.5
                continue
            last = crossed(*located)
            yield Stretch(here, last.before, here.arclength(last.before))
            yield last
            if last.reverses is not None:
                beyond = _beyond(last, last.reverses)
                if beyond is None:
                    yield End("graze")
                    return
                here, step, last = beyond, options.first_step, None
                continue
            for change in at_once(last):
                yield change
                last = change
            if last.after is None:
                break
            if last.after.problem.events > options.max_contacts:
                yield End("contacts")
                return
            here, step = centred(last.after), max(0.5 * step, options.first_step)
            continue
        yield Stretch(here, new, length)
        if at_boundary:
            yield End("boundary")
            return
        growth = options.turning / max(_angle(here, new), 0.5 * options.turning)
        step, last = min(step * max(growth, 0.5), options.largest_step), None
        here = centred(new)
    yield End("lost")


def _beyond(change: SequenceChange, arc: int) -> CurvePoint | None:
    """The first motion of the joint beyond a change whose new arc, while short, is on the wrong side of its stop.

    The solutions of the equations with a short arc are not motions of the joint.  None if no motion of the joint lies
    within the largest step of the curve.
    """
    here, stop = change.after, change.stops[0]
    assert here is not None
    options, gone = here.problem.resolution.options, 0.0
    step = options.first_step
    while gone < options.largest_step and step > options.smallest_step:
        new, at_boundary = _next(here, step)
        if new is None:
            step *= 0.5
            continue
        beyond = violated(new)
        if at_boundary or any((one.kind, one.stop) != ("extremum", stop) for one in beyond):
            return None
        if not beyond and new.entering(arc, stop)[0] > 0:
            return centred(new)
        here, gone, step = new, gone + step, 2 * step
    return None


def _next(here: CurvePoint, step: float) -> tuple[CurvePoint | None, bool]:
    """The point one step along a curve, or at the end of the range if that is nearer; and whether it is at the end."""
    resolution, value = here.problem.resolution, float(here.predicted(step)[-1])
    if resolution.low < value < resolution.high:
        new = stepped(here, step)
        if new is None or resolution.low <= new.value <= resolution.high:
            return new, False
        value = new.value
    boundary = resolution.low if value <= resolution.low else resolution.high
    return at_value(here, boundary, step), True


def at_value(here: CurvePoint, value: float, most: float) -> CurvePoint | None:
    """The curve point at a value of the parameter, in its SI unit, at most the arclength `most` ahead of `here`.

    None if Newton's method finds none, or the curve turns too much.
    """
    rate = float(here.tangent[-1] * here.scale[-1])
    length = (value - here.value) / rate if rate else most
    guess = here.predicted(min(max(length, 0.0), most))
    guess[-1] = value
    return _going_on(here, holding(here.problem, guess, guess.size - 1, here.scale))


def stepped(here: CurvePoint, length: float) -> CurvePoint | None:
    """The point one step of arclength `length`, of either sign, along a curve; None if none is found near the tangent.

    If a curve of constant curvature turns by an angle over the step, the distance from the tangent is half of the angle
    times the step.
    """
    guess = here.predicted(length)
    new = solved(here.problem, guess, here.scale, here.tangent)
    aside = 0.0 if new is None else float(np.linalg.norm((new.u - guess) / here.scale))
    return None if aside > here.problem.resolution.options.turning * abs(length) else _going_on(here, new)


def _going_on(here: CurvePoint, found: CurvePoint | None) -> CurvePoint | None:
    """`found` as the next point of a curve; None if it is on another part of the curve, or the curve turns too much.

    A point is on another part of the curve if its orientation differs, unless the curve has met the curve of motions
    that repeat in half of the time.  It is also on another part if the parameter changed against both tangents.
    """
    if found is None:
        return None
    new = found if _turn(here, found) > 0 else found.turned()
    if _angle(here, new) > 2 * here.problem.resolution.options.turning:
        return None
    if new.orientation != here.orientation and not halves_exchange(here, new):
        return None
    rates = here.tangent[-1], new.tangent[-1]
    if rates[0] * rates[1] > 0 and (new.value - here.value) * rates[0] < 0:
        return None
    return new


def _angle(here: CurvePoint, new: CurvePoint) -> float:
    """Angle between two tangents, rad."""
    return float(np.arccos(np.clip(_turn(here, new), -1.0, 1.0)))


def _turn(here: CurvePoint, new: CurvePoint) -> float:
    """Cosine of the angle between two tangents, in the scale of the first point."""
    other = new.tangent * new.scale / here.scale
    return float(here.tangent @ other / np.linalg.norm(other))


def centred(point: CurvePoint) -> CurvePoint:
    """The motion of a point, with its section moved to the middle of the longest arc if an event is near the section.

    The direction of the tangent along the curve is unchanged.
    """
    shares = point.shares
    if point.problem.events < 2:
        return point
    margin = point.problem.resolution.options.section_margin * (shares[0] + shares[-1])
    if min(shares[0], shares[-1]) >= margin > 0:
        return point
    problem, u, ahead = resectioned(point)
    found = nearest(problem, u)
    if found is None:
        return point
    return found if float(found.tangent @ (ahead / found.scale)) > 0 else found.turned()
