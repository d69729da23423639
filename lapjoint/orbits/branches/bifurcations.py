r"""Bifurcations between two places of a curve: found by their multipliers, and located where a test function vanishes.

Between neighbours with the same contacts the map is smooth.  With M the derivative of the map over the motion's half
periods, mu its eigenvalues and (u, w) the curve's tangent, there lies

    a fold              where w changes its sign,
    a flip              where a real mu passes -1; over an odd number of half periods it breaks the motion's symmetry,
    a Neimark-Sacker    where a complex pair passes the unit circle.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family

Kind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking"]
_REAL = 1e-6
"""Imaginary part of a multiplier over its modulus, up to which it is real."""
_STEPS = 40
"""Most steps of the search for the root of a test function."""
_LOCATED = 1e-9
"""Change of the number over its scale, and of the motion over its size, at which a bifurcation is located; and the
value of a test function there."""
_STUCK = 3
"""Number of steps in turn that leave more than half of what was left, after which it is halved."""


_VANISHES = 1e-4
"""Value of a test function up to which it vanishes: a pair of multipliers that turns real, outside the circle or on the
other side of -1, changes what is counted, too, but is no bifurcation."""


@dataclass(frozen=True)
class Located:
    """A bifurcation of a smooth part of a curve."""

    kind: Kind
    """What it is."""
    place: Place
    """The motion there."""


def between(family: Family, first: Place, last: Place) -> Iterator[Located]:
    """The bifurcations between two neighbouring places with the same contacts, in the sequence of their kinds.

    Parameters
    ----------
    family : Family
        The period maps.
    first, last : Place
        Their tangents point in the direction in which the curve is followed.

    Yields
    ------
    Located
        Of each kind one at most.
    """
    for kind, (count, distance) in tests_of(first).items():
        if count(first) != count(last):
            found = located(family, first, last, count, distance)
            if found is not None and abs(distance(found)) <= _VANISHES:
                yield Located(kind, found)


def tests_of(place: Place) -> dict[Kind, tuple[Callable[[Place], int], Callable[[Place], float]]]:
    """What is counted, and what vanishes where the count changes, for each kind that a branch may have.

    Parameters
    ----------
    place : Place
        A place of the branch.

    Returns
    -------
    dict
        By the kind of the bifurcation.
    """
    return {
        "fold": (lambda at: int(at.tangent[-1] > 0), lambda at: float(at.tangent[-1])),
        "symmetry breaking" if place.count % 2 else "flip": (_beyond_minus_one, _from_minus_one),
        "neimark-sacker": (_pairs_outside, _from_circle),
    }


def located(
    family: Family,
    first: Place,
    last: Place,
    count: Callable[[Place], int],
    distance: Callable[[Place], float],
) -> Place | None:
    """The place between two at which something that is counted changes.

    Parameters
    ----------
    family : Family
        The period maps.
    first, last : Place
        Neighbours, between which the count changes.
    count : callable
        Gives the count at a place.
    distance : callable
        Gives a number that vanishes where it changes.

    Returns
    -------
    Place, or None
        None if a place between the two is not found.
    """
    a, b, before = first, last, count(first)
    fa, fb, stuck = abs(distance(a)), -abs(distance(b)), 0
    for _ in range(_STEPS):
        length = float(np.linalg.norm(b.chord(family, a)))
        if length <= _LOCATED:
            return a
        share = 0.5 if fa == fb or stuck >= _STUCK else fa / (fa - fb)
        here = between_two(family, a, b, min(max(share, 1e-3), 1 - 1e-3), length)
        if here is None:
            return None
        value = distance(here)
        if abs(value) <= _LOCATED:
            return here
        if count(here) == before:
            stuck = stuck + 1 if share < 0.5 else 0
            a, fb, fa = here, fb * _anderson(abs(value), fa) if stuck else fb, abs(value)
        else:
            stuck = stuck + 1 if share > 0.5 else 0
            b, fa, fb = here, fa * _anderson(abs(value), -fb) if stuck else fa, -abs(value)
    return a


def _anderson(value: float, before: float) -> float:
    """What the other end's value is multiplied by where the root stays on its side: Anderson's and Bjoerck's rule."""
    share = 1 - value / before
    return share if share > 0 else 0.5


def between_two(family: Family, a: Place, b: Place, share: float, length: float) -> Place | None:
    """A place between two neighbours.

    Parameters
    ----------
    family : Family
        The period maps.
    a, b : Place
        The two, with tangents in one direction.
    share : float
        How far from `a` towards `b`, 0 to 1.
    length : float
        Arc length between them.

    Returns
    -------
    Place, or None
        None if Newton's method finds none.
    """
    near, far, step = (a, b, share * length) if share <= 0.5 else (b, a, -(1 - share) * length)
    value, guess = near.moved(family, step * near.tangent)
    found = corrected(family, value, guess, near.count)
    if found is None:
        value, guess = near.moved(family, -min(share, 1 - share) * near.chord(family, far))
        found = corrected(family, value, guess, near.count)
    if found is None:
        return None
    chord = found.chord(family, near)
    return found.along(chord if near is a else -chord)


def crosses_minus_one(place: Place) -> tuple[complex, np.ndarray]:
    """The real multiplier nearest to -1, and its eigenvector.

    Parameters
    ----------
    place : Place
        A place at a flip, or where a symmetry breaks.

    Returns
    -------
    tuple of complex and ndarray, shape (n,)
        The multiplier over the motion's half periods, and the vector in the coordinates of its section point.
    """
    values, vectors = place.orbit.spectrum
    k = int(np.argmin(np.abs(values + 1)))
    return complex(values[k]), np.real(vectors[:, k])


def _beyond_minus_one(place: Place) -> int:
    """Number of real multipliers below -1."""
    return int(np.count_nonzero(_real(place) < -1))


def _from_minus_one(place: Place) -> float:
    real = _real(place)
    return float(real[np.argmin(np.abs(real + 1))] + 1) if real.size else 1.0


def _pairs_outside(place: Place) -> int:
    """Number of complex pairs outside the unit circle; real ones that come together there count as none passing it."""
    values = place.orbit.spectrum[0]
    pairs = (np.abs(values.imag) > _REAL * np.abs(values)) & (values.imag > 0)
    return int(np.count_nonzero(pairs & (np.abs(values) > 1)))


def _from_circle(place: Place) -> float:
    values = place.orbit.spectrum[0]
    pairs = values[(np.abs(values.imag) > _REAL * np.abs(values)) & (values.imag > 0)]
    return float(np.abs(pairs[np.argmin(np.abs(np.abs(pairs) - 1))]) - 1) if pairs.size else 1.0


def _real(place: Place) -> np.ndarray:
    values = place.orbit.spectrum[0]
    return np.real(values[np.abs(values.imag) <= _REAL * np.abs(values)])
