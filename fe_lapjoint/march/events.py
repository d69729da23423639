"""The search for the time when a stop opens or closes within one exact flow; no double crossing escapes it.

`solve_ivp` looks at its events at the ends of its steps only, so that two crossings inside one step go unseen, and
restarting on an event fires it again.  Here the gap functions h are sampled on the dense output.  Bounds on how far h
strays from a chord and from a tangent, see `fe_lapjoint.march.envelope`, clear most intervals between two samples; the
others are halved until they are clear, or h rises all the way through one of them, where Newton's method finds the
crossing.  None of the bounds has a unit of its own: a motion a million times as fast is searched in as many steps.

A stop switches once h exceeds its `level`, half of the rounding error of h; the time of the switch is where h last
passed through 0 before.  A stop that has just switched is at h = 0, and h must exceed the level before it switches
again.  Thus rounding makes no contact, and a beam that rests on a stop without a gap does not switch it.  Between two
samples that do not exceed the level, a bound as small as rounding is no switch, either: see `SURE`.

`searching` makes the search from the functions that read a motion.  `in_python` reads any gap functions.  Where the
functions that read a motion are compiled, the search is compiled, too; see `fe_lapjoint.march.gaps`.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any, NamedTuple, Protocol

import numpy as np
import numpy.typing as npt

from lapjoint.compiled.arrays import bool_zeros, int_zeros, zeros
from lapjoint.compiled.compiling import njit_called
from lapjoint.problem import FloatArray

BoolArray = npt.NDArray[np.bool_]
IndexArray = npt.NDArray[np.intp]
_STEPS = 60
"""Most steps of Newton's method or of halving; 52 halvings reach the last digit of an interval."""
CONTINUOUS = 1e6
"""In rounding errors of h: a stop further than this beyond its switch at the start has not just switched; it switches
at once."""
SURE = 0.5
"""In rounding errors of h: a value of h this far above 0 makes a stop switch.

A bound on h between two values may exceed 0 by a whole rounding error without a switch, so that a motion that stays
near its level is not searched without end.
"""
_LATE = 4
"""In units of the resolution, `_RESOLUTION` of the time: the switch of another stop may have been located this much
later."""
_RESOLUTION = 2.0**-50
"""Relative error of a located crossing: four rounding errors of the times that are searched."""
_FEW = 4
"""Up to this many steps are searched directly; of more steps, a bound for each step excludes some first."""


class BoundedGaps(Protocol):
    """The gap functions h, m, of ``P`` stops, with bounds: h rises through 0 where a stop opens or closes."""

    def at(self, k: int, t: float) -> tuple[float, float]:
        """The gap function h of stop `k`, m, and its rate, m/s, at time `t`, s."""

    @property
    def curvature(self) -> FloatArray:
        """Bounds on \\|h''\\| at all times, m/s2, shape ``(P,)``: quickly had, for a first look."""

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """How far each gap function may exceed the larger of its values at both ends of an interval, m, ``(P, i)``.

        The intervals begin at `t`, s, ``(i,)``, and are `width` seconds wide.
        """

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """Upper bound on `side` (+1 or -1) times the gap function of stop `k` in intervals, m, shape ``(i,)``.

        The intervals begin at `t`, s, ``(i,)``, and are `width` seconds wide; the gap function at their ends is `ends`,
        m, ``(2, i)``.  The bound is below the larger value at the ends plus `from_chord` where a term swings within an
        interval: at its crest a swinging term equals its amplitude, whatever its values at the ends.
        """

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """How far the gap function of stop `k`, m, and its rate, m/s, may stray within `width` seconds from time `t`.

        Within the first s of these seconds, the gap function strays by at most s / width of its bound.
        """


class Gaps(BoundedGaps, Protocol):
    """Gap functions with bounds that can be read at many times, and at the steps of the search's grid."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions, m, at the times ``t``, s, shape ``(m,)``; gives shape ``(P, m)``."""

    def at_step(self, k: int, i: int) -> tuple[float, float, float, float]:
        """h, m, and h', m/s, of stop `k` at the beginning, then at the end, of step `i` of the searched grid."""


@njit_called()
def _first_look(
    h: FloatArray, rounding: FloatArray, fresh: BoolArray, curvature: FloatArray, width: float
) -> tuple[BoolArray, FloatArray, BoolArray, IndexArray, tuple[FloatArray, BoolArray, BoolArray]]:
    """Which stops may switch in which steps of the grid, by a bound on the curvature; arguments as in `searching`.

    Returned are: whether each stop has just switched, ``(P,)``; the level that h must exceed, m, ``(P,)``; which stops
    may exceed their level in which steps, up to the first step that is sure to have a crossing, ``(P, m)``; the steps
    in which any stop may switch, ``(s,)``; and zeroed arrays ``(P, 4)``, ``(P,)``, ``(P,)`` that the search of a step
    fills.
    """
    stops, last = h.shape[0], h.shape[1] - 1
    held, level = bool_zeros(stops), SURE * rounding
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
    return held, level, suspicious, steps[:count], (zeros((stops, 4)), bool_zeros(stops), bool_zeros(stops))


@njit_called()
def _passed(rising: tuple[float, ...], level: float) -> float:
    """Estimate of the time, s, when a rising gap function passes a level: a cubic in h, by values and rates at both
    ends."""
    start, end, h, rate, h_end, rate_end = rising
    width, rise = end - start, h_end - h
    u = (level - h) / rise
    if not rate_end > 0:  # estimates in place of bounds allow a falling end
        return start + u * width
    slow, fast = rise / rate, rise / rate_end
    return start + u * (u * (3 - 2 * u) * width + (1 - u) * ((1 - u) * slow - u * fast))


Function = Callable[..., Any]
"""A function of a search for switches, or a function by which the search reads a motion."""


class GapReaders(NamedTuple):
    """The functions by which a search reads gap functions; `gaps` is whatever these take."""

    at: Function
    """(gaps, k, t): as `BoundedGaps.at`."""
    at_step: Function
    """(gaps, k, i): as `Gaps.at_step`."""
    from_chord: Function
    """(gaps, k, t, width): as `BoundedGaps.from_chord`, for one stop and one interval."""
    ceiling: Function
    """(gaps, k, t, width, h, h_end): as `BoundedGaps.ceiling`, for one interval."""
    from_tangent: Function
    """(gaps, k, t, width): as `BoundedGaps.from_tangent`."""


class SwitchSearch(NamedTuple):
    """The two functions of a search for switches."""

    first_switch: Function
    """See `searching`."""
    first_in: Function
    """See `searching`."""


def _as_it_is(function: Function) -> Function:
    return function


def searching(reads: GapReaders, inner: Function = _as_it_is, outer: Function = _as_it_is) -> SwitchSearch:
    """The search for the first switch, made from the functions that read a motion.

    `inner` and `outer` decorate the functions that the search alone calls, and those that others call. Both functions
    of the search return the time, s, and the stop, which is -1 if none switches.

    - ``first_switch(gaps, t, h, rounding, fresh, curvature)`` finds the first crossing of any gap function on an even
      grid of times `t`, s, ascending, ``(m + 1,)``.  `h` holds the gap functions there, m, ``(P, m + 1)``; `rounding`
      the rounding error of each, m, ``(P,)``; `fresh` whether each stop may have switched at ``t[0]``, where its gap
      function is then zero but for rounding, ``(P,)``; `curvature` bounds on their curvature, m/s2, ``(P,)``.

    - ``first_in(gaps, start, end, which, ends, level, rounding, touching, curvature, latest)`` finds the first crossing
      from `start` to `end`, s.  `which` says the stops that may switch then, ``(P,)``; `ends` their gap functions, m,
      and rates, m/s, at `start` and at `end`, ``(P, 4)``; `level` the value that each must exceed and `rounding` its
      rounding error, m, ``(P,)``; `touching` whether each has just switched at `start`, ``(P,)``; `latest` is the
      largest modulus of the times, s, to the rounding of which a crossing is located.
    """
    at, at_step, from_chord, ceiling, from_tangent = reads

    @inner
    def located(
        gaps: Any, k: int, rising: tuple[float, ...], level: float, curvature: float, resolution: float
    ) -> float:
        """Where a gap function that rises all the way passes a level: Newton's method, kept between the ends.

        It ends with a step so short that the curvature moves the crossing by less than the resolution: a
        step s at a rate of more than 2 B s, with B the bound on the curvature, misses the crossing by at most
        B s^2 / rate.
        """
        lo, hi = rising[0], rising[1]
        t: float = min(max(_passed(rising, level), lo), hi)
        for _ in range(_STEPS):
            h, rate = at(gaps, k, t)
            if h < level:
                lo = t
            else:
                hi = t
            step = (level - h) / rate if rate > 0 else math.inf
            if abs(step) <= resolution or hi - lo <= resolution:
                break
            within = lo < t + step < hi
            t = t + step if within else (lo + hi) / 2
            bent = curvature * abs(step)
            if within and 2 * bent < rate and bent * abs(step) <= resolution * rate:
                break
        return t

    @inner
    def first_crossing(
        gaps: Any,
        k: int,
        part: tuple[float, ...],
        level: float,
        rounding: float,
        touching: bool,
        curvature: float,
        resolution: float,
    ) -> float:
        """Where a stop first switches in an interval, or NaN; at once if it is above its level from the start."""
        t, end, h, rate, h_last, rate_last = part
        if h > level + _LATE * resolution * abs(rate):
            return t
        touching = touching or h > level
        level, width = max(h, level), end - t
        # After a switch, widths grow from nothing.  A part of a swing may be unclear where whole swings, whose crest
        # is known, are clear: therefore a width as long as the whole time since the switch is tried, too.
        clear, begin = level + (1 - SURE) * rounding, t if touching else math.inf
        while t < end:
            last = width >= end - t
            if last:
                width, after, h_after, rate_after = end - t, end, h_last, rate_last
            else:
                after = t + width
                h_after, rate_after = at(gaps, k, after)
            stray, turn = curvature * width**2 / 2, curvature * width
            if h + rate * width + stray > clear and rate <= turn:  # neither clear nor rising all the way, at first
                stray, turn = from_tangent(gaps, k, t, width)
            if h_after <= level and (
                h + rate * width + stray <= clear or ceiling(gaps, k, t, width, h, h_after) <= clear
            ):
                t, h, rate, touching, width = after, h_after, rate_after, False, max(2 * width, after - begin)
            elif h_after > level and rate > turn:  # it rises all the way
                if h >= 0 and not touching:
                    return t
                rising = (t, after, h, rate, h_after, rate_after)
                crossing: float = located(gaps, k, rising, 0.0 if h < 0 else level, curvature, resolution)
                return crossing
            elif width > resolution:
                width /= 2
            elif h_after > level:
                return after
            else:
                t, h, rate, touching = after, h_after, rate_after, False
        return math.nan

    @outer
    def first_in(
        gaps: Any,
        start: float,
        end: float,
        which: BoolArray,
        ends: FloatArray,
        level: FloatArray,
        rounding: FloatArray,
        touching: BoolArray,
        curvature: FloatArray,
        latest: float,
    ) -> tuple[float, int]:
        """The first crossing in one part of the time."""
        resolution, until, stop = _RESOLUTION * latest, end, -1
        for k in range(which.size):
            if which[k]:
                h, rate = (ends[k, 2], ends[k, 3]) if stop < 0 else at(gaps, k, until)
                part = (start, until, ends[k, 0], ends[k, 1], h, rate)
                time = first_crossing(gaps, k, part, level[k], rounding[k], touching[k], curvature[k], resolution)
                if not math.isnan(time):
                    until, stop = time, k
        return until, stop

    @outer
    def first_switch(
        gaps: Any, t: FloatArray, h: FloatArray, rounding: FloatArray, fresh: BoolArray, curvature: FloatArray
    ) -> tuple[float, int]:
        """The first crossing on a grid."""
        width, latest = t[1] - t[0], max(abs(t[0]), abs(t[-1]))
        held, level, suspicious, steps, (ends, which, none) = _first_look(h, rounding, fresh, curvature, width)
        more = steps.size > _FEW  # a bound for each step excludes most steps
        for i in steps:
            found = False
            for k in range(fresh.size):
                which[k] = suspicious[k, i]
                if which[k] and more:
                    top = max(h[k, i], h[k, i + 1]) - level[k]
                    which[k] = top > -from_chord(gaps, k, t[i], width)
                if which[k]:
                    found = True
                    ends[k, 0], ends[k, 1], ends[k, 2], ends[k, 3] = at_step(gaps, k, i)
            if found:
                touching = held if i == 0 else none
                time, stop = first_in(gaps, t[i], t[i + 1], which, ends, level, rounding, touching, curvature, latest)
                if stop >= 0:
                    return time, stop
        return math.inf, -1

    return SwitchSearch(first_switch, first_in)


in_python = searching(
    GapReaders(
        at=lambda gaps, k, t: gaps.at(k, t),
        at_step=lambda gaps, k, i: gaps.at_step(k, i),
        from_chord=lambda gaps, k, t, width: float(gaps.from_chord(np.array([t]), width)[k, 0]),
        ceiling=lambda gaps, k, t, width, h, h_end: float(
            gaps.ceiling(k, np.array([t]), width, np.array([[h], [h_end]]))[0]
        ),
        from_tangent=lambda gaps, k, t, width: gaps.from_tangent(k, t, width),
    )
)
"""The search in Python, in gap functions of any kind."""
