"""A bifurcation restored from the motion at it, without following its branch."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import replace

import numpy as np

from lapjoint.answers.branches import Bifurcation, MotionThere
from lapjoint.errors import SolverError
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.extremum_search import OnExtremum
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import smooth_finder
from lapjoint.orbits.branches.found_along import Surroundings, motion_at
from lapjoint.orbits.branches.gap_extrema import Extremum
from lapjoint.orbits.branches.grazing import located_graze, slow_switch
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.passings import Coming, rates_of
from lapjoint.orbits.branches.run import Graze
from lapjoint.orbits.branches.shooting import taken_over

_FINER = 4
"""Most finer selves of the solver that are asked: a branch that only the second one has is resolved by two more."""
_AS_IT_IS = 1e-8
"""Arc length from a motion in the file up to which it is the one that closes: what closes to 1e-9 on one processor may
miss by a little more on another, where multipliers are a thousand.  Other selves have theirs at 1e-6 and more."""
_SHARPER = 2
"""Most selves finer than that which found it by which it is located again: the third one's motion is hardly nearer."""
_SLOWER = 10.0
"""How much nearer a graze must be at which a switch vanishes than one at which an extremum does: mostly both do, and
then the motion's own extremum is asked for."""


def restored(family: Family, one: Bifurcation, rivals: Iterable[MotionThere] = ()) -> Listed | None:
    """A bifurcation with what was found, by the solver that found it.

    Parameters
    ----------
    family : Family
        The period maps of the solver.
    one : Bifurcation
        The bifurcation, with the motion there.
    rivals : iterable of MotionThere, optional
        The motions at others for which it may be taken.

    Returns
    -------
    Listed or None
        By this solver, or a finer self of it; None if none finds it from that motion.
    """
    found = None if one.motion is None else _restored(family, one, one.motion)
    if found is None:
        return None
    places = (next((place for _, place in _places(found.family, rival)), None) for rival in rivals)
    return replace(_sharper(found), rivals=tuple(place for place in places if place is not None))


def _restored(family: Family, one: Bifurcation, motion: MotionThere) -> Listed | None:
    """`restored` by the self that found it, or else the first one that finds it."""
    places = list[tuple[Family, Place]]()
    for own, place in _places(family, motion):
        places.append((own, place))
        in_file = replace(place.beginning_at(motion.point), value=motion.value)
        if float(np.linalg.norm(place.chord(own, in_file))) <= _AS_IT_IS:  # this is the self that found it
            found = _as_it_is(own, one, place)
            if found is not None:
                return found
    return next((found for own, place in places if (found := _found(own, one, place)) is not None), None)


def _sharper(one: Listed) -> Listed:
    """The same by finer selves, as far as they come to where the file has it: their motions are nearer to the truth."""
    for _ in range(_SHARPER if np.isfinite(one.bifurcation.error) else 0):
        known = one.family.finer(one.bifurcation.value)
        there = None if known is None else _again(one, known[1])
        if there is None or not _off(there) <= max(_off(one), one.bifurcation.error):
            break
        one = there
    return one


def _off(one: Listed) -> float:
    """How far from the file's number a self has a bifurcation, in the same unit."""
    assert one.found is not None
    value = one.found.value
    return abs(value - one.bifurcation.value)


def _again(one: Listed, family: Family) -> Listed | None:
    """The bifurcation by another self, from the motion at it."""
    assert one.found is not None
    place = motion_at(one.found)
    try:
        if isinstance(one.found, Located):
            return _found(family, one.bifurcation, place)
        near = taken_over(family, place)
        return None if near is None else _found(family, one.bifurcation, near.going_on_from(place))
    except SolverError:
        return None


def _places(family: Family, motion: MotionThere) -> Iterator[tuple[Family, Place]]:
    """The motion by the solver, and by finer selves of it, unless Newton's method leads to one that repeats sooner."""
    own: Family | None = family
    for _ in range(_FINER + 1):
        if own is None:
            return
        place = corrected(own, motion.value, own.adopted(motion.value, motion.point), motion.half_periods)
        if place is not None and not place.repeats_in_half:
            yield own, place
        finer = own.finer(motion.value)
        own = None if finer is None else finer[1]


def _as_it_is(family: Family, one: Bifurcation, place: Place) -> Listed | None:
    """The bifurcation with the motion at which it was found."""
    assert one.kind != "unresolved"
    if one.kind != "grazing":
        return _listed(family, one, Located(one.kind, place))
    near = _towards(family, one, place)
    if near is None:
        return None
    place, extremum, rate = near
    at = OnExtremum(place, extremum, float(place.tangent[-1]) * family.scale(place.value) / rate)
    return _listed(family, one, _graze(one, at, rate))


def _found(family: Family, one: Bifurcation, place: Place) -> Listed | None:
    """The bifurcation from a place near it; that of a graze is this self's own, and its tangent leads towards it."""
    assert one.kind != "unresolved"
    if one.kind != "grazing":
        there = smooth_finder(one.kind)(family, place)
        return None if there is None else _listed(family, one, Located(one.kind, there.place))
    near = _towards(family, one, place)
    found = None if near is None else located_graze(family, *near)
    if near is None or found is None:
        return None
    found = replace(found, place=found.place.going_on_from(near[0]))
    return _listed(family, one, _graze(one, found, near[2]))


def _listed(family: Family, one: Bifurcation, found: Located | Graze) -> Listed:
    return Listed(family, one, found, Surroundings(family, motion_at(found)))


def _graze(one: Bifurcation, at: OnExtremum, rate: float) -> Graze:
    return Graze(one.stop, at.value, one.after, at, rate, 0, at.left)


def _towards(family: Family, one: Bifurcation, place: Place) -> tuple[Place, Extremum, float] | None:
    """A place with its tangent towards a graze, its extremum of that stop nearest to it, and the rate of its value."""
    try:
        found = [_nearest_extremum(family, one.stop, place)]
        found += [(own, slow_switch(family, own)) for own in (place, place.turned())]
    except SolverError:
        return None
    there = [(own, near) for own, near in found if near is not None and near.extremum.stop == one.stop]
    if not there:
        return None
    own, near = min(there, key=lambda each: each[1].length * (_SLOWER if each[1].extremum.segment is not None else 1.0))
    return own, near.extremum, near.rate


def _nearest_extremum(family: Family, stop: int, place: Place) -> tuple[Place, Coming | None]:
    """A place with its tangent towards the graze of a stop at which its least extremum vanishes."""
    mine = np.flatnonzero(place.extrema.stop == stop)
    if not mine.size:
        return place, None
    i = int(mine[np.argmin(np.abs(place.extrema.value[mine]))])
    extremum, rate = place.extrema[i], float(rates_of(family, place).value[i])
    if rate == 0.0:
        return place, None
    return (place.turned(), Coming(extremum, -rate)) if rate * extremum.value > 0 else (place, Coming(extremum, rate))
