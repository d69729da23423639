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

from analytic.march.loads import MOVED_STOPS, Harmonics
from analytic.march.modal_state import LoadedStructure, modal_state
from analytic.march.oscillator import (
    SPLIT,
    kinds_of,
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
    cube: FloatArray
    """|lambda|^3, 1/s^3, shape ``(T,)``."""
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
    cube: FloatArray
    """|lambda|^3, 1/s^3, shape ``(S, T)``."""
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
    coupled: BoolArray
    """Whether damping couples the modes of each state, shape ``(S,)``; see `analytic.march.coupled`."""
    twist: FloatArray
    """Imaginary parts of the weights of terms in coupled states, of which `weight` has the real parts, kg^-1/2, shape
    ``(S, U, T)``; ``(S, 0, 0)`` if no state may be coupled."""
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
        cube=np.abs(root) ** 3,
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


def moves_stops(loaded: LoadedStructure) -> BoolArray:
    """Whether each load moves the stops that are fixed in space, shape ``(1 + H + R,)``."""
    return np.array([False, *(shape == MOVED_STOPS for shape in loaded.positions)])


def seen_motion(loaded: LoadedStructure) -> FloatArray:
    """The motion of the base that each stop's gap sees, m for each unit of load, shape ``(1 + H + R, P)``."""
    return np.outer(moves_stops(loaded), [stop.base_share for stop in loaded.problem.structure.stops])


def known_switches(tables: Tables) -> int:
    """Number of switches that the tables know, each direction counted: the number of used rows of `Tables.carry`."""
    return int(np.count_nonzero(tables.passage >= 0))


def switch_of(tables: Tables, row: int) -> int:
    """The index of `ContactState.toggled` of a switch of a row of the tables."""
    owner = -1 if tables.owner is None else int(tables.owner[row])
    return row if owner < 0 else ~owner


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
        cube=np.zeros((S, T)),
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
        coupled=np.zeros(S, dtype=np.bool_),
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
    tables.inverse[slot, :terms], tables.cube[slot, :terms] = flat.inverse, flat.cube
    tables.turn[slot, :, :terms] = flat.turn
    tables.static[slot, :n] = flat.static
    tables.force[slot, :, :n] = flat.force
    places, stops = flat.weight.shape[0], flat.closed.size
    tables.weight[slot, :places, :terms] = flat.weight
    tables.constant[slot, :places] = flat.residual[:, 0]
    tables.closed[slot, :stops] = flat.closed
    tables.asleep[slot, stops:] = True
    if tables.owner is not None:
        tables.gradient[slot, :places, 0, :n] = flat.weight[:, :n]
