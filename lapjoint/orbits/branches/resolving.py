"""Parts of a curve that a finer self of the solver sees otherwise are followed by it, until one finer still agrees.

Close to a graze, where a map of few modes jumps or turns sharply, a coarse solver may have bifurcations that a finer
one has not, or none at all.  What is not confirmed there says nothing of the joint.  So each such part, with a little
of the curve before and behind it, is followed by the finer solver from the motion before to the one behind; its motions
and bifurcations take the place of the others, if less of them is in doubt.  Where the branch springs from another
beside such a part, or is lost there, the finer solver follows it to where it springs; a branch that is all in doubt is
followed both ways from a motion within.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import chain, islice, pairwise, repeat

import numpy as np

from lapjoint.answers.branches import Bifurcation
from lapjoint.errors import SolverError
from lapjoint.orbits.branches.bridging import followed
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.coinciding import doubted
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import alike
from lapjoint.orbits.branches.found_along import Surroundings, motion_at
from lapjoint.orbits.branches.listing import Listed, among, listed
from lapjoint.orbits.branches.run import Limits, Run, joined
from lapjoint.orbits.branches.shooting import taken_over
from lapjoint.orbits.branches.switching import repeated_near, springs_beside, switched
from lapjoint.orbits.branches.value_errors import AIM

_LISTED = 0.3
"""Share of the work that is behind once the bifurcations are listed, about, where some parts are in doubt."""
_LEVELS = 2
"""Most finer solvers by which a part is followed: each leaves about a third of what the one before left in doubt."""
_MORE = 1
"""Finer solvers beyond these by which a part is followed of which they leave something unconfirmed: that is rare, and
beside a graze 36 modes had a fold without an error, and 54 are sure of it to 4e-7 rad/s."""
_ASKED, _FOLLOWED = 3, 2
"""Most finer selves by which what has no error is looked for again, and which is the last that follows its own curve: a
third one found 2 of 23 beside grazes that two did not, and 1 of 31 along its curve, for as much work as the others."""
_LITTLE = 400
"""Most marches by which that is looked for in a part that was only not resolved: 37 of 41 took at most 340, and the
other four as long as all of these together."""
_NARROW = 0.01 * AIM
"""Half width, over the scale of the number, of what a finer solver leaves unresolved up to which it stays so: parts
within parts took half of the work on a long branch."""
_TOGETHER = 8
"""Most places between two bifurcations in doubt that belong to one part."""
_MARGINS = (1e-3, 1e-2, 5e-2)
"""Arc lengths before and behind a part from which on the finer solver may begin and end, in turn, until it comes from
end to end: of 78 wider tries after that, two left less in doubt."""
_FARTHEST = 30
"""Most places before and behind a part at which it may begin and end, and most of a branch that is all in doubt."""
_FAR_OFF = 60
"""Most places from a part to an end of the branch to which a finer solver follows it, if both have no motion between:
of the ways that led there, none was longer than 48."""
_LONGER = 2.0
"""Most by which the finer solver's curve is longer than the coarser one's."""
_AHEAD = 0.05
"""Arc length that it may be longer beyond where a curve is lost."""
_POINTS = 100
"""Most points of the finer solver's curve, besides twice as many as there were."""
_TRIED = 2
"""Most motions within a branch, and most beside where it springs, from which the finer solver follows it in turn."""
_FIRST = 0.1
"""First step from within a branch over the length of that."""
_NEAR = 0.05
"""Largest distance of the motions of two solvers over their size."""
_SPRINGS = "bifurcation"
"""Why a curve ends where its branch springs from another."""
_OPEN = (_SPRINGS, "lost", "graze")
"""Why a curve ends that a finer solver may follow to where it springs, without a motion behind that both have."""


@dataclass(frozen=True)
class Resolved:
    """A curve, and its bifurcations."""

    places: list[Place]
    """Its places, in sequence."""
    bifurcations: list[Listed]
    """Its bifurcations, in sequence."""
    families: list[Family]
    """The period maps of each place."""
    ends: tuple[str, str]
    """Why it ends at its first place, and at its last."""
    elsewhere: frozenset[int] = frozenset()
    """As `Run.elsewhere`: no bifurcation was looked for there."""


@dataclass(frozen=True)
class Part:
    """A part of a curve as a finer solver has it."""

    first: int
    """Index of the first place that it takes the place of."""
    last: int
    """Index of the last one."""
    found: Resolved
    """The part."""

    def covers(self, one: Listed) -> bool:
        """Whether a bifurcation of the curve lies in it; one that is at the first place of the curve does.

        Parameters
        ----------
        one : Listed
            The bifurcation.

        Returns
        -------
        bool
            Whether it does.
        """
        return (self.first < one.index or self.first == 0) and one.index <= self.last


def unrefined(family: Family, run: Run) -> Resolved:
    """A curve with its bifurcations, as it was followed, without errors.

    Parameters
    ----------
    family : Family
        The period maps.
    run : Run
        The curve.

    Returns
    -------
    Resolved
        The curve.
    """
    return _as_followed(family, run, errors=False)


def resolved(
    family: Family, run: Run, levels: int = _LEVELS, progress: Callable[[float], None] | None = None
) -> Resolved:
    """A curve with its bifurcations and their errors, in which parts in doubt are followed by finer solvers.

    Parameters
    ----------
    family : Family
        The period maps by which it was followed.
    run : Run
        The curve.
    levels : int
        Most finer solvers.
    progress : callable, optional
        Called with the share of this work that is behind.

    Returns
    -------
    Resolved
        The curve.
    """
    return _all_asked_again(_resolved(family, run, levels, progress, more=_MORE))


def _all_asked_again(found: Resolved) -> Resolved:
    """The same after what is in doubt has been asked for again."""
    own = found.bifurcations
    asked = [asked_again(among(one, own)) if one.to_be_asked else one for one in own]
    return replace(found, bifurcations=asked)


def _as_followed(family: Family, run: Run, *, errors: bool, known: Sequence[Bifurcation] = ()) -> Resolved:
    """A curve as it was followed, of which some bifurcations may be known."""
    places = run.places
    found = listed(family, run, errors, known)
    if errors:
        found = doubted(found)
    return Resolved(places, found, [family] * len(places), (run.begin, run.end), run.elsewhere)


def _resolved(
    family: Family,
    run: Run,
    levels: int,
    progress: Callable[[float], None] | None = None,
    known: Sequence[Bifurcation] = (),
    narrow: float = 0.0,
    more: int = 0,
) -> Resolved:
    """`resolved`, before what is left in doubt is asked for again.

    Some bifurcations may be known, and what is not resolved and so `narrow` stays as it is.  So many `more` finer
    solvers follow what those leave unconfirmed.
    """
    now = _as_followed(family, run, errors=True, known=known)
    if levels <= 0:
        return now
    search, taken = _Search(family, run, now.bifurcations, levels, more), list[Part]()
    parts = list(_parts(now.bifurcations, narrow))
    for done, part in enumerate(reversed(parts)):  # the indices of those before stay as they are
        if progress is not None:
            progress(_LISTED + (1 - _LISTED) * done / len(parts))
        taken = search.taken_with(part, taken)
    for one in taken:
        now = _put_in(now, one)
    return now


def asked_again(one: Listed, marches: float = np.inf) -> Listed:
    """A bifurcation with its error by finer solvers among themselves, if it has none, or one that may be by chance.

    One of them did not find it.  So the others must agree well: that there is nothing they would say by a large error.
    Where they do not come to it from motions of the branch, they may from those of a closer look around it.

    Parameters
    ----------
    one : Listed
        The bifurcation.
    marches : float
        Number of marches by each after which nothing else is tried.

    Returns
    -------
    Listed
        The same where it has an error that is sure, is not resolved, or they do not agree.
    """
    if one.found is None or (one.sure and not one.unconfirmed):
        return one
    for way in (one.way, Surroundings(one.family, motion_at(one.found))):
        known = by_another(replace(one, way=way), one.family, _ASKED, _FOLLOWED, marches)
        if known is not None and known.error <= AIM * one.family.scale(known.value):
            return replace(one, bifurcation=replace(one.bifurcation, value=known.value, error=known.error), sure=True)
    return replace(one, asked=True)


def _parts(bifurcations: list[Listed], narrow: float) -> Iterator[tuple[int, int]]:
    """The first and the last index of what is in doubt, part by part, but for what is not resolved and so narrow."""
    indices = [one.index for one in bifurcations if one.doubtful and one.bifurcation.error >= narrow]
    edges = [i for i, (a, b) in enumerate(pairwise(indices), start=1) if b - a > _TOGETHER]
    for first, last in pairwise([0, *edges, len(indices)]):
        if first < last:
            yield indices[first], indices[last - 1]


@dataclass(frozen=True)
class _Search:
    """The search for what finer solvers have for parts of a curve."""

    family: Family
    """The period maps by which it was followed."""
    run: Run
    """The curve."""
    bifurcations: list[Listed]
    """Its bifurcations."""
    levels: int
    """Most finer solvers."""
    more: int
    """Further ones, for what these leave unconfirmed."""

    @cached_property
    def selves(self) -> list[Family]:
        """The finer solvers, each finer than the one before."""
        found = list[Family]()
        while len(found) < self.levels + self.more:
            known = (found[-1] if found else self.family).finer(self.run.places[0].value)
            if known is None:
                break
            found.append(known[1])
        return found

    def taken_with(self, part: tuple[int, int], taken: list[Part]) -> list[Part]:
        """What has been taken, the last part first, with what a finer solver has for the part before it, if that does.

        Where the part behind it is in the way, it has both as one.  For a part that is only not resolved, one finer
        solver alone is asked: much work after that makes few of these narrower.
        """
        unconfirmed = any(one.unconfirmed and part[0] <= one.index <= part[1] for one in self.bifurcations)
        levels = self.selves[: self.levels if unconfirmed else 1]
        for level in range(1, len(levels) + 1):
            alone = self._followed(part, level, taken)
            better = None if alone is None else _with_less_than(_doubt(self._between(alone)), alone)
            if better is not None:
                return [*taken, self._by_more(part, better, taken)]
            if alone is not None or not taken or not unconfirmed:
                continue
            behind = taken[-1]
            both = self._followed((part[0], behind.last - 1), level, taken[:-1])
            better = None if both is None else _with_less_than(_doubt(self._between(both, behind)), both)
            if better is not None:
                return [*taken[:-1], better]
        return taken

    def _by_more(self, part: tuple[int, int], best: Part, taken: list[Part]) -> Part:
        """A part as a finer solver has it, or as one still finer has, if that leaves less of the curve in doubt."""
        for level in range(self.levels + 1, len(self.selves) + 1):
            best = replace(best, found=_all_asked_again(best.found))
            if not any(one.unconfirmed for one in best.found.bifurcations):
                break
            finer = self._followed(part, level, taken)
            if finer is not None:
                finer = replace(finer, found=_all_asked_again(finer.found))
                best = min((best, finer), key=self._left)
        return best

    def _left(self, part: Part) -> tuple[int, float]:
        """What is in doubt with a part in place of the curve's own."""
        own = (one for one in self.bifurcations if not part.covers(one))
        return _doubt([*own, *part.found.bifurcations])

    def _between(self, part: Part, known: Part | None = None) -> list[Listed]:
        """The bifurcations in whose place those of a part come, of which a piece may be known by a finer solver."""
        own = [one for one in self.bifurcations if part.covers(one)]
        if known is None:
            return own
        return [one for one in own if not known.covers(one)] + known.found.bifurcations

    def _followed(self, part: tuple[int, int], level: int, taken: list[Part]) -> Part | None:
        """A part as a finer solver has it; None if that does not come from the motion before to the one behind.

        All that is at the first place of what has been taken, or behind it, is of another part.
        """
        finer, limit = self.selves[level - 1], taken[-1].first if taken else len(self.run.places)
        if part[1] >= limit:
            return None
        try:
            found = self._run(part, finer, limit)
            if found is None:
                return None
            first, last, there = found
            within = (one for one in self.bifurcations if first <= one.index <= last and not one.doubtful and one.sure)
            known = [one.bifurcation for one in within]
            narrow = _NARROW * finer.scale(there.places[0].value)
            return Part(first, last, _resolved(finer, there, self.levels - level, known=known, narrow=narrow))
        except SolverError:
            return None

    def _run(self, part: tuple[int, int], finer: Family, limit: int) -> tuple[int, int, Run] | None:
        """A part as a finer solver follows it, with the indices of the first and the last place that it replaces."""
        first, last = part
        tried = set[tuple[int | None, ...]]()
        for margin in _MARGINS:
            before = self._end(finer, range(first - 1, max(first - 2 - _FARTHEST, -1), -1), margin)
            behind = self._end(finer, range(last + 1, min(last + 2 + _FARTHEST, limit)), margin)
            ends = tuple(None if end is None else end[0] for end in (before, behind))
            if ends in tried or (behind is None and limit < len(self.run.places)):
                continue
            tried.add(ends)
            if (before is None and first > _FAR_OFF) or (behind is None and len(self.run.places) - last > _FAR_OFF):
                continue
            if (before is None and self.run.begin not in _OPEN) or (behind is None and self.run.end not in _OPEN):
                continue
            there = self._from_end_to_end(finer, before, behind)
            if there is not None:
                i, j = (0 if before is None else before[0]), (len(self.run.places) - 1 if behind is None else behind[0])
                return i, j, there
        return None

    def _from_end_to_end(
        self, finer: Family, before: tuple[int, Place] | None, behind: tuple[int, Place] | None
    ) -> Run | None:
        """The curve of a finer solver between two motions, or from one of them to where the branch springs."""
        if before is None and behind is None:
            return self._whole(finer)
        if before is None:
            assert behind is not None
            back = self._from(finer, range(behind[0], -1, -1), behind[1].turned(), self.run.begin)
            return None if back is None else joined(back, Run([behind[1]], [], [], ""))
        if behind is None:
            return self._from(finer, range(before[0], len(self.run.places)), before[1], self.run.end)
        until, length = behind[1], self._length(range(before[0], behind[0] + 1))
        most = _POINTS + 2 * (behind[0] - before[0])
        there = followed(finer, before[1], Limits(most=most, length=_LONGER * length, until=until))
        return there if there.end == "until" else None

    def _from(self, finer: Family, indices: range, start: Place, end: str) -> Run | None:
        """The curve of a finer solver from a motion to where the branch springs; None if it does not lead there."""
        length = _LONGER * self._length(indices) + (0.0 if end == _SPRINGS else _AHEAD)
        there = follow(finer, start, Limits(most=_POINTS + 2 * len(indices), length=length))
        if there.end != _SPRINGS:
            return None
        return there if self._is_near(finer, there.places[-1], self.run.places[indices[-1]]) else None

    def _whole(self, finer: Family) -> Run | None:
        """The curve of a finer solver from a motion within the branch, both ways to where that springs."""
        places = self.run.places
        length = self._length(range(len(places)))
        limits = Limits(_POINTS + 2 * len(places), _LONGER * length + _AHEAD, _FIRST * length)
        springs = [self.run.begin, self.run.end].count(_SPRINGS)
        starts = chain(
            zip(islice(self._within(finer), _TRIED), repeat(min(springs + 1, 2))),
            zip(islice(self._springing(finer), _TRIED), repeat(springs)),
        )
        for start, least in starts:
            ahead = follow(finer, start, limits)
            if ahead.end != _SPRINGS and least == 2:
                continue
            back = follow(finer, start.turned(), limits)
            if [back.end, ahead.end].count(_SPRINGS) >= least:
                return joined(back, ahead)
        return None

    def _within(self, finer: Family) -> Iterator[Place]:
        """Motions of a finer solver near a branch that is all in doubt, first those with the same contacts."""
        others = list[Place]()
        for place in self.run.places[:: 1 + len(self.run.places) // _FARTHEST]:
            near = taken_over(finer, place)
            if near is None or not self._is_near(finer, near, place):
                continue
            near = near.going_on_from(place)
            if near.closings == place.closings:
                yield near
            else:
                others.append(near)
        yield from others

    def _springing(self, finer: Family) -> Iterator[Place]:
        """Motions of branches of a finer solver that spring near the ends of one that is all in doubt."""
        for place in (self.run.places[0], self.run.places[-1]):
            mother = repeated_near(finer, place)
            for spring in () if mother is None else springs_beside(finer, mother):
                new = switched(finer, spring)
                if new is not None and self._is_near(finer, new, place):
                    yield new

    @staticmethod
    def _is_near(finer: Family, new: Place, place: Place) -> bool:
        """Whether the motions of two solvers may be of one branch."""
        return float(np.linalg.norm(new.chord(finer, place))) <= _NEAR

    def _length(self, indices: range) -> float:
        """Arc length of the curve through some of its places."""
        places = [self.run.places[i] for i in indices]
        return sum(float(np.linalg.norm(b.chord(self.family, a))) for a, b in pairwise(places))

    def _end(self, finer: Family, indices: range, margin: float) -> tuple[int, Place] | None:
        """Where a part begins or ends: the index of a place some arc length off, and the motion of the finer solver."""
        places, taken, length = self.run.places, {one.index for one in self.bifurcations}, 0.0
        for i in indices:
            length += float(np.linalg.norm(places[i].chord(self.family, places[i - indices.step])))
            if length < margin or not taken.isdisjoint((i, i + 1)):
                continue
            near = alike(finer, places[i])
            if near is not None and self._is_near(finer, near, places[i]):
                return i, near
        return None


def _with_less_than(doubt: tuple[int, float], part: Part) -> Part | None:
    """A part of which less is in doubt, be it after that has been asked for again; None if not."""
    own, most, vain = list(part.found.bifurcations), np.inf if doubt[0] else _LITTLE, 0
    for i, one in enumerate(own):
        if _doubt(own) < doubt or vain > doubt[0]:
            break
        if one.unconfirmed and not one.asked:
            own[i] = asked_again(among(one, own), most)
            vain += own[i].doubtful
    return replace(part, found=replace(part.found, bifurcations=own)) if _doubt(own) < doubt else None


def _doubt(bifurcations: list[Listed]) -> tuple[int, float]:
    """How many have no error, and how wide all parts are that are not resolved."""
    wide = sum(one.bifurcation.error for one in bifurcations if one.bifurcation.kind == "unresolved")
    return sum(one.unconfirmed for one in bifurcations), wide


def _put_in(whole: Resolved, part: Part) -> Resolved:
    """A curve whose places from the first to the last of a part are those of that."""
    i, j, found = part.first, part.last, part.found
    more = len(found.places) - (j + 1 - i)
    bifurcations = [one for one in whole.bifurcations if one.index <= i and not part.covers(one)]
    bifurcations += [_later(one, i) for one in found.bifurcations]
    bifurcations += [_later(one, more) for one in whole.bifurcations if one.index > j]
    return Resolved(
        whole.places[:i] + found.places + whole.places[j + 1 :],
        bifurcations,
        whole.families[:i] + found.families + whole.families[j + 1 :],
        (_end_of(found.ends[0], whole.ends[0]), _end_of(found.ends[1], whole.ends[1])),
        frozenset(k if k <= i else k + more for k in whole.elsewhere if k <= i or k > j),
    )


def _end_of(part: str, whole: str) -> str:
    """Why a curve ends of which a part is known by a finer solver, which may end within it."""
    return whole if part in ("", "until") else part


def _later(one: Listed, by: int) -> Listed:
    """The same with a larger index."""
    return replace(one, bifurcation=replace(one.bifurcation, index=one.index + by))
