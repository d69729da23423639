"""The bifurcations of a curve that was followed, listed in their sequence with their errors."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from typing import TypeVar

import numpy as np

from lapjoint.answers.branches import Bifurcation, BifurcationKind, MotionThere
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import Located, NotLocated, between
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import hides_something
from lapjoint.orbits.branches.found_along import About, Way, directly, motion_at
from lapjoint.orbits.branches.run import Graze, Jump, Run
from lapjoint.orbits.branches.value_errors import Stated, stated

_RIVALS, _AS_NEAR = 4, 1e-3
"""Most other bifurcations of a branch, of the kind that is looked for, from which it is told; and the distance of the
number, over it, within which they may be taken for it: two solvers have nearly all to 1e-5."""
_LOCATED = 1e-8
"""Distance of the number, over its scale, up to which one that has been located twice is one: it is to 1e-9."""
T = TypeVar("T")
_SPRINGING = ("flip", "symmetry breaking")
"""Kinds of bifurcations from which a branch of periodic motions springs."""


@dataclass(frozen=True)
class Listed:
    """A bifurcation of a curve."""

    family: Family
    """The period maps by which it was found."""
    bifurcation: Bifurcation
    """The bifurcation, with the index of the place that follows it or lies at it."""
    found: Located | Graze | None = field(default=None, repr=False)
    """What was found; None if it is not resolved."""
    way: About | None = field(default=None, repr=False)
    """The branch about it; None if it is not resolved."""
    rivals: tuple[Place, ...] = field(default=(), repr=False)
    """The motions at others of its kind nearby, as far as they are known, for which another solver may take it."""
    asked: bool = False
    """Whether finer solvers have been asked for it again, in vain."""
    sure: bool = True
    """As `Stated.sure`."""

    @property
    def index(self) -> int:
        """The index of the place that follows it or lies at it."""
        return self.bifurcation.index

    @property
    def doubtful(self) -> bool:
        """Whether a finer solver may have another one in its place."""
        return self.bifurcation.kind == "unresolved" or not np.isfinite(self.bifurcation.error)

    @property
    def unconfirmed(self) -> bool:
        """Whether it was found, and finer solvers do not say how surely."""
        return self.doubtful and self.found is not None

    @property
    def to_be_asked(self) -> bool:
        """Whether finer solvers are to be asked for it again: at most two agree so far, and may by chance."""
        return not self.asked and (self.unconfirmed or not self.sure)

    @property
    def springing(self) -> Place | None:
        """The motion there, if a branch springs from it."""
        found = self.found
        return found.place if isinstance(found, Located) and found.kind in _SPRINGING else None


def rivals_of(value: float, others: Iterable[tuple[float, T]]) -> tuple[T, ...]:
    """What another solver may take for a bifurcation.

    Parameters
    ----------
    value : float
        The number at the bifurcation, in its SI unit.
    others : iterable of tuple
        The numbers at others of its kind on its branch, and whatever they are told by.

    Returns
    -------
    tuple
        What the nearest ones are told by, the nearest first.
    """
    near = sorted(others, key=lambda other: abs(other[0] - value))[:_RIVALS]
    return tuple(told_by for there, told_by in near if abs(there - value) <= _AS_NEAR * abs(value))


def among(one: Listed, others: Iterable[Listed]) -> Listed:
    """A bifurcation with its rivals.

    Parameters
    ----------
    one : Listed
        The bifurcation.
    others : iterable of Listed
        All of its branch.

    Returns
    -------
    Listed
        With the motions at the nearest ones for which another solver may take it.
    """
    mine = one.bifurcation
    near = (
        (other.bifurcation.value, motion_at(other.found))
        for other in others
        if other.found is not None
        and other is not one
        and (other.bifurcation.kind, other.bifurcation.stop) == (mine.kind, mine.stop)
    )
    return replace(one, rivals=rivals_of(mine.value, near))


def listed(family: Family, run: Run, errors: bool, known: Sequence[Bifurcation] = ()) -> list[Listed]:
    """The bifurcations of a curve.

    Parameters
    ----------
    family : Family
        The period maps.
    run : Run
        The curve.
    errors : bool
        Whether to estimate their errors, from the motions at them.
    known : sequence of Bifurcation
        Some of which the values and errors are known already.

    Returns
    -------
    list of Listed
        In their sequence along the curve.
    """
    return sorted(_each(family, run, errors, known), key=lambda one: one.index)


def _each(family: Family, run: Run, errors: bool, known: Sequence[Bifurcation]) -> Iterator[Listed]:
    """Those at grazes, those that are not resolved, and those on smooth parts; none that is another branch's."""
    found = list[tuple[Located | Graze, tuple[int, int]]]()  # each with the indices of the places beside it
    for graze in (one for one in run.grazes if one.index not in run.elsewhere):
        found.append((graze, (graze.index - 1, graze.index + 1)))
        if errors and not graze.seen:
            yield from _just_beyond(family, run, graze)
    for jump in (one for one in run.jumps if one.index not in run.elsewhere):
        yield Listed(family, _unresolved(jump, jump.index))
    for index, one in _smooth(family, run):
        if isinstance(one, NotLocated):
            yield Listed(family, _unresolved(one, index))
        else:
            found.append((one, (index - 1, index)))
    told = _told(family, [its for its, _ in found], known)
    for i, (its, beside) in enumerate(found):
        yield _named(family, run, its, beside, told.get(i) or _stated(family, its, errors))


def _told(family: Family, found: Sequence[Located | Graze], known: Sequence[Bifurcation]) -> dict[int, Stated]:
    """What is known already of some, by their indices: where one alone of its kind is there, and is meant."""
    pairs = [
        (i, k)
        for k, other in enumerate(known)
        for i, one in enumerate(found)
        if _kind_and_stop(one) == (other.kind, other.stop)
        and abs(one.value - other.value) <= other.error + _LOCATED * family.scale(other.value)
    ]
    there, meant = Counter(i for i, _ in pairs), Counter(k for _, k in pairs)
    return {i: Stated(known[k].value, known[k].error) for i, k in pairs if there[i] == meant[k] == 1}


def _kind_and_stop(one: Located | Graze) -> tuple[BifurcationKind, int]:
    return ("grazing", one.stop) if isinstance(one, Graze) else (one.kind, -1)


def _stated(family: Family, one: Located | Graze, errors: bool) -> Stated:
    return stated(family, motion_at(one), one.value, directly(one, family)) if errors else Stated(one.value, np.inf)


def _just_beyond(family: Family, run: Run, graze: Graze) -> Iterator[Listed]:
    """The part between a graze and the next place beyond it, on whichever side, if a finer solver sees more there."""
    places, known = run.places, family.finer(graze.value)
    for i in (graze.index, graze.index + 1):  # the second place of either part
        if known is None or not 0 < i < len(places) or places[i - 1].closings == places[i].closings:
            continue
        after = places[i] if i > graze.index else places[i - 1]
        with suppress(SolverError, InputError):
            if hides_something(known[1], graze.before, graze.rate, after):
                yield Listed(family, _unresolved(NotLocated(places[i - 1].value, places[i].value), i))


def _smooth(family: Family, run: Run) -> Iterator[tuple[int, Located | NotLocated]]:
    """Those on the smooth parts of a curve, each with the index of the place that follows it."""
    parts, places = {i for i, _, _ in run.smooth_parts}, run.places
    for i, a, b in (part for part in run.smooth_parts if part[0] not in run.elsewhere):
        before, after = (places[i - 2] if i - 1 in parts else None), (places[i + 1] if i + 1 in parts else None)
        for one in between(family, a, b, (before, after)):
            yield i, one


def _unresolved(part: Jump | NotLocated, index: int) -> Bifurcation:
    return Bifurcation("unresolved", 0.5 * (part.first + part.last), 0.5 * abs(part.last - part.first), index)


def _named(family: Family, run: Run, one: Located | Graze, beside: tuple[int, int], known: Stated) -> Listed:
    """One that is resolved, with the indices of the places before it and behind it, and its number."""
    place, (kind, stop) = motion_at(one), _kind_and_stop(one)
    index, after = (one.index, one.kind) if isinstance(one, Graze) else (beside[1], "")
    motion = MotionThere(place.value, place.point, place.count)
    found = Bifurcation(kind, known.value, known.error, index, stop, after, _impulses(place), motion)
    return Listed(family, found, one, Way(family, run, *beside), sure=known.sure)


def _impulses(place: Place) -> tuple[float, ...]:
    multiple = place.orbit.period_multiple
    passage = place.half_periods.map.march(place.point, 2 * multiple)
    return tuple((passage.impulses / multiple).tolist())
