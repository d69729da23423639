"""Motions that repeat in half of their time, and the branches that begin on them, at flips and broken symmetries.

Where a multiplier passes -1, a branch of motions with twice as many half periods begins (*springs*).  The first half of
a motion of this branch differs from the motion at the flip by the multiplier's eigenvector, its second half by the
opposite vector.  Where both branches meet again, this difference passes zero.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import product

import numpy as np

from lapjoint.orbits.arcs import ContactSequence, image_of
from lapjoint.orbits.branches.bifurcations import Stretch, beside, flip_test, located_in
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.point import SAME, CurvePoint, scale_of, solved
from lapjoint.orbits.branches.releases import vanishing
from lapjoint.orbits.branches.sequence_changes import (
    SequenceChange,
    ended_arc,
    nearest,
    on_duration,
    violated,
)
from lapjoint.problem import FloatArray
from lapjoint.problem.symmetry import mirror_twins

_AWAY = tuple(1e-2 * 0.5**k for k in range(14))
"""Arclengths from a bifurcation at which a motion of the springing branch is searched, in turn, each half of the
previous length.  At the first length there is a motion unless the branch is narrower, or grazes a stop before.  Much
nearer to a graze, rounding decides whether Newton's method finds a motion.  Each length is tried on both sides: the
motions there are images of each other, except for the part of a motion that the solver loses at a change of contact
state."""


def springing(point: CurvePoint) -> CurvePoint | None:
    """A motion of the branch that springs at a motion with a multiplier of -1; None if Newton's method finds none.

    The tangent of the new point leads away from the bifurcation.
    """
    problem, u, way = _doubled(point)
    scale = scale_of(problem, u)
    away = way / scale
    away /= np.linalg.norm(away)
    for length, row in product(_AWAY, (away, -away)):
        new = solved(problem, u + length * scale * row, scale, row)
        missed = None if new is None else half_difference(new)
        if missed is not None and float(np.linalg.norm(missed)) <= SAME * length / _AWAY[0]:
            continue  # the motion from which the branch springs, twice
        if new is not None and not violated(new):
            return new if float(new.tangent @ (row * scale / new.scale)) > 0 else new.turned()
    return None


def _doubled(point: CurvePoint) -> tuple[BoundaryProblem, FloatArray, FloatArray]:
    """The motion of a point, taken twice, and the direction in which a motion of twice the length differs from it."""
    problem, n, M = point.problem, point.coordinates, point.problem.events
    twins = mirror_twins(problem.arcs(point.u).problem) if problem.half_periods % 2 else None
    stops = problem.sequence.stops
    image = tuple(image_of(k, twins) for k in stops) if twins is not None else stops
    shares = point.shares
    J = point.linearisation.jacobian
    vector, moved = np.linalg.svd(point.linearisation.monodromy + np.eye(n))[2][-1], np.zeros(M + 1)
    if M:
        moved[problem.free] = -np.linalg.solve(J[n:, n:-1], J[n:, :n] @ vector)
        moved[-1] = -moved.sum()
    twice = [
        np.array([*one[:-1], one[-1] + sign * one[0], *(sign * one[1:])]) / 2
        for one, sign in ((shares, 1), (moved, -1))
    ]
    doubled = replace(
        problem,
        sequence=ContactSequence(problem.sequence.first, (*stops, *image)),
        half_periods=2 * problem.half_periods,
        tied=problem.tied | {k + M for k in problem.tied},
    )
    return doubled, doubled.packed(point.u[:n], twice[0], point.value), doubled.packed(vector, twice[1], 0.0)


def beside_graze(change: SequenceChange) -> CurvePoint | None:
    """A motion of twice the length near a graze, with the contact in one half only.

    At the graze the motion taken twice, with the contact of zero duration in one half only, solves the equations.  Most
    branches that spring there lead to a flip very near the graze, at which a motion of the branch is found anyway.  The
    search near the graze is therefore made only at the largest arclength that is tried at a flip.

    Parameters
    ----------
    change : SequenceChange
        The graze.

    Returns
    -------
    CurvePoint, or None
        The motion, with a tangent that leads away from the graze; None if none is found, or events are tied at the
        graze.
    """
    more = change.more
    if more is None or more.problem.tied or change.reverses is not None:
        return None
    problem, n, M = more.problem, more.coordinates, more.problem.events
    twins = mirror_twins(problem.arcs(more.u).problem) if problem.half_periods % 2 else None
    arc, stops, shares = ended_arc(problem, more.u), problem.sequence.stops, (more.shares / 2).tolist()
    image = [image_of(k, twins) for k in stops] if twins is not None else list(stops)
    events = vanishing(problem.sequence, arc)
    if events is None:
        return None
    twice = [*shares[:-1], shares[-1] + shares[0], *shares[1:]]
    gone, instead = events
    first, last = M + gone[0] + len(instead), M + gone[-1] + 2
    twice[first:last] = [sum(twice[first:last])]
    left = [k if twins is None else image_of(k, twins) for k in instead]
    order = ContactSequence(problem.sequence.first, (*stops, *image[: gone[0]], *left, *image[gone[-1] + 1 :]))
    doubled = replace(problem, sequence=order, half_periods=2 * problem.half_periods)
    graze = on_duration(doubled, doubled.packed(more.u[:n], np.array(twice), more.value), arc)
    new = None if graze is None else solved(doubled, graze.predicted(_AWAY[0]), graze.scale, graze.tangent)
    if graze is None or new is None or violated(new):
        return None
    return new if float(new.tangent @ (graze.tangent * graze.scale / new.scale)) > 0 else new.turned()


def half_difference(point: CurvePoint) -> FloatArray | None:
    """Difference between a motion at the section and half of its time later, in scaled coordinates, shape (n,).

    None if the contact sequences of both halves differ, or half of the time is no period of the problem.
    """
    problem, M = point.problem, point.problem.events
    half, odd = problem.half_periods // 2, problem.half_periods % 2
    twins = mirror_twins(problem.arcs(point.u).problem) if half % 2 else None
    if odd or M % 2 or (half % 2 and twins is None):
        return None
    stops, states = problem.sequence.stops, problem.sequence.states
    image = tuple(image_of(k, twins) for k in stops[: M // 2]) if twins is not None else stops[: M // 2]
    expected = states[0].mirrored(twins) if twins is not None else states[0]
    if stops[M // 2 :] != image or states[M // 2] != expected:
        return None
    arcs, chain = problem.arcs(point.u), point.linearisation.chain
    time, began = problem.time(point.u) + problem.length(point.u) / 2, float(chain.times[M // 2])
    there = arcs.later(states[M // 2], chain.starts[M // 2], began, time - began)
    n = point.coordinates
    return np.asarray(((-there if twins is not None else there) - point.u[:n]) / point.scale[:n])


def halves_exchange(here: CurvePoint, new: CurvePoint) -> bool:
    """Whether the difference of both halves passes zero between two points of a curve, where motions of half the time
    branch."""
    first, last = half_difference(here), half_difference(new)
    return first is not None and last is not None and float(first @ last) < 0


@dataclass(frozen=True)
class Meeting:
    """A point at which a branch meets the branch of motions that repeat in half of the time."""

    point: CurvePoint
    """The motion at the meeting, as a point of the branch that ends there."""
    mother: CurvePoint
    """The motion at the meeting, as a motion that repeats in half of the time, with the multiplier -1."""


def meeting(stretch: Stretch) -> Meeting | None:
    """The meeting of a branch with motions that repeat in half of the time, in a step or just beyond it, if any.

    At the meeting the equations of the branch are singular; the equations of the branch that flips are regular.  The
    part of a motion that the solver loses at a change of contact state connects both branches before the meeting, so
    that a curve followed in small steps never reaches the meeting.  The search therefore begins as soon as the
    difference of both halves is as small as at the points where a springing branch is searched.
    """
    first, last = half_difference(stretch.start), half_difference(stretch.end)
    if first is None or last is None or float(first @ last) >= float(first @ first):
        return None
    if float(first @ last) > 0 and float(np.linalg.norm(last)) > _AWAY[0]:
        return None
    share = float(first @ first) / float(first @ (first - last))
    across = (stretch.end.u - stretch.start.u) / stretch.start.scale
    guess = stretch.start.u + share * across * stretch.start.scale
    resolution = stretch.start.problem.resolution
    if not resolution.low <= guess[-1] <= resolution.high:
        return None
    near = nearest(*_halved(stretch.start.problem, guess))
    mother = None if near is None else _flip_beside(near, max(float(np.linalg.norm(across)), _AWAY[0]))
    if mother is None or violated(mother):
        return None
    problem, u, way = _doubled(mother)
    scale = scale_of(problem, u)
    tangent = way / scale
    tangent /= np.linalg.norm(tangent)
    return Meeting(CurvePoint(problem, u, scale, tangent, problem.linearised(u), stretch.start.orientation), mother)


def half_of(point: CurvePoint, same: float) -> CurvePoint | None:
    """A motion that repeats in half of its time, as a curve point of half the length; None if its halves differ by more
    than `same`.

    For a motion that grazes, the answer is a point beside the graze, if there is room.
    """
    missed = half_difference(point)
    if missed is None or float(np.linalg.norm(missed)) > same:
        return None
    half = nearest(*_halved(point.problem, point.u))
    if half is None or not violated(half):
        return half
    on_either_side = (beside(half, way) for length in _AWAY[1:] for way in (length, -length))
    return next((one for one in on_either_side if one is not None and not violated(one)), half)


def _halved(problem: BoundaryProblem, u: FloatArray) -> tuple[BoundaryProblem, FloatArray]:
    """The equations and unknowns of a motion that repeats in half of its time, over half of its time."""
    M, n = problem.events, problem.coordinates(u)
    sequence = ContactSequence(problem.sequence.first, problem.sequence.stops[: M // 2])
    tied = frozenset(k for k in problem.tied if k < M // 2)
    halved = replace(problem, sequence=sequence, half_periods=problem.half_periods // 2, tied=tied)
    return halved, halved.packed(u[:n], 2 * problem.shares(u)[: M // 2], u[-1])


def _flip_beside(point: CurvePoint, most: float) -> CurvePoint | None:
    """The nearest flip of a curve on either side of a point, at most the arclength `most` away."""
    length = _AWAY[-1]
    while length <= most:
        ends = [beside(point, way) for way in (-length, length)]
        if ends[0] is None or ends[1] is None:
            return None
        if flip_test(ends[0]) * flip_test(ends[1]) < 0:
            found = located_in(Stretch(point, ends[1], length), "flip", -length, length)
            return None if found is None else found[1]
        length *= 4
    return None
