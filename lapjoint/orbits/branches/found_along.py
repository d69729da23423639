"""A bifurcation found again by another solver along its own curve, where the way from motion to motion does not lead.

Close to a graze the motion of one solver may touch a stop that the other's does not yet touch, and a secant cannot go
across.  A few places of the branch lie before and behind the bifurcation; from the nearest that the other solver has
too, with the same contacts, its own branch is followed, across grazes, until it has come past.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from lapjoint.orbits.branches.bifurcations import Located, criteria_of, located
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import NEAR, Again, Finder, graze_finder, is_same, smooth_finder
from lapjoint.orbits.branches.run import Graze, Limits, Run

_FROM = (1e-4, 1e-3, 1e-2)
"""Arc lengths to a bifurcation from which on a place of the branch may be where the other solver begins, in turn."""
_LOOKED_AT = 60
"""Most places of the branch, either way, among which these are looked for."""
_PAST = 3.0
"""Arc length followed by the other solver over that from where it begins to the bifurcation, at most."""
_MOST = 30
"""Most points of the other solver's curve: most bifurcations come within ten."""
_LONGER = 1.2
"""Largest ratio of a curve's length between two neighbours and of their distance: it turns by some 0.45 at most, which
makes it 1.02, and coordinates are scaled a little otherwise at each place."""
_PHASE = 0.05
"""Distance of the phases of one extremum by two solvers, at most."""


class Approach(NamedTuple):
    """A place from which a branch leads to a bifurcation."""

    place: Place
    """The place; its tangent points towards the bifurcation."""
    length: float
    """Arc length to there."""


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
            there = [] if run is None else list(_like(one, family, run, place))
            apart = [float(np.linalg.norm(other.place.chord(family, place))) for other in there]
            if there and min(apart) <= NEAR:
                return there[int(np.argmin(apart))]
        return None

    return find


def _like(one: Located | Graze, family: Family, run: Run, place: Place) -> Iterator[Again]:
    """Those bifurcations of a curve that may be a given one, and may lie near a place."""
    if isinstance(one, Graze):
        yield from (
            Again(other.before.place, other.value, other.left) for other in run.grazes if _same_graze(one, other)
        )
        return
    for _, a, b in run.smooth_parts:
        criterion = criteria_of(a)[one.kind]
        if criterion.count(a) != criterion.count(b) and _passes_by(family, a, b, place):
            found = located(family, a, b, criterion)
            if found is not None and is_same(one.kind, found, one.place):
                yield Again(found, found.value)


def _passes_by(family: Family, a: Place, b: Place, near: Place) -> bool:
    """Whether the curve between two neighbours, as long as it may be, may come closer than `NEAR` to a motion.

    What lies on it is at least as far from the motion as either end is, less the way from that end.
    """
    to_a, to_b, length = (float(np.linalg.norm(u.chord(family, v))) for u, v in ((a, near), (b, near), (b, a)))
    return to_a + to_b <= _LONGER * length + 2 * NEAR


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
    farthest = min(_PAST * start.length, start.length + 2 * NEAR)
    return follow(family, near.going_on_from(place), Limits(most=_MOST, length=farthest))
