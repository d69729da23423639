"""Errors of bifurcations: each is located again by a finer self of the solver, and by a finer one still if need be."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import Kind, located, tests_of
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum
from lapjoint.orbits.branches.grazing import located_graze
from lapjoint.orbits.refinement import ROUNDING

AIM = 1e-5
"""Error of a bifurcation over the scale of its number that is aimed at."""
_MOST = 3
"""Most finer solvers that are asked."""
_REACHES = (1e-3, 1e-2, 5e-2)
"""Arc lengths, to both sides of where the coarser solver has it, within which a bifurcation is looked for."""


@dataclass(frozen=True)
class Stated:
    """The value of a bifurcation with its error."""

    value: float
    """The number, in its SI unit."""
    error: float
    """Its error, in the same unit; infinite where none can be stated."""


Finder = Callable[[Family, Place], tuple[Place, float] | None]
"""Finds a bifurcation by another solver from where one has it: the motion just at it, and the number."""


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
        By the finest solver that was asked; its error is that of the one before it.
    """
    error, scale = np.inf, family.scale(value)
    try:
        for _ in range(_MOST):
            finer = family.finer(value)
            found = None if finer is None else finder(finer[1], place)
            if finer is None or found is None:
                break
            apart = np.array([found[1] - value])
            error = float(finer[0].bounds(apart, np.abs(apart))[0]) + ROUNDING * scale
            family, (place, value) = finer[1], found
            if error <= AIM * scale:
                break
    except (InputError, SolverError):
        pass
    return Stated(value, error)


def smooth_finder(kind: Kind) -> Finder:
    """Finds a bifurcation of a smooth part of a curve.

    Parameters
    ----------
    kind : str
        Its kind.

    Returns
    -------
    Finder
        The function.
    """

    def find(family: Family, place: Place) -> tuple[Place, float] | None:
        near = corrected(family, place.value, family.adopted(place.value, place.point), place.count)
        if near is None:
            return None
        count, distance = tests_of(near)[kind]
        for reach in _REACHES:
            ends = []
            for step in (-reach, reach):
                value, guess = near.moved(family, step * near.tangent)
                end = corrected(family, value, guess, near.count)
                if end is not None:
                    ends.append(end.along(np.sign(step) * end.chord(family, near)))
            if len(ends) == 2 and count(ends[0]) != count(ends[1]):
                found = located(family, ends[0], ends[1], count, distance)
                return None if found is None else (found, found.value)
        return None

    return find


def graze_finder(extremum: Extremum, rate: float, duration: float) -> Finder:
    """Finds a graze.

    Parameters
    ----------
    extremum : Extremum
        The extremum that vanishes there, as the coarsest solver has it just before.
    rate : float
        Change of its value with the arc length before it, m.
    duration : float
        Length of the motion there, s.

    Returns
    -------
    Finder
        The function.
    """

    def find(family: Family, place: Place) -> tuple[Place, float] | None:
        near = corrected(family, place.value, family.adopted(place.value, place.point), place.count)
        mine = None if near is None else near.extrema.matching(extremum, duration)
        graze = None if near is None or mine is None else located_graze(family, near, mine, rate)
        if graze is None:
            return None
        return graze.place, graze.place.value - graze.rate * graze.extremum.value

    return find
