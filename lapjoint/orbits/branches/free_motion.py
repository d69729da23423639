"""The motion without contact, from which a branch is followed even where a march from rest ends in another motion."""

from __future__ import annotations

import math

from lapjoint.errors import SolverError
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.tracing import Seed
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import find_orbit
from lapjoint.problem import Problem

_WIDE = 1e3
"""Gap over the length of the beam that no motion closes."""


@in_one_thread
def free_seed(family: Family, value: float) -> Seed | None:
    """The motion without contact.

    Where no stop is in the way the motion is linear, and Newton's method finds it at once; it is one of the problem
    itself if its march touches no stop there.

    Parameters
    ----------
    family : Family
        The period maps.
    value : float
        The number, in its SI unit.

    Returns
    -------
    Seed, or None
        None if there is no such motion, or it is not found.
    """
    try:
        half = HalfPeriods(family.solver_at(value).period_map(_out_of_reach(family.problem_at(value))))
        orbit = find_orbit(half, half.map.initial(), half.least, math.inf)
        if orbit is None:
            return None
        count = family.at(value).least  # out of reach, stops may mirror each other that do not where they are
        found = corrected(family, value, family.adopted(value, orbit.point), count, fixed=True)
    except SolverError:
        return None
    if found is None or any(found.closings) or any(found.point.state.closed):
        return None
    return Seed(value, found.point, count)


def _out_of_reach(problem: Problem) -> Problem:
    """The problem with stops where they are, but so far away that none is touched."""
    gap = _WIDE * problem.beam.length
    return problem.replace(stops=tuple(stop.model_copy(update={"gap": gap}) for stop in problem.stops))
