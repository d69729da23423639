"""Errors of bifurcations: each is located again by a finer self of the solver, and by a finer one still if need be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Finder, leads_back
from lapjoint.orbits.refinement import ROUNDING, Refinement

AIM = 1e-5
"""Error of a bifurcation over the scale of its number that is aimed at."""
_MOST = 3
"""Most finer solvers that are asked."""


@dataclass(frozen=True)
class Stated:
    """The value of a bifurcation with its error."""

    value: float
    """The number, in its SI unit."""
    error: float
    """Its error, in the same unit; infinite where none can be stated."""


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
        By the finest solver that was asked; its error is that of the one before it, with what its motion leaves of the
        way to a graze, and infinite where one of them does not find it.
    """
    error, scale = np.inf, family.scale(value)
    try:
        for _ in range(_MOST):
            finer = family.finer(value)
            if finer is None:
                break
            found = finder(finer[1], place)
            if found is None or not leads_back(family, place, finer[1], found, finder):
                return Stated(value, np.inf)
            bound = apart_by(finer[0], found.value - value)
            family, place, value = finer[1], found.place, found.value
            error = bound + found.left + ROUNDING * scale
            if bound <= AIM * scale:
                break
    except (InputError, SolverError):
        error = np.inf
    return Stated(value, error)
