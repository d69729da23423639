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
"""Relative distance from a root at which Newton's method ends.  A step stays so far below the root, 1e7 roundings, that
the sign of the cubic there is certain."""
_LEAST = 1e-15  # first upper end of an interval that begins at 0, as a fraction of the cubic's own times
_TINY = 1e-300  # s: keeps that upper end above 0


@njit_called()
def first_root_of_bound(h: float, h1: float, h2: float, b3: float, most: float) -> float:
    """A time just below the first root of h + h1 tau + h2 tau^2/2 + b3 tau^3/6, s, or `most` if none is before.

    `h`, m, is 0 or less; `h1`, m/s, and `h2`, m/s^2, are the derivatives now; `b3`, m/s^3, is positive; `most` is in s.
    """
    if stays_below(h, h1, h2, b3, most):
        return most
    if h1 > 0:
        rise = _root_of_rise(h, h1, h2, b3)
        if rise > 0:
            return min(rise, most)
    lo, hi = 0.0, -1.0
    discriminant = h2 * h2 - 2 * b3 * h1
    if discriminant > 0:
        split = math.sqrt(discriminant)
        # the smaller and the larger root of the derivative, without cancellation
        if h2 > 0:
            r1 = (-h2 - split) / b3
            r2 = -2 * h1 / (h2 + split)
        else:
            r2 = (-h2 + split) / b3
            r1 = 2 * h1 / (-h2 + split)
        if r1 > 0 and h + r1 * (h1 + r1 * (h2 / 2 + r1 * b3 / 6)) >= 0:
            hi = r1
        elif r2 > 0:
            lo = r2
    # From `lo` to the root the cubic rises.  No third of |h| is made up for before this:
    third = -h / 3
    safe = most
    if h1 * safe > third:
        safe = third / h1
    if h2 * safe * safe > 2 * third:
        safe = math.sqrt(2 * third / h2)
    if b3 * safe * safe * safe > 6 * third:
        safe = (6 * third / b3) ** (1 / 3)
    lo = max(lo, 0.999 * safe)
    if lo >= most:
        return most
    if hi < 0:
        hi = 2 * lo if lo > 0 else _LEAST * (abs(h2) / b3 + math.sqrt(abs(h1) / b3)) + _TINY
        while h + hi * (h1 + hi * (h2 / 2 + hi * b3 / 6)) < 0:
            lo = hi
            if lo >= most:
                return most
            hi = 2 * hi
    return min(_root_from_below(h, h1, h2, b3, lo, hi), most)


@njit_inner()
def stays_below(h: float, h1: float, h2: float, b3: float, most: float) -> bool:
    """Whether a glance shows the cubic of `first_root_of_bound` below 0 for `most` seconds: its positive parts are."""
    return h + most * (max(h1, 0.0) + most * (max(h2, 0.0) / 2 + most * b3 / 6)) < 0


@njit_called()
def crosses(h: float, h1: float, h2: float, b3: float, tau: float, sharp: float) -> bool:
    """Whether a gap function is above 0 `sharp` seconds after `tau`, for any third derivative within `b3`."""
    x = tau + sharp
    return h + x * (h1 + x * (h2 / 2 - x * b3 / 6)) > 0


@njit_inner()
def _root_of_rise(h: float, h1: float, h2: float, b3: float) -> float:
    """A time just below the root of a cubic that rises up to there, or 0 if the rise is not shown at once.

    `h1` is positive.  Close to a switch the cubic rises, and the root of the parabola is close to that of the cubic.
    """
    square = h1 * h1 - 2 * h2 * h
    if square <= 0:
        return 0.0
    x = -2 * h / (h1 + math.sqrt(square))
    for _ in range(3):
        slope = h1 + x * (h2 + x * b3 / 2)
        if slope <= 0:
            return 0.0
        change = (h + x * (h1 + x * (h2 / 2 + x * b3 / 6))) / slope
        x -= change
        if abs(change) < _NEAR * x:
            break
    x *= 1 - 2 * _NEAR
    rises = x > 0 and h1 + x * min(h2, 0.0) > 0
    return x if rises and h + x * (h1 + x * (h2 / 2 + x * b3 / 6)) < 0 else 0.0


@njit_inner()
def _root_from_below(h: float, h1: float, h2: float, b3: float, lo: float, hi: float) -> float:
    """A time below the root of a cubic that rises from `lo` to `hi`, by at most a thousandth."""
    x = 0.5 * (lo + hi)
    for _ in range(60):
        value = h + x * (h1 + x * (h2 / 2 + x * b3 / 6))
        if value < 0:
            lo = x
        else:
            hi = x
        if hi - lo <= 1e-3 * hi:
            break
        slope = h1 + x * (h2 + x * b3 / 2)
        # Newton's step, or just below it, so that `lo` comes close to the root in the next one.
        newton = (x - value / slope) * (1 - 4e-4) if slope > 0 else lo
        x = newton if lo < newton < hi else 0.5 * (lo + hi)
        if value < 0 and 0 < newton - lo < 3e-4 * lo:
            break
    return lo
