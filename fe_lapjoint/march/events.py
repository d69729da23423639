"""Where a stop opens or closes within one exact flow: a search that no double crossing escapes.

`solve_ivp` looks at its events at the ends of its steps only, so that two crossings inside one step go unseen, and
restarting on an event fires it again.  Here the gap functions are sampled on the dense output.  Between two samples a
gap function stays below the larger of the two plus B w^2 / 8, where w is the spacing and B bounds its curvature; an
interval for which that is not below zero is walked through from the left in steps s for which h + h' s + B s^2 / 2
stays below zero.  They lead to the first crossing, ever faster as Newton's do, and past a near miss; none is made
shorter than 1e-9 s, so that only a contact of less than that may hide.  A stop that has just switched is looked at
again only after the time during which its curvature cannot bring it back.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Protocol

import numpy as np

from lapjoint.problem import FloatArray

SHORTEST = 1e-9  # s: least step of the search, so that a shorter contact may be missed; 2500 times LOCATION
LOCATION = 4e-13  # s: a crossing is located to this; it is a few rounding errors of a time near 1000 s
_STEPS = 20  # of Newton's method, at most; a few are enough where it converges quadratically
_HALVINGS = 100  # steps at most where some of them halve the interval; 41 of them shrink 1 s to LOCATION


class Gaps(Protocol):
    """The gap functions h, m, of ``P`` stops: h rises through 0 where a stop opens or closes."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions at the times ``t``, s, shape ``(m,)``: m, shape ``(P, m)``."""

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate at one time.

        Parameters
        ----------
        k : int
            The stop.
        t : float
            The time, s.

        Returns
        -------
        float, float
            h, m, and h', m/s.
        """


@dataclass(frozen=True)
class Switch:
    """A stop opens or closes."""

    time: float
    """s."""
    stop: int
    """Which stop."""


def first_switch(gaps: Gaps, t: FloatArray, h: FloatArray, curvature: FloatArray, fresh: FloatArray) -> Switch | None:
    """The first crossing of any gap function between the first and the last of the times ``t``.

    Parameters
    ----------
    gaps : Gaps
        The gap functions of ``P`` stops.
    t : FloatArray, shape (m + 1,)
        Grid that is searched, s, ascending.
    h : FloatArray, shape (P, m + 1)
        The gap functions there, m.
    curvature : FloatArray, shape (P, m)
        Bounds on the second derivative of each gap function from each grid time on, m/s2.
    fresh : FloatArray, shape (P,)
        Time of each stop's last switch, s; -inf for none.

    Returns
    -------
    Switch or None
        The first crossing, or None if there is none.
    """
    quiet = _quiet_until(gaps, float(t[0]), curvature[:, 0], fresh)
    ends = np.maximum(h[:, :-1], h[:, 1:])
    suspicious = ends + curvature * ((t[1:] - t[:-1]) ** 2 / 8) >= 0
    for k, since in quiet.items():  # a quiet stop cannot cross; it is looked at from the interval on in which that ends
        calm = int(np.searchsorted(t, since))
        suspicious[k, : calm - 1] = False
        suspicious[k, calm - 1 : calm] = True
    for i in np.nonzero(suspicious.any(axis=0))[0].tolist():
        first: Switch | None = None
        for k in np.nonzero(suspicious[:, i])[0].tolist():
            lo, hi = max(float(t[i]), quiet.get(k, -math.inf)), float(t[i + 1]) if first is None else first.time
            time = _first_crossing(gaps, k, lo, hi, float(curvature[k, i]))
            first = first if time is None else Switch(time, k)
        if first is not None:
            return first
    return None


def _quiet_until(gaps: Gaps, start: float, curvature: FloatArray, fresh: FloatArray) -> dict[int, float]:
    """From when, s, each stop may switch that has done so just before `start`."""
    quiet = {}
    for k in np.nonzero(start - fresh < SHORTEST)[0].tolist():
        rate = gaps.at(k, start)[1]
        leaving = -2 * rate / max(float(curvature[k]), 1e-300) if rate < 0 else 0.0
        # h <= h' s + B s^2 / 2 < 0 before 2 |h'| / B; half of it leaves room for the rounding of h at the start
        quiet[k] = start + max(leaving / 2, SHORTEST)
    return quiet


def _first_crossing(gaps: Gaps, k: int, t: float, end: float, curvature: float) -> float | None:
    """Where stop `k` first switches in an interval, or None; at once if it is beyond zero from the start."""
    while t < end:
        h, rate = gaps.at(k, t)
        if h >= 0:
            return t
        step = _safe_step(h, rate, curvature)
        if rate > 4 * curvature * step:  # h rises all the way to a crossing within 2 step
            time = _newton(gaps, k, t, h, rate)
            return time if time < end else None
        if step <= SHORTEST:
            step = SHORTEST
            if gaps.at(k, t + step)[0] > 0:
                time = _locate(gaps, k, t, t + step)
                return time if time < end else None
        t += step
    return None


def _safe_step(h: float, rate: float, curvature: float) -> float:
    """The s > 0 at which h + rate s + curvature s^2 / 2 comes up to zero, with h < 0."""
    root = math.sqrt(rate * rate - 2 * curvature * h)
    below = rate + root if rate > 0 else -2 * curvature * h / max(root - rate, 1e-300)
    return -2 * h / max(below, 1e-300)


def _newton(gaps: Gaps, k: int, t: float, h: float, rate: float) -> float:
    """The crossing just ahead of `t`, where the rate hardly changes: the steps shrink quadratically."""
    for _ in range(_STEPS):
        step = -h / rate
        t += step
        if abs(step) <= LOCATION:
            break
        h, rate = gaps.at(k, t)
    return t


def _locate(gaps: Gaps, k: int, lo: float, hi: float) -> float:
    """The crossing of stop `k` between `lo` and `hi`, where h is positive: Newton's method, or else halving."""
    h, rate = gaps.at(k, lo)
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
