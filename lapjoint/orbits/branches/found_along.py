"""A bifurcation found again by another solver along its own curve, where the way from motion to motion does not lead.

Close to a graze the motion of one solver may touch a stop that the other's does not yet touch, and a secant cannot go
across.  A few places of the branch lie before and behind the bifurcation; from the nearest that the other solver has
too, with the same contacts, its own branch is followed, across grazes, until it has come past; from either side, as
the branch may have two of a kind close together, and the nearer one is meant.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import NamedTuple, Protocol

import numpy as np

from lapjoint.errors import SolverError
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import (
    NEAR,
    Again,
    Finder,
    graze_finder,
    is_same,
    smooth_finder,
    with_same_contacts,
)
from lapjoint.orbits.branches.locating import criteria_of, located
from lapjoint.orbits.branches.run import Graze, Limits, Run

_FROM = (1e-4, 1e-3, 1e-2)
"""Arc lengths to a bifurcation from which on a place of the branch may be where the other solver begins, in turn."""
_LOOKED_AT = 60
"""Most places of the branch, either way, among which these are looked for."""
_PAST = 3.0
"""Arc length followed by the other solver over that from where it begins to the bifurcation, at most."""
_MOST, _MARCHES = 30, 200
"""Most points of the other solver's curve, and marches for them, about: of 44 bifurcations the median came within six
points and 24 marches, and the last within fifteen and 146.  A curve that cannot cross a graze takes 800."""
_SHORT = 0.2
"""First step over the arc length to a bifurcation beside a graze: the curve may turn on the way."""
_LONGER = 1.2
"""Largest ratio of a curve's length between two neighbours and of their distance: it turns by some 0.45 at most, which
makes it 1.02, and coordinates are scaled a little otherwise at each place."""
_ABOUT = Limits(most=60, length=0.03)
"""How far the branch about a bifurcation is followed, either way: a little more than another solver needs."""
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
    def sides(self) -> Iterable[Iterable[Approach]]:
        """Places from which it does: before it, and behind it, each in the sequence in which they are tried."""


class About(Starts, Protocol):
    """The branch about a bifurcation."""

    @property
    def grazes(self) -> Iterable[Graze]:
        """Grazes of the branch beside the bifurcation, in the sequence in which it is looked for from them."""


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
    def sides(self) -> tuple[tuple[Approach, ...], ...]:
        """Places from which the branch leads to it: before it, and behind it, the nearest first."""
        places = self.run.places
        ahead = approaches(self.family, [places[i] for i in self._connected(self.before, -1)])
        return ahead, approaches(self.family, [places[i].turned() for i in self._connected(self.after, 1)])

    @property
    def grazes(self) -> tuple[Graze, ...]:
        """The last graze before the bifurcation, and the first one behind it, the nearer one first."""
        ahead = [(self.before - one.index, one) for one in self.run.grazes if one.index <= self.before]
        behind = [(one.index - self.after, one) for one in self.run.grazes if one.index >= self.after]
        nearest = [min(some, key=lambda it: it[0]) for some in (ahead, behind) if some]
        return tuple(one for _, one in sorted(nearest, key=lambda it: it[0]))

    def _connected(self, here: int, step: int) -> list[int]:
        """Indices from one on, one way, up to where the curve is not resolved."""
        apart, found = {jump.index for jump in self.run.jumps}, list[int]()
        while 0 <= here < len(self.run.places) and len(found) < _LOOKED_AT:
            found.append(here)
            if max(here, here + step) in apart:
                break
            here += step
        return found


@dataclass(frozen=True)
class Surroundings:
    """The branch about a bifurcation, followed when it is asked for."""

    family: Family
    """The period maps."""
    place: Place
    """The motion at the bifurcation."""

    @cached_property
    def sides(self) -> tuple[tuple[Approach, ...], ...]:
        """Places from which the branch leads to it: before it, and behind it, the nearest first."""
        return tuple(self._starts(run) for run in self._runs)

    def _starts(self, run: Run) -> tuple[Approach, ...]:
        """Those of one way."""
        apart = min((jump.index for jump in run.jumps), default=len(run.places))
        return approaches(self.family, [one.turned() for one in run.places[:apart]])

    @cached_property
    def grazes(self) -> tuple[Graze, ...]:
        """The first graze either way."""
        return tuple(run.grazes[0] for run in self._runs if run.grazes)

    @cached_property
    def _runs(self) -> tuple[Run, ...]:
        """The branch either way, as far as it can be followed."""
        return tuple(self._followed(place) for place in (self.place.turned(), self.place))

    def _followed(self, place: Place) -> Run:
        try:
            return follow(self.family, place, _ABOUT)
        except SolverError:
            return Run([place], [], [], "lost")


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


def directly(one: Located | Graze, own: Family | None = None, like: Place | None = None) -> Finder:
    """Finds a bifurcation by another solver from the motion there.

    Parameters
    ----------
    one : Located or Graze
        The bifurcation.
    own, like : Family and Place, optional
        As `smooth_finder` has them.

    Returns
    -------
    Finder
        The function.
    """
    if isinstance(one, Located):
        return smooth_finder(one.kind, like, own)
    return graze_finder(one.before, one.rate)


def along(one: Located | Graze, starts: Starts) -> Finder:
    """Finds a bifurcation by another solver along the curve that this follows.

    It is looked for from both sides: where a curve turns twice, another of the same kind lies on the way from one.

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
        looks = [look for side in starts.sides if (look := _looked(one, family, place, side)) is not None]
        return min(looks, key=lambda look: look.apart).found if looks else None

    return find


def _looked(one: Located | Graze, family: Family, place: Place, side: Iterable[Approach]) -> _Look | None:
    """The first look from one side that finds a bifurcation; None if none does."""
    for start in side:
        look = _Look(one, family, place)
        _follow(family, start, look)
        if look.found is not None:
            return look
    return None


def around(one: Located | Graze, family: Family, start: Place, near: Place, length: float) -> Again | None:
    """Find a bifurcation by another solver along its curve, both ways from one of its motions, in short steps.

    Parameters
    ----------
    one : Located or Graze
        The bifurcation, by the solver that has it.
    family : Family
        The period maps of the other solver.
    start : Place
        The motion at which the other solver begins.
    near : Place
        Where the bifurcation is looked for.
    length : float
        Arc length from the one to the other, about.

    Returns
    -------
    Again or None
        The one nearest to there.
    """
    looks = list[_Look]()
    for place in (start, start.turned()):
        looks.append(look := _Look(one, family, near))
        limits = Limits(_MOST, _PAST * length, _SHORT * length, _MARCHES, enough=look)
        look(follow(family, place, limits))
    return min(looks, key=lambda look: look.apart).found


class _Look:
    """Looks at a curve while it is followed for the bifurcation that is nearest to where it is looked for.

    Parameters
    ----------
    one : Located or Graze
        The bifurcation, by the solver that has it.
    family : Family
        The period maps of the solver whose curve it is.
    place : Place
        Where it is looked for.
    """

    def __init__(self, one: Located | Graze, family: Family, place: Place) -> None:
        self._one, self._family, self._place = one, family, place
        self._places, self._grazes, self.apart = 1, 0, math.inf
        self.found: Again | None = None
        """What it has found, within `NEAR`; `apart` is how far off."""

    def __call__(self, run: Run) -> bool:
        """Look at what is new of a curve; whether what has been found is nearer than where the curve has come to."""
        for other in self._new(run):
            apart = self._away(other.place)
            if apart <= min(self.apart, NEAR):
                self.found, self.apart = other, apart
        return self.found is not None and self._away(run.places[-1]) > self.apart

    def _away(self, place: Place) -> float:
        return float(np.linalg.norm(place.chord(self._family, self._place)))

    def _new(self, run: Run) -> Iterator[Again]:
        """Bifurcations that may be the one that is looked for, and may lie near its place."""
        grazes, self._grazes = run.grazes[self._grazes :], len(run.grazes)
        first, self._places = self._places, len(run.places)
        one = self._one
        if isinstance(one, Graze):
            yield from (Again(it.before.place, it.value, it.left) for it in grazes if same_graze(one, it))
            return
        for i, a, b in run.smooth_parts:
            criterion = criteria_of(a)[one.kind]
            if i >= first and criterion.changes(a, b) and _passes_by(self._family, a, b, self._place):
                found = located(self._family, a, b, criterion)
                if found is not None and is_same(one.kind, found, one.place):
                    yield Again(found, found.value)


def _passes_by(family: Family, a: Place, b: Place, near: Place) -> bool:
    """Whether the curve between two neighbours, as long as it may be, may come closer than `NEAR` to a motion.

    What lies on it is at least as far from the motion as either end is, less the way from that end.
    """
    to_a, to_b, length = (float(np.linalg.norm(u.chord(family, v))) for u, v in ((a, near), (b, near), (b, a)))
    return to_a + to_b <= _LONGER * length + 2 * NEAR


def same_graze(one: Graze, other: Graze) -> bool:
    """Whether two grazes are one: of one extremum, and come to from the same side, or from the other.

    Parameters
    ----------
    one, other : Graze
        The two, of one solver or of two.

    Returns
    -------
    bool
        Whether they are.
    """
    mine, its = one.before.extremum, other.before.extremum
    here, there = one.before.place.extrema, other.before.place.extrema
    later = its.time / there.duration - mine.time / here.duration
    same = (mine.stop, mine.highest) == (its.stop, its.highest) and there.closings in one.before.closings_of_sides
    return same and abs(later - round(later)) <= _PHASE


def _follow(family: Family, start: Approach, look: _Look) -> None:
    """Look along the curve of another solver from a place of a branch on, if that solver has such a motion there."""
    near = with_same_contacts(family, start.place)
    if near is not None:
        farthest = min(_PAST * start.length, start.length + 2 * NEAR)
        look(follow(family, near, Limits(most=_MOST, length=farthest, marches=_MARCHES, enough=look)))
