"""A motion in stretches, so that a long one needs no more memory than a short one.

A stretch ends where a segment ends without a switch.  Along ramps it ends at a knot where the log has a new segment in
any case, so that the motion has the bits of the whole motion.  Under a periodic excitation it ends with a period, as in
the search for periodic motions.  Otherwise it ends at one of a sequence of equal times.
"""

from __future__ import annotations

import itertools
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analytic.march.initial_state import started
from analytic.march.joint import Joint
from analytic.march.march import MOST_SWITCHES, Marching, joined
from analytic.march.motion import Log


@dataclass(frozen=True)
class StretchSize:
    """Size of the stretches; it changes no motion but by the rounding of a segment's end."""

    rows: int = 1024
    """Least number of segments of every stretch but the last: 1 MB with 20 modes, a millisecond of work on its
    arrays."""
    room: int = 256
    """Number of segments logged before the log is handed on."""
    steps: float = 16
    """Time between two ends of stretches, where these are equally spaced, as a multiple of the first tabulated step,
    which is about half a period of the beam."""


STANDARD = StretchSize()


def stretches(logs: Iterator[Log], size: StretchSize) -> Iterator[Log]:
    """The segments of a motion, given in parts of any length, in stretches that end without a switch."""
    kept: list[Log] = []
    for log in logs:
        kept.append(log)
        if sum(part.slot.size for part in kept) < size.rows:
            continue
        whole = joined(kept)
        ends = np.flatnonzero(whole.stop < 0)
        kept = [whole]
        if ends.size:
            cut = int(ends[-1]) + 1
            yield _rows(whole, slice(cut))
            kept = [_rows(whole, slice(cut, None))]
    if any(part.slot.size for part in kept):
        yield joined(kept)


def marched(joint: Joint, duration: float, size: StretchSize) -> Iterator[Log]:
    """The segments of the motion from the initial state to `duration`, s, for an excitation without a period.

    The segments have the depths of contacts, and some end without a switch.  `SolverError` is raised where too many
    switches occur between two segments that end without one, or the march makes no progress.
    """
    marching = Marching(joint, started(joint), 0.0, room=size.room, depth=True, max_switches=MOST_SWITCHES)
    step = np.inf if joint.sampled else size.steps * float(joint.tables.step[0])
    for i in itertools.count(1):
        goal = min(i * step, duration)
        for log in marching.logs_to(goal):
            if np.any(log.stop < 0):
                marching.forget_switches()
            yield log
        if goal == duration:
            return


def _rows(log: Log, rows: slice) -> Log:
    """Some segments of a log."""
    return Log._make(part[rows] for part in log)
