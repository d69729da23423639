"""The step bound: how long a gap function cannot reach 0, from its derivatives now and a bound on its third one."""

from __future__ import annotations

import math

from lapjoint.compiled.compiling import njit_called, njit_inner

RESOLUTION = 1e-10
"""Length of a certified step below which a switch is found, as a fraction of the unit of time
`analytic.march.tables.Tables.unit`.  At 500 rad/s it is 2e-13 s, ten times the resolution of a double at 100 s."""
SHARP = 1e-13
"""Accuracy of a switch located by its last step, as a fraction of the unit of time.  `RESOLUTION` is for gap functions
that nearly graze."""
_NEAR = 1e-9
"""Relative length of the last step of Newton's method close to a switch, where the cubic rises from the start.  What is
returned stays twice as far below the root, 1e7 roundings, so that the sign of the cubic there is certain."""
_FAIR = 0.02
"""The same elsewhere: after such a step Newton's method is within 4e-4, its square, of the root."""
_BELOW = 5e-4  # relative distance to the root by which it is then sure that the root is not passed
_SEVERAL = 4  # steps of Newton's method in which `_NEAR` is reached where the cubic rises steadily
_MOST = 60  # most steps of Newton's method: it halves the distance to a double root at least


@njit_called()
def first_root_of_bound(h: float, h1: float, h2: float, b3: float, most: float) -> float:
    """A time just below the first root of h + h1 tau + h2 tau^2/2 + b3 tau^3/6, s, or `most` if none is before.

    `h`, m, is 0 or less; `h1`, m/s, and `h2`, m/s^2, are the derivatives now; `b3`, m/s^3, is positive; `most` is in s.
    """
    if stays_below(h, h1, h2, b3, most):
        return most
    c2, c3 = h2 / 2, b3 / 6
    # From `origin` on, `depth` below 0, the cubic rises and bends upwards: -depth + slope y + bend y^2 + c3 y^3.
    origin, depth, slope, bend = 0.0, -h, h1, c2
    if h1 < 0 or h2 < 0:
        square = h2 * h2 - 2 * b3 * h1
        split = math.sqrt(max(square, 0.0))
        if h1 > 0:
            # It rises first, to a maximum or to where it bends upwards.
            top = 2 * h1 / (split - h2) if square > 0 else -h2 / b3
            if _cubic(h, h1, c2, c3, top) >= 0:
                return min(_root_before_the_top(h, h1, c2, c3), most)
        if square > 0:
            # the minimum, without cancellation
            origin = (split - h2) / b3 if h2 < 0 else -2 * h1 / (h2 + split)
            slope, bend = 0.0, split / 2
        else:
            origin = max(-h2 / b3, 0.0)
            slope, bend = max(h1 + origin * h2 / 2, 0.0), max(c2, 0.0)
        depth = -_cubic(h, h1, c2, c3, origin)
    if origin >= most or _cubic(h, h1, c2, c3, most) < 0:
        return most
    y = _root_of_rise(depth, slope, bend, c3, most - origin, h1 > 0)
    while y > 0 and _cubic(h, h1, c2, c3, origin + y) >= 0:  # where depth is of rounding size
        y = y / 2 if origin + y > origin else 0.0
    return min(origin + y, most)


@njit_inner()
def stays_below(h: float, h1: float, h2: float, b3: float, most: float) -> bool:
    """Whether a glance shows the cubic of `first_root_of_bound` below 0 for `most` seconds: its positive parts are."""
    return h + most * (max(h1, 0.0) + most * (max(h2, 0.0) / 2 + most * b3 / 6)) < 0


@njit_called()
def crosses(h: float, h1: float, h2: float, b3: float, tau: float, sharp: float) -> bool:
    """Whether a gap function is above 0 `sharp` seconds after `tau`, for any third derivative within `b3`."""
    x = tau + sharp
    return h + x * (h1 + x * (h2 / 2 - x * b3 / 6)) > 0


@njit_inner(inline="always")
def _cubic(h: float, h1: float, c2: float, c3: float, x: float) -> float:
    """h + h1 x + c2 x^2 + c3 x^3."""
    return h + x * (h1 + x * (c2 + x * c3))


@njit_inner()
def _root_before_the_top(h: float, h1: float, c2: float, c3: float) -> float:
    """A time just below the root of a cubic that rises to it, and bends downwards up to there.

    Newton's method comes from below, because each tangent is above the cubic.
    """
    x = 0.0
    for n in range(_MOST):
        slope = h1 + x * (2 * c2 + x * 3 * c3)
        if slope <= 0:
            break
        change = -_cubic(h, h1, c2, c3, x) / slope
        x += change
        if change <= _NEAR * x or (n >= _SEVERAL and change <= _BELOW * x):
            break
    return x * (1 - 2 * _NEAR)


@njit_inner()
def _root_of_rise(depth: float, slope: float, bend: float, c3: float, most: float, near: bool) -> float:
    """A time just below the root of -depth + slope y + bend y^2 + c3 y^3, which is at most `most`.

    No coefficient is negative.  Newton's method comes from above, because each tangent is below the cubic.  `near` says
    that the root may be that of the last step before a switch, and is found to `_NEAR` if a few steps do.
    """
    if depth <= 0:
        return 0.0
    # The cubic is above its parabola: the parabola's root is later.
    y, sum_of = most, slope + math.sqrt(slope * slope + 4 * bend * depth)
    if 2 * depth < sum_of * y:
        y = 2 * depth / sum_of
    if c3 * y * y > slope + bend * y:
        # With (bend + c3 y) y^2 for the last two terms, a late y gives an early one, and that one a better late one.
        sum_of = slope + math.sqrt(slope * slope + 4 * (bend + c3 * y) * depth)
        early = 2 * depth / sum_of if sum_of > 0 else 0.0  # where the product is too small for a number
        sum_of = slope + math.sqrt(slope * slope + 4 * (bend + c3 * early) * depth)
        y = 2 * depth / sum_of if 2 * depth < sum_of * y else y
    change = y
    for n in range(_MOST):
        rate = slope + y * (2 * bend + 3 * c3 * y)
        if rate <= 0:
            break
        change = (y * (slope + y * (bend + y * c3)) - depth) / rate
        y -= change
        if change <= _NEAR * y or (change <= _FAIR * y and (n >= _SEVERAL or not near)):
            break
    return y * (1 - (2 * _NEAR if change <= _NEAR * y else _BELOW))
