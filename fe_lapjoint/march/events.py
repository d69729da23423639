"""Where a stop opens or closes within one exact flow: a search that no double crossing escapes.

`solve_ivp` looks at its events at the ends of its steps only, so that two crossings inside one step go unseen, and
restarting on an event fires it again.  Here the gap functions h are sampled on the dense output.  Bounds on how far h
strays from a chord and from a tangent, see `fe_lapjoint.march.envelope`, clear most intervals between two samples; the
others are halved until they are clear, or h rises all the way through one of them, where Newton's method finds the
crossing.  None of the bounds has a unit of its own: a motion a million times as fast is searched in as many steps.

A stop switches where h exceeds what rounding makes of a gap that is closed, its `level`, and the switch is where h
passes through 0 before that.  A stop that has just switched is at h = 0; it must rise above its level to switch again.
So rounding makes no contact, and a stop that rests on a gap of zero stays as it is.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray

BoolArray = npt.NDArray[np.bool_]
_STEPS = 60  # of Newton's method or of halving, at most; 52 halvings leave the last digit of an interval
_CONTINUOUS = 1e6  # roundings: a stop further beyond its switch than this has not just switched, but switches at once
_LATE = 4  # resolutions: another stop's switch may have been located so much later than this stop's
_RESOLUTION = 2.0**-50  # relative: a crossing is located to four rounding errors of the times that are searched


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

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """How far each gap function may rise above, or fall below, both ends of an interval.

        Parameters
        ----------
        t : FloatArray, shape (i,)
            Where intervals begin, s.
        width : float
            Their width, s.

        Returns
        -------
        FloatArray, shape (P, i)
            m.
        """

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """How far a gap function, and its rate, may stray from their values at a time.

        Parameters
        ----------
        k : int
            The stop.
        t : float
            The time, s.
        width : float
            For how long after it, s.

        Returns
        -------
        float, float
            By how much it may leave its tangent, m: by no more than the part s / width of that after s; and by how much
            its rate may change, m/s.
        """


@dataclass(frozen=True)
class Switch:
    """A stop opens or closes."""

    time: float
    """s."""
    stop: int
    """Which stop."""


def first_switch(
    gaps: Gaps, t: FloatArray, h: FloatArray, straying: FloatArray, rounding: FloatArray, fresh: BoolArray
) -> Switch | None:
    """The first crossing of any gap function between the first and the last of the times ``t``.

    Parameters
    ----------
    gaps : Gaps
        The gap functions of ``P`` stops.
    t : FloatArray, shape (m + 1,)
        Grid that is searched, s, ascending.
    h : FloatArray, shape (P, m + 1)
        The gap functions there, m.
    straying : FloatArray, shape (P, m)
        How far each of them may rise above both ends of each step, m.
    rounding : FloatArray, shape (P,)
        What rounding makes of each gap function, m.
    fresh : BoolArray, shape (P,)
        Whether each stop may have switched at ``t[0]``, so that its gap function is zero there but for rounding.

    Returns
    -------
    Switch or None
        The first crossing, or None if there is none.
    """
    held = fresh & (h[:, 0] <= _CONTINUOUS * rounding)
    level = np.where(held, np.maximum(h[:, 0], 0.0), 0.0) + rounding
    top = np.maximum(h[:, :-1], h[:, 1:]) + straying
    suspicious = top > level[:, None]
    resolution = _RESOLUTION * max(abs(float(t[0])), abs(float(t[-1])))
    for i in np.flatnonzero(suspicious.any(axis=0)):
        first: Switch | None = None
        for k in np.flatnonzero(suspicious[:, i]):
            end = float(t[i + 1]) if first is None else first.time
            touching = i == 0 and bool(held[k])
            time = _first_crossing(gaps, int(k), (float(t[i]), end), float(level[k]), touching, resolution)
            first = first if time is None else Switch(time, int(k))
        if first is not None:
            return first
    return None


def _first_crossing(
    gaps: Gaps, k: int, interval: tuple[float, float], level: float, touching: bool, resolution: float
) -> float | None:
    """Where stop `k` first switches in an interval, or None; at once if it is above its level from the start."""
    t, end = interval
    h, rate = gaps.at(k, t)
    if h > level + _LATE * resolution * abs(rate):
        return t
    level, touching, width = max(h, level), touching or h > level, end - t
    while t < end:
        last = width >= end - t
        width, after = (end - t, end) if last else (width, t + width)
        h_after, rate_after = gaps.at(k, after)
        stray, turn = gaps.from_tangent(k, t, width)
        if h_after <= level and (
            h + rate * width + stray <= level
            or max(h, h_after) + float(gaps.from_chord(np.array([t]), width)[k, 0]) <= level
        ):
            t, h, rate, touching, width = after, h_after, rate_after, False, 2 * width
        elif h_after > level and rate > turn:  # it rises all the way
            if h >= 0 and not touching:
                return t
            return _located(gaps, k, (t, after), (h, h_after), 0.0 if h < 0 else level, resolution)
        elif width > resolution:
            width /= 2
        elif h_after > level:
            return after
        else:
            t, h, rate, touching = after, h_after, rate_after, False
    return None


def _located(
    gaps: Gaps, k: int, interval: tuple[float, float], ends: tuple[float, float], level: float, resolution: float
) -> float:
    """Where a gap function that rises all the way passes a level: Newton's method, kept between the ends."""
    (lo, hi), (h_lo, h_hi) = interval, ends
    t = lo + (hi - lo) * (level - h_lo) / (h_hi - h_lo)
    for _ in range(_STEPS):
        h, rate = gaps.at(k, t)
        lo, hi = (t, hi) if h < level else (lo, t)
        step = (level - h) / rate if rate > 0 else np.inf
        if abs(step) <= resolution or hi - lo <= resolution:
            break
        t = t + step if lo < t + step < hi else (lo + hi) / 2
    return float(t)
