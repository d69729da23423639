"""The times at which a motion is shown: given times, or as many as the motion needs.

The switches of the contact state are always among them.
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray

MOST_FRAMES = 100_000
"""Largest number of times of a motion, so that programs can open its files."""
TOLERANCE = 0.01
"""Default of the largest error of linear interpolation between frames, divided by the largest value: one per cent."""
_FEWEST = 33
"""Least number of equidistant times with which the halving of intervals begins."""
_A_PERIOD = 2
"""First number of intervals in a period of the fastest excitation: with fewer, some motions seem at rest."""
_STATIONS = 33
"""Number of equidistant positions on the beam at which errors are measured."""
_INSIDE = (0.2, 0.4, 0.6, 0.8)
"""Fractions of an interval at which the error is measured: several, so that a point of inflection hides no error."""
_MARGIN = 0.8
"""Largest measured error, divided by the tolerance; the rest allows for errors between the measured positions."""


def common_time(histories: Sequence[History]) -> tuple[float, float]:
    """The first and the last time that all histories cover, s."""
    start, end = max(h.start for h in histories), min(h.end for h in histories)
    if start > end:
        raise InputError("motion: these motions have no time in common")
    return start, end


def chosen_times(
    histories: Sequence[History],
    *,
    times: FloatArray | Sequence[float] | None = None,
    frames: int | None = None,
    tolerance: float | None = None,
) -> FloatArray:
    """The times of the frames, s, ascending, (n,): the switches, and the times of one choice of three.

    `times` are the times themselves, s; `frames` is a number of equidistant times.  Otherwise there are as many as the
    motion needs: between two frames, displacement and velocity differ from linear interpolation by at most `tolerance`,
    by default `TOLERANCE`, times their largest value along the beam.
    """
    if sum(choice is not None for choice in (times, frames, tolerance)) > 1:
        raise InputError("frames: give times, frames or tolerance, and not two of them")
    start, end = common_time(histories)
    if times is not None:
        found = _given(times, start, end)
        start, end = float(found[0]), float(found[-1])
    elif frames is not None:
        check_frames(frames)
        found = np.linspace(start, end, frames)
    else:
        found = np.unique(np.concatenate([_resolved(h, start, end, tolerance) for h in histories]))
    switches = np.concatenate([h.switch_times for h in histories])
    found = np.union1d(found, switches[(switches >= start) & (switches <= end)])
    return _not_too_many(found)


def check_frames(frames: int, most: int = MOST_FRAMES) -> None:
    """Refuse a number of frames below 2 or above `most`."""
    if not 2 <= frames <= most:
        raise InputError(f"frames = {frames}: allowed are 2 to {most}")


def _given(times: FloatArray | Sequence[float], start: float, end: float) -> FloatArray:
    t = np.unique(np.asarray(times, dtype=float))
    if not 1 <= t.size <= MOST_FRAMES or not np.all((t >= start) & (t <= end)):
        raise InputError(f"times: allowed are 1 to {MOST_FRAMES} numbers within the history, {start:g} to {end:g} s")
    return t


def _not_too_many(times: FloatArray) -> FloatArray:
    if times.size > MOST_FRAMES:
        raise InputError(f"frames: with its switches, this motion needs {times.size}; allowed are {MOST_FRAMES}")
    return times


def _resolved(history: History, start: float, end: float, tolerance: float | None) -> FloatArray:
    """Times, s, ascending, between which linear interpolation errs by at most `tolerance`, found by halving
    intervals."""
    allowed = TOLERANCE if tolerance is None else tolerance
    if not 0 < allowed < 1:
        raise InputError(f"tolerance = {allowed:g}: must be between 0 and 1")
    x = history.problem.line.grid(_STATIONS)

    def motion(t: FloatArray) -> FloatArray:
        return np.stack([history.displacement(x, t), history.velocity(x, t)])

    switches, waves = history.switch_times, (end - start) * history.problem.forces.fastest / (2 * math.pi)
    begin = _not_too_many(np.linspace(start, end, max(_FEWEST, math.ceil(_A_PERIOD * min(waves, MOST_FRAMES)) + 1)))
    times = np.union1d(begin, switches[(switches > start) & (switches < end)])
    left, right = times[:-1], times[1:]
    largest = np.max(np.abs(motion(times)), axis=(1, 2))[:, None, None]
    while left.size:
        a, b, wrong = motion(left), motion(right), np.zeros(left.size)
        for share in _INSIDE:
            inside = motion(left + share * (right - left))
            largest = np.maximum(largest, np.max(np.abs(inside), axis=(1, 2))[:, None, None])
            error = np.abs(inside - (1 - share) * a - share * b) / np.where(largest > 0, largest, 1.0)
            wrong = np.maximum(wrong, error.max(axis=(0, 1)))
        halved = wrong > _MARGIN * allowed
        middle = (left[halved] + right[halved]) / 2
        times = _not_too_many(np.union1d(times, middle))
        left, right = np.concatenate([left[halved], middle]), np.concatenate([middle, right[halved]])
    return times
