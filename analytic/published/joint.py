"""A joint as the published scheme sees it, and where a motion of it is."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from analytic.march.joint import DrivenProblem, Joint, driven_problem
from analytic.march.known_states import KnownStates
from analytic.march.modal_state import LoadedStructure, passage
from analytic.march.motion import SLOT, Motion, new_motion
from analytic.march.oscillator import ABOVE
from analytic.march.switching import Frozen
from analytic.march.tables import Tables, count_in
from analytic.march.unit_tables import Unscaled
from lapjoint.answers.contact_state import ContactState
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem

_PRODUCTS = 32  # sets of inner products kept, as in `analytic.march.tables`; 9 states with 8 modes take 40 kB


@dataclass
class FrozenMotion:
    """A motion by the published scheme: the modes' part, and the shape that stands still."""

    moving: Motion
    rest: FloatArray
    """Coefficients of the frozen shape R, the displacement that the modes of the state do not carry, over the modes of
    all states, kg^1/2 m, shape ``(S, N)``."""

    @property
    def slot(self) -> int:
        """The slot of the contact state."""
        return int(self.moving.counts[SLOT])


class PublishedJoint(Joint):
    """A joint whose tables leave out what the published scheme does not have: the residual shapes."""

    def __init__(
        self, problem: Problem | DrivenProblem, free_modes: int, contact_modes: int, side: float = ABOVE
    ) -> None:
        driven = driven_problem(problem) if isinstance(problem, Problem) else problem
        for k, stop in enumerate(driven.loaded.problem.structure.stops):
            if stop.damping > 0:
                raise InputError(f"stops[{k}].damping = {stop.damping:g}: the published scheme has no damped stops")
        super().__init__(driven, free_modes, contact_modes, side)

    def begin(self, state: ContactState, q: FloatArray, v: FloatArray) -> FrozenMotion:
        """A motion at the time 0 from `q`, kg^1/2 m, and `v`, kg^1/2 m/s, ``(N,)``, without a frozen shape."""
        slot, size = self.slot(state), max(self.counts)
        moving = new_motion(slot, 0.0, q, v, size, self.stops)
        return FrozenMotion(moving, np.zeros((self.tables.modes.size, size)))

    def frozen(self, motion: FrozenMotion) -> Frozen:
        """The input of the published switch rule; `motion.rest` is padded to room for the states met so far."""
        more = self.cross.shape[0] - motion.rest.shape[0]
        if more > 0:
            motion.rest = np.pad(motion.rest, ((0, more), (0, 0)))
        return Frozen(motion.rest, self.cross, self.order)

    def _fill_known(self, known: KnownStates) -> None:
        super()._fill_known(known)
        self.cross = _products(self.loaded, self.counts, known.states).copy()
        """S_ij of (43), from the modes of each state (second axis) to those of each (first), ``(S, S, N, N)``."""
        self.order = np.arange(len(known.states))
        """The slots in the order in which to sum over states, shape ``(states,)``."""

    def _grow(self, slots: int, switches: int) -> None:
        super()._grow(slots, switches)
        used, size = self.cross.shape[0], max(self.counts)
        if slots == used:
            return
        cross = np.zeros((slots, slots, size, size))
        cross[:used, :used] = self.cross
        self.cross = cross

    def _fill(self, slot: int) -> None:
        super()._fill(slot)
        _fill_products(self.cross, self.loaded, self.counts, self.states, slot)
        self.order = np.array(sorted(range(slot + 1), key=lambda at: self.states[at].closed), dtype=np.int64)

    def _scale(self, unit: Tables, first: int, unscaled: Unscaled) -> None:
        super()._scale(unit, first, unscaled._replace(residual=np.zeros_like(unscaled.residual)))
        self.tables.constant[first:] = 0.0


@lru_cache(maxsize=_PRODUCTS)
def _products(loaded: LoadedStructure, counts: tuple[int, int], states: tuple[ContactState, ...]) -> FloatArray:
    """Inner products of the modes of every two states, shape ``(S, S, N, N)``; not to be written to."""
    cross = np.zeros((len(states), len(states), max(counts), max(counts)))
    for slot in range(len(states)):
        _fill_products(cross, loaded, counts, states, slot)
    cross.flags.writeable = False
    return cross


def _fill_products(
    cross: FloatArray, loaded: LoadedStructure, counts: tuple[int, int], states: tuple[ContactState, ...], slot: int
) -> None:
    """Write the inner products of the modes in a slot with those in the slots up to it."""
    for other in range(slot + 1):
        S = _between(loaded, counts, states[other], states[slot])
        cross[slot, other, : S.shape[0], : S.shape[1]] = S
        cross[other, slot, : S.shape[1], : S.shape[0]] = S.T


def _between(loaded: LoadedStructure, counts: tuple[int, int], old: ContactState, new: ContactState) -> FloatArray:
    """S_ij of (43) from the modes of `old` to those of `new`, computed in one direction, for the last bits."""
    if old == new:
        return np.eye(count_in(old, counts))
    if old.closed > new.closed:
        return _between(loaded, counts, new, old).T
    return passage(loaded, old, count_in(old, counts), new, count_in(new, counts)).S
