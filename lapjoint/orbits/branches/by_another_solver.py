"""A bifurcation that one solver has, looked for by another, from the first one's motions as sampled shapes.

The other solver finds it by its own marches, derivatives and multipliers.  Of its selves, each finer than the one
before, a finer one begins, as its motion is nearer to that of the first solver; the next coarser one begins from the
finer one's motion, and how far apart both are gives the error; if that one alone lacks it, one coarser still does.  The
first solver's number decides only which two are asked first.  Where the motion touches at a graze already, they begin
on its other side.  Where none comes from the motion at the bifurcation, they follow the curve from motions beside it,
or begin at the graze next to it as they have that; they begin there at once where that is very near.

A bifurcation that the next finer self of the first solver does not find is looked for in the same way by its selves.
"""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.carrier import Carrier
from lapjoint.orbits.branches.closing import begun_anywhere
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import NEAR, Again, comes_back, leads_back
from lapjoint.orbits.branches.found_along import Approach, Starts, along, directly, motion_at, same_graze
from lapjoint.orbits.branches.found_beside import Beside
from lapjoint.orbits.branches.grazing import one_contact_apart, seen_from_beyond
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.passings import rates_of
from lapjoint.orbits.branches.run import Graze
from lapjoint.orbits.branches.springing import Springing, spring_of, springing
from lapjoint.orbits.branches.value_errors import AIM, Stated, apart_by
from lapjoint.orbits.refinement import ROUNDING, Refinement, one_after_other

_BACK = (0.0, 1e-5, 1e-4, 1e-3)
"""Arc lengths before a bifurcation from which it is looked for, in turn: a graze may come before for another solver."""
_SURE = 3e-4
"""Arc length within which what another solver finds on a smooth part is not asked to lead back: a flip 1e-3 off was
taken for another, and motions on the other side of a graze are not carried back."""
_CLOSE = 2e-5
"""Arc length to a graze, as its rate has it, within which a bifurcation is looked for from there first: two solvers
have most of them some 1e-5 apart."""
_ALONG = 2
"""Number of the first self that follows the curve, the coarsest being 0: of coarser ones it often leads elsewhere."""
_FINER, _FOLLOWED = 6, 5
"""Most finer selves that are asked unless said otherwise, and which is the last that follows its own curve: for the
paper's joint, 40, 61, 91, 137, 206, 309 and 464 elements.  Where a graze is near, the finer ones cost less than what
the coarser ones look for in vain; the last has a flip 7.6e-8 rad/s from a fold that only one other has."""


def by_another(
    one: Listed, family: Family, finer: int = _FINER, followed: int = _FOLLOWED, marches: float = np.inf
) -> Stated | None:
    """A bifurcation's value, with its error, by another solver.

    Parameters
    ----------
    one : Listed
        The bifurcation, and what was found, by the first solver.
    family : Family
        The period maps of the other solver.
    finer : int
        Most finer selves of it that are asked.
    followed : int
        Number of the finest of these that follows its own curve, the coarsest being 0.
    marches : float
        Number of marches by all of them after which nothing else is tried.

    Returns
    -------
    Stated or None
        The value of the finer of two selves that agree; with an infinite error where only one finds it; None if none
        does.
    """
    try:
        return _Search(one, family, finer, followed, marches).run()
    except (InputError, SolverError):
        return None


@dataclass
class _Search:
    """The search for one bifurcation."""

    one: Listed
    family: Family
    finer: int = _FINER
    followed: int = _FOLLOWED
    marches: float = np.inf
    before: dict[float, Carrier | None] = field(default_factory=dict)
    """Motions of the first solver before the bifurcation, by the arc length to it."""
    found: dict[int, Again] = field(default_factory=dict)
    """What each self has found, by its number, the coarsest first."""
    missed: set[int] = field(default_factory=set)
    """Which selves have looked for it from the motions of the first solver, and not found it so."""
    came_past: dict[int, Again | None] = field(default_factory=dict)
    """What each self has found along its own curve."""

    def __post_init__(self) -> None:
        assert self.one.found is not None
        self.motion, self.direct = motion_at(self.one.found), directly(self.one.found)
        # Where the other solver's motion is not critical yet:
        self.from_motion = directly(self.one.found, self.one.family, like=self.motion)
        self.selves, self.known = [self.family], list[Refinement]()
        while len(self.known) < self.finer and (finer := self.selves[-1].finer(self.motion.value)) is not None:
            self.known.append(finer[0])
            self.selves.append(finer[1])
        self.marches += self._marched

    def run(self) -> Stated | None:
        """From beyond it, from the motion at it, along the curve of the other solver, or from a graze beside it.

        A finer self of the first solver has looked for it from that motion already.  Where a graze is closer than the
        solvers have it to each other, it is looked for from there at once.
        """
        ways = [] if self._is_own else [self._from_beyond, self._direct]
        ways += [self._along, self._beside]
        if self._is_close_to_a_graze:
            ways.insert(0, ways.pop())
        best: Stated | None = None
        for way in ways:
            best = _surer(best, way())
            if self._is_spent or (best is not None and np.isfinite(best.error)):
                break
        return best

    @cached_property
    def _motions(self) -> list[list[Carrier]]:
        """The first solver's motion at the bifurcation, and those at its rivals, each begun anywhere."""
        places = (self.motion, *self.one.rivals)
        return [[Carrier(self.one.family, one) for one in begun_anywhere(place)] for place in places]

    @property
    def _is_own(self) -> bool:
        """Whether finer selves of the first solver are asked."""
        return self.family.is_a_self_of(self.one.family)

    @property
    def _is_spent(self) -> bool:
        """Whether there have been as many marches as there may be."""
        return self._marched >= self.marches

    @property
    def _marched(self) -> int:
        """How many marches all selves have made so far."""
        return sum(family.marches for family in self.selves)

    @property
    def _is_close_to_a_graze(self) -> bool:
        """Whether another graze lies closer to the bifurcation than both solvers have it."""
        if isinstance(self.one.found, Graze):
            return False
        try:
            rates = rates_of(self.one.family, self.motion).value
        except SolverError:
            return False
        return bool(((rates != 0) & (np.abs(self.motion.extrema.value) <= _CLOSE * np.abs(rates))).any())

    def _direct(self) -> Stated | None:
        """From the motion at the bifurcation: by a self and the next finer one, up to the finest."""
        if not self.known:
            alone = self._at_motion(0)
            return None if alone is None else self._stated(0, alone, None)
        best, last = None, len(self.known)
        for i in range(1, last + 1):
            here = self._at_motion(i) or self._from_coarser(i)
            if here is None or (i < last and (i - 1 in self.missed or self._will_not_do(i, here))):
                continue
            best = _surer(self._by_two(i, here), best)
            if self._is_sure(best):
                return best
        if best is None and self.found:
            i = max(self.found)
            best = self._by_two(i, self.found[i])
        return best

    def _by_two(self, i: int, here: Again) -> Stated:
        """What a self has found, with its error by the next coarser one, or by one coarser still if that lacks it."""
        coarser = self._again(i - 1, here)
        if coarser is None and i > 1 and (farther := self._at_motion(i - 2)) is not None:
            found = self._stated(i, here, farther, 2)
            if self._is_sure(found):
                return found
        return self._stated(i, here, coarser)

    def _is_sure(self, found: Stated | None) -> bool:
        """Whether the error is as small as is aimed at."""
        return found is not None and found.error <= AIM * self.family.scale(found.value)

    def _will_not_do(self, i: int, here: Again) -> bool:
        """Whether the next coarser self will differ by too much, as the first solver's number has it."""
        refinement, error = self.known[i - 1], abs(here.value - self.one.bifurcation.value)
        difference = error * (refinement.ratio**refinement.order - 1)
        return apart_by(refinement, difference) > AIM * self.family.scale(here.value)

    def _stated(self, i: int, here: Again, coarser: Again | None, by: int = 1) -> Stated:
        """What a self has found, with the error of one that is coarser by so many."""
        if coarser is None:
            return Stated(here.value, np.inf)
        bound = apart_by(one_after_other(self.known[i - by : i]), here.value - coarser.value)
        return Stated(here.value, bound + here.left + ROUNDING * self.family.scale(here.value))

    def _at_motion(self, i: int) -> Again | None:
        """What a self finds from the motion of the first solver at the bifurcation, or a little before it."""
        if i in self.found or i in self.missed:
            return self.found.get(i)
        self.missed.add(i)
        for back in _BACK:
            before = self._before(back)
            near = None if before is None else before.carried(self.selves[i])
            if near is not None:
                found = self.from_motion(self.selves[i], near)
                return self._kept(i, found if found is not None and self._is_it(i, near, found) else None)
        return None

    def _is_it(self, i: int, near: Place, found: Again) -> bool:
        """Whether what a self finds is the bifurcation, and not a neighbour: from there, the first solver finds it."""
        beyond = self._contacts_beyond(found.place)
        if beyond is None:
            return False
        if not self._is_nearest(i, found):
            self._forget_coarser(i)
            return False
        way = float(np.linalg.norm(found.place.chord(self.selves[i], near)))
        there = Carrier(self.selves[i], found.place)
        sure = 0.0 if beyond else NEAR if isinstance(self.one.found, Graze) else _SURE
        own = self.one.family
        return comes_back(way, own, self.motion, lambda: there.carried(own), self.from_motion, sure)

    def _forget_coarser(self, i: int) -> None:
        """Take for missed what coarser selves than one that comes to a rival have found: it may be that rival."""
        for k in [k for k in self.found if k < i]:
            del self.found[k]
            self.missed.add(k)

    def _is_nearest(self, i: int, found: Again, spring: Springing | None = None) -> bool:
        """Whether what a self has found is nearer to the first solver's motion than to those at its rivals.

        One that repeats sooner is of the branch from which that of the first solver springs.
        """
        if found.place.repeats_sooner_than(self.motion):
            return False
        if not self.one.rivals:
            return True
        family = self.selves[i]

        def away(one: Carrier) -> float:
            there = one.seen_by(family) if spring is None else spring.expected(one)
            return float(np.linalg.norm(found.place.chord(family, there)))

        mine, *others = (min(map(away, motion)) for motion in self._motions)
        return mine <= min(others)

    def _contacts_beyond(self, place: Place) -> bool | None:
        """Whether a motion has the contacts of those beyond the graze, instead of before; None if it has neither."""
        if place.closings == self.motion.closings:
            return False
        return True if isinstance(self.one.found, Graze) and one_contact_apart(self.one.found, place) else None

    def _again(self, i: int, finer: Again) -> Again | None:
        """What a self finds from the motion of the next finer one."""
        if i not in self.found:
            self._from_another(i, i + 1, finer)
        return self._at_motion(i)

    def _from_coarser(self, i: int) -> Again | None:
        """What a self finds from what the next coarser one has found."""
        coarser = self.found.get(i - 1)
        return None if coarser is None else self._from_another(i, i - 1, coarser)

    def _from_another(self, i: int, other: int, there: Again) -> Again | None:
        """What a self finds from what another one has found, if it leads back to that."""
        found = self.direct(self.selves[i], there.place)
        if found is None or not leads_back(self.selves[other], there.place, self.selves[i], found, self.direct):
            return None
        return self._kept(i, found) if self._is_nearest(i, found) else None

    def _along(self) -> Stated | None:
        """Along the curve of a self, from motions beside the bifurcation; the coarser one from there, or likewise."""
        best, last = None, min(len(self.known), self.followed)
        for i in range(min(_ALONG, last), last + 1):
            here = self._found_along(i)
            if here is None:
                continue
            coarser = None if i == 0 else self._again(i - 1, here) or self._found_along(i - 1)
            best = self._stated(i, here, coarser)
            if self._is_sure(best):
                return best
        return best

    def _found_along(self, i: int) -> Again | None:
        """What a self finds along its own curve."""
        if i not in self.came_past:
            self.came_past[i] = self._looked_along(i)
        return self.came_past[i]

    def _looked_along(self, i: int) -> Again | None:
        """`_found_along`, before it is kept."""
        here = self._before(0.0)
        if self.one.way is None or self.one.found is None or here is None:
            return None
        family, own = self.selves[i], self.one.family
        found = along(self.one.found, CarriedWay(self.one.way, own, family))(family, here.seen_by(family))
        if found is not None and self._is_nearest(i, found):
            return found
        for spring in () if self._spring is None else springing(here, self._spring, family):
            found = along(self.one.found, spring)(family, spring.expected(here))
            if found is not None and self._is_nearest(i, found, spring):
                return found
        return None

    @cached_property
    def _spring(self) -> tuple[Carrier, Carrier] | None:
        """Where the branch springs, by the first solver."""
        return spring_of(self.one.family, self.motion)

    def _beside(self) -> Stated | None:
        """Beside a graze: by a self and the next coarser one that has it too, each from the graze as it has that."""
        one, way = self.one.found, self.one.way
        assert one is not None
        for graze in () if way is None else way.grazes:
            if isinstance(one, Graze) and same_graze(one, graze):
                continue
            best = self._from_graze(Beside(self.one.family, one, graze))
            if best is not None or self._is_spent:
                return best
        return None

    def _from_graze(self, beside: Beside) -> Stated | None:
        """Beside one graze; None if no two selves have it, or they do not agree."""
        there = dict[int, Again]()
        for i, family in enumerate(self.selves):
            coarser = [k for k in self._coarser(i) if k in there]
            begun = i - 1 in there and i - 2 not in there  # another self is asked in any case
            if (self._is_spent and not begun) or (i == len(self.known) and not coarser):
                break
            here = beside.found_by(family)
            if here is None or not self._is_nearest(i, here):
                continue
            there[i] = here
            found = self._stated(i, here, there[coarser[0]], i - coarser[0]) if coarser else None
            if self._is_sure(found):
                return found
        return None

    def _coarser(self, i: int) -> tuple[int, ...]:
        """By which selves a self's error may be known, the nearer first: one may lack what both beside it have.

        Those of the first solver have one such self already, which is why they are asked.
        """
        return tuple(k for k in ((i - 1,) if self._is_own else (i - 1, i - 2)) if k >= 0)

    def _from_beyond(self) -> Stated | None:
        """A graze from its other side, where the motion has the contact that comes there.

        On that side the number goes as a root of the penetration, on the other smoothly.
        """
        graze = self.one.found
        if not isinstance(graze, Graze) or not graze.before.touched:
            return None
        try:
            seen = seen_from_beyond(self.one.family, graze)
            if seen is None:
                return None
            there = replace(self.one, found=seen)
            return _Search(there, self.family, self.finer, self.followed, self.marches - self._marched)._direct()
        except (InputError, SolverError):  # the motion before it is left
            return None

    def _kept(self, i: int, found: Again | None) -> Again | None:
        if found is not None:
            self.found[i] = found
            self.missed.discard(i)
        return found

    def _before(self, back: float) -> Carrier | None:
        """The motion of the first solver some arc length before the bifurcation."""
        if back not in self.before:
            own = self.one.family
            value, guess = self.motion.moved(own, -back * self.motion.tangent)
            place = self.motion if back == 0.0 else corrected(own, value, guess, self.motion.count)
            self.before[back] = None if place is None else Carrier(own, place)
        return self.before[back]


def _surer(first: Stated | None, second: Stated | None) -> Stated | None:
    """Of two answers the one with the smaller error; the first if that is the same."""
    if first is None or second is None:
        return first or second
    return second if second.error < first.error else first


@dataclass(frozen=True)
class CarriedWay:
    """The part of a branch about a bifurcation, as another solver has it."""

    way: Starts
    """The same by the first solver."""
    own: Family
    """The period maps of that one."""
    family: Family
    """The period maps of the other."""

    @property
    def sides(self) -> Iterator[Iterator[Approach]]:
        """Places from which the branch leads to the bifurcation: before it, and behind it."""
        for side in self.way.sides:
            yield self._carried(side)

    def _carried(self, side: Iterable[Approach]) -> Iterator[Approach]:
        """Those of one side that the other solver has."""
        for start in side:
            place = Carrier(self.own, start.place).carried(self.family)
            if place is not None:
                yield Approach(place, start.length)
