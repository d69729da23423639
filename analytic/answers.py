"""From a problem and numbers of modes to a motion."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from analytic.march import Joint, march
from analytic.march.field import history_of
from analytic.march.initial_state import started
from analytic.march.oscillator import ABOVE
from analytic.march.stretches import STANDARD, StretchSize, marched, stretches
from analytic.period_map import PeriodMap
from lapjoint.answers import History
from lapjoint.problem import Problem
from lapjoint.solver import Progress

_ROUNDINGS = 1e-12  # relative rounding error of a sum of whole periods that comes to the duration asked for


def simulate(
    problem: Problem,
    name: str,
    counts: tuple[int, int],
    duration: float,
    progress: Progress | None,
    side: float = ABOVE,
) -> History:
    """The motion from the initial state to `duration`, s, with its contacts, by a solver called `name`.

    `counts` are the numbers of modes in the free state and in every other; `side` says to which side of a load's
    frequency undamped modes are moved, see `analytic.march.oscillator.away_from_resonance`.  `progress` is called with
    (done, total).
    """
    joint = Joint(problem, *counts, side)
    if problem.excitation_frequency is not None:
        return PeriodMap(joint, name).simulated(duration, progress)
    motion = march(joint, started(joint), 0.0, duration, depth=True, progress=progress)
    return history_of(name, motion.joint, motion.log)


def stream(
    problem: Problem,
    name: str,
    counts: tuple[int, int],
    duration: float,
    progress: Progress | None,
    size: StretchSize = STANDARD,
) -> Iterator[History]:
    """The motion of `simulate`, stretch by stretch. See `lapjoint.solver.Streams.stream`."""
    joint, start = Joint(problem, *counts), 0.0
    if problem.excitation_frequency is None:
        logs = marched(joint, duration, size)
    else:
        logs = PeriodMap(joint, name).marched(duration)
    for log in stretches(logs, size):
        end = duration if log.end[-1] > duration * (1 - _ROUNDINGS) else log.end[-1]
        log = log._replace(start=np.append(start, log.start[1:]), end=np.append(log.end[:-1], end))
        start = float(end)
        yield history_of(name, joint, log)
        if progress is not None:
            progress(start, duration)
