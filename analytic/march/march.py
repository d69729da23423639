"""The march of a joint (19)-(49): its segments, penetrations, and the coordinates at its end."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from analytic.march.compiled import DONE, LOG_FULL, MISSING_SWITCH, STUCK, TOO_MANY, advance
from analytic.march.coordinates import Coordinates
from analytic.march.joint import Joint
from analytic.march.motion import PENDING, SLOT, SWITCHES, Log, Motion, new_log, new_motion, new_work, no_log
from analytic.march.ramps import RampState
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import SolverError
from lapjoint.machine.memory import require
from lapjoint.machine.result_cache import bytes_in
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

MOST_SWITCHES = 1_000_000  # default limit of switches of one march: half a million impacts, minutes of computing
_ROOM = 256  # segments in the log before it is emptied: with 64, joining logs took 6 % of the time of a branch
SWITCHES_AT_ONCE = 1000  # switches in one compiled call, half a second with 320 modes, so that Ctrl-C is heeded
WITH_ALL_AT_ONCE = 100  # switches in one compiled call that carries all deviations, half a second with 320 modes
_PART = 2000  # bytes of a piece of a motion in addition to its segments: a dozen arrays, and its end
_PROGRESS_PARTS = 50  # reports in a march without a log: one every two percent of the time


@dataclass(frozen=True)
class Segment:
    """The motion in one state, from one switch to the next."""

    state: ContactState
    start: float
    """Time at which the segment starts, s."""
    end: float
    """Time at which the segment ends, s."""
    q: FloatArray
    """Modal displacements at the start, kg^1/2 m, shape ``(N,)``."""
    v: FloatArray
    """Modal velocities at the start, kg^1/2 m/s, shape ``(N,)``."""
    switched: int
    """The stop that switches at the end, or `analytic.march.motion.NO_SWITCH`."""


@dataclass(frozen=True)
class March:
    """A motion, and where it ends."""

    joint: Joint
    log: Log
    """Every segment; empty if the motion was not to be recorded."""
    end: Coordinates
    penetration: FloatArray
    """Time integral of each stop's penetration, m s, shape ``(P,)``."""

    @property
    def segments(self) -> tuple[Segment, ...]:
        """The motion state by state."""
        log = self.log
        return tuple(self._segment(i, self.joint.state_in(int(log.slot[i]))) for i in range(log.slot.size))

    def _segment(self, i: int, state: ContactState) -> Segment:
        n, log = self.joint.count(state), self.log
        return Segment(state, float(log.start[i]), float(log.end[i]), log.q[i, :n], log.v[i, :n], int(log.stop[i]))


def march(
    joint: Joint,
    begin: Coordinates,
    start: float,
    end: float,
    *,
    record: bool = True,
    depth: bool = False,
    progress: Progress | None = None,
    max_switches: int = MOST_SWITCHES,
) -> March:
    """March a joint from the time `start` to `end`, s; without `record` no segment is logged.

    `depth` asks for the deepest penetration of each contact, too.  `progress` is called with (done, total), s.
    `SolverError` is raised where more than `max_switches` switches occur, or the march makes no progress.
    """
    marching = Marching(joint, begin, start, room=_ROOM if record else 0, depth=depth, max_switches=max_switches)
    parts = _PROGRESS_PARTS if progress is not None and not record else 1
    full, size = [], 0.0
    for goal in [start + (end - start) * (i + 1) / parts for i in range(parts - 1)] + [end]:
        for log in marching.logs_to(goal):
            full.append(log)
            size = recorded(size, log)
            if progress is not None:
                progress(marching.time - start, end - start)
    return March(joint, joined(full), marching.end, marching.penetration)


def recorded(before: float, log: Log, times: float = 1) -> float:
    """Bytes that the record of a motion takes with the segments of a log added `times` times to the `before` bytes.

    `SolverError` is raised where that is too much; see `lapjoint.machine.memory`.
    """
    size = before + times * (bytes_in(log) + _PART)
    what = f"the segments of a motion, of {log.q.shape[1]} modes each,"
    require(size, what, "take a shorter motion, fewer modes (n_modes), or statistics, which keep sums alone", before)
    return size


class Marching:
    """A march that is advanced from one requested time to the next, from `start`, s.

    Each full log of `room` segments is handed to the caller; with 0, no segment is logged.  `depth` asks for the
    deepest penetration of each contact.  `SolverError` is raised after `max_switches` switches.
    """

    def __init__(
        self, joint: Joint, begin: Coordinates, start: float, *, room: int, depth: bool, max_switches: int
    ) -> None:
        self._joint, self._motion = joint, begun(joint, begin, start)
        modes, stops = self._motion.q.size, self._motion.total.size
        self._log = new_log(room, modes, stops) if room else no_log(modes, stops)
        self._ramps = RampState(joint, start) if joint.sampled else None
        self._work = new_work(joint.tables)
        self._depth, self._max_switches = depth, max_switches

    @property
    def time(self) -> float:
        """The time that the march has reached, s."""
        return float(self._motion.time[0])

    @property
    def end(self) -> Coordinates:
        """Present state and coordinates of the march."""
        return ended(self._joint, self._motion)

    @property
    def penetration(self) -> FloatArray:
        """Time integral of each stop's penetration so far, m s, shape ``(P,)``."""
        return self._motion.total.copy()

    def forget_switches(self) -> None:
        """Reset the count of switches to 0."""
        self._motion.counts[SWITCHES] = 0

    def logs_to(self, goal: float) -> Iterator[Log]:
        """March on to a time, s, at which a segment ends; gives the new segments, or none if there is no room.

        `SolverError` is raised where there are too many switches, or the march makes no progress.
        """
        motion, status = self._motion, LOG_FULL
        while status != DONE or motion.time[0] < goal:
            until, ramps = goal, None
            if self._ramps is not None:
                until, ramps = min(goal, self._ramps.move_to(self.time)), self._ramps.tables
            status, logged = advance(
                self._joint.tables,
                None,
                ramps,
                motion,
                self._work,
                until,
                self._log,
                self._depth,
                0.0,
                next_switches(motion, self._max_switches),
            )
            if status != DONE:
                settle_status(self._joint, motion, status, self._max_switches)
            yield copied(self._log, logged)


def next_switches(motion: Motion, max_switches: int, at_once: int | None = None) -> int:
    """Number of switches, in all, after which a compiled march comes back, so that Ctrl-C is heeded.

    `settle_status` lets it go on until there are more than `max_switches`.  By default `SWITCHES_AT_ONCE` are made.
    """
    return min(int(motion.counts[SWITCHES]) + (at_once or SWITCHES_AT_ONCE), max_switches)


def begun(joint: Joint, begin: Coordinates, start: float) -> Motion:
    """The `Motion` of a march that starts at the time `start`, s, which the compiled march advances in place."""
    slot = joint.slot(begin.state)
    motion = new_motion(slot, start, begin.q, begin.v, max(joint.counts), joint.stops)
    fastest = joint.flat(begin.state).omega.max(initial=0.0) if begin.held else 0.0
    if fastest > 0:
        motion.last_switch[list(begin.held)] = start + 2 * np.pi / fastest
    return motion


def ended(joint: Joint, motion: Motion) -> Coordinates:
    """Present state and coordinates of a march, copied."""
    state = joint.state_in(int(motion.counts[SLOT]))
    n = joint.count(state)
    return Coordinates(state, motion.q[:n].copy(), motion.v[:n].copy())


def settle_status(joint: Joint, motion: Motion, status: int, max_switches: int) -> None:
    """Add to the tables a switch that they lack, or raise `SolverError` if the march cannot go on."""
    slot, t = int(motion.counts[SLOT]), float(motion.time[0])
    if status == MISSING_SWITCH:
        joint.connect(slot, int(motion.counts[PENDING]))
    elif status == TOO_MANY and motion.counts[SWITCHES] > max_switches:
        raise SolverError(f"more than {max_switches} switches before t = {t:.6g} s")
    elif status == STUCK:
        raise SolverError(f"the march makes no progress at t = {t:.12g} s in {joint.state_in(slot)}")


def copied(log: Log, logged: int) -> Log:
    """A copy of the first `logged` segments of a log whose arrays are reused."""
    return Log._make([part[:logged].copy() for part in log])


def joined(logs: list[Log]) -> Log:
    """One log of all segments of at least one log, given in the order of time."""
    if len(logs) == 1:
        return logs[0]
    return Log._make(np.concatenate(parts) for parts in zip(*logs, strict=True))
