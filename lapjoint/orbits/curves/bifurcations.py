r"""Bifurcations of a curve with a fixed contact sequence, by test functions that change their signs there.

With the multipliers mu_i over the motion's half periods:

    fold              the parameter's part of the tangent
    flip              prod_i (1 + mu_i); it breaks the symmetry of a motion that repeats mirrored
    Neimark-Sacker    prod_(i < j) (1 - mu_i mu_j), where a pair is complex (Kuznetsov, Elements of Applied Bifurcation
                      Theory, section 10.2)

Of a product the sign is taken, and the size of its least factor.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from typing import Literal

import numpy as np
from scipy.optimize import linear_sum_assignment, minimize_scalar, toms748

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.curves.point import CurvePoint, solved

Kind = Literal["fold", "flip", "neimark-sacker"]
_PASSING: dict[Kind, int] = {"fold": 1, "flip": 1, "neimark-sacker": 2}
"""Number of multipliers that pass the unit circle at a bifurcation."""
_LOOKS = 8
"""Largest number of points at which a test function is looked at on its way to where it is the least."""
_HALVINGS = 4
"""Largest number of times that a step is halved to tell bifurcations apart: to a sixteenth."""
_FAINT = 1e-4
"""Modulus of a multiplier below which its products with others are not near 1: others are below 1e4 then."""
_AT_GRAZE = 1e-5
"""Arclength between a graze and the nearest motions whose multipliers are asked: at a graze itself the time of a switch
has no derivative by the section, and multipliers are limits."""
_CRITICAL = 1e-2
"""Distance from 1 of minus a multiplier at a flip, or of a product at a Neimark-Sacker, at most: beside a graze they
change by up to 1e6 over an arclength of 1, of which Newton's method leaves 1e-9."""
_REAL = 1e-9
"""Imaginary part of a multiplier, over its modulus, up to which it is real."""


@dataclass(frozen=True)
class Stretch:
    """A step of a curve: two points of one contact sequence, and the arclength between them."""

    start: CurvePoint
    """The first point."""
    end: CurvePoint
    """The second, in the direction of the first one's tangent."""
    length: float
    """Arclength along the first one's tangent."""


@dataclass(frozen=True)
class Bifurcation:
    """A bifurcation of a curve."""

    kind: Kind
    """What happens."""
    point: CurvePoint
    """The motion there."""


def fold_test(point: CurvePoint) -> float:
    """The test function of folds.

    Parameters
    ----------
    point : CurvePoint
        A point of a curve.

    Returns
    -------
    float
        Without unit.
    """
    return float(point.tangent[-1])


def flip_test(point: CurvePoint) -> float:
    """The test function of flips.

    Parameters
    ----------
    point : CurvePoint
        A point of a curve.

    Returns
    -------
    float
        Without unit: the distance of the nearest multiplier from -1.
    """
    return _signed(1 + point.multipliers)


def torus_test(point: CurvePoint) -> float:
    """The test function of Neimark-Sacker bifurcations.

    Parameters
    ----------
    point : CurvePoint
        A point of a curve.

    Returns
    -------
    float
        Without unit: the distance of the nearest product of two multipliers from 1.
    """
    return _signed(_pairs(point)[1])


def _pairs(point: CurvePoint) -> tuple[ComplexArray, ComplexArray]:
    """The first multiplier of each pair of those that are not faint, and 1 less the product of the pair."""
    mu = point.multipliers
    mu = mu[np.abs(mu) > _FAINT]
    i, j = np.triu_indices(mu.size, 1)
    return mu[i], 1 - mu[i] * mu[j]


def _signed(factors: ComplexArray) -> float:
    """The least of some factors in size, with the sign of their product, which is real and may overflow."""
    sizes = np.abs(factors)
    least = float(sizes.min(initial=np.inf))
    return least * float(np.sign(np.prod(factors / sizes).real)) if 0 < least < np.inf else least


_TESTS: dict[Kind, Callable[[CurvePoint], float]] = {
    "fold": fold_test,
    "flip": flip_test,
    "neimark-sacker": torus_test,
}


def test_of(kind: Kind) -> Callable[[CurvePoint], float]:
    """The test function of a kind of bifurcation.

    Parameters
    ----------
    kind : str
        The kind.

    Returns
    -------
    callable
        Takes a point of a curve, and returns the value.
    """
    return _TESTS[kind]


def within(stretch: Stretch) -> Iterator[Bifurcation]:
    """The bifurcations in a step of a curve.

    Test functions change their signs there.  Two bifurcations of a kind within a step undo each other's change: so a
    step is halved if more multipliers pass the unit circle than the changes of signs explain.

    Parameters
    ----------
    stretch : Stretch
        The step.

    Yields
    ------
    Bifurcation
        In the order of the arclength.
    """
    start, end = _ends(stretch)
    if start is not None and end is not None:
        found = sorted(_between(stretch, start, end, _HALVINGS), key=lambda each: each[0])
        yield from (one for _, one in found)


def undone(before: Stretch, after: Stretch) -> Iterator[tuple[bool, Bifurcation]]:
    """Two bifurcations of a kind that undo each other near where two steps meet.

    A test function that is nearer to zero there than at the other ends of both steps may pass zero and come back.
    The step in which a parabola has its least is searched for the least.

    Parameters
    ----------
    before, after : Stretch
        Two steps, of which the second goes on where the first ends, with one contact sequence.

    Yields
    ------
    tuple of bool and Bifurcation
        Whether it lies in the second step, and the bifurcation.
    """
    first, middle, last = _ends(before)[0], before.end, _ends(after)[1]
    if first is None or last is None or _at_graze(middle):
        return
    for kind, test in _TESTS.items():
        values = [test(first[1]), test(middle), test(last[1])]
        sign = np.sign(values[1])
        if not np.isfinite(values).all() or any(sign * value < abs(values[1]) for value in values):
            continue  # without multipliers that are not faint it is infinitely far from zero
        nearest = _nearest_to_zero([first[0] - before.length, 0.0, last[0]], [sign * value for value in values])
        stretch = after if nearest > 0 else before
        known = {0.0: middle, last[0]: last[1]} if nearest > 0 else {first[0]: first[1], before.length: middle}
        low, high = known
        beyond = _beyond_zero(stretch, test, sign, known)
        if beyond is None:
            continue
        for one, other in ((low, beyond), (beyond, high)):
            located = located_in(stretch, kind, one, other, known)
            if located is not None and is_critical(kind, located[1]):
                yield stretch is after, Bifurcation(kind, located[1])


def _beyond_zero(
    stretch: Stretch, test: Callable[[CurvePoint], float], sign: float, known: dict[float, CurvePoint]
) -> float | None:
    """Where between two points of a step a test function has the other sign, if it has where it is the least.

    The point is added to those that are known, by its arclength.
    """
    low, high = known

    def value(at: float) -> float:
        found = [s for s in known if sign * test(known[s]) < 0]
        point = None if found else beside(stretch.start, at, nearest_of(known, at))
        if point is None:
            return 0.0
        known[at] = point
        return sign * test(point)

    minimize_scalar(value, bounds=(low, high), method="bounded", options={"maxiter": _LOOKS})
    return next((s for s in known if sign * test(known[s]) < 0), None)


def _nearest_to_zero(s: list[float], f: list[float]) -> float:
    """Where the parabola through three points is the least, between the outer two; else the middle one."""
    rises = [(f[1] - f[0]) / (s[1] - s[0]), (f[2] - f[1]) / (s[2] - s[1])] if s[0] < s[1] < s[2] else [0.0, 0.0]
    if rises[0] >= rises[1]:
        return s[1]
    bend = (rises[1] - rises[0]) / (s[2] - s[0])
    return min(max((s[0] + s[1] - rises[0] / bend) / 2, s[0]), s[2])


def _between(
    stretch: Stretch, start: tuple[float, CurvePoint], end: tuple[float, CurvePoint], halvings: int
) -> Iterator[tuple[float, Bifurcation]]:
    """The bifurcations between two points of a step, and their arclengths from its start."""
    kinds = [kind for kind, test in _TESTS.items() if test(start[1]) * test(end[1]) < 0]
    if halvings and _passing(start[1], end[1]) > sum(_PASSING[kind] for kind in kinds):
        middle = _with_length(stretch.start, (start[0] + end[0]) / 2)
        if middle is not None:
            yield from _between(stretch, start, middle, halvings - 1)
            yield from _between(stretch, middle, end, halvings - 1)
            return
    for kind in kinds:
        located = located_in(stretch, kind, start[0], end[0], dict((start, end)))
        if located is not None and is_critical(kind, located[1]):
            yield located[0], Bifurcation(kind, located[1])


def _passing(first: CurvePoint, last: CurvePoint) -> int:
    """The number of multipliers that pass the unit circle between two points: the nearest of both are one."""
    mu, other = (np.sort_complex(point.multipliers) for point in (first, last))
    if mu.size != other.size:
        return 0
    is_outside, was_outside = np.abs(other) > 1, np.abs(mu) > 1
    if not (is_outside.any() or was_outside.any()):
        return 0
    i, j = linear_sum_assignment(np.abs(mu[:, None] - other))
    return int((was_outside[i] != is_outside[j]).sum())


def _ends(stretch: Stretch) -> tuple[tuple[float, CurvePoint] | None, tuple[float, CurvePoint] | None]:
    """The first and the last point of a step whose multipliers are known, with their arclengths from the start."""
    start, end = (0.0, stretch.start), (stretch.length, stretch.end)
    return tuple(
        (s, point) if not _at_graze(point) else _with_length(stretch.start, s + way)
        for (s, point), way in ((start, _AT_GRAZE), (end, -_AT_GRAZE))
    )  # type: ignore[return-value]  # it has two parts


def _with_length(start: CurvePoint, length: float) -> tuple[float, CurvePoint] | None:
    point = beside(start, length)
    return None if point is None else (length, point)


def _at_graze(point: CurvePoint) -> bool:
    """Whether a contact or a flight has no duration, all but for less than the way to the motions that are asked."""
    returning = np.array(point.problem.sequence.returning, dtype=bool)
    return bool((np.abs(point.shares[:-1])[returning] < 0.1 * _AT_GRAZE).any())


def is_critical(kind: Kind, point: CurvePoint) -> bool:
    """Whether the multipliers at a zero of a test function are those of its bifurcation.

    Parameters
    ----------
    kind : str
        The kind of bifurcation.
    point : CurvePoint
        The point.

    Returns
    -------
    bool
        False where a multiplier passes infinity, and the test function jumps from one sign to the other, or where the
        pair whose product is 1 is a real saddle's.
    """
    if kind == "fold":
        return True
    if abs(_TESTS[kind](point)) > _CRITICAL:
        return False
    if kind == "flip":
        return True
    first, apart = _pairs(point)
    one = first[np.argmin(np.abs(apart))]
    return bool(abs(one.imag) > _REAL * abs(one))


def located_in(
    stretch: Stretch, kind: Kind, first: float, last: float, known: Mapping[float, CurvePoint] | None = None
) -> tuple[float, CurvePoint] | None:
    """Where a test function is zero in a step in which it changes its sign.

    Parameters
    ----------
    stretch : Stretch
        The step.
    kind : str
        The kind of bifurcation.
    first, last : float
        Arclengths from the start between which the test function changes its sign.
    known : mapping, optional
        Points of the step that are known, by their arclengths.

    Returns
    -------
    tuple of float and CurvePoint, or None
        The arclength from the start, and the point; None if Newton's method loses the curve.
    """
    start, test, points = stretch.start, _TESTS[kind], dict(known or {})

    def value(s: float) -> float:
        point = points[s] if s in points else beside(start, s, nearest_of(points, s))
        if point is None:
            raise ValueError
        points[s] = point
        return test(point)

    try:
        at = toms748(value, first, last, xtol=1e-11, rtol=1e-9)
        value(at)
    except ValueError:
        return None
    return at, points[at]


def nearest_of(known: Mapping[float, CurvePoint], length: float) -> CurvePoint | None:
    """The point nearest to an arclength.

    Parameters
    ----------
    known : mapping
        Points of a curve, by their arclengths.
    length : float
        The arclength.

    Returns
    -------
    CurvePoint, or None
        None if none is known.
    """
    return known[min(known, key=lambda at: abs(at - length))] if known else None


def beside(start: CurvePoint, length: float, near: CurvePoint | None = None, exact: bool = True) -> CurvePoint | None:
    """The point of a curve in the hyperplane some arclength along a point's tangent.

    Parameters
    ----------
    start : CurvePoint
        The point.
    length : float
        The arclength, of either sign.
    near : CurvePoint, optional
        A point of the curve that is nearer, if one is known.
    exact : bool
        Whether to evaluate the derivative there, see `lapjoint.orbits.curves.newton.solve`.

    Returns
    -------
    CurvePoint, or None
        Its tangent goes in the same direction; None if Newton's method finds none.
    """
    near = start if near is None else near
    rate = float(start.tangent @ (near.tangent * near.scale / start.scale))
    guess = near.predicted((length - start.arclength(near)) / rate)
    return solved(start.problem, guess, start.scale, start.tangent, exact)
