"""Whether a curve has come back to where it was, or to an image of that: the same motion, some half periods later.

A motion of ``count`` half periods has as many section points, or half as many where the problem is not its own mirror
image.  A closed curve may lead from one of them to another, and only after several rounds to the first again.  So each
of them is looked for between two neighbouring places: near the chord, and then on the curve itself.
"""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.locating import between_two
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.problem import FloatArray

SAME = 1e-5
"""Distance of two motions over their size, up to which they are one."""
_BESIDE = 0.3
"""Distance from a chord over its length within which the curve may pass: it turns by half of this between places."""
_ABOUT = 0.01
"""Distance of a section point over the motion's size up to which it may be off before Newton's method is asked for it:
multipliers of 1e4 make that of what the first one is off, and 1e-9 is allowed."""
_SLIDES = 4
"""Most steps along the curve to where it is nearest: each leaves the square of the way."""
_CLOSER = 0.01
"""How near a curve must come to a motion again, over how far it has been from it: beside a graze a ring may be 7e-5
long, and a curve may pass a few 1e-6 of its size beside where it was."""
_MARK, _FARTHER = 100, 2
"""Number of the first place, besides the start, to which a curve may come back, and the ratio of each next to it."""


def images_of(half: HalfPeriods, point: SectionPoint, count: int) -> list[SectionPoint]:
    """The section points of a motion, and those of its mirror image where the problem is its own.

    Parameters
    ----------
    half : HalfPeriods
        The map.
    point : SectionPoint
        One of them.
    count : int
        Half periods after which the motion repeats.

    Returns
    -------
    list of SectionPoint
        The one that is given is the first.
    """
    found = [point]
    for _ in range(1, count // half.least):
        found.append(half.marched(found[-1], half.least))
    return found


def begun_anywhere(place: Place) -> tuple[Place, ...]:
    """A motion, and its mirror image where the problem is its own, from each of the section points on.

    Parameters
    ----------
    place : Place
        The motion.

    Returns
    -------
    tuple of Place
        The one that is given is the first; the others are as marches from there have them, which leave unstable ones.
    """
    _, *others = images_of(place.half_periods, place.point, place.count)
    return place, *(place.beginning_at(point) for point in others)


@dataclass(frozen=True)
class Start:
    """Where a curve begins."""

    family: Family
    """The period maps."""
    place: Place
    """The place."""
    itself: bool = False
    """Whether only this section point of the motion counts."""

    @cached_property
    def _about(self) -> tuple[Place, ...]:
        """About the place at each of the motion's section points, as an unstable motion is left soon."""
        return (self.place,) if self.itself else begun_anywhere(self.place)

    @cached_property
    def _exact(self) -> dict[int, Place]:
        """The place at some of them, by their numbers; its tangent is that of the first."""
        return {0: self.place}

    def _image(self, k: int) -> Place:
        """The place at one of the section points."""
        if k not in self._exact:
            about, first = self._about[k], self.place
            exact = corrected(self.family, first.value, about.point, first.count, fixed=True)
            self._exact[k] = about if exact is None else first.beginning_at(exact.point)
        return self._exact[k]

    @cached_property
    def _closings(self) -> list[int]:
        """How often stops close: the same for all images, though not for the same stops."""
        return sorted(self.place.closings)

    def between(self, a: Place, b: Place, same: float = SAME) -> Place | None:
        """The place of the curve, between two neighbours, that is an image of its start.

        Parameters
        ----------
        a, b : Place
            The neighbours, with tangents in one direction.
        same : float
            Distance of two motions over their size, up to which they are one.

        Returns
        -------
        Place, or None
            None if there is none.
        """
        if a.closings != b.closings or sorted(a.closings) != self._closings:
            return None
        chord = b.chord(self.family, a)
        length = float(np.linalg.norm(chord))
        if not length or abs(b.value - self.place.value) > (1 + _BESIDE) * length * self.family.scale(b.value):
            return None
        for k, about in enumerate(self._about):
            if self._share(about, b, chord, same, _ABOUT) is None:
                continue
            image = self._image(k)
            share = self._share(image, b, chord, same)
            found = None if share is None else between_two(self.family, a, b, share, length)
            there = self._on_curve(found, a, image, same)
            if there is not None:
                return there
        return None

    def _share(self, image: Place, b: Place, chord: FloatArray, same: float, off: float = 0.0) -> float | None:
        """How far along a chord that ends at `b` an image is, which may be `off`; None if it is not beside that."""
        length, left = float(np.linalg.norm(chord)), b.chord(self.family, image)
        share, beyond = 1 - float(left @ chord) / length**2, (same + off) / length
        aside = float(np.linalg.norm(left - (1 - share) * chord))
        return share if -beyond <= share <= 1 + beyond and aside <= _BESIDE * length + off else None

    def _on_curve(self, here: Place | None, like: Place, image: Place, same: float) -> Place | None:
        """The place of the curve that is nearest to an image, if it is the image, and not beyond a graze."""
        for _ in range(_SLIDES):
            if here is None:
                return None
            way = -here.chord(self.family, image)
            if float(np.linalg.norm(way)) <= same:
                return here if here.closings == like.closings else None
            value, guess = here.moved(self.family, float(way @ here.tangent) * here.tangent)
            found = corrected(self.family, value, guess, here.count)
            here = None if found is None else found.along(here.tangent)
        return None


def has_been_at(family: Family, places: Sequence[Place], place: Place, same: float = SAME) -> bool:
    """Whether a curve has been at a place before.

    Parameters
    ----------
    family : Family
        The period maps.
    places : sequence of Place
        The curve so far.
    place : Place
        The place, or an image of it.
    same : float
        Distance of two motions over their size, up to which they are one.

    Returns
    -------
    bool
        Whether it has: what leads there leads round in a ring for ever.
    """
    there = Start(family, place)
    return any(there.between(a, b, same) is not None for a, b in pairwise(places))


def is_back_where_it_was(family: Family, places: Sequence[Place], before: int) -> bool:
    """Whether the last of some places lies where a curve had been up to one of them, however little way is between.

    Parameters
    ----------
    family : Family
        The period maps.
    places : sequence of Place
        The curve so far.
    before : int
        Number of the places up to there.

    Returns
    -------
    bool
        Whether it lies far nearer to these than those between lead away.
    """
    here = places[-1]
    away = max((float(np.linalg.norm(place.chord(family, here))) for place in places[before:]), default=0.0)
    return has_been_at(family, places[:before], here, min(SAME, _CLOSER * away))


@dataclass
class _Away:
    """A curve that has been at a place, and goes on."""

    family: Family
    """The period maps."""
    mark: Start
    """The place."""
    farthest: float = 0.0
    """How far it has been from there, over the motion's size, up to where that no longer matters."""

    def back(self, a: Place, b: Place, connected: bool = True) -> Place | None:
        """The place between two neighbours at which the curve is back; to be asked for each two in turn.

        Parameters
        ----------
        a, b : Place
            The neighbours.
        connected : bool
            Whether a curve leads from one to the other.

        Returns
        -------
        Place, or None
            None if it is not, or has hardly been away.
        """
        if self.farthest * _CLOSER < SAME:
            self.farthest = max(self.farthest, float(np.linalg.norm(a.chord(self.family, self.mark.place))))
        near = min(SAME, _CLOSER * self.farthest)
        return self.mark.between(a, b, near) if connected and self.farthest > SAME else None


class Marks:
    """Where a curve under way may come back to: its start, and a place of it that is chosen anew ever farther along.

    Beyond a graze that cannot be resolved it may come to a ring on which its start does not lie.

    Parameters
    ----------
    family : Family
        The period maps.
    start : Place
        Where the curve begins.
    """

    def __init__(self, family: Family, start: Place) -> None:
        self._family = family
        self._marks, self._next = {0: self._from(start)}, _MARK

    def _from(self, place: Place) -> _Away:
        return _Away(self._family, Start(self._family, place))

    def forget_from(self, index: int) -> None:
        """Forget the marks at places that are no more of the curve: those with this index, and behind.

        Parameters
        ----------
        index : int
            Number of places that are left.
        """
        self._marks = {own: mark for own, mark in self._marks.items() if own < index}

    def come_back(self, places: Sequence[Place], i: int, connected: bool) -> tuple[int, Place] | None:
        """Whether a curve has been before where it is between two neighbouring places.

        Parameters
        ----------
        places : sequence of Place
            The curve so far.
        i : int
            Index of the first of the two; to be asked for each in turn.
        connected : bool
            Whether a curve leads from one to the other: across a part that was left out it comes back to nothing.

        Returns
        -------
        tuple of int and Place, or None
            The place with which the curve is gone round once, and the index of the one before that.
        """
        if i == self._next:
            self._marks = {0: self._marks[0], i: self._from(places[i])}
            self._next = _FARTHER * i
        for index, mark in self._marks.items():
            back = mark.back(places[i], places[i + 1], connected) if i > index else None
            if back is not None:
                return self._once_around(places, index, i) or (i, back)
        return None

    def _once_around(self, places: Sequence[Place], index: int, i: int) -> tuple[int, Place] | None:
        """Where a curve that comes back to a mark came back to where it entered the ring, maybe long before.

        Behind a part that was left out it may enter a ring anywhere; from there on, all places lie on it.
        """
        ring = places[index : i + 2]
        entered = bisect_left(range(index), True, key=lambda k: has_been_at(self._family, ring, places[k]))
        away = self._from(places[entered])
        returns = ((k, away.back(places[k], places[k + 1])) for k in range(entered, i + 1))
        return next(((k, there) for k, there in returns if there is not None), None)
