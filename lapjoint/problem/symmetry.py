"""Whether a problem is its own mirror image, z -> -z half a period later."""

from __future__ import annotations

from functools import lru_cache

from lapjoint.problem import Problem
from lapjoint.problem.structure import Structure

_Key = tuple[tuple[float, bool], float, float, float, bool]
_KEPT = 64
"""Number of structures whose twins are cached: all problems of one sweep, or of one branch, mostly share one
structure."""


def mirror_twins(problem: Problem) -> tuple[int, ...] | None:
    """For each stop the index of its twin on the other side, if the problem is its own mirror image; else None.

    A problem is its own mirror image if all forces change sign in half a period, which excludes constant forces and
    even harmonics, and if the stops of both sides agree in place, gap, stiffness and damping. A problem without an
    excitation frequency has no half period, and no mirror image.
    """
    return stop_twins(problem.structure) if problem.forces.change_sign else None


@lru_cache(maxsize=_KEPT)
def stop_twins(structure: Structure) -> tuple[int, ...] | None:
    """The twin of each stop on the other side, if both sides agree in place, gap, stiffness and damping; else None."""
    sides: dict[str, list[tuple[_Key, int]]] = {"top": [], "bottom": []}
    for k, stop in enumerate(structure.stops):
        sides[stop.side].append(((stop.place, stop.gap, stop.stiffness, stop.damping, stop.may_pull), k))
    top, bottom = (sorted(sides[side]) for side in ("top", "bottom"))
    if [key for key, _ in top] != [key for key, _ in bottom]:
        return None
    twins = {a: b for (_, a), (_, b) in zip(top, bottom, strict=True)}
    twins |= {b: a for a, b in twins.items()}
    return tuple(twins[k] for k in range(len(structure.stops)))
