"""A joint: one problem with its numbers of modes, and the contact states that motions of it have met.

A state gets a slot in the tables when a motion first reaches it: of the many sets of stops that could be closed, a
motion meets few.  States that motions of its structure have met before have slots from the start.  The tables belong to
the joint alone.  Which slot a state has depends on the motions before; what is in the slot does not.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from analytic.march.coupled import (
    SAMPLED,
    Coupled,
    coupled,
    force_rows,
    is_coupled,
    whole_map,
    write_coupled,
    write_still,
)
from analytic.march.known_states import KnownStates, memory_of
from analytic.march.loads import MOVED_STOPS, Excitation, excitation_of
from analytic.march.modal_state import LoadedStructure, ModalState, Passage, loaded_structure, modal_state, passage
from analytic.march.oscillator import ABOVE
from analytic.march.room import grown, with_spare
from analytic.march.tables import (
    FlatState,
    IntArray,
    Tables,
    Unscaled,
    connect,
    copied,
    count_in,
    fill,
    flat_state,
    known_switches,
    owned,
    scale,
    seen_motion,
    unit_tables,
)
from analytic.modes.beam_functions import ComplexArray
from analytic.modes.static_residual import Residual
from lapjoint.answers.contact_state import ContactState
from lapjoint.orbits.parameters import ExcitationChange, excitation_change
from lapjoint.problem import FloatArray, Problem

_FEW_POSITIONS, _MOST_KEPT = 64, 256
"""Largest number of positions for which shapes are kept, and largest number of kept shapes: 3 MB with 20 modes."""
_NONE_KNOWN = KnownStates()  # what a joint with damped stops begins with: its states depend on the excitation


@dataclass(frozen=True, eq=False)
class DrivenProblem:
    """A problem whose structure and excitation are known before it is made."""

    loaded: LoadedStructure
    excitation: Excitation
    make: Callable[[], Problem]
    """Gives the problem; called once, where the problem is asked for."""

    @cached_property
    def problem(self) -> Problem:
        """The problem."""
        return self.make()

    def __reduce__(self) -> tuple[object, ...]:
        return driven_problem, (self.problem,)


def driven_problem(problem: Problem) -> DrivenProblem:
    """A `DrivenProblem` of a problem that exists already."""
    return DrivenProblem(loaded_structure(problem), excitation_of(problem), lambda: problem)


class Joint:
    """A problem with numbers of modes in the free state, and in every other.

    One motion at a time: two threads that march take a joint each.  `side` says to which side of a load's frequency
    undamped modes are moved, see `analytic.march.oscillator.away_from_resonance`.
    """

    def __init__(
        self, problem: Problem | DrivenProblem, free_modes: int, contact_modes: int, side: float = ABOVE
    ) -> None:
        driven = driven_problem(problem) if isinstance(problem, Problem) else problem
        self._driven, self.loaded, self.side, self.counts = driven, driven.loaded, side, (free_modes, contact_modes)
        self.harmonics, self.sizes, self.period = (
            driven.excitation.harmonics,
            driven.excitation.sizes,
            driven.excitation.period,
        )
        """See `analytic.march.loads.Excitation`."""
        self.sampled = self.sizes.size - 1 - self.harmonics.omega.size
        """Number of sampled loads."""
        self.damped = self.loaded.problem.structure.couples or self.loaded.damped
        """Whether damping couples the modes of a state; see `analytic.march.coupled`."""
        self.turning = np.concatenate([[0.0], 1j * self.harmonics.omega, np.full(self.sampled, SAMPLED)])
        """The time derivative of each load divided by it, 1/s, shape ``(1 + H + R,)``; see `SAMPLED`."""
        self._coupled: dict[tuple[ContactState, int], Coupled] = {}
        self._memory = memory_of(self.loaded, self.counts)
        self._flat: dict[ContactState, FlatState] = {}
        self._kept_shapes: dict[tuple[Any, ...], FloatArray] = {}
        self._changes: dict[str, ExcitationChange | None] = dict(driven.excitation.changes)
        self.tables: Tables
        self._borrows: bool
        self.known = _NONE_KNOWN if self.damped else self._memory.known
        """The states and switches that the tables have from the start, in slots of that order."""
        self._fill_known(self.known)

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self._driven.problem

    def change_by(self, field: str) -> ExcitationChange | None:
        """How the excitation changes with a parameter, by its path, or None if that is not known."""
        if field not in self._changes:
            self._changes[field] = excitation_change(self.problem, field)
        return self._changes[field]

    @property
    def stops(self) -> int:
        """Number of stops in the tables, where a damped stop has a second row; see `analytic.march.coupled`."""
        return int(self.tables.sign.size)

    @cached_property
    def force_rows(self) -> IntArray:
        """The row of the tables whose penetration is proportional to each stop's force, shape ``(P,)``."""
        return force_rows(self.loaded.problem)

    def count(self, state: ContactState) -> int:
        """Number of modes in a state."""
        return count_in(state, self.counts)

    def modal(self, state: ContactState) -> ModalState:
        """One contact state in modal form, for unit loads."""
        return modal_state(self.loaded, state.pressed, self.count(state))

    def left_out(self, state: ContactState) -> FloatArray:
        """What the gaps see beside the modes under each load, m, ``(1 + H + R, P)``: residual shapes, and the base."""
        return self._seen_beside(self.modal(state))

    def _seen_beside(self, modal: ModalState) -> FloatArray:
        """`left_out` of a state in modal form."""
        return np.asarray((modal.residual_at_stops + seen_motion(self.loaded)) * self.sizes[:, None])

    def coupled(self, state: ContactState, count: int | None = None) -> Coupled | None:
        """The oscillators of a state whose modes are coupled, of its own or another `count` of modes; None of any
        other state."""
        if not self.damped or not is_coupled(self.loaded.problem, state):
            return None
        count = count or self.count(state)
        found = self._coupled.get((state, count))
        if found is None:
            modal = modal_state(self.loaded, ContactState(state.closed), count)
            moved = self.sampled > 0 and self.loaded.positions[-1] == MOVED_STOPS
            loads = self._seen_beside(modal), self.sizes, self.turning, self.sampled, moved
            found = self._coupled[state, count] = coupled(self.loaded, state, count, *loads, self.side)
        return found

    def residual(self, state: ContactState) -> Residual:
        """The residual shapes, m, of the 1 + H + R loads at their real size; the constant load is first."""
        return self.modal(state).residual.scaled(self.sizes)

    def shapes_at(self, state: ContactState, x: FloatArray, dx: int) -> FloatArray:
        """The `dx`-th x-derivative of a state's modes at `x`, m, ``(n,)``: kg^-1/2 m^-dx, ``(N, n)``; read only."""
        modes = self.modal(state).modes
        return self._at_positions(("shapes", state, x.tobytes(), dx), lambda: modes.shapes(x, dx), x.size)

    def residual_at(self, state: ContactState, x: FloatArray, dx: int) -> FloatArray:
        """The `dx`-th x-derivative of `residual` at `x`, m, ``(n,)``: m^(1 - dx), ``(1 + H + R, n)``; read only."""
        return self._at_positions(("residual", state, x.tobytes(), dx), lambda: self.residual(state)(x, dx), x.size)

    def _at_positions(self, key: tuple[Any, ...], make: Callable[[], FloatArray], positions: int) -> FloatArray:
        """The array that `make` gives, from the cache if `key` is in it; arrays at few positions are cached."""
        if positions > _FEW_POSITIONS:
            return make()
        found = self._kept_shapes.get(key)
        if found is None:
            if len(self._kept_shapes) >= _MOST_KEPT:
                self._kept_shapes.clear()
            found = self._kept_shapes[key] = make()
        return found

    def passage(self, old: ContactState, new: ContactState) -> Passage:
        """The map of displacement and velocity from one state to another, for the loads at their real size; S0, Sh in
        kg^1/2 m."""
        unit = passage(self.loaded, old, self.count(old), new, self.count(new))
        return Passage(unit.S, unit.residual * self.sizes[:, None])

    def whole_passage(self, old: ContactState, new: ContactState) -> tuple[FloatArray, ComplexArray]:
        """The map of (q, v) from one state to another, ``(2 N, 2 N)``, and the part of the loads, ``(1 + H + R, 2 N)``.

        Either state may be coupled: (q, v) are then (P, V) of `analytic.march.coupled`.
        """
        n_old, n_new = self.count(old), self.count(new)
        if old.closed == new.closed:
            left_out = np.zeros((self.turning.size, n_new))
        else:
            left_out = self.passage(old.pressed, new.pressed).residual
        both = whole_map(self.loaded, old, n_old, new, n_new)
        load = np.concatenate([left_out, self.turning[:, None] * left_out], axis=1)
        before, after = self.coupled(old), self.coupled(new)
        if after is not None:
            load = load @ after.back.T
            load[:, n_new:] += after.carried
        if before is not None:
            load = load - before.carried @ both[:, n_old:].T
        return both, load

    def from_modes(self, state: ContactState, q: FloatArray, v: FloatArray, t: float) -> tuple[FloatArray, FloatArray]:
        """Coordinates of a state from displacements and velocities of its modes, ``(N,)``, at the time `t`, s."""
        it = self.coupled(state)
        if it is None:
            return q, v
        y = it.back @ np.concatenate([q, v])
        y[q.size :] += self.lags(it.carried, np.array([t]))[:, 0]
        return y[: q.size], y[q.size :]

    def in_modes(
        self, state: ContactState, P: FloatArray, V: FloatArray, t: float, count: int | None = None
    ) -> tuple[FloatArray, FloatArray]:
        """The inverse of `from_modes`, in a state with its own or another `count` of modes."""
        it = self.coupled(state, count)
        if it is None:
            return P, V
        y = it.to @ np.concatenate([P, V - self.lags(it.carried, np.array([t]))[:, 0]])
        return y[: P.size], y[P.size :]

    def lags(self, lag: ComplexArray, t: FloatArray, dt: int = 0) -> FloatArray:
        """The dt-th derivative of r at times ``(m,)``, from `lag` or `carried` of `Coupled`: ``(N, m)``."""
        omega, H = self.harmonics.omega[:, None], self.harmonics.omega.size
        waves = (1j * omega) ** dt * np.exp(1j * (omega * t + self.harmonics.phase[:, None]))
        found = (lag[1 : 1 + H].T @ waves).imag + (lag[0].real[:, None] if dt == 0 else 0.0)
        if self.sampled:
            loads, of_loads = self.sampled_loads(t), lag[1 + H :].T
            found += of_loads.real @ loads[dt] + of_loads.imag @ loads[dt + 1]
        return np.asarray(found)

    def sampled_loads(self, t: FloatArray) -> FloatArray:
        """The sampled loads at times ``(m,)`` and three derivatives, after knots, ``(4, R, m)``."""
        blocks = self.problem.forces.ramps
        assert blocks is not None
        (force, slope), none = blocks.at(t), np.zeros((len(blocks.forces), t.size))
        linear = np.stack([force.T, slope.T, none, none])
        return linear if blocks.base is None else np.concatenate([linear, blocks.base_at(t)[:, None]], axis=1)

    def flat(self, state: ContactState) -> FlatState:
        """One contact state as flat arrays, for unit loads; not to be written to."""
        found = self._flat.get(state)
        if found is None:
            found = self._flat[state] = flat_state(self.loaded, state.pressed, self.count(state))
        return found

    @property
    def states(self) -> tuple[ContactState, ...]:
        """The states met so far, by slot."""
        return tuple(self._states)

    def slot(self, state: ContactState) -> int:
        """The slot of a contact state in the tables; a state without a slot is given one."""
        if state not in self._slots:
            if len(self._states) == self.tables.modes.size:
                self._grow(with_spare(len(self._states)), self.tables.carry.shape[0])
            self._slots[state] = len(self._states)
            self._states.append(state)
            self._fill(self._slots[state])
        return self._slots[state]

    def state_in(self, slot: int) -> ContactState:
        """The contact state in a slot."""
        return self._states[slot]

    def connect(self, slot: int, stop: int) -> None:
        """Write the switch of a stop from the state in a slot, and the reverse switch, to the tables."""
        self._own()
        old = self._states[slot]
        new = old.toggled(self.index_of(stop))
        target, row = self.slot(new), known_switches(self.tables)
        if row + 2 > self.tables.carry.shape[0]:
            self._grow(self.tables.modes.size, with_spare(row))
        if self.damped:
            self._connect_whole(slot, target, stop, row)
            return
        connect(self.tables, self.loaded, self.counts, stop, (slot, old), (target, new))
        self.tables.carry_residual[row : row + 2] *= self.sizes[:, None]
        self._memory.known = self._memory.known.and_of(old, stop)

    def index_of(self, row: int) -> int:
        """The index of `ContactState.toggled` of a switch of a row of the tables."""
        owner = -1 if self.tables.owner is None else int(self.tables.owner[row])
        return row if owner < 0 else ~owner

    def _connect_whole(self, slot: int, target: int, stop: int, row: int) -> None:
        """`connect` for a joint with damped stops: the switch of a row of the tables alone, to its row of switches."""
        whole, load = self.whole_passage(self._states[slot], self._states[target])
        n_new, n_old = whole.shape[0] // 2, whole.shape[1] // 2
        self.tables.whole[row, :, :n_new, :, :n_old] = whole.reshape(2, n_new, 2, n_old)
        self.tables.whole_load[row, :, :, :n_new] = load.reshape(-1, 2, n_new)
        self.tables.next_slot[slot, stop], self.tables.passage[slot, stop] = target, row

    def _own(self) -> None:
        """Make all arrays of the tables the joint's own, before they are written to."""
        if self._borrows:
            self.tables, self._borrows = owned(self.tables), False

    def _fill_known(self, known: KnownStates) -> None:
        unit = unit_tables(self.loaded, self.counts, known)
        self._states = list(known.states)
        self._slots = known.slots.copy()
        self.tables = copied(unit, self.harmonics, self.sizes)
        self._borrows = True
        self._scale(unit.borrowed, 0, unit.unscaled)

    def _grow(self, slots: int, switches: int) -> None:
        self._own()
        if self.damped:
            before = self._memory.room
            slots, switches = self._memory.room = max(slots, before[0]), max(switches, before[1])
        self.tables = grown(self.tables, slots, switches)

    def _fill(self, slot: int) -> None:
        """Fill in a state that is met for the first time."""
        self._own()
        state, size = self._states[slot], max(self.counts)
        it = self.coupled(state)
        if it is not None:
            write_coupled(self.tables, slot, self.loaded.problem, state, self.left_out(state), it, self.turning)
            write_still(self.tables, slot)
            return
        flat = self.flat(state)
        fill(self.tables, slot, flat)
        left_out = np.zeros((1, self.tables.constant.shape[1], self.sizes.size))
        left_out[0, : flat.residual.shape[0]] = flat.residual
        unscaled = Unscaled(np.zeros((1, size)), np.zeros((1, size)), left_out)
        n = flat.omega.size
        unscaled.natural[0, :n], unscaled.damping_rate[0, :n] = flat.omega, flat.damping_rate
        self._scale(self.tables, slot, unscaled)
        if self.damped:
            self.tables.push[slot] = self.tables.force[slot]
            write_still(self.tables, slot)

    def _scale(self, unit: Tables, first: int, unscaled: Unscaled) -> None:
        """Scale the slots from the `first` on to the excitation; see `analytic.march.tables.scale`."""
        scale(unit, self.tables, first, unscaled, self.sizes, self.side)
