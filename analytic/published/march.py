"""The march of a joint by the scheme as published."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.compiled import DONE, LOG_FULL, advance
from analytic.march.march import MOST_SWITCHES, March, copied, ended, joined, settle_status
from analytic.march.motion import NO_SWITCH, PENDING, Log, new_log, new_work
from analytic.published.joint import FrozenMotion, PublishedJoint
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_ROOM = 256  # segments logged before the log is emptied


@dataclass(frozen=True)
class PublishedMarch(March):
    """A motion by the scheme as published."""

    rest: FloatArray
    """Coefficients of the frozen shape R, the displacement that the modes of a state do not carry, kg^1/2 m, shape
    ``(M, S, N)``: for each of M segments, over the N modes of each of S states."""


def march_published(
    joint: PublishedJoint,
    motion: FrozenMotion,
    end: float,
    *,
    shortest: float,
    progress: Progress | None = None,
) -> PublishedMarch:
    """March from the time 0 to `end`, s, with every segment logged; `motion` is advanced in place.

    No state lasts less than `shortest`, s.  `progress` is called with (done, total), s.  `SolverError` is raised where
    more than `MOST_SWITCHES` switches occur, or the march makes no progress.
    """
    restarted(motion)
    log, full, first = new_log(_ROOM, motion.moving.q.size, motion.moving.total.size), [], motion.rest.copy()
    status, work = LOG_FULL, new_work(joint.tables)
    while status != DONE:
        tables, frozen, moving = joint.tables, joint.frozen(motion), motion.moving
        status, logged = advance(tables, frozen, None, moving, work, end, log, True, shortest, MOST_SWITCHES)
        full.append(copied(log, logged))
        settle_status(joint, motion.moving, status, MOST_SWITCHES)
        if progress is not None:
            progress(float(motion.moving.time[0]), end)
    whole = joined(full)
    rest = _rest_of_segments(whole, first, (joint.tables.modes.size, motion.moving.q.size))
    return PublishedMarch(joint, whole, ended(joint, motion.moving), motion.moving.total.copy(), rest)


def restarted(motion: FrozenMotion) -> None:
    """Reset time, integrals of penetration and counts of switches of a motion to 0, in place."""
    motion.moving.time[:], motion.moving.last_switch[:], motion.moving.total[:] = 0.0, 0.0, 0.0
    motion.moving.counts[1:] = 0
    motion.moving.counts[PENDING] = NO_SWITCH


def _rest_of_segments(log: Log, first: FloatArray, shape: tuple[int, int]) -> FloatArray:
    """R of each segment, shape ``(M, S, N)``: `first` plus the sum of the changes at all earlier switches; `shape` is
    ``(S, N)``."""
    change = np.zeros((log.slot.size, *shape))
    change[0, : first.shape[0]] = first
    later = np.arange(1, log.slot.size)
    np.add.at(change, (later, log.slot[:-1]), log.q_end[:-1])
    np.add.at(change, (later, log.slot[1:]), -log.q[1:])
    return np.cumsum(change, axis=0)
