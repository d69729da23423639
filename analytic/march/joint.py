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
    whole_passage,
    write_coupled,
    write_still,
)
from analytic.march.known_states import KnownStates, memory_of
from analytic.march.loads import Excitation, excitation_of
from analytic.march.modal_state import LoadedStructure, ModalState, Passage, loaded_structure, modal_state, passage
from analytic.march.oscillator import ABOVE
from analytic.march.room import grown, with_spare
from analytic.march.tables import (
    FlatState,
    IntArray,
    Tables,
    count_in,
    fill,
    flat_state,
    known_switches,
    seen_motion,
    switch_of,
)
from analytic.march.unit_tables import (
    Unscaled,
    connect,
    copied,
    empty_turning,
    owned,
    scale,
    scale_coupled,
    unit_tables,
)
from analytic.modes.beam_functions import ComplexArray
from analytic.modes.static_residual import Residual
from lapjoint.answers.contact_state import ContactState
from lapjoint.orbits.parameters import ExcitationChange, excitation_change
from lapjoint.problem import FloatArray, Problem

_FEW_POSITIONS, _MOST_KEPT = 64, 256
"""Largest number of positions for which shapes are kept, and largest number of kept shapes: 3 MB with 20 modes."""


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
        self.sampled = self.loaded.sampled
        """Number of sampled loads."""
        self.damped = self.loaded.problem.structure.couples or self.loaded.damped
        """Whether damping couples the modes of a state; see `analytic.march.coupled`."""
        self.turning = np.concatenate([[0.0], 1j * self.harmonics.omega, np.full(self.sampled, SAMPLED)])
        """The turning of each load, 1/s, shape ``(1 + H + R,)``; see `analytic.march.coupled.Coupled`."""
        self._coupled: dict[tuple[ContactState, int], Coupled] = {}
        self._memory = memory_of(self.loaded, self.counts)
        self._flat: dict[ContactState, FlatState] = {}
        self._kept_shapes: dict[tuple[Any, ...], FloatArray] = {}
        self._changes: dict[str, ExcitationChange | None] = dict(driven.excitation.changes)
        self.tables: Tables
        self._borrows: bool
        self.known = self._memory.known
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
        seen = self.modal(state).residual_at_stops + seen_motion(self.loaded)
        return np.asarray(seen * self.sizes[:, None])

    def coupled(self, state: ContactState, count: int | None = None) -> Coupled | None:
        """The oscillators of a state whose modes are coupled, of its own or another `count` of modes, for unit loads;
        None of any other state."""
        if not self.damped or not is_coupled(self.loaded.problem, state):
            return None
        count = count or self.count(state)
        found = self._coupled.get((state, count))
        if found is None:
            found = coupled(self.loaded, state, count, self.harmonics.omega, self.side)
            self._coupled[state, count] = found
        return found

    def of_loads(self, parts: FloatArray) -> ComplexArray:
        """What each load does at its real size, ``(1 + H + R, n)``; `parts`, ``(p, 1 + H + R, n)``, has coefficients as
        in `Coupled`."""
        powers = self.sizes * self.turning ** np.arange(parts.shape[0])[:, None]
        return np.asarray((powers[:, :, None] * parts).sum(axis=0))

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
        whole, load = whole_passage(self.loaded, old, self.count(old), new, self.count(new))
        return whole, self.of_loads(load)

    def whole_map(self, old: ContactState, new: ContactState) -> FloatArray:
        """The map of `whole_passage`, ``(2 N, 2 N)``, alone; not to be written to."""
        return whole_passage(self.loaded, old, self.count(old), new, self.count(new))[0]

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

    def lags(self, parts: FloatArray, t: FloatArray, dt: int = 0) -> FloatArray:
        """The dt-th derivative of r at times ``(m,)``, from `lag` or `carried` of `Coupled`: ``(N, m)``."""
        lag = self.of_loads(parts)
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
        old, taken = self._states[slot], known_switches(self.tables)
        new = old.toggled(switch_of(self.tables, stop))
        self.slot(new)
        both = [(old, new)] if self.damped else [(old, new), (new, old)]
        if taken + len(both) > self.tables.carry.shape[0]:
            self._grow(self.tables.modes.size, with_spare(taken))
        for row, states in enumerate(both, start=taken):
            turning = empty_turning(self.tables, 0, 1)
            slots = self._slots[states[0]], self._slots[states[1]]
            connect(self.tables, turning.passed[0], self.loaded, self.counts, stop, slots, states)
            self.tables.carry_residual[row] *= self.sizes[:, None]
            if self.damped:
                scale_coupled(self.tables, 0, row, turning, self.sizes, self.turning)
        self._memory.known = self._memory.known.and_of(*((before, stop, after) for before, after in both))

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
        if self.damped:
            scale_coupled(self.tables, 0, 0, unit.turning, self.sizes, self.turning)
            for slot in range(len(known.states)) if unit.resonant else ():
                self._fill(slot)

    def _grow(self, slots: int, switches: int) -> None:
        self._own()
        self.tables = grown(self.tables, slots, switches)

    def _fill(self, slot: int) -> None:
        """Fill in a state that is met for the first time, or whose modes are kept away from the loads' frequencies."""
        self._own()
        state, size = self._states[slot], max(self.counts)
        it, turning = self.coupled(state), empty_turning(self.tables, 1, 0)
        if it is None:
            fill(self.tables, slot, self.flat(state))
            residual = np.zeros((1, self.tables.constant.shape[1], self.sizes.size))
            unscaled = Unscaled(np.zeros((1, size)), np.zeros((1, size)), residual)
            unscaled.write(0, self.flat(state))
            self._scale(self.tables, slot, unscaled)
        else:
            write_coupled(self.tables, slot, self.loaded.problem, state, it)
            turning.write(0, it)
        if self.damped:
            write_still(self.tables, slot)
            scale_coupled(self.tables, slot, 0, turning, self.sizes, self.turning)

    def _scale(self, unit: Tables, first: int, unscaled: Unscaled) -> None:
        """Scale the slots from the `first` on to the excitation; see `analytic.march.tables.scale`."""
        scale(unit, self.tables, first, unscaled, self.sizes, self.side)
