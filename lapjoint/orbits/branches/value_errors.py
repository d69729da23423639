"""Errors of bifurcations: each is located again by a finer self of the solver, and by a finer one still if need be.

Two solvers may agree by chance: of 148 bifurcations of the lightly damped joint, four errors were too small.  So one
motion of the next finer one says to first order how far off that has it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import NEAR, SHARE_BACK, Again, Finder
from lapjoint.orbits.refinement import ROUNDING, Refinement

AIM = 1e-5
"""Error of a bifurcation over the scale of its number that is aimed at."""
_MOST = 5
"""Most finer solvers that are asked: of 3769 bifurcations of the lightly damped joint, the third left two errors larger
than is aimed at, and the fourth none."""
_SURE = 1e-5
"""Arc length between a bifurcation as two solvers have it within which it is not asked whether the way leads back: two
grazes of a stop may lie nearer than `found_again.NEAR`, and then solvers that agree may have the other one."""
_ALONG = 3e-6
"""The same for its part along the curve: most of the way between two solvers' motions leads off it, by the modes that
one of them has more.  Of 552 bifurcations of the lightly damped joint 146 lie nearer, and all of these lead back; of
another 135 up to 1e-5 two do not."""


@dataclass(frozen=True)
class Stated:
    """The value of a bifurcation with its error."""

    value: float
    """The number, in its SI unit."""
    error: float
    """Its error, in the same unit; infinite where none can be stated."""
    sure: bool = True
    """Whether the finer solver that is asked about two that agree has it, if there is one."""


def apart_by(refinement: Refinement, difference: float) -> float:
    """The error of a number that a finer solver has elsewhere.

    Parameters
    ----------
    refinement : Refinement
        What is known of the finer solver.
    difference : float
        How far apart both have it.

    Returns
    -------
    float
        In the same unit.
    """
    apart = np.array([difference])
    return float(refinement.bounds(apart, np.abs(apart))[0])


def stated(family: Family, place: Place, value: float, finder: Finder) -> Stated:
    """A bifurcation's value with its error.

    Parameters
    ----------
    family : Family
        The period maps by which it was found.
    place : Place
        The motion there.
    value : float
        The number there, in its SI unit.
    finder : callable
        Finds it by another solver.

    Returns
    -------
    Stated
        By the finest solver that located it; its error is that of the one before it, or its own by one motion of the
        next, where that is larger, with what its motion leaves of the way to a graze.  It is infinite where one of them
        does not find it, and not sure where only the one that is asked last does not.
    """
    error, scale, sure = np.inf, family.scale(value), True
    try:
        for _ in range(_MOST):
            finer = family.finer(value)
            if finer is None:
                break
            found = _same(family, place, value, finer[1], finder)
            if found is None:
                return Stated(value, np.inf)
            bound = apart_by(finer[0], found.value - value)
            family, place, value = finer[1], found.place, found.value
            if bound <= AIM * scale:
                more = _by_one_more(family, found, finder)
                bound, sure = max(bound, more or 0.0), more is not None
            error = bound + found.left + ROUNDING * scale
            if bound <= AIM * scale:
                break
    except (InputError, SolverError):
        error = np.inf
    return Stated(value, error, sure)


def _same(family: Family, place: Place, value: float, finer: Family, finder: Finder) -> Again | None:
    """A bifurcation as a finer solver has it, from the motion at it; None if what that finds is another one.

    From there the way leads back to the motion, or to the number: just before a graze, a motion is at some distance.
    Mostly its first step tells so, for one march instead of a search.  Near by, it is enough that the way does not lead
    to another one: motions beyond a graze are not carried back.
    """
    found = finder(finer, place)
    if found is None:
        return None
    chord, apart = found.place.chord(finer, place), abs(found.value - value)
    way, along = float(np.linalg.norm(chord)), abs(float(chord @ found.place.tangent))
    if apart <= _SURE * family.scale(value) and (way <= _SURE or along <= _ALONG):
        return found
    ahead = None if found.first_step is None else found.first_step(family)
    if ahead is not None:
        there = replace(place.beginning_at(ahead.point), value=ahead.value)
        if float(np.linalg.norm(place.chord(family, there))) <= SHARE_BACK * way:
            return found
    back = finder(family, found.place)
    if back is None:
        return found if way <= NEAR else None
    same = float(np.linalg.norm(back.place.chord(family, place))) <= SHARE_BACK * way
    return found if same or abs(back.value - value) <= SHARE_BACK * apart else None


def _by_one_more(family: Family, found: Again, finder: Finder) -> float | None:
    """The error of what two solvers agree on, by the next finer solver; None if that does not find it.

    Where its motion has other contacts, as it has the graze earlier, it locates it.
    """
    finer = family.finer(found.value)
    if finer is None:
        return 0.0
    shift = None if found.by_one_motion is None else found.by_one_motion(finer[1])
    if shift is None:
        try:
            there = _same(family, found.place, found.value, finer[1], finder)
        except (InputError, SolverError):
            there = None
        if there is None:
            return None
        shift = there.value - found.value
    return apart_by(finer[0], shift)
