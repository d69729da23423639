"""Whether a problem is its own mirror image, z -> -z half a period later."""

from __future__ import annotations

from lapjoint.problem import Problem


def mirror_twins(problem: Problem) -> tuple[int, ...] | None:
    """The twin of each stop on the other side, if the problem is its own mirror image; else None.

    It is if all forces change sign in half a period, so that none is constant and none repeats after an even part of
    the period, and if the stops of both sides agree in position, gap and stiffness.

    Parameters
    ----------
    problem : Problem
        Any problem; one without a single excitation frequency has no half period, and so no mirror image.

    Returns
    -------
    tuple of int, or None
        For each stop the index of its twin, as indices into ``problem.stops``.
    """
    if not problem.forces.change_sign:
        return None
    sides: dict[str, list[tuple[tuple[float, float, float], int]]] = {"top": [], "bottom": []}
    for k, stop in enumerate(problem.stops):
        sides[stop.side].append(((stop.x, stop.gap, stop.stiffness), k))
    top, bottom = (sorted(sides[side]) for side in ("top", "bottom"))
    if [key for key, _ in top] != [key for key, _ in bottom]:
        return None
    twins = {a: b for (_, a), (_, b) in zip(top, bottom, strict=True)}
    twins |= {b: a for a, b in twins.items()}
    return tuple(twins[k] for k in range(len(problem.stops)))
