"""Beyond where a curve is lost: a finer self of the solver goes on, and shows where the curve lies again.

At a graze the map of few modes may jump, so that no motion lies beyond, or none is found.  From a motion before, the
finer solver's curve is followed past it; from the first of its motions there that both solvers have, the curve is
followed again.  What lies between is a part that is not resolved, until `resolving` has the finer solver follow it.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import pairwise

import numpy as np

from lapjoint.orbits.branches.closing import has_been_at
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import alike
from lapjoint.orbits.branches.run import Jump, Limits, Run

_BRIDGES = 8
"""Most parts of a curve that are gone past so."""
_BACK = (1e-4, 1e-3, 1e-2)
"""Arc lengths before the end from which on a motion may be where the finer solver begins, in turn."""
_AHEAD = 0.02
"""Arc length beyond the end that the finer solver's curve is followed."""
_MOST = 60
"""Most points of it."""
_NEAR = 1e-5
"""Least such distance: a finer solver that has the same end, too, may have it a little farther on."""
_FAR = 0.05
"""Largest distance, over the size of the motion, of the motions on both sides of such a part."""
_LOST = ("lost", "graze")
"""How curves end that may go on."""


def followed(family: Family, start: Place, limits: Limits) -> Run:
    """Follow a curve from a place, in the direction of its tangent, past where it is lost.

    Parameters
    ----------
    family : Family
        The period maps.
    start : Place
        Where to begin.
    limits : Limits
        How far.

    Returns
    -------
    Run
        All places, with `start` as the first.
    """
    run = follow(family, start, limits)
    for _ in range(_BRIDGES):
        beyond = _beyond(family, run) if run.end in _LOST and len(run.places) < limits.most else None
        if beyond is None or has_been_at(family, run.places, beyond):
            break
        rest = follow(family, beyond, replace(limits, most=limits.most - len(run.places)))
        run = _one_after_other(run, rest)
    return run


def _beyond(family: Family, run: Run) -> Place | None:
    """The motion of a curve beyond its end, as a finer solver shows it; None if that does not go on either."""
    here = run.places[-1]
    known = family.finer(here.value)
    if known is None:
        return None
    finer = known[1]
    for place, length in _before(family, run):
        near = alike(finer, place)
        if near is None:
            continue
        there, gone = follow(finer, near, Limits(most=_MOST, length=length + _AHEAD)), 0.0
        for a, b in pairwise(there.places):
            gone += float(np.linalg.norm(b.chord(finer, a)))
            own = alike(family, b) if gone > length else None
            if own is not None and _NEAR <= float(np.linalg.norm(own.chord(family, here))) <= _FAR:
                return own
    return None


def _before(family: Family, run: Run) -> Iterator[tuple[Place, float]]:
    """Places before the end of a curve, and the arc length from each to there."""
    length, left = 0.0, list(_BACK)
    for a, b in pairwise(reversed(run.places)):
        length += float(np.linalg.norm(a.chord(family, b)))
        if left and length >= left[0]:
            yield b, length
            left = [one for one in left if one > length]


def _one_after_other(run: Run, rest: Run) -> Run:
    """Two curves as one, with a part between them that is not resolved, and in which the first does not end."""
    first, last = run.places[-1], rest.places[0]
    count = len(run.places)
    grazes = [graze for graze in run.grazes if graze.kind not in ("ends", "lost")]
    grazes += [replace(graze, index=graze.index + count) for graze in rest.grazes]
    jumps = [*run.jumps, Jump(first.value, last.value, count)]
    jumps += [replace(jump, index=jump.index + count) for jump in rest.jumps]
    return Run([*run.places, *rest.places], grazes, jumps, rest.end)
