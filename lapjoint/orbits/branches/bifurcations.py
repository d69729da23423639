r"""Bifurcations of a curve with a fixed contact sequence, by test functions that change their signs there.

With the multipliers mu_i over the motion's half periods:

    fold              the parameter's part of the tangent
    flip              min_i |1 + mu_i|, its sign the parity of the number of |mu_i| > 1, which folds change, too; it
                      breaks the symmetry of a motion that repeats mirrored
    Neimark-Sacker    prod_(i < j) (1 - mu_i mu_j), where a pair is complex (Kuznetsov, Elements of Applied Bifurcation
                      Theory, section 10.2): its sign, and the size of its least factor
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import pairwise
from typing import Literal

import numpy as np
from scipy.optimize import linear_sum_assignment, toms748

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.branches.point import SAME, CurvePoint, solved

Kind = Literal["fold", "flip", "neimark-sacker"]
_PASSING: dict[Kind, int] = {"fold": 1, "flip": 1, "neimark-sacker": 2}
"""Number of multipliers that pass the unit circle at a bifurcation."""
_HALVINGS = 8
"""Largest number of times that a step is halved to tell its bifurcations apart, down to a 256th of the step; also the
largest number of iterations to the point where two multipliers meet, of which two or three are needed."""
_COUPLED = 0.5
"""Least first-order estimate of the difference in modulus after two multipliers have met, divided by their distance
from the unit circle, with which the meeting is located.  The estimate is accurate to about a half."""
_FAINT = 1e-4
"""Modulus of a multiplier below which its products with other multipliers are far from 1, as all are below 1e4."""
_AT_GRAZE = 1e-5
"""Arclength between a graze and the nearest motions whose multipliers are evaluated.  At a graze the time of a switch
has no derivative by the section, and multipliers exist as limits only."""
_CRITICAL = 1e-2
"""Largest distance from 1 of minus the multiplier at a flip, or of the product at a Neimark-Sacker bifurcation.  Near a
graze both change by up to 1e6 per unit of arclength, and Newton's method leaves an error of 1e-9 in arclength."""


@dataclass(frozen=True)
class Stretch:
    """A step of a curve: two points of one contact sequence, and the arclength between them."""

    start: CurvePoint
    """The first point."""
    end: CurvePoint
    """The second point, in the direction of the first point's tangent."""
    length: float
    """Arclength along the first point's tangent."""


@dataclass(frozen=True)
class Bifurcation:
    """A bifurcation of a curve."""

    kind: Kind
    """Fold, flip or Neimark-Sacker."""
    point: CurvePoint
    """The motion at the bifurcation."""


def fold_test(point: CurvePoint) -> float:
    """The test function of folds: the parameter's part of the tangent, without unit."""
    return float(point.tangent[-1])


def flip_test(point: CurvePoint) -> float:
    """The test function of flips: the distance of the nearest multiplier from -1, with a sign that changes at flips."""
    mu, forwards = point.multipliers, point.tangent[-1] > 0
    is_even = (int((np.abs(mu) > 1).sum()) + int(forwards)) % 2 == 0
    return float(np.abs(1 + mu).min(initial=np.inf)) * (1.0 if is_even else -1.0)


def torus_test(point: CurvePoint) -> float:
    """The test function of Neimark-Sacker bifurcations: the distance of the nearest product of two multipliers from 1,
    signed."""
    return _signed(_pairs(point)[1])


def _pairs(point: CurvePoint) -> tuple[ComplexArray, ComplexArray]:
    """For each pair of multipliers that are not faint, the first multiplier, and 1 minus the product of both."""
    mu = point.multipliers
    mu = mu[np.abs(mu) > _FAINT]
    i, j = np.triu_indices(mu.size, 1)
    return mu[i], 1 - mu[i] * mu[j]


def _signed(factors: ComplexArray) -> float:
    """The modulus of the least factor, with the sign of the product of all factors, which is real but may overflow."""
    sizes = np.abs(factors)
    least = float(sizes.min(initial=np.inf))
    return least * float(np.sign(np.prod(factors / sizes).real)) if 0 < least < np.inf else least


_TESTS: dict[Kind, Callable[[CurvePoint], float]] = {
    "fold": fold_test,
    "flip": flip_test,
    "neimark-sacker": torus_test,
}


def test_of(kind: Kind) -> Callable[[CurvePoint], float]:
    """The test function of a kind of bifurcation, which takes a curve point."""
    return _TESTS[kind]


def within(stretch: Stretch) -> Iterator[Bifurcation]:
    """The bifurcations in a step of a curve, in the order of their arclengths.

    A test function changes its sign at each bifurcation.  Two bifurcations of one kind within a step leave the sign
    unchanged.  A step is therefore halved while the bifurcations found do not explain how many multipliers lie outside
    the unit circle at its ends.
    """
    start, end = _ends(stretch)
    if start is not None and end is not None:
        found = sorted(_between(stretch, start, end, _HALVINGS), key=lambda each: each[0])
        yield from (one for _, one in found)


def _between(
    stretch: Stretch, start: tuple[float, CurvePoint], end: tuple[float, CurvePoint], halvings: int
) -> Iterator[tuple[float, Bifurcation]]:
    """The bifurcations between two points of a step, and their arclengths from its start."""
    found = list[tuple[float, Bifurcation]]()
    kinds = [kind for kind, test in _TESTS.items() if test(start[1]) * test(end[1]) < 0]
    if kinds == ["neimark-sacker"] and _outside(start[1].multipliers) == _outside(end[1].multipliers):
        kinds = []  # two real multipliers are reciprocal on the way, or one is infinite
    for kind in kinds:
        located = located_in(stretch, kind, start[0], end[0], dict((start, end)))
        if located is not None and is_critical(kind, located[1]):
            found.append((located[0], Bifurcation(kind, located[1])))
    found.sort(key=lambda one: one[0])
    middle = None
    if halvings and not _explains([one for _, one in found], start[1], end[1]):
        middle = _with_length(stretch.start, (start[0] + end[0]) / 2)
    elif halvings:
        middle = _met(stretch, start, end)
    if middle is None:
        yield from found
        return
    yield from _between(stretch, start, middle, halvings - 1)
    yield from _between(stretch, middle, end, halvings - 1)


def _met(
    stretch: Stretch, start: tuple[float, CurvePoint], end: tuple[float, CurvePoint]
) -> tuple[float, CurvePoint] | None:
    """A point at which two multipliers that meet within a step have left the unit circle; None if there is none.

    Two multipliers of one modulus that meet may differ in modulus for a while, and then have one modulus again.  The
    number of multipliers outside the circle is then equal at both ends of the step, and the two have exchanged angles.
    """
    if int((np.abs(start[1].multipliers) > _FAINT).sum()) < 2:
        return None
    mu, vectors = start[1].linearisation.modes
    outside, match = int((np.abs(mu) > 1).sum()), partial(_matched, mu.size, vectors)
    there = match(end[1])
    if there is None:
        return None
    change = np.linalg.solve(vectors, (end[1].linearisation.monodromy - start[1].linearisation.monodromy) @ vectors)
    turn, turned = (np.angle(values[:, None] * values.conj()) for values in (mu, there))
    loud = (np.abs(mu) > _FAINT) & (np.abs(there) > _FAINT)
    exchanged = (turn * turned < 0) & (np.abs(turn - turned) < 1) & (mu.imag[:, None] > 0) & loud & loud[:, None]
    for i, j in np.argwhere(np.triu(exchanged | exchanged.T)):
        low, high, before, after = start[0], end[0], turn[i, j], turned[i, j]
        parted = 2 * abs(before / (before - after)) * np.sqrt(abs(change[i, j] * change[j, i]) / abs(mu[i] * mu[j]))
        if parted < _COUPLED * abs(np.log(abs(mu[i]))):
            continue
        for _ in range(_HALVINGS):
            point = _with_length(stretch.start, low + (high - low) * before / (before - after))
            here = None if point is None else match(point[1])
            if point is None or here is None:
                break
            if int((np.abs(here) > 1).sum()) != outside:
                return point
            apart = float(np.angle(here[i] * here[j].conj()))
            if abs(apart) <= abs(np.log(max(abs(here[i]), _FAINT))):
                break  # the two meet near here, but part too little to cross the unit circle
            if apart * before > 0:
                low, before = point[0], apart
            else:
                high, after = point[0], apart
    return None


def _matched(size: int, vectors: ComplexArray, point: CurvePoint) -> ComplexArray | None:
    """The multipliers of a point in the order of their eigenvectors in `vectors`; None if the numbers differ."""
    mu, own = point.linearisation.modes
    if mu.size != size:
        return None
    try:
        shares = np.abs(np.linalg.solve(vectors, own))
    except np.linalg.LinAlgError:  # multipliers that are zero share a vector
        return None
    return np.asarray(mu[linear_sum_assignment(-shares)[1]])


def _explains(found: Sequence[Bifurcation], first: CurvePoint, last: CurvePoint) -> bool:
    """Whether the bifurcations between two points explain how many multipliers lie outside the unit circle at both
    points.

    Between neighbouring bifurcations the number of multipliers outside must not change.
    """
    if _passing(first, last) > sum(_PASSING[one.kind] for one in found):
        return False
    counts = [_outside(first.multipliers), *(_outside(one.point.multipliers, one.kind) for one in found)]
    return all(one & other for one, other in pairwise([*counts, _outside(last.multipliers)]))


def _outside(multipliers: ComplexArray, kind: Kind | None = None) -> set[int]:
    """Possible numbers of multipliers outside the unit circle: before and after a bifurcation of the kind, or the one
    number without a kind."""
    modulus, critical = np.abs(multipliers), 0 if kind is None else _PASSING[kind]
    if critical > modulus.size:
        return set()
    beside = np.delete(modulus, np.argsort(np.abs(modulus - 1))[:critical])
    count = int((beside > 1).sum())
    return {count, count + critical}


def _passing(first: CurvePoint, last: CurvePoint) -> int:
    """Number of multipliers that cross the unit circle between two points, each matched to its nearest at the other
    point."""
    mu, other = (np.sort_complex(point.multipliers) for point in (first, last))
    if mu.size != other.size:
        return 0
    is_outside, was_outside = np.abs(other) > 1, np.abs(mu) > 1
    if not (is_outside.any() or was_outside.any()):
        return 0
    i, j = linear_sum_assignment(np.abs(mu[:, None] - other))
    return int((was_outside[i] != is_outside[j]).sum())


def _ends(stretch: Stretch) -> tuple[tuple[float, CurvePoint] | None, tuple[float, CurvePoint] | None]:
    """The first and the last point of a step whose multipliers exist, with their arclengths from the start."""
    start, end = (0.0, stretch.start), (stretch.length, stretch.end)
    return tuple(
        (s, point) if not _at_graze(point) else _with_length(stretch.start, s + way)
        for (s, point), way in ((start, _AT_GRAZE), (end, -_AT_GRAZE))
    )  # type: ignore[return-value]  # it has two parts


def _with_length(start: CurvePoint, length: float) -> tuple[float, CurvePoint] | None:
    point = beside(start, length)
    return None if point is None else (length, point)


def _at_graze(point: CurvePoint) -> bool:
    """Whether a contact or a flight has no duration, or one too short for the multipliers to be evaluated."""
    returning = np.array(point.problem.sequence.returning, dtype=bool)
    return bool((np.abs(point.shares[:-1])[returning] < SAME).any())


def is_critical(kind: Kind, point: CurvePoint) -> bool:
    """Whether a zero of a test function is a bifurcation, by its multipliers.

    It is none where a multiplier passes infinity, so that the test function jumps from one sign to the other.  It is
    none, either, where the pair with product 1 is the real pair of a saddle.
    """
    if kind == "fold":
        return True
    if abs(_TESTS[kind](point)) > _CRITICAL:
        return False
    if kind == "flip":
        return True
    first, apart = _pairs(point)
    one = first[np.argmin(np.abs(apart))]
    return bool(one.imag != 0)


def located_in(
    stretch: Stretch, kind: Kind, first: float, last: float, known: Mapping[float, CurvePoint] | None = None
) -> tuple[float, CurvePoint] | None:
    """The zero of a test function in a step: its arclength from the start, and the point; None if the curve is lost.

    The test function has different signs at the arclengths `first` and `last`; `known` has points by their arclengths.
    """
    start, test, points = stretch.start, _TESTS[kind], dict(known or {})

    def value(s: float) -> float:
        point = points[s] if s in points else beside(start, s, nearest_of(points, s))
        if point is None:
            raise ValueError
        points[s] = point
        return test(point)

    tolerance = start.problem.resolution.options.newton_tolerance
    try:
        at = toms748(value, first, last, xtol=tolerance, rtol=tolerance)
        value(at)
    except ValueError:
        return None
    return at, points[at]


def nearest_of(known: Mapping[float, CurvePoint], length: float) -> CurvePoint | None:
    """The known point nearest to an arclength, of points by their arclengths; None if none is known."""
    return known[min(known, key=lambda at: abs(at - length))] if known else None


def beside(start: CurvePoint, length: float, near: CurvePoint | None = None, exact: bool = True) -> CurvePoint | None:
    """The curve point in the hyperplane at the arclength `length`, of either sign, along the tangent of `start`; None
    if none is found.

    Newton's method begins at `near`, a nearer point of the curve, if one is known.  The tangent of the result has the
    direction of the tangent of `start` along the curve.
    """
    near = start if near is None else near
    rate = float(start.tangent @ (near.tangent * near.scale / start.scale))
    guess = near.predicted((length - start.arclength(near)) / rate)
    return solved(start.problem, guess, start.scale, start.tangent, exact)
