"""A joint ready to be marched (19)-(49), and what a march gives: segments, contacts, and where it ends."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from analytic import kernel
from analytic.state import Passage, StateModel, build_passage, build_state, family_of, harmonics_of
from analytic.tables import Tables, slots_of
from lapjoint.answers import Contact
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, Problem
from lapjoint.solver import Progress

_ROOM = 64  # segments logged before the log is emptied
_MOST_SWITCHES = 1_000_000
_PROGRESS_PARTS = 50


@dataclass(frozen=True)
class Coordinates:
    """Modal coordinates in a contact state, at a moment."""

    state: ContactState
    q: FloatArray
    """Modal displacements, shape ``(N,)``."""
    v: FloatArray
    """Modal velocities, shape ``(N,)``."""

    @property
    def y(self) -> FloatArray:
        """q and v in one array, shape ``(2 N,)``."""
        return np.concatenate([self.q, self.v])

    def moved(self, y: FloatArray) -> Coordinates:
        """The same contact state with other coordinates ``y``."""
        return Coordinates(self.state, y[: self.q.size].copy(), y[self.q.size :].copy())


@dataclass(frozen=True)
class Segment:
    """The motion in one state, from one switch to the next."""

    state: ContactState
    start: float
    end: float
    q: FloatArray
    """Modal displacements at the start, shape ``(N,)``."""
    v: FloatArray
    """Modal velocities at the start, shape ``(N,)``."""
    switched: int
    """The stop that switches at the end, or `kernel.NO_SWITCH`."""


class Joint:
    """A problem with numbers of modes in the free state, and in every other."""

    def __init__(self, problem: Problem, free_modes: int, contact_modes: int) -> None:
        self.problem = problem
        self.harmonics = harmonics_of(problem)
        self.family = family_of(problem)
        self._slots = slots_of(self.family, free_modes, contact_modes)
        self.tables: Tables = self._slots.scaled(problem)
        self._models: dict[ContactState, StateModel] = {}

    def model(self, state: ContactState) -> StateModel:
        """One contact state in modal form."""
        if state not in self._models:
            self._models[state] = build_state(self.problem, self.family, state, self._slots.count(state))
        return self._models[state]

    def count(self, state: ContactState) -> int:
        """Number of modes in a state."""
        return self._slots.count(state)

    def passage(self, old: ContactState, new: ContactState) -> Passage:
        """The map from one state to another."""
        return build_passage(self.problem, self.family, self.model(old), self.model(new))

    def slot(self, state: ContactState) -> int:
        """Where a contact state is in the tables."""
        known = state in self._slots.states
        slot = self._slots.slot(state)
        if not known:
            self.tables = self._slots.scaled(self.problem)
        return slot

    def state_in(self, slot: int) -> ContactState:
        """The contact state in a slot."""
        return self._slots.states[slot]

    def connect(self, slot: int, stop: int) -> None:
        """Make the switch of a stop from the state in a slot known to the tables."""
        self._slots.connect(slot, stop)
        self.tables = self._slots.scaled(self.problem)

    @property
    def every_stop_closed(self) -> ContactState:
        """All stops, whether or not they can be closed together."""
        return ContactState(tuple(range(len(self.problem.stops))))


@dataclass(frozen=True)
class March:
    """A motion, and where it ends."""

    joint: Joint
    log: kernel.Log
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
    max_switches: int = _MOST_SWITCHES,
) -> March:
    """March from `start` to `end`.

    Parameters
    ----------
    record : bool
        Whether to log every segment.
    depth : bool
        Whether to find the deepest penetration of each contact, too.

    Raises
    ------
    SolverError
        If more than `max_switches` switches occur, or the march makes no progress.
    """
    size, stops = joint.tables.static.shape[1], len(joint.problem.stops)
    q, v = _padded(begin.q, size), _padded(begin.v, size)
    slot, t, pending, left = joint.slot(begin.state), start, kernel.NO_SWITCH, max_switches
    last_switch = np.full(stops, start)  # at the start a stop that just touches counts as fresh
    total, log, full = np.zeros(stops), kernel.new_log(_ROOM if record else 0, size, stops), []
    parts = _PROGRESS_PARTS if progress is not None else 1
    goals = [start + (end - start) * (i + 1) / parts for i in range(parts - 1)] + [end]
    for goal in goals if not record else [end]:
        status = kernel.MISSING_STATE
        while status != kernel.DONE:
            status, slot, t, pending, logged, switches = kernel.march(
                joint.tables, slot, t, goal, q, v, last_switch, total, pending, log, depth, left
            )
            left -= switches
            if logged:
                full.append(kernel.Log(*(part[:logged].copy() for part in log)))
            if status == kernel.MISSING_STATE:
                joint.connect(slot, pending)
            elif status == kernel.TOO_MANY:
                raise SolverError(f"more than {max_switches} switches before t = {t:.6g} s")
            elif status == kernel.STUCK:
                raise SolverError(f"the march makes no progress at t = {t:.12g} s in {joint.state_in(slot)}")
            if progress is not None:
                progress(t - start, end - start)
    state = joint.state_in(slot)
    n = joint.count(state)
    whole = kernel.Log(*(np.concatenate(parts) for parts in zip(*full, strict=True))) if full else log
    return March(joint, whole, Coordinates(state, q[:n].copy(), v[:n].copy()), total)


def joined(motions: Sequence[March], period: float) -> March:
    """Recorded marches that follow each other, a period apart, each from its own time 0, as one."""
    parts = [
        motion.log._replace(start=motion.log.start + i * period, end=motion.log.end + i * period)
        for i, motion in enumerate(motions)
    ]
    log = kernel.Log(*(np.concatenate(columns) for columns in zip(*parts, strict=True)))
    total = np.sum([motion.penetration for motion in motions], axis=0)
    return March(motions[-1].joint, log, motions[-1].end, total)


def _padded(values: FloatArray, size: int) -> FloatArray:
    result = np.zeros(size)
    result[: values.size] = values
    return result


def contacts_of(motion: March) -> tuple[Contact, ...]:
    """All contacts of a motion marched with `depth`, by start time."""
    joint, log = motion.joint, motion.log
    found: list[Contact] = []
    going: dict[int, tuple[int, bool]] = dict.fromkeys(joint.state_in(int(log.slot[0])).closed, (0, True))
    for i, stop in enumerate(log.stop):
        if stop < 0:
            continue
        if stop in going:
            first, open_start = going.pop(int(stop))
            found.append(_contact(motion, int(stop), first, i, open_start, open_end=False))
        else:
            going[int(stop)] = (i + 1, False)
    last = log.slot.size - 1
    found += [_contact(motion, k, first, last, open_start, open_end=True) for k, (first, open_start) in going.items()]
    return tuple(sorted(found, key=lambda contact: (contact.start, contact.stop)))


def _contact(motion: March, k: int, first: int, last: int, open_start: bool, *, open_end: bool) -> Contact:
    """The contact of stop `k` from the start of segment `first` to the end of segment `last`."""
    log, stop = motion.log, motion.joint.problem.stops[k]
    return Contact(
        stop=k,
        start=float(log.start[first]),
        end=float(log.end[last]),
        impulse=stop.sign * stop.stiffness * float(log.area[first : last + 1, k].sum()),
        peak_force=stop.stiffness * float(log.deepest[first : last + 1, k].max()),
        open_start=open_start,
        open_end=open_end,
    )
