"""A whole branch from one of its motions: followed both ways, with its bifurcations, and what springs from them."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lapjoint.answers.branches import Bifurcation, Branch, BranchPoint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.bifurcations import Located, NotLocated, between
from lapjoint.orbits.branches.continuation import Graze, Jump, Limits, Run, follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.switching import sprung_from, switched
from lapjoint.orbits.branches.value_errors import Stated, graze_finder, smooth_finder, stated
from lapjoint.orbits.steady_state import periodic_state


@dataclass(frozen=True)
class Seed:
    """A motion from which a branch is followed."""

    value: float
    """The number, in its SI unit."""
    point: SectionPoint
    """Its section point."""
    count: int
    """Half periods after which it repeats."""
    away_from: tuple[float, SectionPoint] | None = None
    """The bifurcation from which its branch springs: the number, and the section point; None if none is known."""


@dataclass(frozen=True)
class Traced:
    """A branch, and the motions that lead to other branches."""

    branch: Branch
    """The branch."""
    seeds: tuple[Seed, ...]
    """A motion of each branch that springs from it."""
    springs: tuple[tuple[float, SectionPoint], ...] = ()
    """Bifurcations of other branches from which it springs, at either end: the number, and the section point."""


@in_one_thread
def trace(
    family: Family, seed: Seed, *, most_multiple: int, errors: bool = True, limits: Limits | None = None
) -> Traced | None:
    """The branch of a motion.

    Parameters
    ----------
    family : Family
        The period maps.
    seed : Seed
        The motion.
    most_multiple : int
        Largest period multiple of branches that are looked for where one springs from this.
    errors : bool
        Whether to estimate the errors of the bifurcations.
    limits : Limits, optional
        How far it is followed.

    Returns
    -------
    Traced, or None
        None if Newton's method does not find the motion again.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    limits = limits or Limits()
    start = _start(family, seed)
    if start is None:
        return None
    ahead, back = _both_ways(family, start, seed, limits)
    run = _joined(back, ahead)
    found = sorted(_bifurcations(family, run, errors), key=lambda pair: pair[0].index)
    points = tuple(_point(family, place) for place in run.places)
    seeds = []
    for _, place in found:
        if place is not None and place.count * 2 <= 2 * most_multiple:
            new = switched(family, place)
            if new is not None:
                seeds.append(Seed(new.value, new.point, new.count, (place.value, place.point)))
    branch = Branch(family.path, points, tuple(one for one, _ in found), (back.end, ahead.end))
    runs = [ahead] if seed.away_from is not None else [back, ahead]
    ends = [sprung_from(family, one.places[-1]) for one in runs if one.end == "bifurcation"]
    springs = (seed.away_from, *((one.value, one.point) for one in ends if one is not None))
    return Traced(branch, tuple(seeds), tuple(one for one in springs if one is not None))


def _start(family: Family, seed: Seed) -> Place | None:
    """The place of a seed, in the range: the shortest way to the curve may lead out of it from an end."""
    guess = family.adopted(seed.value, seed.point)
    if family.low < seed.value < family.high:
        found = corrected(family, seed.value, guess, seed.count)
        if found is None or family.low <= found.value <= family.high:
            return found
    return corrected(family, seed.value, guess, seed.count, fixed=True)


def _both_ways(family: Family, start: Place, seed: Seed, limits: Limits) -> tuple[Run, Run]:
    """The curve ahead of a place, and behind it: up and down the range, or away from a bifurcation and back to it."""
    up = np.append(np.zeros(start.tangent.size - 1), 1.0)
    if seed.away_from is not None:
        value, point = seed.away_from
        up = start.chord(family, replace(start, value=value, orbit=replace(start.orbit, point=point)))
    start, behind = start.along(up), start.along(-up)
    ahead = follow(family, start, limits)
    if seed.away_from is not None:
        return ahead, Run([behind], [], [], "bifurcation")
    if ahead.end == "closed":
        return ahead, Run([behind], [], [], "closed")
    left = replace(limits, most=max(limits.most - len(ahead.places), 1))
    return ahead, follow(family, behind, left)


def _joined(back: Run, ahead: Run) -> Run:
    """Two runs from one start as one, in the direction of the second."""
    turned = [place.turned() for place in reversed(back.places)]
    first = len(back.places)
    # A graze is at the place of its index, and a jump before it; what was before lies behind when it is turned.
    grazes = [replace(one, index=first - 1 - one.index) for one in back.grazes]
    jumps = [replace(one, index=first - one.index) for one in back.jumps]
    grazes += [replace(one, index=one.index + first - 1) for one in ahead.grazes]
    jumps += [replace(one, index=one.index + first - 1) for one in ahead.jumps]
    return Run([*turned, *ahead.places[1:]], grazes, jumps, ahead.end)


def _point(family: Family, place: Place) -> BranchPoint:
    solver = family.solver_at(place.value).name
    return BranchPoint(place.value, periodic_state(place.half_periods.map, solver, place.orbit, None))


def _bifurcations(family: Family, run: Run, errors: bool) -> Iterator[tuple[Bifurcation, Place | None]]:
    """Those of a run; with the place where a branch springs from it, if one does."""
    for graze in run.grazes:
        yield _grazing(family, graze, errors), None
    for jump in run.jumps:
        yield _unresolved(jump, jump.index), None
    apart = {jump.index for jump in run.jumps}
    for i, (a, b) in enumerate(pairwise(run.places)):
        if i + 1 in apart or a.extrema.closings != b.extrema.closings:
            continue
        for one in between(family, a, b, (_beside(run, i, i - 1, apart), _beside(run, i + 1, i + 2, apart))):
            if isinstance(one, NotLocated):
                yield _unresolved(one, i + 1), None
                continue
            yield _smooth(family, one, i + 1, errors), one.place if one.kind in _SPRINGING else None


def _beside(run: Run, here: int, other: int, apart: set[int]) -> Place | None:
    """The neighbour of a place, if the curve goes on smoothly to it."""
    if not 0 <= other < len(run.places) or max(here, other) in apart:
        return None
    same = run.places[other].extrema.closings == run.places[here].extrema.closings
    return run.places[other] if same else None


_SPRINGING = ("flip", "symmetry breaking")
"""Kinds of bifurcations from which a branch of periodic motions springs."""


def _unresolved(part: Jump | NotLocated, index: int) -> Bifurcation:
    return Bifurcation("unresolved", 0.5 * (part.first + part.last), 0.5 * abs(part.last - part.first), index)


def _smooth(family: Family, one: Located, index: int, errors: bool) -> Bifurcation:
    value = one.place.value
    known = stated(family, one.place, value, smooth_finder(one.kind)) if errors else Stated(value, np.inf)
    return Bifurcation(one.kind, known.value, known.error, index, impulses=_impulses(one.place))


def _grazing(family: Family, graze: Graze, errors: bool) -> Bifurcation:
    place, known = graze.before.place, Stated(graze.value, np.inf)
    if errors:
        known = stated(
            family, place, graze.value, graze_finder(graze.before.extremum, graze.rate, place.extrema.duration)
        )
    return Bifurcation("grazing", known.value, known.error, graze.index, graze.stop, graze.kind, _impulses(place))


def _impulses(place: Place) -> tuple[float, ...]:
    multiple = place.orbit.period_multiple
    passage = place.half_periods.map.march(place.point, 2 * multiple)
    return tuple((passage.impulses / multiple).tolist())
