"""A whole branch from one of its motions: followed both ways, with its bifurcations and the branches that begin
there."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import Bifurcation, Stretch, within
from lapjoint.orbits.branches.continuation import End, Step, at_value, follow
from lapjoint.orbits.branches.errors import carried
from lapjoint.orbits.branches.halves import beside_graze, half_of, meeting, springing
from lapjoint.orbits.branches.point import SAME, CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange, Resolution
from lapjoint.orbits.branches.sequence_changes import SequenceChange, is_grazing, nearest
from lapjoint.orbits.branches.starts import Start
from lapjoint.orbits.half_periods import HalfPeriods

_GONE_ROUND = 3
"""Least number of steps after which a curve may close to a ring."""


@dataclass(frozen=True)
class Limits:
    """Limits and options of following a branch."""

    max_points: float = np.inf
    """Largest number of its points."""
    progress: Callable[[float], None] | None = None
    """Called with the fraction of the range, or of the points, that is done."""
    from_grazes: bool = False
    """Whether motions of twice the length are searched near grazes."""


@dataclass(frozen=True)
class Found:
    """A bifurcation, or a graze, of a curve."""

    what: Bifurcation | SequenceChange
    """The bifurcation or the change of the contact sequence that was located."""
    index: int
    """Number of points of the curve before the bifurcation or graze."""
    after: str = ""
    """The behaviour of the curve beyond a graze: it ``persists``, ``folds``, ``ends`` or is ``lost``."""


@dataclass
class Way:
    """A curve followed in one direction."""

    points: list[CurvePoint]
    """Its points in order, from the start."""
    found: list[Found] = field(default_factory=list)
    """Its bifurcations and grazes, in sequence."""
    end: str = ""
    """Why the curve ends."""
    mother: Start | None = None
    """If the curve ends as ``bifurcation``, its last motion as a motion that repeats in half of the time; else None."""

    @property
    def ends_at_graze(self) -> bool:
        """Whether it ends at a graze."""
        return bool(self.found) and self.found[-1].after == "ends"

    def turned(self) -> Way:
        """The curve in the opposite direction, with the indices of its bifurcations counted from the opposite end."""
        count = len(self.points)
        found = [replace(one, index=count - one.index) for one in reversed(self.found)]
        return Way([point.turned() for point in reversed(self.points)], found, self.end, self.mother)


@dataclass(frozen=True)
class Traced:
    """A branch, and the motions that lead to other branches."""

    points: list[CurvePoint] = field(repr=False)
    """Its points in sequence."""
    found: list[Found]
    """Its bifurcations and grazes, in sequence."""
    ends: tuple[str, str]
    """Why the branch ends at its first and its last point."""
    starts: list[Start] = field(repr=False)
    """A motion of each branch that begins on this branch, and of the branch on which this branch begins."""
    springs: list[tuple[float, SectionPoint]] = field(repr=False)
    """The points at either end where the branch begins on another branch: the parameter, and the motion there."""
    unsprung: list[Bifurcation] = field(repr=False)
    """Bifurcations at which a branch begins, of which no motion was found."""


def trace(of: ParameterRange, start: Start, most_multiple: int, limits: Limits | None = None) -> Traced | None:
    """The branch of a motion; None if Newton's method does not find the motion again.

    `most_multiple` is the largest period multiple of the branches that spring from it.
    """
    limits = limits or Limits()
    first = start.solved(of)
    if first is None:
        return None
    ahead = one_way(of, first, limits)
    left = replace(limits, max_points=max(limits.max_points - len(ahead.points), 1))
    back = Way([first.turned()], end="closed") if ahead.end == "closed" else one_way(of, first.turned(), left)
    before = back.turned()
    shift = len(before.points) - 1
    found = [*before.found, *(replace(one, index=one.index + shift) for one in ahead.found)]
    starts, unsprung = _sprung([one.what for one in found], most_multiple, limits.from_grazes)
    springs = [] if start.away_from is None else [start.away_from]
    for way in (back, ahead):
        if way.mother is not None:
            if not limits.from_grazes or not way.ends_at_graze:
                springs.append((way.points[-1].value, way.points[-1].section()))
            starts.append(way.mother)
    return Traced([*before.points, *ahead.points[1:]], found, (back.end, ahead.end), starts, springs, unsprung)


def _sprung(
    found: list[Bifurcation | SequenceChange], most_multiple: int, from_grazes: bool
) -> tuple[list[Start], list[Bifurcation]]:
    """A motion of each branch that springs from a curve, and the bifurcations for which none was found.

    A flip may be so near a graze that a motion near both may belong to the branch of either; a motion found from a
    graze therefore records no bifurcation.
    """
    starts, unsprung = list[Start](), list[Bifurcation]()
    for what in found:
        mother = what.point if isinstance(what, Bifurcation) else what.fewer
        if mother.problem.half_periods > most_multiple:
            continue
        if isinstance(what, SequenceChange):
            new = beside_graze(what) if from_grazes else None
            starts += [] if new is None else [Start.at(new)]
        elif what.kind == "flip":
            new = springing(mother)
            starts += [] if new is None else [Start.at(new, (mother.value, mother.section()))]
            unsprung += [what] if new is None else []
    return starts, unsprung


def one_way(of: ParameterRange, start: CurvePoint, limits: Limits) -> Way:
    """A curve followed from a point in the direction of its tangent."""
    way, change, steps, seen = Way([start]), list[SequenceChange](), 0, list[SequenceChange]()
    for step in _through_zones(of, start):
        if isinstance(step, End):
            way.end = step.reason
            if change:
                way.found.append(Found(change.pop(), len(way.points), "ends" if way.end == "graze" else "lost"))
            break
        if isinstance(step, SequenceChange):
            if change:
                way.found.append(Found(change.pop(), len(way.points), "persists"))
            if any(_is_same_change(step, other) for other in seen):
                way.end = "lost"
                break
            seen.append(step)
            mother = None if step.after is None else half_of(step.after, SAME)
            if step.after is not None and mother is not None:
                way.found.append(Found(step, len(way.points), "ends"))
                way.points.append(step.after)
                way.end, way.mother = "bifurcation", replace(Start.at(mother), direction=None)
                break
            if step.kind != "exchange":
                change.append(step)
            continue
        met = meeting(step)
        if met is not None:
            step = Stretch(step.start, met.point, step.start.arclength(met.point))
        here = [one for one in within(step) if met is None or not _is_near(one, met.point)]
        here = [one for one in here if one.kind != "fold" or not is_grazing(one.point)]
        if change:
            turns = [one.point for one in here if one.kind == "fold"]
            way.found.append(Found(change[0], len(way.points), _after(change.pop(), [*turns, step.end][0])))
        way.found += [Found(one, len(way.points)) for one in here]
        if met is not None:
            way.points.append(met.point)
            way.end, way.mother = "bifurcation", replace(Start.at(met.mother), direction=None)
            break
        if step.end.problem.sequence is step.start.problem.sequence and not _is_at_change(step.end):
            way.points.append(step.end)
        steps += 1
        if steps > _GONE_ROUND and _closes(step, start):
            way.end = "closed"
            break
        if len(way.points) >= limits.max_points:
            way.end = "effort"
            break
        if limits.progress is not None:
            limits.progress(_share(of, way, limits))
    way.found.sort(key=lambda one: one.index)
    way.found = [one for i, one in enumerate(way.found) if not _is_truncation(one, way.found[max(i - 1, 0) : i + 2])]
    return way


def _is_truncation(one: Found, neighbours: list[Found]) -> bool:
    """Whether a bifurcation is nearer to a graze than the graze's offset, which is an error of truncation."""
    grazes = [other.what for other in neighbours if isinstance(other.what, SequenceChange)]
    what = one.what
    if not isinstance(what, Bifurcation):
        return False
    return any(abs(what.point.value - graze.value) <= graze.offset < np.inf for graze in grazes)


def _is_same_change(one: SequenceChange, other: SequenceChange) -> bool:
    """Whether two changes of the contact sequence are one, passed in either direction, so that the curve repeats
    itself."""
    if one.after is None or other.after is None or one.stops != other.stops:
        return False
    tolerance = one.before.problem.resolution.options.newton_tolerance
    events, others = (
        {change.before.problem.events, change.after.problem.events} for change in (one, other) if change.after
    )
    return events == others and abs(one.value - other.value) <= tolerance * one.before.scale[-1]


def _is_at_change(point: CurvePoint) -> bool:
    """Whether a point lies on a change of the contact sequence."""
    return bool((point.shares[point.problem.free[1:]] == 0).any())


def _is_near(one: Bifurcation, point: CurvePoint) -> bool:
    """Whether a bifurcation has the parameter of a point where two branches meet; one of the two then leaves it out."""
    return abs(one.point.value - point.value) <= SAME * point.problem.resolution.scale(point.value)


def _after(change: SequenceChange, next_: CurvePoint) -> str:
    """``persists`` if the parameter continues in its direction at a graze, else ``folds``."""
    came, goes = float(change.before.tangent[-1]), next_.value - change.value
    return "persists" if came * goes > 0 else "folds"


def _through_zones(of: ParameterRange, start: CurvePoint) -> Iterator[Step]:
    """Follow a curve, changing to the resolution that `of` prescribes for each part of the range."""
    here: CurvePoint | None = start
    while here is not None:
        steps, here = follow(here), None
        for step in steps:
            yield step
            if isinstance(step, Stretch):
                other = of.resolution(step.end.value)
                if other is not step.end.problem.resolution:
                    here = at_resolution(step.end, other)
                    if here is None:
                        yield End("lost")
                        return
                    break


def at_resolution(point: CurvePoint, resolution: Resolution) -> CurvePoint | None:
    """A motion at another resolution of its solver, its tangent in the same direction; None if it has no such
    motion."""
    try:
        guess = carried(point, resolution)
        other = None if guess is None else nearest(*guess)
    except (InputError, SolverError):
        return None
    if other is None:
        return None
    n, m = point.coordinates, other.coordinates
    same = float(point.tangent[n:] @ other.tangent[m:])
    return other if same >= 0 else other.turned()


def _closes(step: Stretch, start: CurvePoint) -> bool:
    """Whether a step passes the motion from which the curve started, or its image some periods later."""
    first, last = step.start.value - start.value, step.end.value - start.value
    if step.end.problem.events != start.problem.events or first * last > 0:
        return False
    there = at_value(step.start, start.value, abs(step.length))
    if there is None:
        return False
    half = HalfPeriods(start.problem.resolution.map(start.value))
    mine = start.section()
    try:
        return any(half.apart(half.map.adopted(image), mine) <= SAME for image in there.sections())
    except (InputError, SolverError):
        return False


def _share(of: ParameterRange, way: Way, limits: Limits) -> float:
    """Fraction of the range, or of the points allowed, that is done."""
    covered = abs(way.points[-1].value - way.points[0].value) / (of.high - of.low)
    return min(max(covered, len(way.points) / limits.max_points), 1.0)
