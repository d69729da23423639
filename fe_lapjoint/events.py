"""Where a stop opens or closes within one exact flow: a search that no double crossing escapes.

`solve_ivp` looks at its events at the ends of its steps only, so that two crossings inside one step go unseen, and
restarting on an event fires it again.  Here the gap functions are sampled on the dense output.  Between two samples a
gap function stays below the larger of the two plus B w^2 / 8, where w is the spacing and B bounds its curvature; an
interval for which that is not below zero is divided until it is, or holds a crossing, or is so short that what could
hide in it is a contact of less than 1e-9 s.  A stop that has just switched is looked at again only after the time
during which its curvature cannot bring it back.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray

SHORTEST = 1e-9  # s: intervals are not divided further
LOCATION = 4e-13  # s: to which a crossing is located
_DIVISIONS = 16
_HALVINGS = 100  # at most: Newton's steps are far fewer


class Gaps(Protocol):
    """The gap functions h of all stops; h > 0 is a switch."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All of them at the times ``(m,)``: ``(P, m)``."""

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One of them, and its rate, at one time."""


@dataclass(frozen=True)
class Switch:
    """A stop opens or closes."""

    time: float
    stop: int


def first_switch(gaps: Gaps, t: FloatArray, h: FloatArray, curvature: FloatArray, fresh: FloatArray) -> Switch | None:
    """The first crossing of any gap function between the first and the last of the times ``t``.

    Parameters
    ----------
    gaps : Gaps
        The gap functions.
    t : FloatArray
        Grid that is searched, s, shape ``(m + 1,)``.
    h : FloatArray
        The gap functions there, shape ``(P, m + 1)``.
    curvature : FloatArray
        Bounds on the second derivative of each gap function from each grid time on, shape ``(P, m)``.
    fresh : FloatArray
        Time of each stop's last switch, shape ``(P,)``; -inf for none.
    """
    return _search(gaps, t, h, curvature, _quiet_until(gaps, float(t[0]), curvature[:, 0], fresh))


def _quiet_until(gaps: Gaps, start: float, curvature: FloatArray, fresh: FloatArray) -> FloatArray:
    """From when each stop may switch, ``(P,)``: later than `start` for those that have just done so."""
    quiet = np.full(fresh.size, start)
    for k in np.flatnonzero(start - fresh < SHORTEST):
        rate = gaps.at(int(k), start)[1]
        leaving = -2 * rate / max(curvature[k], 1e-300) if rate < 0 else 0.0
        # h <= h' s + B s^2 / 2 < 0 before 2 |h'| / B; half of it leaves room for the rounding of h at the start
        quiet[k] = start + max(leaving / 2, SHORTEST)
    return quiet


def _search(gaps: Gaps, t: FloatArray, h: FloatArray, curvature: FloatArray, quiet: FloatArray) -> Switch | None:
    """Left to right through the intervals of the grid ``t``, dividing those that may hide a crossing."""
    # The first grid point after a quiet time starts its stop anew: it may already be beyond zero.
    curvature = np.broadcast_to(curvature, (h.shape[0], t.size - 1))
    calm = t < quiet[:, None]
    h = np.where(calm, -np.inf, h)  # a quiet stop cannot cross
    width = t[1:] - t[:-1]
    ends = np.maximum(h[:, :-1], h[:, 1:])
    suspicious = (ends + curvature * (width**2 / 8) >= 0) | (calm[:, :-1] & (t[1:] > quiet[:, None]))
    for i in np.flatnonzero(suspicious.any(axis=0)):
        here, bound = suspicious[:, i], curvature[:, i]
        simple = _single_crossing(gaps, h, t, int(i), bound, here, quiet)
        if simple is not None:
            return simple
        if width[i] <= SHORTEST:
            crossed = [k for k in range(h.shape[0]) if h[k, i + 1] > 0]
            times = [Switch(_locate(gaps, k, t[i], t[i + 1], quiet[k]), k) for k in crossed]
            if times:
                return min(times, key=lambda switch: switch.time)
            continue
        finer = t[i] + (t[i + 1] - t[i]) * _FRACTIONS
        finer[-1] = t[i + 1]
        inside = _search(gaps, finer, gaps(finer), bound[:, None], quiet)
        if inside is not None:
            return inside
    return None


_FRACTIONS = np.arange(_DIVISIONS + 1) / _DIVISIONS


def _single_crossing(
    gaps: Gaps,
    h: FloatArray,
    t: FloatArray,
    i: int,
    curvature: FloatArray,
    suspicious: npt.NDArray[np.bool_],
    quiet: FloatArray,
) -> Switch | None:
    """The switch in the i-th interval if one stop alone can switch there, and its gap function rises in it."""
    if np.count_nonzero(suspicious) != 1:
        return None
    k, width = int(np.argmax(suspicious)), t[i + 1] - t[i]
    if not (t[i] >= quiet[k] and h[k, i] <= 0 < h[k, i + 1]):
        return None
    rate = gaps.at(k, float(t[i]))[1]
    return Switch(_locate(gaps, k, t[i], t[i + 1], quiet[k]), k) if rate > curvature[k] * width else None


def _locate(gaps: Gaps, k: int, lo: float, hi: float, quiet: float) -> float:
    """The crossing of stop `k` between `lo` and `hi`, where h is positive: Newton's method, or else halving."""
    lo, hi = max(float(lo), float(quiet)), float(hi)
    if lo >= hi:
        return lo
    h, rate = gaps.at(k, lo)
    if h >= 0:
        return lo
    t = lo
    for _ in range(_HALVINGS):
        after = t - h / rate if rate > 0 else np.inf
        if abs(after - t) <= LOCATION:
            return float(after)
        if not lo < after < hi:
            after = (lo + hi) / 2
            if hi - lo <= LOCATION:
                return after
        t = after
        h, rate = gaps.at(k, t)
        lo, hi = (lo, t) if h > 0 else (t, hi)
    return t
