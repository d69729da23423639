"""A whole branch from one of its motions: followed both ways, with its bifurcations, and what springs from them."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import dataclass, replace

import numpy as np

from lapjoint.answers.branches import Bifurcation, Branch, BranchPoint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.collecting import seldom_collected
from lapjoint.errors import InputError, SolverError
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.bridging import followed
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import smooth_finder
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.locating import flip_of
from lapjoint.orbits.branches.resolving import Resolved, resolved, unrefined
from lapjoint.orbits.branches.run import Limits, Run, joined
from lapjoint.orbits.branches.shooting import taken_over
from lapjoint.orbits.branches.switching import back_to_where_it_springs, sprung_from, switched
from lapjoint.orbits.steady_state import periodic_state

_FOLLOWED = 0.4
"""Share of the work that is behind once a branch is followed, about, where errors are estimated."""
_FINER = 2
"""Most finer solvers that are asked for a motion of a branch that springs where one finds none."""
_FARTHER, _AWAY = 30, 0.05
"""Most points, and arc length, of a branch along which a motion is looked for that a coarser solver has, too."""


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
    level: int = 0
    """`Family.level` of the solver that follows its branch: above 0 where only a finer one has that."""


@dataclass(frozen=True)
class Traced:
    """A branch, and the motions that lead to other branches."""

    branch: Branch
    """The branch."""
    seeds: tuple[Seed, ...]
    """A motion of each branch that springs from it."""
    bifurcations: tuple[Listed, ...]
    """Its bifurcations, with the motions there."""
    springs: tuple[tuple[float, SectionPoint], ...] = ()
    """Bifurcations of other branches from which it springs, at either end: the number, and the section point."""
    unsprung: tuple[Bifurcation, ...] = ()
    """Its bifurcations from which another branch springs of which no motion was found."""
    elsewhere: frozenset[int] = frozenset()
    """Numbers of points up to which, from the one before, it is another branch, and no bifurcation was looked for."""


@in_one_thread
@seldom_collected
def trace(
    family: Family,
    seed: Seed,
    *,
    most_multiple: int,
    errors: bool = True,
    limits: Limits | None = None,
    elsewhere: Callable[[Run], frozenset[int]] | None = None,
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
    elsewhere : callable, optional
        Called with the curve, where it is a branch that is known already, as `Run.elsewhere` has it.

    Returns
    -------
    Traced, or None
        None if Newton's method does not find the motion again.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    limits, own = limits or Limits(), family.self_at(seed.level)
    start = _start(own, seed)
    if start is None:
        return None
    followed_at = _FOLLOWED if errors else 1.0
    first = replace(limits, progress=_part_of(limits.progress, 0.0, followed_at))
    ahead, back = _both_ways(own, start, seed, first)
    run = joined(back, ahead)
    if elsewhere is not None:
        run = replace(run, elsewhere=elsewhere(run))
    later = _part_of(limits.progress, followed_at, 1.0)
    found = resolved(own, run, progress=later) if errors else unrefined(own, run)
    points = tuple(_point(*one) for one in zip(found.families, found.places, strict=True))
    seeds, unsprung = list[Seed](), list[Bifurcation]()
    for one in found.bifurcations:
        place = one.springing
        if place is not None and place.count * 2 <= 2 * most_multiple:
            new = _sprung(family, one, place, _FINER if errors else 0)
            if new is None:
                unsprung.append(one.bifurcation)
            else:
                seeds.append(new)
    branch = Branch(family.path, points, tuple(one.bifurcation for one in found.bifurcations), found.ends)
    springs = [
        seed.away_from or _spring(own, run.begin, run.places[0], found, 0),
        _spring(own, run.end, run.places[-1], found, -1),
    ]
    known = tuple(one for one in springs if one is not None)
    return Traced(branch, tuple(seeds), tuple(found.bifurcations), known, tuple(unsprung), found.elsewhere)


def _spring(family: Family, end: str, place: Place, found: Resolved, at: int) -> tuple[float, SectionPoint] | None:
    """The bifurcation from which a branch springs at an end: the solver's own, or a finer one's if only that has it."""
    own = family if end == found.ends[at] else found.families[at]
    near = place if own is family else found.places[at]
    mother = sprung_from(own, near) if found.ends[at] == "bifurcation" else None
    return None if mother is None else (mother.value, mother.point)


def _sprung(family: Family, bifurcation: Listed, at: Place, finer: int) -> Seed | None:
    """The seed of a branch that springs from a bifurcation; None if neither its solver nor so many finer ones have one.

    One that is found the other way along the vector alone ends soon at a graze, and may be narrower than a solver's
    error.  So the one of them follows it that has the bifurcation nearest to where it is stated, within its error.
    """
    own, number, selves = bifurcation.family, bifurcation.bifurcation, list[tuple[Family, Place]]()
    for one, there in _with_finer(own, at, finer):
        new = switched(one, there)
        if new is not None and not new.repeats_in_half:
            return _seed(family, one, there, new)
        selves.append((one, there))
    for one, there in sorted(selves, key=lambda pair: abs(pair[1].value - number.value)):
        new = switched(one, there, sign=-1) if abs(there.value - number.value) <= number.error else None
        if new is not None and not new.repeats_in_half:
            return Seed(new.value, new.point, new.count, (there.value, there.point), one.level)
    return None


def _with_finer(own: Family, place: Place, finer: int) -> Iterator[tuple[Family, Place]]:
    """A solver and so many finer ones, each with where it has a bifurcation, as long as they find it."""
    yield own, place
    known, again = own.finer(place.value) if finer else None, None
    if known is not None:
        with suppress(SolverError, InputError):
            again = smooth_finder(flip_of(place))(known[1], place)
    if known is not None and again is not None:
        yield from _with_finer(known[1], again.place, finer - 1)


def _seed(family: Family, own: Family, bifurcation: Place, new: Place) -> Seed:
    """The seed of a branch that springs from a bifurcation, of which a motion is known by a solver that may be finer.

    Where a finer solver has the bifurcation a little elsewhere, a motion near it need not be one of this solver; then
    it is one farther along the branch, which leads back to where this solver has the bifurcation.  If this solver has
    none there either, the finer one follows the branch.
    """
    away_from = bifurcation.value, family.adopted(bifurcation.value, bifurcation.point)
    near = new if own is family else taken_over(family, new)
    if near is not None and not near.repeats_in_half:
        return Seed(near.value, near.point, near.count, away_from)
    with suppress(SolverError):
        for there in follow(own, new, Limits(most=_FARTHER, length=_AWAY)).places[1:]:
            found = taken_over(family, there)
            if found is not None and not found.repeats_in_half:
                return Seed(found.value, found.point, found.count)
    return Seed(new.value, new.point, new.count, (bifurcation.value, bifurcation.point), own.level)


def _part_of(progress: Callable[[float], None] | None, first: float, last: float) -> Callable[[float], None] | None:
    """What takes the share that is behind of a part of the work, from one share of the whole to another."""
    return None if progress is None else lambda share: progress(first + (last - first) * share)


def _start(family: Family, seed: Seed) -> Place | None:
    """The place of a seed, in the range: the shortest way to the curve may lead out of it from an end.

    None, too, where it leads to the branch from which that of the seed springs: then only a finer solver has that.
    """
    guess, found = family.adopted(seed.value, seed.point), None
    inside = family.low < seed.value < family.high
    if inside:
        found = corrected(family, seed.value, guess, seed.count)
    if not inside or (found is not None and not family.covers(found.value)):
        found = corrected(family, seed.value, guess, seed.count, fixed=True)
    return None if found is None or (seed.away_from is not None and found.repeats_in_half) else found


def _both_ways(family: Family, start: Place, seed: Seed, limits: Limits) -> tuple[Run, Run]:
    """The curve ahead of a place, and behind it: up and down the range, or away from a bifurcation and back to it."""
    up = np.append(np.zeros(start.tangent.size - 1), 1.0)
    if seed.away_from is not None:
        value, point = seed.away_from
        up = start.chord(family, replace(start.beginning_at(point), value=value))
        limits = replace(limits, first=float(np.linalg.norm(up)))  # beside it lies the branch that it springs from
    start, behind = start.along(up), start.along(-up)
    ahead = followed(family, start, limits)
    if seed.away_from is not None:
        return ahead, back_to_where_it_springs(family, behind, limits.first)
    if ahead.end == "closed":
        return ahead, Run([behind], [], [], "closed")
    left = replace(limits, most=max(limits.most - len(ahead.places), 1))
    return ahead, followed(family, behind, left)


def _point(family: Family, place: Place) -> BranchPoint:
    solver = family.solver_at(place.value).name
    return BranchPoint(place.value, periodic_state(place.half_periods.map, solver, place.orbit, None))
