r"""Across a graze, where the sequence of contacts changes and the map is not smooth.

On one side of a graze the map is smooth; on the other, where the stop is touched, its derivative may grow without bound
(as 1 / sqrt(h*) where the damping forces jump with the state).  So the curve is not stepped across: motions whose
extremum has a given value are looked for, for values ever nearer to zero, from the side where the curve comes from, and
then for one beyond.

The number at the graze is p - (dp/dh*) h* from the nearest motion.  On the smooth side that leaves the square of the
arc length, or more where the curve is about to turn (`OnExtremum.bent`).  On the other p - p* goes as a power q < 1 of
h*, and (1/q - 1) times what is taken off is left, as much again where q = 1/2; every solver leaves about the same, so
that no refinement shows it.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.extremum_search import OnExtremum, by_difference, on_extremum
from lapjoint.orbits.branches.extremum_shooting import by_stretches
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum, derivatives_of, turning_points
from lapjoint.orbits.branches.passings import Coming, coming, rates_of
from lapjoint.orbits.branches.run import Graze
from lapjoint.orbits.half_periods import gives
from lapjoint.orbits.period_map import Tangent
from lapjoint.orbits.segments import Segment, Segments

AT_GRAZE = 1e-5
"""Arc length to a graze up to which the curve is at it, before or behind."""
_BACKWARD = 0.5
"""Least cosine between the curve beyond a graze and the way back to it, where it has been gone across backward: above
0.98 where a curve came back over a graze that it had just crossed, and below 0.4 else."""
_CLOSE = 1e-6
"""Arc length to the graze, as the extremum's rate has it, at which it counts as located; the rest is taken off along
the tangent, and leaves the square of this.  Light contacts of a stiff stop are far less deep than its gap is wide, and
so no length of the problem is what an extremum can be compared with."""
_BEYOND = (3e-5, 3e-6, 1e-4, 1e-3)
"""Distances beyond a graze, as such arc lengths, at which the curve is looked for."""
_BEYOND_ROOT = (3e-5, 1e-5, 3e-6, 1e-4, 3e-4, 1e-3, 1e-6, 1e-7)
"""The same where the map changes as a root: other grazes may lie beside this one, or the curve go far away at once."""
_SURELY, _LOOKS = 2.0, 5
"""How much farther than to the nearest motion the derivative is taken on, and at how many shares of that, to tell that
no multiplier passes the unit circle there."""
_NEARLY = 3.0
"""Most by which a motion may be farther from a graze than is aimed at, and be just beyond it."""
_SHARE, _SHARES = 0.3, 8
"""Share of such a distance by which a graze is come nearer to from beyond, and most such steps: of 60 grazes, one in
seven had a bifurcation between where the curve goes on and the graze."""
_NEAREST = 0.1
"""The same from just beyond, where the map may change as a root: one of 40 had a bifurcation there, none nearer."""
_SLOW = 1e-3
"""Arc length within which a switch is about to vanish, as the rate of its turning point has it: half of what is left,
as that goes as the square."""
_JUST_BEYOND = 1e-5
"""The same at which it is seen whether a motion comes back."""
_SURE, _LEFT_AT_MOST = 1e-5, 10.0
"""Arc length between the motions on both sides of a graze, and distance of its numbers as both have it over what the
one may leave, up to which either shows that it is the same."""
_SHARE_BACK = 0.1
"""Most by which the way back across it may miss where it began, over the way between both: of 60, two missed all of
it, and the others 2e-4 at most."""
_SAME = 2e-4
"""Arc length between both up to which it is the same where no motion is found on the way back."""
_NEAR = 0.05
"""Arc length from the graze within which the motion beyond it must lie."""


def sharper(family: Family, graze: OnExtremum, other: OnExtremum | None, rate: float) -> OnExtremum:
    """The motion from which the number at a graze is best known: on its other side, if that is the smooth one.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.
    other : OnExtremum or None
        The motion just beyond it, if there is one.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    OnExtremum
        The motion before it, unless that leaves something, and there is one of the same graze that leaves less.
    """
    if other is None or other.left >= graze.left:
        return graze
    return other if _is_same(family, graze, other, rate) else graze


def _is_same(family: Family, graze: OnExtremum, other: OnExtremum, rate: float) -> bool:
    """Whether a motion on the other side is at the same graze: near by, or going back across it leads to the first one.

    Where several branches meet at a graze, it may lead to another one.
    """
    way = float(np.linalg.norm(other.place.chord(family, graze.place)))
    if way <= _SURE or abs(other.value - graze.value) <= _LEFT_AT_MOST * graze.left:
        return True
    target, scale = graze.extremum.value, abs(rate)
    for patiently in (False, True):
        back = on_extremum(family, other.place, other.extremum, target, scale, patiently=patiently)
        if back is not None:
            return _is_back(family, back, graze, way)
    return way <= _SAME


def _is_back(family: Family, back: OnExtremum, graze: OnExtremum, way: float) -> bool:
    """Whether the way back across a graze misses where it began by a small share of the way between both."""
    return float(np.linalg.norm(back.place.chord(family, graze.place))) <= _SHARE_BACK * way


def located_graze(family: Family, place: Place, extremum: Extremum, rate: float) -> OnExtremum | None:
    """The motion just before a graze, on the side of a place.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        A motion near the graze.
    extremum : Extremum
        Its extremum that vanishes there.
    rate : float
        Change of its value with the arc length, m.

    Returns
    -------
    OnExtremum, or None
        Within `_CLOSE` of the graze, or else a little farther off; None if Newton's method does not lead there, or to a
        motion that repeats sooner.
    """
    scale = abs(rate)
    end = float(np.copysign(_CLOSE * scale, extremum.value))
    if abs(extremum.value) <= abs(end):
        end = extremum.value
    found = on_extremum(family, place, extremum, end, scale, towards=True)
    return found if found is not None and _is_of_its_branch(found.place, place) else None


def graze_near(family: Family, near: Place, like: OnExtremum, rate: float) -> OnExtremum | None:
    """The motion just before a graze that another solver has.

    Parameters
    ----------
    family : Family
        The period maps.
    near : Place
        A motion by these near the graze.
    like : OnExtremum
        The motion just before it by the other solver.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    OnExtremum, or None
        As `located_graze` has it; None, too, if the motion has no such extremum.
    """
    extremum = near.matching(like.extremum, like.place.extrema.duration)
    return None if extremum is None else located_graze(family, near, extremum, rate)


def _is_of_its_branch(found: Place, place: Place) -> bool:
    """Whether a motion has the contacts of the one from which it was found, and does not repeat sooner."""
    return found.closings == place.closings and not found.repeats_sooner_than(place)


def beyond_graze(family: Family, graze: OnExtremum, rate: float) -> OnExtremum | None:
    """The motion on the other side of a graze, a little beyond it.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    OnExtremum, or None
        None if Newton's method finds none: the branch ends at the graze.
    """

    def found(share: float, patiently: bool, stretches: bool = False) -> OnExtremum | None:
        target = -float(np.copysign(share * abs(rate), graze.extremum.value))
        if stretches:
            there = by_stretches(family, graze.place, graze.extremum, target, abs(rate))
        else:
            there = on_extremum(family, graze.place, graze.extremum, target, abs(rate), patiently=patiently)
        if there is None or float(np.linalg.norm(there.place.chord(family, graze.place))) > _NEAR:
            return None
        changed = np.subtract(there.place.closings, graze.place.closings)
        count = int(np.abs(changed).sum())
        if count != abs(int(changed.sum())):  # one contact has come, and another gone: two grazes lie between
            return None
        if count != 1 and there.place.repeats_sooner_than(graze.place):  # one half alone grazes here
            return None
        if stretches and not _comes_from(family, graze, there, rate):
            return None
        return there if count == 1 or (count and not patiently) else None

    if graze.extremum.segment is not None and leaves_at(family, graze, rate):
        return None
    there = next((one for share in _BEYOND if (one := found(share, False))), None)
    if there is None and graze.close:
        there = next((one for share in _BEYOND if (one := found(share, True, stretches=True))), None)
    if there is None and graze.close:
        there = next((one for share in _BEYOND_ROOT if (one := found(share, True))), None)
    return there


def _comes_from(family: Family, graze: OnExtremum, beyond: OnExtremum, rate: float) -> bool:
    """Whether the way back across a graze leads to where it was come from.

    Several section points reach far, to the motions of another branch, too, which has a graze of its own.  Of what is
    found from one it is not asked, as extrema jump at grazes: the curves of finer solvers led across 29 of 35 that did
    not lead back, and across 112 of 126 that did; most others they have a little elsewhere.
    """
    back = by_stretches(family, beyond.place, beyond.extremum, graze.extremum.value, abs(rate))
    way = float(np.linalg.norm(beyond.place.chord(family, graze.place)))
    return back is not None and _is_back(family, back, graze, way)


def slow_switch(family: Family, place: Place) -> Coming | None:
    """The graze at which the next switch of a motion vanishes, because the motion comes to it ever more slowly.

    Beyond that switch it need not turn, see `same_turning_point`; so no extremum of the motion itself shows this graze.

    Parameters
    ----------
    family : Family
        The period maps.
    place : Place
        A motion near the graze, with its tangent towards it.

    Returns
    -------
    Coming, or None
        With the turning point just beyond the switch; None if there is none within `_SLOW`, or the solver does not give
        its motions in closed form.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    found = place.orbit.last
    if not gives(place.half_periods.map, Tangent) or not place.half_periods.structure.stops:
        return None
    there = list[Coming]()
    for one in turning_points(found):
        row, slope = derivatives_of(found, one)
        if slope is None:
            slope = by_difference(family, place.value, found, one)[1]
        rate = float(np.append(row / place.weights, slope * family.scale(place.value)) @ place.tangent)
        if rate * one.value < 0 and abs(one.value) <= _SLOW * abs(rate):
            there.append(Coming(one, rate))
    return min(there, key=lambda one: one.length) if there else None


def leaves_at(family: Family, graze: OnExtremum, rate: float) -> bool:
    """Whether a motion just beyond a graze does not come back from it: the map jumps, and a branch does end.

    It is so where the damping forces jump by so much with the contact state that the stop's gap function is bent the
    other way in the other state: what has crossed goes on, and is not turned back.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : OnExtremum
        The motion just before it.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    bool
        Whether it is; False where the solver does not give its motions in closed form.

    Raises
    ------
    SolverError
        If the march cannot go on.
    """
    place, one = graze.place, graze.extremum
    half, last = place.half_periods, place.orbit.last
    if not gives(half.map, Tangent):
        return False
    if (one.value > 0) == one.highest:  # it has crossed
        return _is_driven_on(last.linearised.motion, one)
    row = derivatives_of(last, one)[0] / place.weights
    across = -float(np.copysign(_JUST_BEYOND * abs(rate), one.value)) - one.value
    point = half.map.moved(place.point, across * row / float(row @ row) / place.weights)
    return _is_driven_on(family.linearised(place.value, point, place.count).linearised.motion, one)


def _is_driven_on(segments: Segments, one: Extremum) -> bool:
    """Whether a motion that has crossed a graze does not turn in the state beyond, though it would in that before."""
    switches = np.flatnonzero(segments.switched[:-1] == one.at)
    if not switches.size:
        return False
    i = int(switches[np.argmin(np.abs(segments.end[switches] - one.time))])
    before, after = (_acceleration(segments[k], one.at, float(segments.end[i])) for k in (i, i + 1))
    return before * after < 0


def _acceleration(segment: Segment, k: int, t: float) -> float:
    """That of stop `k` at a time of a segment, m/s2."""
    wave = segment.weights[k] * segment.amplitudes * np.exp(segment.rates * (t - segment.start))
    return float((wave @ segment.rates**2).real) + 2 * float(segment.polynomial[k, 2])


def across(
    family: Family, here: Place, soon: Coming, index: int, sooner: bool = True
) -> tuple[Graze, tuple[Place, ...]] | None:
    """A graze after a place, and the places beyond it: just beyond, if there is one, and where the curve goes on.

    Where there is none beyond, it may be that another extremum vanishes sooner, which arises on the way to this graze:
    then it is that one's.

    Parameters
    ----------
    family : Family
        The period maps.
    here : Place
        The place.
    soon : Coming
        The graze, as the rates there have it.
    index : int
        Number of the place beyond it on the curve.
    sooner : bool
        Whether to look for one that comes sooner.

    Returns
    -------
    tuple of Graze and tuple of Place, or None
        The graze ``ends`` the curve where there is no place beyond it; None if it is not found.
    """
    extremum = soon.extremum
    graze = located_graze(family, here, extremum, soon.rate)
    if graze is None:
        return None
    before, beyond = graze.place.going_on_from(here), beyond_graze(family, graze, soon.rate)
    first = _vanishes_sooner(family, before, soon) if beyond is None and sooner else None
    there = None if first is None else across(family, before, first, index, sooner=False)
    if there is not None and there[1]:
        return there
    if beyond is None:
        return Graze(extremum.stop, graze.value, "ends", graze, soon.rate, index, graze.left), ()
    inside = _stays_inside(before, beyond, soon.rate)
    other = None if inside and not graze.touched else just_beyond(family, beyond, soon.rate)
    best, after = sharper(family, graze, other, soon.rate), beyond.place.going_on_from(here)
    if _leads_back(family, before, after):
        return None
    nearer, seen = ([], True) if inside else nearer_to_graze(family, before, beyond, other, soon.rate)
    came, goes = before.tangent[-1], after.tangent[-1]
    kind = "persists" if came * goes > 0 else "folds"
    return Graze(extremum.stop, best.value, kind, graze, soon.rate, index, best.left, seen), (*nearer, after)


def _stays_inside(before: Place, beyond: OnExtremum, rate: float) -> bool:
    """Whether no multiplier passes the circle between a graze and a motion beyond it, if they change as its root.

    The map's derivative differs from that before the graze by as much more as the root of the distance is smaller.
    """
    orbits = before.orbit, beyond.place.orbit
    first, last = (orbit.last.matrix for orbit in orbits)
    if first.shape != last.shape or not all(orbit.moduli.max() < 1 for orbit in orbits):
        return False
    most = _SURELY * np.sqrt(max(abs(beyond.extremum.value) / (_NEAREST * _CLOSE * abs(rate)), 1.0))
    shares = np.geomspace(1.0, most, _LOOKS)[1:]
    return all(np.abs(np.linalg.eigvals(first + share * (last - first))).max() < 1 for share in shares)


def just_beyond(family: Family, beyond: OnExtremum, rate: float) -> OnExtremum | None:
    """The motion just beyond a graze, from one a little farther.

    Parameters
    ----------
    family : Family
        The period maps.
    beyond : OnExtremum
        The motion beyond it.
    rate : float
        Change of the extremum's value with the arc length before the graze, m.

    Returns
    -------
    OnExtremum, or None
        As `located_graze`.
    """
    return located_graze(family, beyond.place, beyond.extremum, rate)


def seen_from_beyond(family: Family, graze: Graze) -> Graze | None:
    """A graze as the curve comes to it from its other side.

    Parameters
    ----------
    family : Family
        The period maps.
    graze : Graze
        The graze.

    Returns
    -------
    Graze, or None
        With a motion a little beyond as the one just before it; None if there is none beyond, or another contact comes
        or goes on the way, so that it need not be this graze to which the curve comes from there.
    """
    beyond = beyond_graze(family, graze.before, graze.rate)
    if beyond is None or not one_contact_apart(graze, beyond.place):
        return None
    place, value = beyond.place, beyond.extremum.value
    rate = float(place.tangent[-1]) * family.scale(place.value) / beyond.rate
    if rate * value > 0:  # it leads away
        place, rate = place.turned(), -rate
    return replace(graze, value=beyond.value, before=replace(beyond, place=place), rate=rate, left=beyond.left)


def one_contact_apart(graze: Graze, place: Place) -> bool:
    """Whether a motion has one contact of the stop that is grazed more or less than that at the graze, and no other.

    Parameters
    ----------
    graze : Graze
        The graze.
    place : Place
        The motion.

    Returns
    -------
    bool
        Whether it is so.
    """
    apart = np.abs(np.subtract(place.closings, graze.before.place.closings))
    return bool(apart[graze.stop] == apart.sum() == 1)


def nearer_to_graze(
    family: Family, before: Place, beyond: OnExtremum, other: OnExtremum | None, rate: float
) -> tuple[list[Place], bool]:
    """Motions nearer to a graze than one beyond it, and whether they lead to it.

    If none just beyond it is known, it is come to step by step, as far as extrema do not jump.

    Parameters
    ----------
    family : Family
        The period maps.
    before : Place
        The motion just before the graze.
    beyond : OnExtremum
        The one beyond it.
    other : OnExtremum or None
        That of `just_beyond`.
    rate : float
        Change of the extremum's value with the arc length before it, m.

    Returns
    -------
    tuple of list of Place and bool
        The nearest first.
    """
    known, behind = other, beyond
    for _ in range(_SHARES if other is None else 0):
        there = _at_share(family, behind, _SHARE, rate)
        if there is None or not abs(there.extremum.value) < abs(behind.extremum.value):
            break
        known = behind = there
        if abs(there.extremum.value) <= _CLOSE * abs(rate):
            break
    nearest = _at_share(family, known, _NEAREST, rate) if known is not None and known.touched else None
    sequence = [one for one in (nearest, known, beyond) if one is not None]
    ways = [float(np.linalg.norm(one.place.chord(family, before))) for one in sequence]
    there_too = [one for one, way, farther in zip(sequence[:-1], ways[:-1], ways[1:], strict=True) if way < farther]
    last = (there_too or [beyond])[0]
    seen = abs(last.extremum.value) <= _NEARLY * _CLOSE * abs(rate) or min(ways) <= AT_GRAZE
    return [one.place.going_on_from(before) for one in there_too], seen


def _at_share(family: Family, beyond: OnExtremum, share: float, rate: float) -> OnExtremum | None:
    """The motion beyond a graze at a share of the distance, with the same contacts."""
    found = on_extremum(family, beyond.place, beyond.extremum, share * beyond.extremum.value, abs(rate))
    return found if found is not None and _is_of_its_branch(found.place, beyond.place) else None


def _vanishes_sooner(family: Family, place: Place, than: Coming) -> Coming | None:
    """The graze that comes before the one just before which a place is; None if that is the first."""
    first = coming(place, rates_of(family, place))
    if first is None or first.length > AT_GRAZE:
        return None
    mine, its = than.extremum, first.extremum
    return None if (mine.at, mine.highest) == (its.at, its.highest) else first


def _leads_back(family: Family, before: Place, after: Place) -> bool:
    """Whether the way across a graze goes against the curve on both sides: it is gone back, across a graze behind.

    On one side alone it may: there the curve turns as soon as the map's root outweighs what is smooth.
    """
    way = after.chord(family, before)
    ahead = float(way @ after.tangent) / max(float(np.linalg.norm(way)), 1e-300)
    return ahead < -_BACKWARD and float(way @ before.tangent) < 0
