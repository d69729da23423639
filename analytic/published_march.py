"""A joint ready to be marched by the scheme as published, and the march of it."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from analytic import kernel, published_kernel
from analytic.march import Coordinates, Joint, March
from analytic.published_kernel import Carried
from analytic.tables import Slots, Tables, slots_of
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray, Problem
from lapjoint.solver import Progress

_ROOM = 256  # segments logged before the log is emptied
MOST_SWITCHES = 1_000_000


class Crossings:
    """S_ij of (43), between the modes of every two states that motions have met, shape ``(S, S, N, N)``."""

    def __init__(self, slots: Slots) -> None:
        self._slots, self._filled = slots, 0
        self._products = np.zeros((0, 0, 0, 0))

    def products(self) -> FloatArray:
        """The inner products, padded with 0 to the largest number of modes and to all slots."""
        states, size = self._slots.states, max(self._slots.counts)
        if self._filled < len(states):
            products = np.zeros((len(states), len(states), size, size))
            if self._filled:
                products[: self._filled, : self._filled] = self._products
            for new in range(self._filled, len(states)):
                for old in range(new + 1):
                    S = self._between(states[old], states[new])
                    products[new, old, : S.shape[0], : S.shape[1]] = S
                    products[old, new, : S.shape[1], : S.shape[0]] = S.T
            self._products, self._filled = products, len(states)
        return self._products

    def _between(self, old: ContactState, new: ContactState) -> FloatArray:
        """From the modes of `old` to those of `new`: computed one way only, as the other has other last bits."""
        slots = self._slots
        if old == new:
            return np.eye(slots.count(old))
        if old.closed > new.closed:
            return self._between(new, old).T
        return slots.family.passage(old, slots.count(old), new, slots.count(new)).S


@lru_cache(maxsize=64)
def _crossings_of(slots: Slots) -> Crossings:
    return Crossings(slots)


class PublishedJoint(Joint):
    """A joint whose tables leave out what the published scheme does not have: the residual shapes."""

    def __init__(self, problem: Problem, free_modes: int, contact_modes: int) -> None:
        super().__init__(problem, free_modes, contact_modes)
        self._crossings = _crossings_of(slots_of(self.family, free_modes, contact_modes))
        self.frozen_tables, self.cross = self.tables, np.zeros((0, 0, 0, 0))
        self.refresh()

    def refresh(self) -> None:
        """Bring tables and inner products up to date, after a state was met for the first time."""
        self.tables = self._slots.scaled(self.problem)
        self.cross = self._crossings.products()
        self.frozen_tables = _without_residual(self.tables)

    def begin(self, state: ContactState, q: FloatArray, v: FloatArray) -> tuple[int, Carried]:
        """Slot and coordinates of a motion that starts within the span of a state's modes."""
        slot = self.slot(state)
        self.refresh()
        states, size = self.cross.shape[0], self.cross.shape[2]
        carried = Carried(
            np.zeros(size), np.zeros(size), np.zeros((states, size)), *np.zeros((2, len(self.problem.stops)))
        )
        carried.q[: q.size], carried.v[: v.size] = q, v
        return slot, carried

    def grown(self, carried: Carried) -> Carried:
        """The same coordinates with room for the states met since."""
        more = self.cross.shape[0] - carried.rest.shape[0]
        return carried._replace(rest=np.pad(carried.rest, ((0, more), (0, 0)))) if more > 0 else carried

    def meet(self, slot: int, stop: int, carried: Carried) -> Carried:
        """Make the switch of a stop known, with the state that it leads to."""
        self.connect(slot, stop)
        self.refresh()
        return self.grown(carried)


def _without_residual(tables: Tables) -> Tables:
    """Own copy of what the march writes to, and the motion forced by harmonics in the modes alone."""
    modes = tables.weight[:, :, : tables.harmonic.shape[2]]
    forced = np.asarray(modes @ tables.harmonic.transpose(0, 2, 1))
    return tables._replace(forced=forced, constant=np.zeros_like(tables.constant))


@dataclass(frozen=True)
class PublishedMarch(March):
    """A motion by the scheme as published."""

    rest: FloatArray
    """Coefficients of the frozen shape R over the modes of all states, in each segment, shape ``(M, S, N)``."""


def march(
    joint: PublishedJoint,
    slot: int,
    carried: Carried,
    start: float,
    end: float,
    *,
    depth: bool = True,
    shortest: float,
    progress: Progress | None = None,
) -> PublishedMarch:
    """March from `start` to `end`, with every segment logged; `carried` is used up.

    No state lasts less than `shortest`, s.

    Raises
    ------
    SolverError
        If more than `MOST_SWITCHES` switches occur, or the march makes no progress.
    """
    stops = len(joint.problem.stops)
    carried.last_switch[:], carried.total[:] = start, 0.0
    log, full, first = kernel.new_log(_ROOM, carried.q.size, stops), [], carried.rest.copy()
    t, pending, left, status = start, kernel.NO_SWITCH, MOST_SWITCHES, kernel.MISSING_STATE
    while status != kernel.DONE:
        status, slot, t, pending, logged, switches = published_kernel.march(
            joint.frozen_tables, joint.cross, slot, t, end, carried, pending, log, depth, shortest, left
        )
        left -= switches
        full.append(kernel.Log(*(part[:logged].copy() for part in log)))
        if status == kernel.MISSING_STATE:
            carried = joint.meet(slot, pending, carried)
        raise_if_stuck(joint, status, slot, t)
        if progress is not None:
            progress(t - start, end - start)
    whole = kernel.Log(*(np.concatenate(parts) for parts in zip(*full, strict=True)))
    state = joint.state_in(slot)
    n = joint.count(state)
    ends = Coordinates(state, carried.q[:n].copy(), carried.v[:n].copy())
    return PublishedMarch(joint, whole, ends, carried.total.copy(), _frozen(joint, whole, first))


def raise_if_stuck(joint: Joint, status: int, slot: int, t: float) -> None:
    """Turn the two ways in which a march fails into errors."""
    if status == kernel.TOO_MANY:
        raise SolverError(f"more than {MOST_SWITCHES} switches before t = {t:.6g} s")
    if status == kernel.STUCK:
        raise SolverError(f"the march makes no progress at t = {t:.12g} s in {joint.state_in(slot)}")


def _frozen(joint: PublishedJoint, log: kernel.Log, first: FloatArray) -> FloatArray:
    """R of each segment, by adding up what each switch adds to it, shape ``(M, S, N)``."""
    segments, (states, _, size, _) = log.slot.size, joint.cross.shape
    change = np.zeros((segments, states, size))
    change[0, : first.shape[0]] = first
    later = np.arange(1, segments)
    np.add.at(change, (later, log.slot[:-1]), log.q_end[:-1])
    np.add.at(change, (later, log.slot[1:]), -log.q[1:])
    return np.cumsum(change, axis=0)
