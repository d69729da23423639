"""Two bifurcations of a curve that a finer self of the solver has at one motion: at most one of them is there.

A map of few modes may jump at a graze: its curve has that graze twice, as it is from either side, and a finer self has
it once.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import NEAR, SHARE_BACK
from lapjoint.orbits.branches.found_along import directly, motion_at
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.run import Graze
from lapjoint.orbits.refinement import ROUNDING

_SELVES = 3
"""Most finer selves that are asked: of the pair that is known, each has its two a twentieth as far apart as the one
before."""


def doubted(found: Sequence[Listed]) -> list[Listed]:
    """Bifurcations of a curve, without the error of one that a finer self has where it has another one.

    Parameters
    ----------
    found : sequence of Listed
        All of a curve by one self of the solver, with their errors.

    Returns
    -------
    list of Listed
        The same; of two that coincide, the one that moves farther has an infinite error.
    """
    now = list(found)
    for i, j in combinations(range(len(now)), 2):
        one, other = now[i], now[j]
        if one.found is None or other.found is None or not _may_be_one(one, other):
            continue
        moved = _moved_together(one.family, one.found, other.found)
        if moved is not None:
            k = i if moved[0] > moved[1] else j
            now[k] = replace(now[k], bifurcation=replace(now[k].bifurcation, error=np.inf))
    return now


def _may_be_one(one: Listed, other: Listed) -> bool:
    """Whether two are of one kind, and no farther apart than their errors say; what has none is in doubt already."""
    a, b = one.bifurcation, other.bifurcation
    same = (a.kind, a.stop) == (b.kind, b.stop) and not (one.doubtful or other.doubtful)
    return same and abs(a.value - b.value) <= a.error + b.error


def _moved_together(family: Family, one: Located | Graze, other: Located | Graze) -> tuple[float, float] | None:
    """How far the numbers of two move to where a finer self has both at once; None if none has."""
    first, finders = (one.value, other.value), (directly(one), directly(other))
    places, scale = (motion_at(one), motion_at(other)), family.scale(one.value)
    most = SHARE_BACK * abs(first[1] - first[0]) + ROUNDING * scale
    for _ in range(_SELVES):
        known = family.finer(first[0])
        if known is None:
            return None
        family = known[1]
        try:
            a, b = finders[0](family, places[0]), finders[1](family, places[1])
        except (InputError, SolverError):
            return None
        if a is None or b is None:
            return None
        places = a.place, b.place
        if abs(b.value - a.value) <= most and float(np.linalg.norm(a.place.chord(family, b.place))) <= NEAR:
            return abs(a.value - first[0]), abs(b.value - first[1])
    return None
