"""Whether a problem is its own mirror image, z -> -z half a period later."""

from __future__ import annotations

from functools import lru_cache

from lapjoint.problem import Problem
from lapjoint.problem.structure import Structure
from lapjoint.problem.supports_and_stops import PlacedStop

_Key = tuple[tuple[tuple[float, float], ...], float, float, float, float, bool]
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
    keys = [(*_seen(stop, 1), stop.gap, stop.stiffness, stop.damping, stop.may_pull) for stop in structure.stops]
    mirrored = [(*_seen(stop, -1), *key[2:]) for stop, key in zip(structure.stops, keys, strict=True)]
    if sorted(keys) != sorted(mirrored):
        return None
    free: dict[_Key, list[int]] = {}
    for k, key in enumerate(keys):
        free.setdefault(key, []).append(k)
    return tuple(free[key].pop(0) for key in mirrored)


def _seen(stop: PlacedStop, mirror: int) -> tuple[tuple[tuple[float, float], ...], float]:
    """Which displacements close a stop, with their factors, and its share of the base's motion; `mirror` is 1 or -1."""
    factor = mirror * stop.sign
    return tuple(sorted((x, factor * a) for x, a in stop.reading)), factor * stop.base_share
