"""The known states of a joint with the switches between them, for unit loads, and their scaling to an excitation.

`UnitTables` are immutable, and cached: all joints of a loaded structure begin with them.  What a load does in a coupled
state is a polynomial in the turning of the load, see `analytic.march.coupled.Coupled`: `scale_coupled` sums it up.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from analytic.march.coupled import Coupled, coupled_at_rest, is_coupled, whole_passage, write_coupled, write_still
from analytic.march.known_states import KnownStates
from analytic.march.loads import Harmonics
from analytic.march.modal_state import LoadedStructure, passage
from analytic.march.oscillator import ABOVE, away_from_resonance, forced_answer, may_resonate, roots_of
from analytic.march.tables import (
    BoolArray,
    FlatState,
    IntArray,
    Tables,
    count_in,
    empty_tables,
    fill,
    flat_state,
    known_switches,
    switch_of,
    turns,
    unit_of_time,
)
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers.contact_state import ContactState
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray

_UNIT_TABLES = 32  # unit tables kept, a few for each structure as states become known; about 1 MB each with 20 modes


@by_reference
class Unscaled(NamedTuple):
    """Quantities of ``S`` states that `scale` needs beside their tables with unit loads."""

    natural: FloatArray
    """Natural angular frequencies, rad/s, shape ``(S, N)``."""
    damping_rate: FloatArray
    """Damping rates zeta omega, 1/s, shape ``(S, N)``."""
    residual: FloatArray
    """Residual shapes at the stops' positions, constant one first, m for each unit of load, ``(S, U, 1 + H + R)``."""

    def write(self, row: int, flat: FlatState) -> None:
        """Write a state that is not coupled to a row."""
        n = flat.omega.size
        self.natural[row, :n], self.damping_rate[row, :n] = flat.omega, flat.damping_rate
        self.residual[row, : flat.residual.shape[0]] = flat.residual


class Turning(NamedTuple):
    """What unit loads do in ``S`` coupled states and at ``K`` switches, by powers of the turning of each load.

    The columns of a state that is not coupled are 0; see `analytic.march.coupled.Coupled`.
    """

    stiffness: FloatArray
    """Squared frequencies of the oscillators, 1/s2, shape ``(S, M)``."""
    damping: FloatArray
    """Twice their damping rates, 1/s, shape ``(S, M)``."""
    push: FloatArray
    """`Coupled.push`, shape ``(S, 3, 1 + H + R, M)``."""
    beside: FloatArray
    """`Coupled.beside`, shape ``(S, 2, U, 1 + H + R)``."""
    passed: FloatArray
    """The part of (q, v) after each switch that the loads bring, shape ``(K, 2, 1 + H + R, 2, M)``."""

    def write(self, row: int, it: Coupled) -> None:
        """Write a coupled state to a row."""
        n = it.roots.shape[0]
        self.stiffness[row, :n], self.damping[row, :n], self.push[row, :, :, :n] = it.stiffness, it.damping, it.push
        self.beside[row] = it.beside


def empty_turning(tables: Tables, states: int, switches: int) -> Turning:
    """Room for some states and switches of a joint with these tables."""
    U, loads, M = tables.constant.shape[1], tables.force.shape[1], tables.push.shape[2]
    return Turning(
        np.zeros((states, M)),
        np.zeros((states, M)),
        np.zeros((states, 3, loads, M)),
        np.zeros((states, 2, U, loads)),
        np.zeros((switches, 2, loads, 2, M)),
    )


class UnitTables(NamedTuple):
    """Known states of a loaded structure with unit loads: ``S`` slots, at most ``N`` modes each."""

    tables: Tables
    unscaled: Unscaled
    """What `scale` needs beside `tables`.  As with `borrowed`, the arrays are writable, for compiled functions, and
    nobody writes to them."""
    turning: Turning
    """What `scale_coupled` needs beside `tables`, as `unscaled`."""
    resonant: bool
    """Whether a mode may have to be moved, see `analytic.march.oscillator.away_from_resonance`."""
    borrowed: Tables
    """The same arrays as `tables`, for compiled functions, which take writable arrays only.  Nobody writes to them."""


@cached(_UNIT_TABLES)
def unit_tables(loaded: LoadedStructure, counts: tuple[int, int], known: KnownStates) -> UnitTables:
    """The known states, in sorted order, with the known switches between them, for unit loads; not to be written to."""
    problem, size, S = loaded.problem, max(counts), len(known.states)
    harmonics = Harmonics.of_unit_frequency(len(loaded.positions))
    tables = empty_tables(problem, harmonics, size, S, len(known.switches))
    U, loads = tables.constant.shape[1], tables.force.shape[1]
    borrowed = Tables._make(part.view() if isinstance(part, np.ndarray) else part for part in tables)
    unscaled = Unscaled(np.zeros((S, size)), np.zeros((S, size)), np.zeros((S, U, loads)))
    turning, resonant = empty_turning(tables, S, len(known.switches)), False
    for slot, state in enumerate(known.states):
        count = count_in(state, counts)
        if is_coupled(problem, state):
            it = coupled_at_rest(loaded, state, count)
            write_coupled(tables, slot, problem, state, it)
            turning.write(slot, it)
            resonant |= it.resonant
        else:
            flat = flat_state(loaded, state, count)
            fill(tables, slot, flat)
            unscaled.write(slot, flat)
        if tables.owner is not None:
            write_still(tables, slot)
    for i, (state, row) in enumerate(known.switches):
        other = state.toggled(switch_of(tables, row))
        slots = known.slots[state], known.slots[other]
        connect(tables, turning.passed[i], loaded, counts, row, slots, (state, other))
    for array in tables:
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
    resonant |= may_resonate(unscaled.natural, unscaled.damping_rate)
    return UnitTables(tables, unscaled, turning, resonant, borrowed)


def connect(
    tables: Tables,
    passed: FloatArray,
    loaded: LoadedStructure,
    counts: tuple[int, int],
    row: int,
    slots: tuple[int, int],
    states: tuple[ContactState, ContactState],
) -> None:
    """Write the switch of a row of the tables from one state to another, for unit loads.

    `tables` have room for it, and both states, the old one first, in `slots`.  `passed` takes the switch's row of
    `Turning.passed`, if states may be coupled.
    """
    (old, new), at = states, known_switches(tables)
    n_old, n_new = count_in(old, counts), count_in(new, counts)
    if tables.owner is None:
        unit = passage(loaded, old, n_old, new, n_new)
        tables.carry[at, :n_new, :n_old] = unit.S
        tables.carry_residual[at, :, :n_new] = unit.residual
    else:
        whole, load = whole_passage(loaded, old, n_old, new, n_new)
        tables.whole[at, :, :n_new, :, :n_old] = whole.reshape(2, n_new, 2, n_old)
        passed[..., :n_new] = load.reshape(2, -1, 2, n_new)
    tables.next_slot[slots[0], row], tables.passage[slots[0], row] = slots[1], at


def scale(unit: Tables, tables: Tables, first: int, unscaled: Unscaled, sizes: FloatArray, side: float = ABOVE) -> None:
    """Scale slots from the `first` on to an excitation, and write the answer to its harmonics.

    `unit` has the states, for unit loads, in the same slots, and may be `tables`; `tables`, with the frequencies and
    phases of the harmonics, are changed.  `sizes`, ``(1 + H + R,)``, are as in `analytic.march.loads.Excitation`, and
    `side` as in `analytic.march.oscillator.away_from_resonance`.
    """
    omega = unscaled.natural.copy()
    answers = tables.omega, tables.weight, tables.harmonic, tables.forced
    if _scale(unit.force, tables.force, *answers, first, unscaled.damping_rate, unscaled.residual, omega, sizes, side):
        for row, i in np.argwhere(omega != unscaled.natural):
            _move(tables, first + int(row), int(i), omega[row, i : i + 1], unscaled.damping_rate[row, i : i + 1])


@njit_called()
def _scale(
    unit_force: FloatArray,
    force: FloatArray,
    frequency: FloatArray,
    weight: FloatArray,
    harmonic: ComplexArray,
    forced: ComplexArray,
    first: int,
    damping_rate: FloatArray,
    residual: FloatArray,
    omega: FloatArray,
    sizes: FloatArray,
    side: float,
) -> bool:
    """`scale`, but for the free motion of moved modes, whose frequencies `omega` takes; whether there are any.

    Sums are formed mode by mode, so that a state has the same bits in any slot.  To hand over these few arrays takes a
    fifth of the time that all tables would.
    """
    moved = False
    for row in range(omega.shape[0]):
        slot = first + row
        for i in range(omega.shape[1]):
            away = away_from_resonance(omega[row, i], damping_rate[row, i], frequency, side)
            moved |= away != omega[row, i]
            omega[row, i] = away
        for load in range(sizes.size):
            for i in range(omega.shape[1]):
                force[slot, load, i] = unit_force[slot, load, i] * sizes[load]
        for h in range(frequency.size):
            for u in range(forced.shape[1]):
                forced[slot, u, h] = residual[row, u, 1 + h] * sizes[1 + h]
            for i in range(omega.shape[1]):
                answer = forced_answer(force[slot, 1 + h, i], omega[row, i], damping_rate[row, i], frequency[h])
                harmonic[slot, h, i] = answer
                for u in range(forced.shape[1]):
                    forced[slot, u, h] += weight[slot, u, i] * answer
    return moved


def _move(tables: Tables, slot: int, i: int, omega: FloatArray, damping_rate: FloatArray) -> None:
    """Give an undamped mode the frequency that `away_from_resonance` has found, `omega`, rad/s, shape ``(1,)``."""
    root = roots_of(omega, damping_rate)[0, 0]
    tables.root[slot, i], tables.inverse[slot, i], tables.cube[slot, i] = root, 1 / root, abs(root) ** 3
    tables.turn[slot, :, i] = np.exp(tables.step * root)
    tables.static[slot, i, 0] = tables.force[slot, 0, i] / omega[0] ** 2


def scale_coupled(
    tables: Tables, first: int, row: int, turning: Turning, sizes: FloatArray, turns_at: ComplexArray
) -> None:
    """Scale coupled states and switches to an excitation, and write the answer to its harmonics.

    The states are in the slots from the `first` on, and the switches in rows from `row` on; `scale` has scaled the
    states that are not coupled.  `sizes` are as in `scale`, and `turns_at`, ``(1 + H + R,)``, is `Joint.turning`.
    """
    parts = tables.modes, tables.coupled, tables.force, tables.gradient, tables.push, tables.harmonic, tables.forced
    _scale_coupled(*parts, tables.whole_load, first, row, *turning, sizes, turns_at)


@njit_called()
def _scale_coupled(
    modes: IntArray,
    coupled: BoolArray,
    force: FloatArray,
    gradient: FloatArray,
    push: ComplexArray,
    harmonic: ComplexArray,
    forced: ComplexArray,
    whole_load: ComplexArray,
    first: int,
    row: int,
    stiffness: FloatArray,
    damping: FloatArray,
    unit_push: FloatArray,
    beside: FloatArray,
    passed: FloatArray,
    sizes: FloatArray,
    turning: ComplexArray,
) -> None:
    """`scale_coupled`; sums are formed mode by mode, so that a state has the same bits in any slot."""
    for k in range(passed.shape[0]):
        for load in range(sizes.size):
            for a in range(2):
                for i in range(passed.shape[4]):
                    x = passed[k, 0, load, a, i] + turning[load] * passed[k, 1, load, a, i]
                    whole_load[row + k, load, a, i] = x * sizes[load]
    for state in range(stiffness.shape[0]):
        slot = first + state
        for load in range(sizes.size):
            s = turning[load]
            for i in range(modes[slot]):
                if not coupled[slot]:
                    push[slot, load, i] = force[slot, load, i]
                    continue
                x = unit_push[state, 0, load, i] + s * (unit_push[state, 1, load, i] + s * unit_push[state, 2, load, i])
                push[slot, load, i] = x * sizes[load]
        for h in range(harmonic.shape[1] if coupled[slot] else 0):
            s = turning[1 + h]
            for u in range(forced.shape[1]):
                forced[slot, u, h] = (beside[state, 0, u, 1 + h] + s * beside[state, 1, u, 1 + h]) * sizes[1 + h]
            for i in range(modes[slot]):
                answer = push[slot, 1 + h, i] / (stiffness[state, i] + s * (damping[state, i] + s))
                harmonic[slot, h, i] = answer
                for u in range(forced.shape[1]):
                    forced[slot, u, h] += (gradient[slot, u, 0, i] + s * gradient[slot, u, 1, i]) * answer


def owned(tables: Tables) -> Tables:
    """A copy of tables, of which no array is borrowed."""
    return Tables._make(part.copy() if isinstance(part, np.ndarray) else part for part in tables)


def copied(unit: UnitTables, harmonics: Harmonics, sizes: FloatArray) -> Tables:
    """The known states with a joint's harmonics, and the known switches under its loads, but for what is scaled.

    `sizes`, ``(1 + H + R,)``, are as in `scale`.  The arrays that `scale` and `scale_coupled` write to are the joint's
    own, with anything in them; the others are borrowed, and `owned` makes them the joint's own before they are written
    to.
    """
    borrowed, H = unit.borrowed, harmonics.omega.size
    (S, _, N), U = borrowed.harmonic.shape, borrowed.forced.shape[1]
    own = borrowed._replace(
        omega=harmonics.omega,
        phase=harmonics.phase,
        harmonic_turn=turns(borrowed.step, harmonics.omega),
        unit=unit_of_time(borrowed.step, harmonics),
        harmonic=np.empty((S, H, N), dtype=complex),
        forced=np.empty((S, U, H), dtype=complex),
        force=np.empty(borrowed.force.shape),
        constant=borrowed.constant.copy(),
        push=np.zeros(borrowed.push.shape, dtype=complex),
        carry_residual=borrowed.carry_residual * sizes[:, None],
        whole_load=np.zeros(borrowed.whole_load.shape, dtype=complex),
    )
    return owned(own) if unit.resonant else own
