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
the distance of one of them from the circle, or would pass it on the way if they went on as they come, and where
det(1 + M) may vanish twice, by the same rules.  Beside one bifurcation that makes up all that changes, two others may
undo each other, such as flips of two mu of which one goes out and the other comes in: so the ways to it from both
places are judged likewise, by the mu that do not pass there.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence, Set
from dataclasses import dataclass
from itertools import pairwise, product
from typing import TypeAlias

import numpy as np

from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.locating import (
    LOCATED,
    Kind,
    above_minus_one,
    between_two,
    criteria_of,
    flip_of,
    from_one,
    goes_up,
    lies_between,
    located,
    outside,
)
from lapjoint.orbits.newton import RESIDUAL, of_det_one_plus
from lapjoint.problem import FloatArray

_HALVINGS = 8
"""How often the way between two places is halved to tell bifurcations apart that lie on it, or to find two that undo
each other: with five for those, two tori and two broken symmetries of the lightly damped joint, within a twelfth of a
step, were seen or not as steps happened to be, and two branches with forty more that spring from them."""
_PAIR = 2
"""Most multipliers that pass the circle at once."""
_GOES_ON = 2.0
"""Largest ratio of a step and the one before it for which it is looked how moduli go on."""
_SHARPER = 2.0
"""By how much faster than before a modulus may grow as a power: near a light contact it grows ever faster."""
_TINY = 1e-9
"""Modulus up to which it says nothing how many times as large a multiplier becomes."""
_ROUNDING = 1e-6
"""Distance outside the circle up to which a multiplier may lie on it: without damping all of them do."""
_STILL_ON = 2.0
"""The same over the distance by which the multipliers that pass the circle miss it: some pass it so fast that a change
of the number by `LOCATED` is too much for them."""
_ROUGH = 1e-4
"""Distance from the curve, over the length between two neighbours, up to which a motion tells what lies between them
though it does not close: that saves a march.  Of 321 such, no modulus was 0.3 % off that on the curve."""
_TELLS = 0.01
"""Distance of all its moduli from 1, at least: then no multiplier passes the circle on the way to the curve."""
_STRAIGHT = 0.5
"""Cosine of the angles between a chord and both tangents at its ends from which on what does not see these in opposite
directions is not between them: Newton's method led beyond one, and what lies there was listed twice."""
_VANISHES = 1e-4
"""Value of a test function up to which it vanishes: at a jump of the multipliers, of truncated modes, it does not."""
_JUMPS = 0.01
"""Value from which on it does not between nearer places, either; beside a graze, where multipliers change as one over a
root, it may."""


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

    @property
    def value(self) -> float:
        """The number, in its SI unit."""
        return self.place.value

    @property
    def left(self) -> float:
        """What is left there of what must vanish."""
        return criteria_of(self.place)[self.kind].left(self.place)


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


def _within(
    family: Family, first: Place, last: Place, around: Around, halvings: int, known: Located | None = None
) -> Iterator[Located | NotLocated]:
    """The bifurcations between two places, the way between which has been halved so often; one may be known.

    So may a place at which multipliers jump, to which a search for it has led.
    """
    a, b = signature(first), signature(last)
    change = (int(a[0] != b[0]), int(a[1] != b[1])), abs(b[2] - a[2])
    single = _kind_of(change, first)
    if known is not None and (known.kind != single or not lies_between(family, first, last, known.place)):
        known = None
    if known is None and single is not None:
        known = next(iter(_at_changes(family, first, last, {single})), None)
    found = [known] if known is not None and known.left <= _VANISHES else []
    if not found and known is not None and known.left < _JUMPS:  # between nearer places it may be found
        known = None
    told = change == _NONE or (bool(found) and _accounts(found, first, last))
    if halvings < _HALVINGS and (not told or _two_more_may_lie(family, first, last, around, found)):
        middle = _middle(family, first, last)
        if middle is not None and not _is_undecided(middle):
            yield from _within(family, first, middle, (around[0], last), halvings + 1, known)
            yield from _within(family, middle, last, (first, around[1]), halvings + 1, known)
            return
    if not told:
        kinds = _kinds_in(change, first, besides=bool(found)) - {single}
        found += [one for one in _at_changes(family, first, last, kinds) if one.left <= _VANISHES]
    yield from found
    if not _accounts(found, first, last):
        yield NotLocated(first.value, last.value)


def _at_changes(family: Family, first: Place, last: Place, kinds: Set[Kind]) -> list[Located]:
    """Where what tells some kinds of bifurcations changes between two places, one of each at most."""
    first, last = _closed(family, first), _closed(family, last)
    criteria = {
        kind: criterion
        for kind, criterion in criteria_of(first).items()
        if kind in kinds and criterion.changes(first, last)
    }
    found = {kind: located(family, first, last, criterion) for kind, criterion in criteria.items()}
    return [Located(kind, place) for kind, place in found.items() if place is not None]


Change: TypeAlias = tuple[tuple[int, int], int]
"""Whether the signs of w and of det(1 + M) differ, 0 or 1, and by how much the number of mu outside the circle does."""
_NONE: Change = ((0, 0), 0)
_FOLD: Change = ((1, 0), 1)
_FLIP: Change = ((0, 1), 1)
_NEIMARK_SACKER: Change = ((0, 0), 2)


def _kind_of(change: Change, place: Place) -> Kind | None:
    """What changes that alone."""
    kinds: dict[Change, Kind] = {_FOLD: "fold", _FLIP: flip_of(place), _NEIMARK_SACKER: "neimark-sacker"}
    return kinds.get(change)


def _kinds_in(change: Change, place: Place, besides: bool) -> set[Kind]:
    """The kinds of bifurcations that may change that.

    A pair passes the circle where real multipliers that do are too few, or where it does so `besides` what is known.
    """
    (fold, flip), outside = change
    kinds: set[Kind] = {"fold", flip_of(place)}
    if besides or outside not in {abs(fold - flip), fold + flip}:
        kinds.add("neimark-sacker")
    return kinds


def _accounts(found: list[Located], first: Place, last: Place) -> bool:
    """Whether bifurcations between two places, one of each kind at most, make up all that changes on the way."""
    a, b, kinds = signature(first), signature(last), {one.kind for one in found}
    if (a[0] != b[0], a[1] != b[1]) != ("fold" in kinds, flip_of(first) in kinds):
        return False
    changes = [2 if kind == "neimark-sacker" else 1 for kind in kinds]
    if abs(b[2] - a[2]) not in {abs(sum(one)) for one in product(*((-change, change) for change in changes))}:
        return False
    return len(found) != 1 or _others_outside(found[0]) == min(a[2], b[2])


def _others_outside(one: Located) -> int:
    """Number of multipliers outside the circle besides those that pass it at a bifurcation, where they lie near it."""
    left = from_one(one.place) if one.kind == "fold" else criteria_of(one.place)[one.kind].left(one.place)
    return outside(one.place, max(_ROUNDING, _STILL_ON * left))


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
    return goes_up(place), above_minus_one(place), outside(place, _ROUNDING)


def _is_undecided(place: Place) -> bool:
    """Whether a real multiplier is outside the circle by less than rounding: det(1 + M) counts it, `outside` not."""
    real = np.abs(place.orbit.real)
    return bool(((real > 1) & (real <= 1 + _ROUNDING)).any())


def _two_more_may_lie(family: Family, first: Place, last: Place, around: Around, found: list[Located]) -> bool:
    """Whether two bifurcations that undo each other may lie between two places, besides one that may be found."""
    if not found:
        return _may_come_back(family, first, last, around, None)
    one, here = found[0], found[0].place
    if _may_come_back(family, first, here, (around[0], last), one):
        return True
    return _may_come_back(family, here, last, (first, around[1]), one)


def _may_come_back(family: Family, first: Place, last: Place, around: Around, besides: Located | None) -> bool:
    """Whether a modulus may pass 1 between two places and come back, or det(1 + M) zero.

    The k-th largest modulus changes steadily: one that passes 1 is the least of those outside the circle, or the
    largest of those within, or the next where a pair does.  One of the places may be a bifurcation, `besides` which
    others are looked for: the multipliers that pass there are left out of both.
    """
    passing = None if besides is None else _passing(besides)
    count = int(np.count_nonzero(_moduli(first, passing) > 1 + _ROUNDING))
    near = slice(max(count - _PAIR, 0), count + _PAIR)
    if _may_pass(family, first, last, around, lambda place: _moduli(place, passing)[near].tolist(), 1.0):
        return True
    return _may_pass(family, first, last, around, lambda place: [_near_minus_one(place, passing)], 0.0)


def _passing(one: Located) -> slice:
    """The numbers of the multipliers that pass the circle at a bifurcation, among all by descending modulus.

    Before it and behind it those with the same numbers are taken for them.
    """
    others = _others_outside(one)
    return slice(others, others + (_PAIR if one.kind == "neimark-sacker" else 1))


def _moduli(place: Place, without: slice | None = None) -> FloatArray:
    """The moduli of the multipliers, largest first, shape ``(n,)``, or fewer where some are left out."""
    moduli = place.orbit.moduli
    return moduli if without is None else np.delete(moduli, without)


def _may_pass(
    family: Family, first: Place, last: Place, around: Around, of: Callable[[Place], list[float]], bound: float
) -> bool:
    """Whether one of the numbers that are given `of` each place may pass a bound between two places and come back.

    It may if it changes by more than its distance from the bound, or would pass that if it went on as it comes to
    either place, unless it rises or falls from the place before both to the one behind.
    """
    a, b = of(first), of(last)
    apart = [(_beyond(x, bound), _beyond(y, bound)) for x, y in zip(a, b, strict=False)]
    if any(abs(y - x) > min(abs(x), abs(y)) for x, y in apart):
        return True
    before, after = (None if place is None else of(place) for place in around)
    turns = [True] * len(a)
    if before is not None and after is not None and len(before) == len(a) == len(b) == len(after):
        turns = [not _steady(values) for values in zip(before, a, b, after, strict=True)]
    ways = ((around[0], first, last), (before, a)), ((around[1], last, first), (after, b))
    return any(turns) and any(_goes_on_past(family, *way, *numbers, bound, turns) for way, numbers in ways)


def _beyond(number: float, bound: float) -> float:
    """How far a number is from a bound; of a modulus outside the circle the logarithm, as it grows many times over."""
    return math.log(number) if number > bound == 1.0 else number - bound


def _steady(values: Sequence[float]) -> bool:
    """Whether a number at places in turn rises or falls all the way."""
    return all(x < y for x, y in pairwise(values)) or all(x > y for x, y in pairwise(values))


def _near_minus_one(place: Place, without: slice | None = None) -> float:
    """The size of det(1 + M), over that of multipliers which are far outside the circle; some may be left out."""
    if without is None:
        return place.orbit.near_minus_one
    return of_det_one_plus(np.delete(place.orbit.values, without), _moduli(place, without))


def _goes_on_past(
    family: Family,
    before: Place | None,
    here: Place,
    other: Place,
    then: list[float] | None,
    now: list[float],
    bound: float,
    which: list[bool],
) -> bool:
    """Whether one of some numbers passes a bound on the way to another place, if it goes on as from the one before.

    `then` they are at the place before, `now` here.  One may grow by as much as before, or as many times: where a
    contact is light, as one over the root of its depth.
    """
    if before is None or then is None or len(now) != len(then):
        return False
    ways = [(max(x, _TINY), max(y, _TINY)) for x, y, asked in zip(now, then, which, strict=True) if asked]
    if not any(_passes(*way, bound, _GOES_ON) for way in ways):
        return False
    way, came = (float(np.linalg.norm(other.chord(family, here))), float(np.linalg.norm(here.chord(family, before))))
    steps = min(way / max(came, 1e-300), _GOES_ON)
    return any(_passes(*way, bound, steps) for way in ways)


def _passes(now: float, then: float, bound: float, steps: float) -> bool:
    """Whether a number passes a bound that goes on for so many times the way from one to the other, either way."""
    ahead = now + steps * (now - then), now * (now / then) ** (_SHARPER * steps)
    return any((now > bound) != (one > bound) for one in ahead)


def _middle(family: Family, first: Place, last: Place) -> Place | None:
    """The place between two, which need not close if it tells; None if there is none, or they are one."""
    ahead, back = last.chord(family, first), first.chord(family, last)
    length = float(np.linalg.norm(ahead))
    if length <= LOCATED:
        return None
    straight = min(float(ahead @ last.tangent), -float(back @ first.tangent)) >= _STRAIGHT * length

    def alike(place: Place) -> bool:
        return place.closings == first.closings and (not straight or lies_between(family, first, last, place))

    def tells(place: Place, off: float) -> bool:
        return off <= _ROUGH * length and alike(place) and bool((np.abs(place.orbit.moduli - 1) > _TELLS).all())

    found = between_two(family, first, last, 0.5, length, alike, tells)
    return None if found is None or found.orientation != first.orientation else found  # it may be of another curve


def _closed(family: Family, place: Place) -> Place:
    """A place of the curve, or the nearest one to a motion that does not close."""
    if place.orbit.residual <= RESIDUAL:
        return place
    found = corrected(family, place.value, place.point, place.count)
    return place if found is None else found.along(place.tangent)
