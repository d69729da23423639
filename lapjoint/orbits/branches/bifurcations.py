r"""Bifurcations between two places of a curve: found by their multipliers, and located where a test function vanishes.

Between neighbours with the same contacts the map is smooth.  With M the derivative of the map over the motion's half
periods, mu its eigenvalues and (u, w) the curve's tangent, there lies

    a fold              where w changes its sign,
    a flip              where a real mu passes -1; over an odd number of half periods it breaks the motion's symmetry,
    a Neimark-Sacker    where a complex pair passes the unit circle.

The sign of w, that of det(1 + M) and the number of mu outside the circle tell these apart where one of them lies
between two places: the first changes the first and the third by one, the second the other two, the last the third by
two.  Where anything else changes, where other mu are outside the circle at the bifurcation than at both places, or
where one of them may go out and come back, the place in the middle is looked at, too: where moduli change by more than
the distance of one of them from the circle, or would pass it on the way if they went on as they come.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np

from lapjoint.orbits.branches.corrector import STEEP, Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.problem import FloatArray

Kind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking"]
_REAL = 1e-6
"""Imaginary part of a multiplier over its modulus, up to which it is real."""
_HALVINGS = 8
"""How often the way between two places is halved to tell bifurcations apart that lie on it."""
_LOOKS = 5
"""How often it is halved to find two that undo each other."""
_PAIR = 2
"""Most multipliers that pass the circle at once."""
_GOES_ON = 2.0
"""Largest ratio of a step and the one before it for which it is looked how moduli go on."""
_SHARPER = 2.0
"""By how much faster than before a modulus may grow as a power: near a light contact it grows ever faster."""
_TINY = 1e-9
"""Modulus up to which it says nothing how many times as large a multiplier becomes."""
_STEPS = 40
"""Most steps of the search for the root of a test function."""
_ROUNDING = 1e-6
"""Distance outside the circle up to which a multiplier may lie on it: without damping all of them do."""
_LOCATED = 1e-9
"""Change of the number over its scale, and of the motion over its size, at which a bifurcation is located; and the
value of a test function there."""
_STUCK = 3
"""Number of steps in turn that leave more than half of what was left, after which it is halved."""


_VANISHES = 1e-4
"""Value of a test function up to which it vanishes: at a jump of the multipliers, of truncated modes, it does not."""


@dataclass(frozen=True)
class NotLocated:
    """A part of a curve on which multipliers pass the circle, but not where they can be followed."""

    first: float
    """The number before it, in its SI unit."""
    last: float
    """The number after it."""


@dataclass(frozen=True)
class Located:
    """A bifurcation of a smooth part of a curve."""

    kind: Kind
    """What it is."""
    place: Place
    """The motion there."""


Around = tuple[Place | None, Place | None]
"""The places before and after two neighbours; None where the curve does not go on smoothly."""


def between(family: Family, first: Place, last: Place, around: Around) -> Iterator[Located | NotLocated]:
    """The bifurcations between two neighbouring places with the same contacts, in their sequence along the curve.

    Parameters
    ----------
    family : Family
        The period maps.
    first, last : Place
        Their tangents point in the direction in which the curve is followed.
    around : tuple of Place or None
        The places before and after them, with the same contacts; None where there is none.

    Yields
    ------
    Located or NotLocated
        They may be several.
    """
    yield from _within(family, first, last, around, 0)


def _within(family: Family, first: Place, last: Place, around: Around, halvings: int) -> Iterator[Located | NotLocated]:
    """The bifurcations between two places, the way between which has been halved so often."""
    a, b = signature(first), signature(last)
    change = tuple(int(x != y) for x, y in zip(a[:2], b[:2], strict=True)), abs(b[2] - a[2])
    found = [] if change == _NONE else list(_at_changes(family, first, last, _kind_of(change, first)))
    if change in _SINGLE and found and _outside(found[0].place, _ROUNDING) == min(a[2], b[2]):
        yield from found
        return
    looked = _LOOKS if change == _NONE else _HALVINGS
    if halvings < looked and (change != _NONE or _may_come_back(family, first, last, around)):
        middle = _middle(family, first, last)
        if middle is not None:
            yield from _within(family, first, middle, (around[0], last), halvings + 1)
            yield from _within(family, middle, last, (first, around[1]), halvings + 1)
            return
    yield from found
    if change != _NONE and not found:
        yield NotLocated(first.value, last.value)


def _at_changes(family: Family, first: Place, last: Place, only: Kind | None) -> Iterator[Located]:
    """The bifurcations of one kind between two places, or of any, one of each at most."""
    for kind, (count, distance) in tests_of(first).items():
        if count(first) != count(last) and only in (None, kind):
            found = located(family, first, last, count, distance)
            if found is not None and abs(distance(found)) <= _VANISHES:
                yield Located(kind, found)


_NONE = ((0, 0), 0)
"""What changes where there is no bifurcation: signs of w and of det(1 + M), and the number of mu outside the circle."""
_FOLD, _FLIP, _NEIMARK_SACKER = ((1, 0), 1), ((0, 1), 1), ((0, 0), 2)
_SINGLE = (_NONE, _FOLD, _FLIP, _NEIMARK_SACKER)


def _kind_of(change: tuple[tuple[int, ...], int], place: Place) -> Kind | None:
    """What changes that alone."""
    kinds: dict[tuple[tuple[int, ...], int], Kind] = {
        _FOLD: "fold",
        _FLIP: flip_of(place),
        _NEIMARK_SACKER: "neimark-sacker",
    }
    return kinds.get(change)


def signature(place: Place) -> tuple[int, int, int]:
    """What tells bifurcations apart that lie between two places.

    Parameters
    ----------
    place : Place
        A place.

    Returns
    -------
    tuple of int
        Signs of w and of det(1 + M), 0 or 1, and the number of mu outside the circle.
    """
    return _goes_up(place), _above_minus_one(place), _outside(place, _ROUNDING)


def _may_come_back(family: Family, first: Place, last: Place, around: Around) -> bool:
    """Whether a modulus changes by more than its distance from 1, or det(1 + M) by more than its own size.

    A multiplier may then pass the circle, or -1, and come back; or if it went on as it comes to either place.  The k-th
    largest modulus changes steadily: one that passes 1 is the least of those outside the circle, or the largest of
    those within, or the next where a pair does.
    """
    count = _outside(first, _ROUNDING)
    near = slice(max(count - _PAIR, 0), count + _PAIR)
    a, b = (np.abs(place.orbit.values[near]) for place in (first, last))
    if bool((np.abs(b - a) > np.minimum(np.abs(a - 1), np.abs(b - 1))).any()):
        return True
    det = [_near_minus_one(place) for place in (first, last)]
    if abs(det[1] - det[0]) > min(det):
        return True
    return _goes_on_past(family, around[0], first, last, near) or _goes_on_past(family, around[1], last, first, near)


def _near_minus_one(place: Place) -> float:
    """The size of det(1 + M), over that of multipliers which are far outside the circle."""
    values = place.orbit.values
    return float(np.prod(np.abs(values + 1) / np.maximum(np.abs(values), 1)))


def _goes_on_past(family: Family, before: Place | None, here: Place, other: Place, near: slice) -> bool:
    """Whether a modulus passes 1 on the way to another place, if it goes on as from the one before.

    It may grow by as much as before, or as many times: where a contact is light, as one over the root of its depth.
    """
    if before is None:
        return False
    now, then = (np.maximum(np.abs(place.orbit.values[near]), _TINY) for place in (here, before))
    if now.shape != then.shape or not _passes(now, then, _GOES_ON):
        return False
    way, came = (float(np.linalg.norm(other.chord(family, here))), float(np.linalg.norm(here.chord(family, before))))
    return _passes(now, then, min(way / max(came, 1e-300), _GOES_ON))


def _passes(now: FloatArray, then: FloatArray, steps: float) -> bool:
    """Whether a number passes 1 that goes on for so many times the way from one to the other, either way."""
    ahead = now + steps * (now - then), now * (now / then) ** (_SHARPER * steps)
    return any(bool(((now > 1) != (one > 1)).any()) for one in ahead)


def _middle(family: Family, first: Place, last: Place) -> Place | None:
    """The place between two; None if there is none, or they are one."""
    length = float(np.linalg.norm(last.chord(family, first)))
    if length <= _LOCATED:
        return None
    middle = between_two(family, first, last, 0.5, length)
    return middle if middle is not None and middle.extrema.closings == first.extrema.closings else None


def flip_of(place: Place) -> Kind:
    """What it is called where a multiplier of a motion is -1.

    Parameters
    ----------
    place : Place
        The motion.

    Returns
    -------
    str
        ``flip`` or ``symmetry breaking``.
    """
    return "symmetry breaking" if place.count % 2 else "flip"


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
        "fold": (_goes_up, lambda at: float(at.tangent[-1])),
        flip_of(place): (_above_minus_one, _from_minus_one),
        "neimark-sacker": (_outside, _from_circle),
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
        here = here or between_two(family, a, b, 0.5, length)
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
    steep = abs(near.tangent[-1]) > STEEP and _goes_up(near) == _goes_up(far)  # no number is held across a fold
    value, guess = near.moved(family, step * near.tangent)
    found = corrected(family, value, guess, near.count, fixed=steep)
    if found is None:
        value, guess = near.moved(family, -min(share, 1 - share) * near.chord(family, far))
        found = corrected(family, value, guess, near.count, fixed=steep)
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


def _goes_up(place: Place) -> int:
    return int(place.tangent[-1] > 0)


def _above_minus_one(place: Place) -> int:
    """Whether det(1 + M) is positive: it changes its sign where a real multiplier passes -1, and nowhere else."""
    real = _real(place)
    return int(np.count_nonzero(real < -1) % 2 == 0)


def _from_minus_one(place: Place) -> float:
    """Distance from -1 of the multiplier that is nearest to it."""
    return float(np.min(np.abs(place.orbit.values + 1), initial=1.0))


def _outside(place: Place, by: float = 0.0) -> int:
    """Number of multipliers outside the unit circle, by some distance at least."""
    return int(np.count_nonzero(np.abs(place.orbit.values) > 1 + by))


def _from_circle(place: Place) -> float:
    """Distance from the circle of the complex multiplier that is nearest to it."""
    values = place.orbit.values
    pairs = values[np.abs(values.imag) > _REAL * np.abs(values)]
    return float(np.min(np.abs(np.abs(pairs) - 1), initial=1.0))


def _real(place: Place) -> np.ndarray:
    values = place.orbit.values
    return np.real(values[np.abs(values.imag) <= _REAL * np.abs(values)])
