"""A bifurcation found again by another solver from a graze beside it.

Next to a graze a curve may turn within a millionth of its length.  Every solver has it so at the graze as it has that
itself, which may lie a hundred times as far off as the turn is long, and no motion nearby leads there.  So the motion
at the bifurcation is looked for as far from the other solver's graze as the first one has it from its own.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.carrier import Carrier
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Again, comes_back, with_same_contacts
from lapjoint.orbits.branches.found_along import around, directly, motion_at
from lapjoint.orbits.branches.grazing import beyond_graze, graze_near, seen_from_beyond
from lapjoint.orbits.branches.run import Graze

_SURE = 0.1
"""Arc length from where a bifurcation is expected, over that to the graze, within which it need not lead back."""


@dataclass(frozen=True)
class Beside:
    """A bifurcation beside a graze."""

    own: Family
    """The period maps of the solver that has both."""
    one: Located | Graze
    """The bifurcation."""
    graze: Graze
    """The graze."""

    @cached_property
    def _again(self) -> Again | None:
        """The graze once more by the solver that has it: a curve may be followed from the motion there."""
        return directly(self.graze)(self.own, self.graze.before.place)

    @cached_property
    def _seen(self) -> Graze | None:
        """The graze from its other side, if the motion before it touches already."""
        return seen_from_beyond(self.own, self.graze) if self.graze.before.touched else None

    def _graze_by(self, family: Family) -> Again | None:
        """The graze by another solver, from the motion before it, or as that comes to it from its other side."""
        mine, find = self.graze.before.place, directly(self.graze)
        if family.is_a_self_of(self.own):
            return find(family, mine)
        near = Carrier(self.own, mine).carried(family)
        its = None if near is None else find(family, near)
        if its is None:
            near = self._across(family)
            its = None if near is None else find(family, near)
        return its

    def _across(self, family: Family) -> Place | None:
        """A motion before the graze by another solver, which has gone across it from beyond."""
        seen = self._seen
        near = None if seen is None else Carrier(self.own, seen.before.place).carried(family)
        if seen is None or near is None:
            return None
        there = graze_near(family, near, seen.before, seen.rate)
        other = None if there is None else beyond_graze(family, there, seen.rate)
        return other.place if other is not None and other.place.closings == self.graze.before.place.closings else None

    def found_by(self, family: Family) -> Again | None:
        """The bifurcation by another solver.

        Parameters
        ----------
        family : Family
            The period maps of that one.

        Returns
        -------
        Again or None
            None if it does not find the graze, or from there not the bifurcation.
        """
        try:
            return self._found_by(family)
        except (InputError, SolverError):
            return None

    def _found_by(self, family: Family) -> Again | None:
        motion, mine = motion_at(self.one), self.graze.before.place
        its = self._graze_by(family)
        if its is None or self._again is None:
            return None
        own = self._again.place
        length = float(np.linalg.norm(mine.chord(self.own, motion)))
        ahead = _FromGraze(self.one, self.own, self.own, own, family, its.place, length)
        found = ahead.found_from(motion)
        if found is None:
            return None
        back = _FromGraze(self.one, self.own, family, its.place, self.own, own, length)
        way = float(np.linalg.norm(found.place.chord(family, ahead.guess(motion))))
        same = comes_back(
            way, self.own, motion, lambda: found.place, lambda _, place: back.found_from(place), _SURE * length
        )
        return found if same else None


@dataclass(frozen=True)
class _FromGraze:
    """The search for a bifurcation by another solver, from where a solver has it, shifted as a graze is."""

    one: Located | Graze
    """The bifurcation."""
    first: Family
    """The period maps of the solver that has this."""
    own: Family
    """The period maps of the one."""
    origin: Place
    """The motion at the graze, by the one."""
    other: Family
    """The period maps of the other."""
    there: Place
    """The motion at the graze, by the other."""
    length: float
    """Arc length from the graze to the bifurcation, about."""

    def guess(self, place: Place) -> Place:
        """What is as far from the other's motion at the graze as a place is from the one's."""
        value = place.value + self.there.value - self.origin.value
        half = self.other.at(value)
        end, begin = (half.map.adopted(Carrier(self.own, one).guess(self.other)) for one in (place, self.origin))
        point = half.map.moved(half.map.adopted(self.there.point), half.map.difference(end, begin))
        return replace(self.there.beginning_at(point), value=value, half_periods=half)

    def found_from(self, place: Place) -> Again | None:
        """The bifurcation, from where the one has it."""
        guess, motion = self.guess(place), motion_at(self.one)
        near = with_same_contacts(self.other, guess, like=motion)
        found = None if near is None else directly(self.one, self.first, like=motion)(self.other, near)
        return found or around(self.one, self.other, near or self.there, guess, self.length)
