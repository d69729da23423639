"""A bifurcation found again by another solver, from the motion at which one has it."""

from __future__ import annotations

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from lapjoint.orbits.branches.bifurcations import signature
from lapjoint.orbits.branches.corrector import STEEP, Place, corrected
from lapjoint.orbits.branches.critical_search import Ahead, Critical, change_beside, critical_motion, one_step
from lapjoint.orbits.branches.extremum_search import OnExtremum
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.grazing import beyond_graze, graze_near, just_beyond, nearer_to_graze, sharper
from lapjoint.orbits.branches.locating import Kind, criteria_of, located
from lapjoint.orbits.branches.shooting import taken_over

_REACHES = (1e-4, 1e-2)
"""Arc lengths, to both sides of where the coarser solver has it, within which a bifurcation is looked for."""
_BACK = (0.0, 1e-5, 1e-4, 1e-3)
"""Arc lengths before a graze from which it is looked for, in turn: by another solver, it may lie before."""
NEAR = 3e-3
"""Arc length between a bifurcation as two solvers have it: another of its kind may lie not far off.  Of 240, three lay
farther apart, and none by 0.01."""
SHARE_BACK = 0.1
"""Most by which the way back misses where it began, over that way: it leads there to 1e-9, or elsewhere."""
_MINUS_ONE = 1e-3
"""Distance of a flip's multiplier from -1, at most: it changes by less than 1e5 over the arc length."""
_SAME_MULTIPLIER = 0.05
"""Distance between the critical multipliers of two solvers up to which a bifurcation is the same one."""


class Again(NamedTuple):
    """A bifurcation as another solver has it."""

    place: Place
    """The motion just at it."""
    value: float
    """The number, in its SI unit."""
    left: float = 0.0
    """What the motion's distance from it may leave of the number, in the same unit."""
    by_one_motion: Shift | None = None
    """How far off other solvers have it, by one motion of theirs; None if how fast something vanishes is not known."""
    first_step: FirstStep | None = None
    """Where the first step of a search by another solver leads; None if more than one march is needed for it."""


FirstStep = Callable[[Family], Ahead | None]
"""Where a step leads; None if the motion from which it would be made has other contacts."""
Shift = Callable[[Family], float | None]
"""By how much a number is larger by another solver, to first order, in its SI unit; None if its motion has other
contacts."""
Finder = Callable[[Family, Place], Again | None]
"""Finds a bifurcation by another solver from where one has it."""


def leads_back(family: Family, place: Place, other: Family, found: Again, finder: Finder) -> bool:
    """Whether a bifurcation that another solver has leads back to where it was looked for: else it is a neighbour's.

    Parameters
    ----------
    family : Family
        The period maps by which it was had first.
    place : Place
        The motion at it, by a solver of which the other can adopt motions.
    other : Family
        The period maps of the other solver.
    found : Again
        What that one has.
    finder : callable
        What found it.

    Returns
    -------
    bool
        True, too, where both are so near that nothing else comes between.
    """
    way = float(np.linalg.norm(found.place.chord(other, place)))
    return comes_back(way, family, place, lambda: found.place, finder)


def comes_back(
    way: float,
    family: Family,
    place: Place,
    there: Callable[[], Place | None],
    finder: Finder,
    sure: float = NEAR,
) -> bool:
    """The same with the way to what was found, and the motion there.

    Parameters
    ----------
    way : float
        Arc length.
    family : Family
        The period maps of that solver.
    place : Place
        The motion at the bifurcation by it.
    there : callable
        Gives the motion at what was found, by a solver of which that one can adopt motions; None if there is none.
    finder : callable
        What found it.
    sure : float
        Arc length within which no other one of its kind is to be expected.

    Returns
    -------
    bool
        As `leads_back`.
    """
    if way <= sure:
        return True
    found = there()
    back = None if found is None else finder(family, found)
    return back is not None and float(np.linalg.norm(back.place.chord(family, place))) <= SHARE_BACK * way


def alike(family: Family, place: Place) -> Place | None:
    """A motion as another solver has it, with its tangent the same way along the curve.

    Parameters
    ----------
    family : Family
        The period maps of the other solver.
    place : Place
        The motion.

    Returns
    -------
    Place, or None
        At the same number; None if it has other contacts there, or other multipliers outside the circle.
    """
    near = taken_over(family, place, fixed=True)
    if near is None or near.closings != place.closings:
        return None
    near = near.going_on_from(place)
    return near if signature(near) == signature(place) else None


def with_same_contacts(family: Family, place: Place, like: Place | None = None) -> Place | None:
    """The motion of another solver that is nearest to one, with its tangent the same way along the curve.

    Parameters
    ----------
    family : Family
        The period maps of the other solver, which can adopt motions of the first one.
    place : Place
        The motion, or a guess.
    like : Place, optional
        The motion whose contacts and tangent count, where that is another one.

    Returns
    -------
    Place, or None
        The number may be another one; None if it has other contacts.
    """
    near, like = taken_over(family, place), like or place
    same = near is not None and near.closings == like.closings
    return near.going_on_from(like) if near is not None and same else None


def smooth_finder(kind: Kind, like: Place | None = None, own: Family | None = None) -> Finder:
    """Finds a bifurcation of a smooth part of a curve: the same one, by the multiplier that is critical there.

    Parameters
    ----------
    kind : str
        Its kind.
    like : Place, optional
        The motion at the bifurcation, by any solver; without it, it is the one from which the search begins.
    own : Family, optional
        The period maps of `like`, or of the first motion given: they tell how fast what vanishes changes there.

    Returns
    -------
    Finder
        The function.
    """

    last: Critical | None = None

    def find(family: Family, place: Place) -> Again | None:
        nonlocal last
        vanishes = critical(kind, like or place)
        if last is None and own is not None:
            last = change_beside(own, like or place, vanishes)
        mine = family.at(place.value) is place.half_periods  # then it is not carried over
        guess = place.point if mine else family.adopted(place.value, place.point)
        root, near = critical_motion(family, place.value, guess, place.count, vanishes, last), place
        if root is None and (last is not None or not mine):
            there = place if mine else taken_over(family, place)
            if there is None:
                return None
            near = there
            root = critical_motion(family, near.value, near.point, near.count, vanishes)
        if root is not None and is_same(kind, root.place, like or place):
            last = root
            return _again(family, root, vanishes)
        found = _between_ends(family, near, kind)
        return Again(found, found.value) if found is not None and is_same(kind, found, like or place) else None

    return find


def critical(kind: Kind, at: Place) -> Callable[[Place], float]:
    """What vanishes at a bifurcation, with a sign, for motions near it.

    Parameters
    ----------
    kind : str
        Its kind.
    at : Place
        The motion there, or nearly there.

    Returns
    -------
    callable
        Takes a place; follows the multiplier that is critical.
    """
    if kind == "fold":
        return lambda place: float(place.tangent[-1])
    mu = critical_multiplier(kind, at)

    def followed(place: Place) -> complex:
        values = place.orbit.values
        return complex(values[int(np.argmin(np.abs(values - mu)))])

    if kind == "neimark-sacker":
        return lambda place: abs(followed(place)) - 1
    return lambda place: followed(place).real + 1


def critical_multiplier(kind: Kind, at: Place) -> complex:
    """The multiplier that is critical at a bifurcation.

    Parameters
    ----------
    kind : str
        Its kind.
    at : Place
        The motion there.

    Returns
    -------
    complex
        1, -1, or that of a pair on the unit circle that has a positive imaginary part.
    """
    if kind == "fold":
        return 1.0
    if kind != "neimark-sacker":
        return -1.0
    values = at.orbit.values
    pairs = values[values.imag > 0]
    return complex(pairs[int(np.argmin(np.abs(np.abs(pairs) - 1)))]) if pairs.size else 1.0


def is_same(kind: Kind, found: Place, place: Place) -> bool:
    """Whether a bifurcation is the one that another solver has at a place, and not its neighbour, or none.

    Parameters
    ----------
    kind : str
        Kind of both.
    found, place : Place
        The motions there.

    Returns
    -------
    bool
        Whether they have the same contacts, and the same critical multiplier: the real part of a pair may be -1, too.
        One that repeats sooner is of another branch.
    """
    if found.closings != place.closings or found.repeats_sooner_than(place):
        return False
    if kind not in ("fold", "neimark-sacker"):
        return bool((np.abs(found.orbit.values + 1) <= _MINUS_ONE).any())
    mu, other = (critical_multiplier(kind, one) for one in (found, place))
    return abs(mu - other) <= _SAME_MULTIPLIER


def _again(family: Family, found: Critical, vanishes: Callable[[Place], float]) -> Again:
    """A bifurcation from the motion at which something vanishes."""
    place = found.place
    left = found.left * abs(float(place.tangent[-1])) * family.scale(place.value)
    if found.rate is None:
        return Again(place, place.value, left)

    def first_step(other: Family) -> Ahead | None:
        return one_step(other, found, vanishes)

    return Again(place, place.value, left, _shift(place, found.rate, vanishes), first_step)


def _shift(place: Place, rate: float, vanishes: Callable[[Place], float]) -> Shift:
    """How far off other solvers have what vanishes at a place, from its change with the arc length there."""

    def shift(family: Family) -> float | None:
        near = with_same_contacts(family, place)
        if near is None:
            return None
        step = (vanishes(place) - vanishes(near)) / rate
        return near.moved(family, step * near.tangent)[0] - place.value

    return shift


def _beside(family: Family, here: Place, step: float) -> Place | None:
    """The place some arc length from another, with its tangent in the same direction."""
    value, guess = here.moved(family, step * here.tangent)
    found = corrected(family, value, guess, here.count, fixed=abs(here.tangent[-1]) > STEEP)
    if found is None or not family.covers(value):
        return None
    return found.along(np.sign(step) * found.chord(family, here))


def _between_ends(family: Family, near: Place, kind: Kind) -> Place | None:
    """The place near another between two at which something is counted that changes at a bifurcation."""
    criterion = criteria_of(near)[kind]
    for reach in _REACHES:
        first, last = (_beside(family, near, step) for step in (-reach, reach))
        if first is not None and last is not None and criterion.changes(first, last):
            return located(family, first, last, criterion)
    return None


def graze_finder(before: OnExtremum, rate: float) -> Finder:
    """Finds a graze.

    Parameters
    ----------
    before : OnExtremum
        The motion just before it, as the coarsest solver has it, and its extremum that vanishes there.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    Finder
        The function.
    """
    extremum, duration = before.extremum, before.place.extrema.duration
    closings = {side[extremum.stop] for side in before.closings_of_sides}

    def find(family: Family, place: Place) -> Again | None:
        for back in _BACK:
            value, guess = place.moved(family, -back * place.tangent)
            near = corrected(family, value, guess, place.count) if back else taken_over(family, place)
            graze = None if near is None else graze_near(family, near, before, rate)
            if graze is not None and graze.place.repeats_sooner_than(before.place):
                continue
            if graze is not None and graze.place.closings[extremum.stop] in closings:
                beyond = beyond_graze(family, graze, rate) if graze.touched else None
                other = None if beyond is None else just_beyond(family, beyond, rate)
                best = sharper(family, graze, other, rate)
                return Again(graze.place, best.value, best.left, _graze_shift(graze, duration))
        return None

    return find


def hides_something(family: Family, before: OnExtremum, rate: float, after: Place) -> bool:
    """Whether a finer solver sees bifurcations between a graze and where the curve goes on beyond it.

    Parameters
    ----------
    family : Family
        The period maps of the finer solver.
    before : OnExtremum
        The motion just before the graze.
    rate : float
        Change of the extremum's value with the arc length before it, m.
    after : Place
        Where the curve goes on, by the solver that does not see what lies between.

    Returns
    -------
    bool
        Whether multipliers are not on the same sides of the unit circle just beyond, farther, and where it goes on.
    """
    near = taken_over(family, before.place)
    graze = None if near is None else graze_near(family, near, before, rate)
    if graze is None:
        return False
    if graze.place.closings == after.closings:  # this solver has it on the other side of its graze
        return signature(graze.place) != signature(after)
    beyond = beyond_graze(family, graze, rate)
    if beyond is None or beyond.place.closings != after.closings:
        return False
    nearer, seen = nearer_to_graze(family, graze.place, beyond, just_beyond(family, beyond, rate), rate)
    return seen and len({signature(one) for one in (*nearer, beyond.place, after)}) > 1


def _graze_shift(graze: OnExtremum, duration: float) -> Shift:
    """How far off other solvers have a graze, from the change of the number with the extremum's value."""

    def shift(family: Family) -> float | None:
        near = with_same_contacts(family, graze.place)
        mine = None if near is None else near.matching(graze.extremum, duration)
        if near is None or mine is None:
            return None
        return near.value - graze.place.value - graze.rate * (mine.value - graze.extremum.value)

    return shift
