"""Where a stop opens or closes within one exact flow: a search that no double crossing escapes.

`solve_ivp` looks at its events at the ends of its steps only, so that two crossings inside one step go unseen, and
restarting on an event fires it again.  Here the gap functions are sampled on the dense output.  Between two samples a
gap function stays below the larger of the two plus B w^2 / 8, where w is the spacing and B bounds its curvature; an
interval for which that is not below zero is divided until it is, or holds a crossing, or is so short that what could
hide in it is a contact of less than 1e-9 s.  A stop that has just switched is looked at again only after the time
during which its curvature cannot bring it back.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy.optimize import brentq

from lapjoint.problem import FloatArray

GapFunctions = Callable[[FloatArray, int], FloatArray]
"""h and its time derivative: called with times ``(m,)`` and order 0 or 1, gives ``(P, m)``; h > 0 is a switch."""

SHORTEST = 1e-9  # s: intervals are not divided further
LOCATION = 4e-13  # s: to which a crossing is located
_DIVISIONS = 16


@dataclass(frozen=True)
class Switch:
    """A stop opens or closes."""

    time: float
    stop: int


def first_switch(
    gaps: GapFunctions, start: float, end: float, curvature: FloatArray, fresh: FloatArray, samples: int = 48
) -> Switch | None:
    """The first crossing of any gap function in ``[start, end]``.

    Parameters
    ----------
    gaps : callable
        The gap functions.
    start, end : float
        Interval, s.
    curvature : FloatArray
        Bound on the second derivative of each gap function, shape ``(P,)``.
    fresh : FloatArray
        Time of each stop's last switch, shape ``(P,)``; -inf for none.
    samples : int
        Intervals of the first division.
    """
    quiet = _quiet_until(gaps, start, curvature, fresh)
    return _search(gaps, np.linspace(start, end, samples + 1), curvature, quiet)


def _quiet_until(gaps: GapFunctions, start: float, curvature: FloatArray, fresh: FloatArray) -> FloatArray:
    """From when each stop may switch, ``(P,)``: later than `start` for those that have just done so."""
    quiet = np.full(fresh.size, start)
    recent = start - fresh < SHORTEST
    if recent.any():
        rate = gaps(np.array([start]), 1)[:, 0]
        leaving = np.where(rate < 0, -2 * rate / np.maximum(curvature, 1e-300), 0.0)
        # h <= h' s + B s^2 / 2 < 0 before 2 |h'| / B; half of it leaves room for the rounding of h at the start
        quiet = np.where(recent, start + np.maximum(leaving / 2, SHORTEST), quiet)
    return quiet


def _search(gaps: GapFunctions, t: FloatArray, curvature: FloatArray, quiet: FloatArray) -> Switch | None:
    """Left to right through the intervals of the grid ``t``, dividing those that may hide a crossing."""
    h = gaps(t, 0)
    h = np.where(t >= quiet[:, None], h, -np.inf)  # a quiet stop cannot cross
    # The first grid point after a quiet time starts its stop anew: it may already be beyond zero.
    width = np.diff(t)
    if h.shape[0] == 0:
        return None
    ends = np.maximum(h[:, :-1], h[:, 1:])
    partly = (t[:-1] < quiet[:, None]) & (t[1:] > quiet[:, None])
    suspicious = (ends + curvature[:, None] * width**2 / 8 >= 0) | partly
    for i in np.flatnonzero(suspicious.any(axis=0)):
        simple = _single_crossing(gaps, h, t, int(i), curvature, suspicious[:, i], quiet)
        if simple is not None:
            return simple
        if width[i] <= SHORTEST:
            crossed = [k for k in range(h.shape[0]) if h[k, i + 1] > 0]
            times = [Switch(_locate(gaps, k, t[i], t[i + 1], quiet[k]), k) for k in crossed]
            if times:
                return min(times, key=lambda switch: switch.time)
            continue
        inside = _search(gaps, np.linspace(t[i], t[i + 1], _DIVISIONS + 1), curvature, quiet)
        if inside is not None:
            return inside
    return None


def _single_crossing(
    gaps: GapFunctions,
    h: FloatArray,
    t: FloatArray,
    i: int,
    curvature: FloatArray,
    suspicious: npt.NDArray[np.bool_],
    quiet: FloatArray,
) -> Switch | None:
    """The switch in the i-th interval if one stop alone can switch there, and its gap function rises in it."""
    if suspicious.sum() != 1:
        return None
    k, width = int(np.argmax(suspicious)), t[i + 1] - t[i]
    if not (t[i] >= quiet[k] and h[k, i] <= 0 < h[k, i + 1]):
        return None
    rate = gaps(t[i : i + 1], 1)[k, 0]
    return Switch(_locate(gaps, k, t[i], t[i + 1], quiet[k]), k) if rate > curvature[k] * width else None


def _locate(gaps: GapFunctions, k: int, lo: float, hi: float, quiet: float) -> float:
    """The crossing of stop `k` between `lo` and `hi`, where h is positive."""
    lo = max(lo, quiet)

    def h(t: float) -> float:
        return float(gaps(np.array([t]), 0)[k, 0])

    if lo >= hi or h(lo) >= 0:
        return lo
    return float(brentq(h, lo, hi, xtol=LOCATION, rtol=8.9e-16))
