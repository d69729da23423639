"""Errors of bifurcations: each is located again by a finer self of the solver, and by a finer one still if need be."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Finder
from lapjoint.orbits.refinement import ROUNDING

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
        By the finest solver that was asked; its error is that of the one before it, and infinite where one of them does
        not find it.
    """
    error, scale = np.inf, family.scale(value)
    try:
        for _ in range(_MOST):
            finer = family.finer(value)
            if finer is None:
                break
            found = finder(finer[1], place)
            if found is None:
                return Stated(value, np.inf)
            apart = np.array([found[1] - value])
            error = float(finer[0].bounds(apart, np.abs(apart))[0]) + ROUNDING * scale
            family, (place, value) = finer[1], found
            if error <= AIM * scale:
                break
    except (InputError, SolverError):
        error = np.inf
    return Stated(value, error)
