"""A bifurcation found again by another solver along its own curve, where the way from motion to motion does not lead.

Close to a graze the motion of one solver may touch a stop that the other's does not yet touch, and a secant cannot go
across.  A few places of the branch lie before and behind the bifurcation; from the nearest that the other solver has
too, with the same contacts, its own branch is followed, across grazes, until it has come past.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from typing import NamedTuple, Protocol

import numpy as np

from lapjoint.orbits.branches.bifurcations import Located, NotLocated, between
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Again, Finder, graze_finder, is_same, smooth_finder
from lapjoint.orbits.branches.run import Graze, Limits, Run

_FROM = (1e-4, 1e-3, 1e-2)
"""Arc lengths to a bifurcation from which on a place of the branch may be where the other solver begins, in turn."""
_LOOKED_AT = 60
"""Most places of the branch, either way, among which these are looked for."""
_PAST = 3.0
"""Arc length followed by the other solver over that from where it begins to the bifurcation."""
_MOST = 30
"""Most points of the other solver's curve: most bifurcations come within ten."""
_NEAR = 3e-3
"""Arc length between a bifurcation as two solvers have it, at most: another of its kind may lie not far off."""
_PHASE = 0.05
"""Distance of the phases of one extremum by two solvers, at most."""


class Approach(NamedTuple):
    """A place from which a branch leads to a bifurcation."""

    place: Place
    """The place; its tangent points towards the bifurcation."""
    length: float
    """Arc length to there."""


def smooth_bifurcations(family: Family, run: Run) -> Iterator[tuple[int, Located | NotLocated]]:
    """The bifurcations on the smooth parts of a curve.

    Parameters
    ----------
    family : Family
        The period maps.
    run : Run
        The curve.

    Yields
    ------
    tuple of int and (Located or NotLocated)
        The index of the place that follows it, and the bifurcation.
    """
    apart = {jump.index for jump in run.jumps}
    for i, (a, b) in enumerate(pairwise(run.places)):
        if i + 1 not in apart and a.extrema.closings == b.extrema.closings:
            for one in between(family, a, b, (_beside(run, i, i - 1, apart), _beside(run, i + 1, i + 2, apart))):
                yield i + 1, one


def _beside(run: Run, here: int, other: int, apart: set[int]) -> Place | None:
    """The neighbour of a place, if the curve goes on smoothly to it."""
    if not 0 <= other < len(run.places) or max(here, other) in apart:
        return None
    same = run.places[other].extrema.closings == run.places[here].extrema.closings
    return run.places[other] if same else None


class Starts(Protocol):
    """Where a branch leads to a bifurcation."""

    @property
    def starts(self) -> Iterable[Approach]:
        """Places from which it does, in the sequence in which they are tried."""


@dataclass(frozen=True)
class Way:
    """The part of a branch about a bifurcation."""

    family: Family
    """The period maps."""
    run: Run
    """The branch."""
    before: int
    """Index of the place before the bifurcation."""
    after: int
    """Index of the place behind it."""

    @cached_property
    def starts(self) -> tuple[Approach, ...]:
        """Places from which the branch leads to it: those before it, the nearest first, then those behind it."""
        places = self.run.places
        ahead = approaches(self.family, [places[i] for i in self._connected(self.before, -1)])
        return ahead + approaches(self.family, [places[i].turned() for i in self._connected(self.after, 1)])

    def _connected(self, here: int, step: int) -> list[int]:
        """Indices from one on, one way, up to where the curve is not resolved."""
        apart, found = {jump.index for jump in self.run.jumps}, list[int]()
        while 0 <= here < len(self.run.places) and len(found) < _LOOKED_AT:
            found.append(here)
            if max(here, here + step) in apart:
                break
            here += step
        return found


def approaches(family: Family, places: Sequence[Place]) -> tuple[Approach, ...]:
    """Those of some places of a branch at which another solver may begin.

    Parameters
    ----------
    family : Family
        The period maps of the branch.
    places : sequence of Place
        In their sequence away from a bifurcation, with their tangents towards it.

    Returns
    -------
    tuple of Approach
        The nearest first.
    """
    found, length = list[Approach](), 0.0
    for i, place in enumerate(places):
        if i:
            length += float(np.linalg.norm(places[i - 1].chord(family, place)))
        if len(found) < len(_FROM) and length >= _FROM[len(found)]:
            found.append(Approach(place, length))
    return tuple(found)


def motion_at(one: Located | Graze) -> Place:
    """The motion at a bifurcation.

    Parameters
    ----------
    one : Located or Graze
        The bifurcation.

    Returns
    -------
    Place
        Just before it, if it is a graze.
    """
    return one.before.place if isinstance(one, Graze) else one.place


def directly(one: Located | Graze) -> Finder:
    """Finds a bifurcation by another solver from the motion there.

    Parameters
    ----------
    one : Located or Graze
        The bifurcation.

    Returns
    -------
    Finder
        The function.
    """
    if isinstance(one, Located):
        return smooth_finder(one.kind)
    return graze_finder(one.before.extremum, one.rate, one.before.place.extrema.duration)


def along(one: Located | Graze, starts: Starts) -> Finder:
    """Finds a bifurcation by another solver along the curve that this follows.

    Parameters
    ----------
    one : Located or Graze
        The bifurcation.
    starts : Starts
        From where it may be followed.

    Returns
    -------
    Finder
        The function.
    """

    def find(family: Family, place: Place) -> Again | None:
        for start in starts.starts:
            run = _followed(family, start)
            there = [] if run is None else list(_like(one, family, run))
            apart = [float(np.linalg.norm(other.place.chord(family, place))) for other in there]
            if there and min(apart) <= _NEAR:
                return there[int(np.argmin(apart))]
        return None

    return find


def _like(one: Located | Graze, family: Family, run: Run) -> Iterator[Again]:
    """Those bifurcations of a curve that may be a given one."""
    if isinstance(one, Graze):
        yield from (
            Again(other.before.place, other.value, other.left) for other in run.grazes if _same_graze(one, other)
        )
        return
    for _, other in smooth_bifurcations(family, run):
        if isinstance(other, Located) and other.kind == one.kind and is_same(one.kind, other.place, one.place):
            yield Again(other.place, other.place.value)


def _same_graze(one: Graze, other: Graze) -> bool:
    """Whether two grazes are one: of one extremum, and come to from the same side."""
    mine, its = one.before.extremum, other.before.extremum
    here, there = one.before.place.extrema, other.before.place.extrema
    later = its.time / there.duration - mine.time / here.duration
    same = (mine.stop, mine.highest, here.closings) == (its.stop, its.highest, there.closings)
    return same and abs(later - round(later)) <= _PHASE


def _followed(family: Family, start: Approach) -> Run | None:
    """The curve of another solver from a place of a branch on; None if that solver has no such motion there."""
    place = start.place
    near = corrected(family, place.value, family.adopted(place.value, place.point), place.count)
    if near is None or near.extrema.closings != place.extrema.closings:
        return None
    return follow(family, near.going_on_from(place), Limits(most=_MOST, length=_PAST * start.length))
