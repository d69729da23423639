"""Contact states as flat arrays, in the form that the compiled march takes.

Each state that a joint knows has a slot.  Its motion is a sum of terms p_t(s) = c_t exp(lambda_t s): one for each
mode, and a second for each mode that is damped above critical; the harmonic loads turn besides.

A `FlatState` is one state with unit loads, and `UnitTables` are several states with the switches between them: both are
immutable, and cached.  `Tables` are the states of one joint, scaled to its excitation: they belong to that joint alone,
which may fill more slots.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
import numpy.typing as npt

from analytic.march.known_states import KnownStates
from analytic.march.loads import MOVED_STOPS, Harmonics
from analytic.march.modal_state import LoadedStructure, modal_state, passage
from analytic.march.oscillator import (
    ABOVE,
    SPLIT,
    away_from_resonance,
    forced_answer,
    kinds_of,
    may_resonate,
    roots_of,
    static_answer,
)
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.compiled.arrays import complex_zeros
from lapjoint.compiled.by_reference import by_reference
from lapjoint.compiled.compiling import njit_called
from lapjoint.machine.result_cache import cached
from lapjoint.problem import FloatArray, Problem

IntArray = npt.NDArray[np.int64]
BoolArray = npt.NDArray[np.bool_]

OCTAVES, PARTS = 16, 4
"""Octaves of tabulated steps, and steps in each octave.  The longest steps are 1, 5/4, 6/4 and 7/4 times sqrt(m / EI)
L^2, about half a period of a cantilever's first mode; each further octave halves the steps, down to 3e-5 of the first
step."""
_FRACTIONS = (0.5 ** np.arange(OCTAVES)[:, None] * (1 + np.arange(PARTS) / PARTS)).ravel()
_UNIT_TABLES = 32  # unit tables kept, a few for each structure as states become known; about 1 MB each with 20 modes
_FLAT_STATES = 256  # flat states kept, as in `analytic.march.modal_state`; about 60 kB each with 20 modes


class FlatState(NamedTuple):
    """One state with unit loads: ``N`` modes, ``T`` terms, ``P`` stops at ``U`` positions, ``H`` harmonics."""

    omega: FloatArray
    """Natural angular frequencies, rad/s, shape ``(N,)``."""
    damping_rate: FloatArray
    """Damping rates zeta omega, 1/s, shape ``(N,)``."""
    kind: IntArray
    """How each mode moves freely, shape ``(N,)``."""
    mode_of: IntArray
    """The mode of each term, shape ``(T,)``."""
    root: ComplexArray
    """lambda of each term, 1/s, shape ``(T,)``."""
    inverse: ComplexArray
    """1 / lambda, s, or 0 where lambda is 0, shape ``(T,)``."""
    fastest: float
    """Largest modulus of the lambdas, 1/s."""
    turn: ComplexArray
    """exp(lambda tau) of the tabulated steps, shape ``(J, T)``."""
    static: FloatArray
    """Coefficients of 1, s, s^2 of the answer to the constant loads, kg^1/2 m divided by powers of s, shape ``(N,
    3)``."""
    force: FloatArray
    """Modal forces, the constant one first, kg^-1/2 N for each unit of load, shape ``(1 + H, N)``."""
    weight: FloatArray
    """The mode of each term at the positions of the stops, kg^-1/2, shape ``(U, T)``."""
    residual: FloatArray
    """Residual shapes at the positions of the stops, with the motion of the base where stops are fixed in space, the
    constant one first, m for each unit of load, ``(U, 1 + H)``."""
    closed: BoolArray
    """Whether each stop is closed, shape ``(P,)``."""


@by_reference
class Tables(NamedTuple):
    """``S`` slots, at most ``N`` modes and ``T = 2 N`` terms, ``P`` stops at ``U`` positions, ``H`` harmonics.

    A matrix S_ij is kept only for the switches that are known: of the ``S P`` that could be, motions make few.

    There are ``R`` sampled loads, linear between knots; see `analytic.march.ramps`.
    """

    modes: IntArray
    """Number of modes, shape ``(S,)``; 0 in a slot that has no state yet."""
    terms: IntArray
    """Number of terms, shape ``(S,)``."""
    kind: IntArray
    """How each mode moves freely, shape ``(S, N)``; see `analytic.march.oscillator`."""
    mode_of: IntArray
    """The mode of each term; the first terms are the modes in order, shape ``(S, T)``."""
    root: ComplexArray
    """lambda of each term, 1/s, shape ``(S, T)``."""
    inverse: ComplexArray
    """1 / lambda, s, or 0 where lambda is 0, shape ``(S, T)``."""
    fastest: FloatArray
    """Largest modulus of the lambdas, 1/s, shape ``(S,)``."""
    turn: ComplexArray
    """exp(lambda tau) of the tabulated steps, shape ``(S, J, T)``."""
    static: FloatArray
    """Coefficients of 1, s, s^2 of the answer to the constant loads, kg^1/2 m divided by powers of s, shape ``(S, N,
    3)``."""
    harmonic: ComplexArray
    """Complex amplitudes of the answer to the harmonics, kg^1/2 m, shape ``(S, H, N)``."""
    force: FloatArray
    """Constant modal force first, then the amplitudes of the harmonics, kg^1/2 m/s^2, then those of the sampled loads,
    kg^-1/2 N for each unit of load, shape ``(S, 1 + H + R, N)``."""
    weight: FloatArray
    """The mode of each term at the positions of the stops, kg^-1/2, shape ``(S, U, T)``."""
    forced: ComplexArray
    """Complex amplitude of the forced motion at the positions of the stops, m, residual included, shape ``(S, U,
    H)``."""
    constant: FloatArray
    """Part of z at the positions of the stops that moves with no mode, m, shape ``(S, U)``: the residual's constant
    part, or the frozen shape of the published scheme."""
    closed: BoolArray
    """Whether each stop is closed, shape ``(S, P)``."""
    asleep: BoolArray
    """Whether each stop may not switch in this state, shape ``(S, P)``; see `analytic.march.coupled`."""
    idle: BoolArray
    """Whether no row at a position may switch in this state, shape ``(S, U)``."""
    own: IntArray
    """Number of terms without second copies, 0 in states without copies, shape ``(S,)``; see
    `analytic.march.coupled`."""
    twist: FloatArray
    """Weights of the second copies of the terms, kg^-1/2, shape ``(S, U, T)``; ``(S, 0, 0)`` if no
    state may be coupled."""
    gradient: FloatArray
    """Displacement at the positions of the stops for units of q and of v, kg^-1/2 and kg^-1/2 s, shape ``(S, U, 2,
    N)``; ``(S, 0, 2, 0)`` if no state may be coupled."""
    still: FloatArray
    """Coefficients of 1, s, s^2 of z at the positions of the stops under the constant loads alone, m divided by powers
    of s, shape ``(S, U, 3)``; ``(S, 0, 3)`` if no state may be coupled."""
    push: ComplexArray
    """`force` of states that may be coupled, kg^1/2 m/s^2, ``(S, 1 + H, N)``; ``(S, 0, 0)`` if none may be."""
    next_slot: IntArray
    """Slot after a stop has switched, or -1 where that switch is not known yet, shape ``(S, P)``."""
    passage: IntArray
    """Row of each switch in `carry` and `carry_residual`, or -1 where the switch is not known, shape ``(S, P)``."""
    carry: FloatArray
    """S_ij of (36), (41) for each known switch, without unit, shape ``(K, N, N)``; unused rows come last."""
    carry_residual: FloatArray
    """S0 and Sh of the known switches, kg^1/2 m, and those of sampled loads for each unit of load, shape ``(K, 1 + H +
    R, N)``."""
    whole: FloatArray
    """(q, v) after each known switch for units of (q, v) before, shape ``(K, 2, N, 2, N)``, which stands in for `carry`
    where states may be coupled; ``(K, 2, 0, 2, 0)`` if no state may be coupled."""
    whole_load: ComplexArray
    """The part of (q, v) after each known switch that the loads bring, kg^1/2 m and kg^1/2 m/s, shape ``(K, 1 + H, 2,
    N)``, or ``(K, 1 + H, 2, 0)``."""
    omega: FloatArray
    """Angular frequencies of the harmonics, rad/s, shape ``(H,)``."""
    phase: FloatArray
    """Phases of the harmonics, rad, shape ``(H,)``."""
    harmonic_turn: ComplexArray
    """exp(i Omega tau) of the tabulated steps, shape ``(J, H)``."""
    position: IntArray
    """Index of the position of each stop, shape ``(P,)``."""
    sign: FloatArray
    """+1 for a top stop, -1 for a bottom stop, shape ``(P,)``."""
    gap: FloatArray
    """Gap of each stop, m, shape ``(P,)``."""
    owner: IntArray | None
    """The stop to which the row of each stop belongs as the row of its force, or -1, shape ``(P,)``; None if no state
    may be coupled, and then compiled functions leave out all that coupled states need; see `analytic.march.coupled`."""
    step: FloatArray
    """The tabulated steps, s, shape ``(J,)``; see `OCTAVES`."""
    unit: float
    """The unit of time, s; see `unit_of_time`."""


PER_SLOT = Tables._fields[: Tables._fields.index("carry")]
PER_SWITCH = "carry", "carry_residual", "whole", "whole_load"
UNKNOWN = "next_slot", "passage"  # fields that hold -1 where a switch is not known


def tabulated_steps(problem: Problem) -> FloatArray:
    """The tabulated steps, s, shape ``(J,)``; see `OCTAVES`."""
    beam = problem.line
    return np.asarray(math.sqrt(beam.m / beam.EI) * beam.length**2 * _FRACTIONS)


def unit_of_time(step: FloatArray, harmonics: Harmonics) -> float:
    """The time by which short times are measured, s: sqrt(m / EI) L^2, or 1 / Omega of the fastest load if less.

    `step`, s, ``(J,)``, are the tabulated steps.
    """
    return float(1 / max([1 / step[0], *harmonics.omega]))


@njit_called()
def turns(step: FloatArray, omega: FloatArray) -> ComplexArray:
    """exp(i Omega tau) for the tabulated steps `step`, s, ``(J,)``, and harmonics `omega`, rad/s, ``(H,)``; shape ``(J,
    H)``."""
    turned = complex_zeros((step.size, omega.size))
    for j in range(step.size):
        for h in range(omega.size):
            angle = step[j] * omega[h]
            turned[j, h] = complex(math.cos(angle), math.sin(angle))
    return turned


@cached(_FLAT_STATES)
def flat_state(loaded: LoadedStructure, state: ContactState, count: int) -> FlatState:
    """The flat view of a contact state with `count` modes, for unit loads; not to be written to."""
    problem, modal = loaded.problem, modal_state(loaded, state, count)
    omega, damping_rate = modal.modes.omega, modal.damping_rate
    roots = roots_of(omega, damping_rate)
    kind = kinds_of(roots)
    split = np.flatnonzero(kind == SPLIT)
    mode_of = np.concatenate([np.arange(count), split])
    root = np.concatenate([roots[:, 0], roots[split, 1]])
    first = np.unique(stop_positions(problem), return_index=True)[1]
    return FlatState(
        omega=omega,
        damping_rate=damping_rate,
        kind=kind,
        mode_of=mode_of,
        root=root,
        inverse=np.divide(1.0, root, out=np.zeros(root.size, dtype=complex), where=root != 0),
        fastest=float(np.abs(root).max(initial=0.0)),
        turn=np.exp(np.outer(tabulated_steps(problem), root)),
        static=static_answer(modal.force[0], omega, damping_rate),
        force=modal.force,
        weight=np.ascontiguousarray(modal.at_stops[first][:, mode_of]),
        residual=np.ascontiguousarray((modal.residual_at_stops + seen_motion(loaded)).T[first]),
        closed=np.array([k in state for k in range(len(problem.structure.stops))], dtype=np.bool_),
    )


def stop_positions(problem: Problem) -> IntArray:
    """Index of the position of each stop among all positions of stops, from the root to the tip, shape ``(P,)``.

    Stops fixed in space have positions of their own, because their gaps see the motion of the base, too.
    """
    places = sorted({stop.place for stop in problem.structure.stops})
    return np.array([places.index(stop.place) for stop in problem.structure.stops], dtype=np.int64)


def seen_motion(loaded: LoadedStructure) -> FloatArray:
    """The motion of the base that each stop's gap sees, m for each unit of load, shape ``(1 + H + R, P)``."""
    moved = np.array([False, *(shape == MOVED_STOPS for shape in loaded.positions)])
    return np.outer(moved, [stop.base_share for stop in loaded.problem.structure.stops])


@by_reference
class Unscaled(NamedTuple):
    """Quantities of ``S`` states that `scale` needs beside their tables with unit loads."""

    natural: FloatArray
    """Natural angular frequencies, rad/s, shape ``(S, N)``."""
    damping_rate: FloatArray
    """Damping rates zeta omega, 1/s, shape ``(S, N)``."""
    residual: FloatArray
    """Residual shapes at the stops' positions, constant one first, m for each unit of load, ``(S, U, 1 + H + R)``."""


class UnitTables(NamedTuple):
    """Known states of a loaded structure with unit loads: ``S`` slots, at most ``N`` modes each."""

    tables: Tables
    unscaled: Unscaled
    """What `scale` needs beside `tables`.  As with `borrowed`, the arrays are writable, for compiled functions, and
    nobody writes to them."""
    resonant: bool
    """Whether `scale` may move a mode."""
    borrowed: Tables
    """The same arrays as `tables`, for compiled functions, which take writable arrays only.  Nobody writes to them."""


@cached(_UNIT_TABLES)
def unit_tables(loaded: LoadedStructure, counts: tuple[int, int], known: KnownStates) -> UnitTables:
    """The known states, in sorted order, with the known switches between them, for unit loads; not to be written to."""
    problem, size, S = loaded.problem, max(counts), len(known.states)
    harmonics = Harmonics.of_unit_frequency(len(loaded.positions))
    tables = empty_tables(problem, harmonics, size, S, 2 * len(known.switches))
    U, loads = tables.constant.shape[1], tables.force.shape[1]
    borrowed = Tables._make(part.view() if isinstance(part, np.ndarray) else part for part in tables)
    unscaled = Unscaled(np.zeros((S, size)), np.zeros((S, size)), np.zeros((S, U, loads)))
    for slot, state in enumerate(known.states):
        flat = flat_state(loaded, state, count_in(state, counts))
        fill(tables, slot, flat)
        n = flat.kind.size
        unscaled.natural[slot, :n], unscaled.damping_rate[slot, :n] = flat.omega, flat.damping_rate
        unscaled.residual[slot] = flat.residual
    for state, stop in known.switches:
        other = state.toggled(stop)
        connect(tables, loaded, counts, stop, (known.slots[state], state), (known.slots[other], other))
    for array in tables:
        if isinstance(array, np.ndarray):
            array.flags.writeable = False
    return UnitTables(tables, unscaled, may_resonate(unscaled.natural, unscaled.damping_rate), borrowed)


def connect(
    tables: Tables,
    loaded: LoadedStructure,
    counts: tuple[int, int],
    stop: int,
    old: tuple[int, ContactState],
    new: tuple[int, ContactState],
) -> None:
    """Write the switch of a stop between two states, and the way back, for unit loads.

    `tables` have both states, and room for two switches.  `old` and `new` are slot and state, before and after the
    switch.
    """
    for (slot, state), (target, other) in ((old, new), (new, old)):
        unit = passage(loaded, state, count_in(state, counts), other, count_in(other, counts))
        n_new, n_old = unit.S.shape
        row = known_switches(tables)
        tables.carry[row, :n_new, :n_old] = unit.S
        tables.carry_residual[row, :, :n_new] = unit.residual
        tables.next_slot[slot, stop], tables.passage[slot, stop] = target, row


def known_switches(tables: Tables) -> int:
    """Number of switches that the tables know, each direction counted: the number of used rows of `Tables.carry`."""
    return int(np.count_nonzero(tables.passage >= 0))


def count_in(state: ContactState, counts: tuple[int, int]) -> int:
    """Number of modes in a state, of `counts` in the free state and in every other."""
    return counts[0] if state == FREE else counts[1]


def empty_tables(problem: Problem, harmonics: Harmonics, size: int, slots: int, switches: int) -> Tables:
    """Tables without a state, with `slots` empty slots and room for `switches` switches.

    `size` is the largest number of modes in a state.
    """
    steps, position = tabulated_steps(problem), stop_positions(problem)
    damped = [k for k, stop in enumerate(problem.structure.stops) if stop.damping > 0]
    may_couple = bool(damped) or problem.structure.couples
    rows = [*problem.structure.stops, *(problem.structure.stops[k] for k in damped)]
    places = int(position.max(initial=-1)) + 1
    position = np.concatenate([position, places + np.arange(len(damped))])
    P, U, H = position.size, int(position.max(initial=-1)) + 1, harmonics.omega.size
    S, N, T = slots, size, 2 * size
    (V, M), own = (U, N) if may_couple else (0, 0), len(problem.structure.stops)
    return Tables(
        modes=np.zeros(S, dtype=np.int64),
        terms=np.zeros(S, dtype=np.int64),
        kind=np.zeros((S, N), dtype=np.int64),
        mode_of=np.zeros((S, T), dtype=np.int64),
        root=np.zeros((S, T), dtype=complex),
        inverse=np.zeros((S, T), dtype=complex),
        fastest=np.zeros(S),
        turn=np.zeros((S, steps.size, T), dtype=complex),
        static=np.zeros((S, N, 3)),
        harmonic=np.zeros((S, H, N), dtype=complex),
        force=np.zeros((S, 1 + H, N)),
        weight=np.zeros((S, U, T)),
        forced=np.zeros((S, U, H), dtype=complex),
        constant=np.zeros((S, U)),
        closed=np.zeros((S, P), dtype=np.bool_),
        asleep=np.zeros((S, P), dtype=np.bool_),
        idle=np.zeros((S, U), dtype=np.bool_),
        own=np.zeros(S, dtype=np.int64),
        twist=np.zeros((S, V, 2 * M)),
        gradient=np.zeros((S, V, 2, M)),
        still=np.zeros((S, V, 3)),
        push=np.zeros((S, 1 + H if may_couple else 0, M), dtype=complex),
        next_slot=np.full((S, P), -1, dtype=np.int64),
        passage=np.full((S, P), -1, dtype=np.int64),
        carry=np.zeros((switches, N, N)),
        carry_residual=np.zeros((switches, 1 + H, N)),
        whole=np.zeros((switches, 2, M, 2, M)),
        whole_load=np.zeros((switches, 1 + H, 2, M), dtype=complex),
        omega=harmonics.omega,
        phase=harmonics.phase,
        harmonic_turn=turns(steps, harmonics.omega),
        position=position,
        sign=np.array([stop.sign for stop in rows], dtype=float),
        gap=np.array([stop.gap for stop in rows], dtype=float),
        owner=np.array([-1] * own + damped, dtype=np.int64) if may_couple else None,
        step=steps,
        unit=unit_of_time(steps, harmonics),
    )


def fill(tables: Tables, slot: int, flat: FlatState) -> None:
    """Write a state with unit loads into its empty slot, but for the answer to the harmonics."""
    n, terms = flat.kind.size, flat.root.size
    tables.modes[slot], tables.terms[slot], tables.fastest[slot] = n, terms, flat.fastest
    tables.kind[slot, :n] = flat.kind
    tables.mode_of[slot, :terms] = flat.mode_of
    tables.root[slot, :terms] = flat.root
    tables.inverse[slot, :terms] = flat.inverse
    tables.turn[slot, :, :terms] = flat.turn
    tables.static[slot, :n] = flat.static
    tables.force[slot, :, :n] = flat.force
    places, stops = flat.weight.shape[0], flat.closed.size
    tables.weight[slot, :places, :terms] = flat.weight
    tables.constant[slot, :places] = flat.residual[:, 0]
    tables.closed[slot, :stops] = flat.closed
    tables.asleep[slot, stops:], tables.idle[slot, places:] = True, True
    if tables.owner is not None:
        tables.gradient[slot, :places, 0, :n] = flat.weight[:, :n]


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
    tables.root[slot, i], tables.inverse[slot, i] = root, 1 / root
    tables.turn[slot, :, i] = np.exp(tables.step * root)
    tables.static[slot, i, 0] = tables.force[slot, 0, i] / omega[0] ** 2


def owned(tables: Tables) -> Tables:
    """A copy of tables, of which no array is borrowed."""
    return Tables._make(part.copy() if isinstance(part, np.ndarray) else part for part in tables)


def copied(unit: UnitTables, harmonics: Harmonics, sizes: FloatArray) -> Tables:
    """The known states with a joint's harmonics, and the known switches under its loads, but for what `scale` writes.

    `sizes`, ``(1 + H + R,)``, are as in `scale`.  The arrays that `scale` writes to are the joint's own, with anything
    in them; the others are borrowed, and `owned` makes them the joint's own before they are written to.
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
        carry_residual=borrowed.carry_residual * sizes[:, None],
    )
    return owned(own) if unit.resonant else own
