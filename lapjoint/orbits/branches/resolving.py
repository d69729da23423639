"""Parts of a curve that a finer self of the solver sees otherwise are followed by it, until one finer still agrees.

Close to a graze, where a map of few modes jumps or turns sharply, a coarse solver may have bifurcations that a finer
one has not, or none at all.  What is not confirmed there says nothing of the joint.  So each such part, with a little
of the curve before and behind it, is followed by the finer solver from the motion before to the one behind; its
motions and bifurcations take the place of the others, if less of them is in doubt.  Where the branch springs from
another beside such a part, the finer solver begins at that bifurcation as it has it, or ends there; a branch that is
all in doubt is followed from one to the other.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from lapjoint.errors import SolverError
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import alike
from lapjoint.orbits.branches.found_along import Surroundings, motion_at
from lapjoint.orbits.branches.listing import Listed, among, listed
from lapjoint.orbits.branches.run import Limits, Run, joined
from lapjoint.orbits.branches.switching import back_to_where_it_springs, sprung
from lapjoint.orbits.branches.value_errors import AIM

_LISTED = 0.3
"""Share of the work that is behind once the bifurcations are listed, about, where some parts are in doubt."""
_LEVELS = 2
"""Most finer solvers by which a part is followed: each leaves about a third of what the one before left in doubt."""
_ASKED, _FOLLOWED = 3, 2
"""Most finer selves by which what has no error is looked for again, and which is the last that follows its own curve: a
third one found 2 of 23 beside grazes that two did not, and 1 of 31 along its curve, for as much work as the others."""
_TOGETHER = 8
"""Most places between two bifurcations in doubt that belong to one part."""
_MARGINS = (1e-3, 1e-2, 5e-2)
"""Arc lengths before and behind a part from which on the finer solver may begin and end, in turn, until it comes from
end to end: of 78 wider tries after that, two left less in doubt."""
_FARTHEST = 30
"""Most places before and behind a part at which it may begin and end."""
_LONGER = 2.0
"""Most by which the finer solver's curve is longer than the coarser one's."""
_POINTS = 100
"""Most points of the finer solver's curve, besides twice as many as there were."""
_NEAR = 0.05
"""Largest distance of the motions of two solvers over their size."""
_SPRINGS = "bifurcation"
"""Why a curve ends where its branch springs from another."""


@dataclass(frozen=True)
class Resolved:
    """A curve, and its bifurcations."""

    places: list[Place]
    """Its places, in sequence."""
    bifurcations: list[Listed]
    """Its bifurcations, in sequence."""
    families: list[Family]
    """The period maps of each place."""


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
    return Resolved(run.places, listed(family, run, errors=False), [family] * len(run.places))


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
    found = _resolved(family, run, levels, progress)
    own = found.bifurcations
    return replace(found, bifurcations=[asked_again(among(one, own)) if one.doubtful else one for one in own])


def _resolved(family: Family, run: Run, levels: int, progress: Callable[[float], None] | None = None) -> Resolved:
    """`resolved`, before what is left in doubt is asked for again."""
    own, last = listed(family, run, errors=True), len(run.places)
    now, parts = Resolved(run.places, own, [family] * last), list(_parts(own)) if levels else []
    for done, part in enumerate(reversed(parts)):  # the indices of those before stay as they are
        if progress is not None:
            progress(_LISTED + (1 - _LISTED) * done / len(parts))
        try:
            finer = _followed(family, run, own, part, last, levels)
        except SolverError:
            continue
        if finer is not None:
            now, last = _put_in(now, *finer), finer[0]
    return now


def asked_again(one: Listed) -> Listed:
    """A bifurcation with its error by finer solvers among themselves, if it has none.

    One of them did not find it.  So the others must agree well: that there is nothing they would say by a large error.
    Where they do not come to it from motions of the branch, they may from those of a closer look around it.

    Parameters
    ----------
    one : Listed
        The bifurcation.

    Returns
    -------
    Listed
        The same where it has an error, is not resolved, or they do not agree.
    """
    if not one.doubtful or one.found is None:
        return one
    for way in (one.way, Surroundings(one.family, motion_at(one.found))):
        known = by_another(replace(one, way=way), one.family, _ASKED, _FOLLOWED)
        if known is not None and known.error <= AIM * one.family.scale(known.value):
            return replace(one, bifurcation=replace(one.bifurcation, value=known.value, error=known.error))
    return one


def _parts(bifurcations: list[Listed]) -> Iterator[tuple[int, int]]:
    """The first and the last index of what is in doubt, part by part."""
    indices = [one.index for one in bifurcations if one.doubtful]
    edges = [i for i, (a, b) in enumerate(pairwise(indices), start=1) if b - a > _TOGETHER]
    for first, last in pairwise([0, *edges, len(indices)]):
        if first < last:
            yield indices[first], indices[last - 1]


def _followed(
    family: Family, run: Run, bifurcations: list[Listed], part: tuple[int, int], before_index: int, levels: int
) -> tuple[int, int, Resolved] | None:
    """A part as the finer solver has it, with the indices of the first and the last place that it takes the place of.

    All that has an index of `before_index` or more is of another part.

    None if the finer solver does not come from the motion before to the one behind, or leaves more in doubt.
    """
    first, last = part
    known = family.finer(run.places[first].value)
    if known is None or last >= before_index:
        return None
    finer, taken = known[1], {one.index for one in bifurcations}
    tried = set[tuple[int | None, ...]]()
    for margin in _MARGINS:
        before = _end(family, finer, run, range(first - 1, max(first - 2 - _FARTHEST, -1), -1), margin, taken)
        behind = _end(family, finer, run, range(last + 1, min(last + 2 + _FARTHEST, before_index)), margin, taken)
        i, j = 0 if before is None else before[0], len(run.places) - 1 if behind is None else behind[0]
        if (before is None and run.begin != _SPRINGS) or (behind is None and run.end != _SPRINGS):
            continue
        ends = tuple(None if end is None else end[0] for end in (before, behind))
        if j >= before_index or ends in tried:
            continue
        tried.add(ends)
        sprang = sprung(family, finer, run.places[0]) if before is None else None
        if before is None and sprang is None:
            break
        length = sum(float(np.linalg.norm(b.chord(family, a))) for a, b in pairwise(run.places[i : j + 1]))
        until = None if behind is None else behind[1]
        limits = Limits(most=_POINTS + 2 * (j - i), length=_LONGER * length, until=until)
        if before is not None:
            there = follow(finer, before[1], limits)
        else:
            assert sprang is not None
            there = follow(finer, sprang[0], replace(limits, first=sprang[1]))
        if not _comes_to(finer, there, run.places[j], until):
            continue
        if sprang is not None:
            there = joined(back_to_where_it_springs(finer, sprang[0].turned(), sprang[1]), there)
        found = _resolved(finer, there, levels - 1)
        own = [one for one in bifurcations if i < one.index <= j]
        return (i, j, found) if _doubt(found.bifurcations) < _doubt(own) else None
    return None


def _comes_to(finer: Family, there: Run, place: Place, until: Place | None) -> bool:
    """Whether a finer solver's curve comes to where a part ends: to a motion, or else to where the branch springs."""
    if until is not None:
        return there.end == "until"
    return there.end == _SPRINGS and float(np.linalg.norm(there.places[-1].chord(finer, place))) <= _NEAR


def _end(
    family: Family, finer: Family, run: Run, indices: range, margin: float, taken: set[int]
) -> tuple[int, Place] | None:
    """Where a part begins or ends: the index of a place some arc length off, and the motion of the finer solver."""
    length = 0.0
    for i in indices:
        place = run.places[i]
        length += float(np.linalg.norm(place.chord(family, run.places[i - indices.step])))
        if length < margin or not taken.isdisjoint((i, i + 1)):
            continue
        near = alike(finer, place)
        if near is not None and float(np.linalg.norm(near.chord(finer, place))) <= _NEAR:
            return i, near
    return None


def _doubt(bifurcations: list[Listed]) -> tuple[int, float]:
    """How many have no error, and how wide all parts are that are not resolved."""
    wide = sum(one.bifurcation.error for one in bifurcations if one.bifurcation.kind == "unresolved")
    return sum(one.doubtful and one.bifurcation.kind != "unresolved" for one in bifurcations), wide


def _put_in(whole: Resolved, i: int, j: int, part: Resolved) -> Resolved:
    """A curve whose places with the indices `i` to `j` are those of another."""
    more = len(part.places) - (j + 1 - i)
    bifurcations = [one for one in whole.bifurcations if one.index <= i]
    bifurcations += [_later(one, i) for one in part.bifurcations]
    bifurcations += [_later(one, more) for one in whole.bifurcations if one.index > j]
    return Resolved(
        whole.places[:i] + part.places + whole.places[j + 1 :],
        bifurcations,
        whole.families[:i] + part.families + whole.families[j + 1 :],
    )


def _later(one: Listed, by: int) -> Listed:
    """The same with a larger index."""
    return replace(one, bifurcation=replace(one.bifurcation, index=one.index + by))
