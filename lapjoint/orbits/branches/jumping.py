"""The motion beyond a part of a curve that cannot be followed, and is left out.

At a graze truncated modes may make an extremum jump past zero, so that no motion lies on it.  The curve goes on a
little apart from where it came to it, with other contacts, either way.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family

WIDTHS = (1e-6, 1e-5, 1e-4, 1e-3, 3e-3)
"""Widths, over the scale of the number, of parts that are left out where a curve cannot be followed."""
_AS_FAR, _LATEST = 0.2, 40
"""Share of such a width that a place is behind from which what lies beyond is guessed, and the most places to it."""
_FAR = 0.05
"""Largest distance, over the size of the motion, of the motions on both sides of such a part."""
_BESIDE = (1e-7, 1e-6, 1e-5)
"""Arc lengths beyond a jump of the map from which Newton's method is to find a motion, in turn."""
_ADJACENT = 1e-3
"""Largest distance, over the size of the motion, of the motions on both sides of a jump: most are below 2e-4."""
_SETTLING = 8
"""Number of the motion's periods that are marched to settle beyond such a part."""


def jumped(family: Family, places: Sequence[Place], least: int) -> tuple[Place, int] | None:
    """The motion some way on that is much like the last one, where the curve between them cannot be followed.

    If motions nearby settle on it, it is marched for some periods there; else Newton's method must find it: along the
    tangent, or along that of a place some way behind, which a graze that is near does not turn yet.  The widths
    that are left out are tried in turn; the number goes with the motion.  A motion that is as stable as this one is
    preferred: just before a graze, where the map's derivative grows, it need not be.

    Parameters
    ----------
    family : Family
        The period maps.
    places : sequence of Place
        The curve so far; at least one.
    least : int
        Number of the width that is tried first.

    Returns
    -------
    tuple of Place and int, or None
        The motion and the number of the width; None if there is none.
    """
    here = places[-1]
    sign, otherwise = math.copysign(1.0, here.tangent[-1]), None
    for width, share in list(enumerate(WIDTHS))[least:]:
        value = here.value + sign * share * family.scale(here.value)
        if not family.covers(value):
            break
        guesses = [here.moved(family, share / abs(here.tangent[-1]) * here.tangent)[1]] if here.tangent[-1] else []
        behind = _behind(family, places, share)
        if behind is not None:
            ahead = (value - behind.value) / family.scale(behind.value) / behind.tangent[-1]
            guesses.append(behind.moved(family, ahead * behind.tangent)[1])
        point = family.adopted(value, here.point)
        if here.orbit.stable:
            for _ in range(_SETTLING):
                point = family.at(value).marched(point, here.count)
        for guess in [*guesses, point]:
            found = corrected(family, value, guess, here.count, fixed=True)
            if found is None:
                continue
            chord = found.chord(family, here)
            beyond = found.along(np.append(np.zeros(chord.size - 1), sign)), width
            if float(np.linalg.norm(chord)) <= _FAR and beyond[0].orientation == here.orientation:
                if found.orbit.stable == here.orbit.stable:
                    return beyond
                otherwise = otherwise or beyond
    return otherwise


def across_jump(family: Family, here: Place) -> Place | None:
    """The motion with other contacts next to one beside which the map jumps, as the curve goes on from it, either way.

    Parameters
    ----------
    family : Family
        The period maps.
    here : Place
        The last motion of the curve.

    Returns
    -------
    Place, or None
        With its tangent the way that the curve goes on, as its orientation tells; None if there is none.
    """
    for found in _beside(family, here):
        if found is None:
            continue
        near = float(np.linalg.norm(found.chord(family, here))) <= _ADJACENT
        if near and found.closings != here.closings and family.covers(found.value):
            return found if found.orientation == here.orientation else found.turned()
    return None


def _beside(family: Family, here: Place) -> Iterator[Place | None]:
    """Motions found from guesses a little farther along the curve: the nearest to them, and at numbers to both sides.

    None for a guess from which none is found.  Where the curve turns sharply, what is nearest to a guess beyond may lie
    on the part that it came along.
    """
    for length in _BESIDE:
        value, guess = here.moved(family, length * here.tangent)
        yield corrected(family, value, guess, here.count)
        for sign in (-1.0, 1.0):
            value = here.value + sign * length * family.scale(here.value)
            if family.covers(value):
                yield corrected(family, value, family.adopted(value, guess), here.count, fixed=True)


def _behind(family: Family, places: Sequence[Place], share: float) -> Place | None:
    """The last place with the same contacts that is a fifth as far behind as a part to be left out is wide."""
    here, far = places[-1], _AS_FAR * share * family.scale(places[-1].value)
    for one in reversed(places[max(len(places) - _LATEST, 0) : -1]):
        if one.closings != here.closings or (here.value - one.value) * one.tangent[-1] <= 0:
            return None
        if abs(here.value - one.value) >= far:
            return one
    return None
