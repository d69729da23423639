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

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from lapjoint.compiled_arrays import bool_zeros, int_zeros
from lapjoint.compiling import njit_called
from lapjoint.problem import FloatArray

BoolArray = npt.NDArray[np.bool_]
IndexArray = npt.NDArray[np.intp]
_STEPS = 60  # of Newton's method or of halving, at most; 52 halvings leave the last digit of an interval
CONTINUOUS = 1e6
"""Roundings: a stop further beyond its switch than this has not just switched, but switches at once."""
_LATE = 4  # resolutions: another stop's switch may have been located so much later than this stop's
_RESOLUTION = 2.0**-50  # relative: a crossing is located to four rounding errors of the times that are searched
_FEW = 4  # steps: so many are searched sooner than a second look at them excludes some


class BoundedGaps(Protocol):
    """The gap functions h, m, of ``P`` stops, with bounds: h rises through 0 where a stop opens or closes."""

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

    @property
    def curvature(self) -> FloatArray:
        """Bounds on \\|h''\\| at all times, m/s2, shape ``(P,)``: quickly had, for a first look."""

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

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """The most that a gap function, or minus it, can be in intervals.

        It is less than the higher end and `from_chord` allow, where something swings within an interval: that reaches
        its crest at most, wherever it is at the ends.

        Parameters
        ----------
        k : int
            The stop.
        t : FloatArray, shape (i,)
            Where intervals begin, s.
        width : float
            Their width, s.
        ends : FloatArray, shape (2, i)
            The gap function at their beginnings and ends, m.
        side : float
            +1 for the gap function, -1 for minus it.

        Returns
        -------
        FloatArray, shape (i,)
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


class Gaps(BoundedGaps, Protocol):
    """The same, on a grid of times, too."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions at the times ``t``, s, shape ``(m,)``: m, shape ``(P, m)``."""

    def at_step(self, k: int, i: int) -> tuple[float, float, float, float]:
        """One gap function and its rate at both ends of a step of the grid that is searched.

        Parameters
        ----------
        k : int
            The stop.
        i : int
            Which step.

        Returns
        -------
        float, float, float, float
            h, m, and h', m/s, at its beginning; h and h' at its end.
        """


@dataclass(frozen=True)
class Switch:
    """A stop opens or closes."""

    time: float
    """s."""
    stop: int
    """Which stop."""


class Part(NamedTuple):
    """A part of the time, with a gap function and its rate at both ends."""

    start: float
    """s."""
    end: float
    """s."""
    h: float
    """m."""
    rate: float
    """m/s."""
    h_end: float
    """m."""
    rate_end: float
    """m/s."""


def first_switch(gaps: Gaps, t: FloatArray, h: FloatArray, rounding: FloatArray, fresh: BoolArray) -> Switch | None:
    """The first crossing of any gap function between the first and the last of the times ``t``.

    Parameters
    ----------
    gaps : Gaps
        The gap functions of ``P`` stops.
    t : FloatArray, shape (m + 1,)
        Even grid that is searched, s, ascending.
    h : FloatArray, shape (P, m + 1)
        The gap functions there, m.
    rounding : FloatArray, shape (P,)
        What rounding makes of each gap function, m.
    fresh : BoolArray, shape (P,)
        Whether each stop may have switched at ``t[0]``, so that its gap function is zero there but for rounding.

    Returns
    -------
    Switch or None
        The first crossing, or None if there is none.
    """
    held, level, suspicious, steps = _first_look(h, rounding, fresh, gaps.curvature, float(t[1] - t[0]))
    if steps.size > _FEW:
        suspicious, steps = _second_look(gaps, t, h, level, suspicious, steps)
    latest = max(abs(float(t[0])), abs(float(t[-1])))
    for i, suspects in zip(steps.tolist(), suspicious[:, steps].T, strict=True):
        begin, end = float(t[i]), float(t[i + 1])
        first = first_in(
            gaps,
            {k: Part(begin, end, *gaps.at_step(k, i)) for k in suspects.nonzero()[0].tolist()},
            level,
            held & (i == 0),
            latest,
        )
        if first is not None:
            return first
    return None


def first_in(
    gaps: BoundedGaps, parts: Mapping[int, Part], level: FloatArray, touching: BoolArray, latest: float
) -> Switch | None:
    """The first crossing of some gap functions in one part of the time.

    Parameters
    ----------
    gaps : BoundedGaps
        The gap functions of ``P`` stops.
    parts : mapping of int to Part
        The stops that may switch in it, and their gap functions at its ends.
    level : FloatArray, shape (P,)
        What each must exceed for the stop to switch, m.
    touching : BoolArray, shape (P,)
        Whether each stop has just switched where the part begins.
    latest : float
        Largest modulus of the times, s, to the rounding of which a crossing is located.

    Returns
    -------
    Switch or None
        The first crossing, or None if there is none.
    """
    resolution, first = _RESOLUTION * latest, None
    for k, part in parts.items():
        if first is not None:
            part = Part(part.start, first.time, part.h, part.rate, *gaps.at(k, first.time))
        time = _first_crossing(gaps, k, part, float(level[k]), bool(touching[k]), resolution)
        first = first if time is None else Switch(time, k)
    return first


@njit_called()
def _first_look(
    h: FloatArray, rounding: FloatArray, fresh: BoolArray, curvature: FloatArray, width: float
) -> tuple[BoolArray, FloatArray, BoolArray, IndexArray]:
    """Which stops may switch in which steps of the grid, by a bound on the curvature.

    Parameters
    ----------
    h : FloatArray, shape (P, m + 1)
        The gap functions on the grid, m.
    rounding, fresh : FloatArray, BoolArray, shape (P,)
        See `first_switch`.
    curvature : FloatArray, shape (P,)
        Bounds on \\|h''\\|, m/s2.
    width : float
        Of a step, s.

    Returns
    -------
    held : BoolArray, shape (P,)
        Whether each stop has just switched.
    level : FloatArray, shape (P,)
        What h must exceed for a stop to switch, m.
    suspicious : BoolArray, shape (P, m)
        Which stops may exceed their level in which steps, up to the first that is sure to have a crossing.
    steps : IndexArray, shape (s,)
        The steps in which any may.
    """
    stops, last = h.shape[0], h.shape[1] - 1
    held, level = bool_zeros(stops), rounding.copy()
    for k in range(stops):
        held[k] = fresh[k] and h[k, 0] <= CONTINUOUS * rounding[k]
        if held[k]:
            level[k] += max(h[k, 0], 0.0)
        for i in range(last):
            if h[k, i + 1] > level[k] + rounding[k]:
                last = i + 1
                break
    suspicious, steps, count = bool_zeros((stops, h.shape[1] - 1)), int_zeros(last), 0
    for i in range(last):
        found = False
        for k in range(stops):
            top = max(h[k, i], h[k, i + 1]) - level[k]
            suspicious[k, i] = top > -curvature[k] * width**2 / 8
            found = found or suspicious[k, i]
        if found:
            steps[count] = i
            count += 1
    return held, level, suspicious, steps[:count]


def _second_look(
    gaps: Gaps, t: FloatArray, h: FloatArray, level: FloatArray, suspicious: BoolArray, steps: IndexArray
) -> tuple[BoolArray, IndexArray]:
    """Which of the steps remain, and which stops in them: a bound for each excludes most.

    As `_first_look` gives them.
    """
    top = np.maximum(h[:, steps], h[:, steps + 1]) - level[:, None]
    suspicious[:, steps] = top > -gaps.from_chord(t[steps], float(t[1] - t[0]))
    return suspicious, steps[suspicious[:, steps].any(axis=0)]


def _first_crossing(
    gaps: BoundedGaps, k: int, interval: Part, level: float, touching: bool, resolution: float
) -> float | None:
    """Where stop `k` first switches in an interval, or None; at once if it is above its level from the start."""
    t, end, h, rate = interval.start, interval.end, interval.h, interval.rate
    if h > level + _LATE * resolution * abs(rate):
        return t
    level, touching, width = max(h, level), touching or h > level, end - t
    curvature = float(gaps.curvature[k])
    while t < end:
        last = width >= end - t
        width, after = (end - t, end) if last else (width, t + width)
        h_after, rate_after = (interval.h_end, interval.rate_end) if last else gaps.at(k, after)
        stray, turn = curvature * width**2 / 2, curvature * width
        if h + rate * width + stray > level and rate <= turn:  # neither clear nor rising all the way, at a first look
            stray, turn = gaps.from_tangent(k, t, width)
        if h_after <= level and (
            h + rate * width + stray <= level
            or gaps.ceiling(k, np.array([t]), width, np.array([[h], [h_after]]))[0] <= level
        ):
            t, h, rate, touching, width = after, h_after, rate_after, False, 2 * width
        elif h_after > level and rate > turn:  # it rises all the way
            if h >= 0 and not touching:
                return t
            rising = Part(t, after, h, rate, h_after, rate_after)
            return _located(gaps, k, rising, 0.0 if h < 0 else level, resolution)
        elif width > resolution:
            width /= 2
        elif h_after > level:
            return after
        else:
            t, h, rate, touching = after, h_after, rate_after, False
    return None


def _located(gaps: BoundedGaps, k: int, rising: Part, level: float, resolution: float) -> float:
    """Where a gap function that rises all the way passes a level: Newton's method, kept between the ends.

    It is done when so short a step remains that the curvature moves the crossing by less than the resolution: a step s
    at a rate of more than 2 B s, with B the bound on the curvature, misses the crossing by at most B s^2 / rate.
    """
    curvature = float(gaps.curvature[k])
    lo, hi = rising.start, rising.end
    t = min(max(_passed(rising, level), lo), hi)
    for _ in range(_STEPS):
        h, rate = gaps.at(k, t)
        lo, hi = (t, hi) if h < level else (lo, t)
        step = (level - h) / rate if rate > 0 else np.inf
        if abs(step) <= resolution or hi - lo <= resolution:
            break
        within = lo < t + step < hi
        t = t + step if within else (lo + hi) / 2
        bent = curvature * abs(step)
        if within and 2 * bent < rate and bent * abs(step) <= resolution * rate:
            break
    return float(t)


def _passed(rising: Part, level: float) -> float:
    """About when a rising gap function passes a level: time as a cubic in it, by its value and rate at both ends."""
    width, rise = rising.end - rising.start, rising.h_end - rising.h
    u = (level - rising.h) / rise
    if not rising.rate_end > 0:  # estimates in place of bounds do not rule that out
        return rising.start + u * width
    slow, fast = rise / rising.rate, rise / rising.rate_end
    return rising.start + u * (u * (3 - 2 * u) * width + (1 - u) * ((1 - u) * slow - u * fast))
