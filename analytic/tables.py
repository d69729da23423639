"""The contact states of a joint as flat arrays, in the form that the compiled march takes.

Each state has a slot.  Its motion is a sum of terms p_t(s) = c_t exp(lambda_t s): one for each mode, and a second for
each mode that is damped above critical; the harmonic loads turn besides.  Slots are filled when a motion first
reaches their state: of the many sets of stops that could be closed, a motion meets few.  They are filled for loads
of unit size, kept for all problems of a family, and scaled to the excitation of each.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any, NamedTuple

import numpy as np

from analytic.state import (
    SPLIT,
    Family,
    UnitState,
    away_from_resonance,
    forced_answer,
    harmonics_of,
    kinds_of,
    load_sizes,
    roots_of,
    static_answer,
)
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.problem import FloatArray, Problem

HALVINGS = 40  # of the longest tabulated step
_SPARE = 4  # slots made at a time


class Tables(NamedTuple):
    """``S`` slots, at most ``N`` modes and ``T`` terms each, ``P`` stops at ``U`` positions, ``H`` harmonics."""

    modes: Any
    """Number of modes, shape ``(S,)``."""
    terms: Any
    """Number of terms, shape ``(S,)``."""
    kind: Any
    """How each mode moves freely, shape ``(S, N)``."""
    mode_of: Any
    """The mode of each term; the first terms are the modes in order, shape ``(S, T)``."""
    root: Any
    """lambda of each term, complex, shape ``(S, T)``."""
    inverse: Any
    """1 / lambda, or 0 where lambda is 0, shape ``(S, T)``."""
    fastest: Any
    """Largest modulus of the lambdas, shape ``(S,)``."""
    turn: Any
    """exp(lambda tau) for tau = longest / 2^j, shape ``(S, HALVINGS, T)``."""
    static: Any
    """Coefficients of 1, t, t^2 of the answer to the constant loads, shape ``(S, N, 3)``."""
    harmonic: Any
    """Complex amplitudes of the answer to the harmonics, shape ``(S, H, N)``."""
    force: Any
    """Constant modal force first, then the amplitudes of the harmonics, shape ``(S, 1 + H, N)``."""
    weight: Any
    """The mode of each term at the positions of the stops, shape ``(S, U, T)``."""
    forced: Any
    """Complex amplitude of the forced motion there, residual included, shape ``(S, U, H)``."""
    constant: Any
    """Constant part of the residual there, shape ``(S, U)``."""
    closed: Any
    """Whether each stop is closed, shape ``(S, P)``."""
    next_slot: Any
    """Slot after a stop has switched, or -1 where that state has none yet, shape ``(S, P)``."""
    carry: Any
    """S_ij of (36), (41) for that switch, shape ``(S, P, N, N)``."""
    carry_residual: Any
    """S0 and Sh of that switch, shape ``(S, P, 1 + H, N)``."""
    omega: Any
    """Angular frequencies of the harmonics, rad/s, shape ``(H,)``."""
    phase: Any
    """Their phases, rad, shape ``(H,)``."""
    harmonic_turn: Any
    """exp(i Omega tau), shape ``(HALVINGS, H)``."""
    position: Any
    """Index of the position of each stop, shape ``(P,)``."""
    sign: Any
    """+1 for a top stop, -1 for a bottom stop, shape ``(P,)``."""
    gap: Any
    """m, shape ``(P,)``."""
    longest: float
    """The longest tabulated step, s."""
    order: Any
    """The slots in the order in which to sum over states, whichever was met first, shape ``(states met,)``."""


class Slots:
    """The states of a family that motions have met so far, for given numbers of modes."""

    def __init__(self, family: Family, free_modes: int, contact_modes: int) -> None:
        self.family = family
        self.counts = (free_modes, contact_modes)
        self.states: list[ContactState] = []
        problem, size = family.problem, max(free_modes, contact_modes)
        self._omega = np.zeros((0, size))
        self._decay = np.zeros((0, size))
        self._residual = np.zeros((0, len({stop.x for stop in problem.stops}), load_sizes(problem).size))
        self._unit = _empty_tables(problem, size)

    def count(self, state: ContactState) -> int:
        """Number of modes in a state."""
        return self.counts[0] if state == FREE else self.counts[1]

    def slot(self, state: ContactState) -> int:
        """Where a contact state is; it is given a slot if it has none."""
        if state not in self.states:
            if len(self.states) == self._unit.modes.size:
                self._grow()
            self.states.append(state)
            self._fill(len(self.states) - 1, self.family.state(state, self.count(state)), state)
        return self.states.index(state)

    def connect(self, slot: int, stop: int) -> None:
        """Make the switch of a stop from the state in a slot known."""
        old = self.states[slot]
        new = old.toggled(stop)
        target = self.slot(new)
        passage, unit = self.family.passage(old, self.count(old), new, self.count(new)), self._unit
        n_new, n_old = passage.S.shape
        unit.carry[slot, stop, :n_new, :n_old] = passage.S
        unit.carry_residual[slot, stop, :, :n_new] = passage.residual
        unit.next_slot[slot, stop] = target

    def scaled(self, problem: Problem) -> Tables:
        """The tables for a problem of the family: its excitation has a size and a frequency."""
        unit, sizes, harmonics = self._unit, load_sizes(problem), harmonics_of(problem)
        used = self._omega.shape[0]
        omega = away_from_resonance(self._omega, self._decay, harmonics.omega)
        force = unit.force * sizes[:, None]
        harmonic = np.zeros(unit.harmonic.shape, dtype=complex)
        harmonic[:used] = forced_answer(force[:used, 1:], omega, self._decay, harmonics.omega)
        weight = unit.weight[:used, :, : self._omega.shape[1]]
        forced = np.zeros(unit.forced.shape, dtype=complex)
        forced[:used] = weight @ harmonic[:used].transpose(0, 2, 1) + self._residual[:, :, 1:] * sizes[1:]
        steps = unit.longest * 0.5 ** np.arange(HALVINGS)
        tables = unit._replace(
            force=force,
            harmonic=harmonic,
            forced=forced,
            carry_residual=unit.carry_residual * sizes[:, None],
            omega=harmonics.omega,
            phase=harmonics.phase,
            harmonic_turn=np.exp(1j * np.outer(steps, harmonics.omega)),
            order=np.array(sorted(range(used), key=lambda slot: self.states[slot].closed), dtype=np.int64),
        )
        return tables if np.array_equal(omega, self._omega) else self._moved(tables, omega)

    def _moved(self, tables: Tables, omega: FloatArray) -> Tables:
        """The tables with other frequencies of undamped modes, as `away_from_resonance` has them."""
        copied = {name: getattr(tables, name).copy() for name in ("root", "inverse", "turn", "static")}
        moved = tables._replace(**copied)
        steps = tables.longest * 0.5 ** np.arange(HALVINGS)
        for slot, i in np.argwhere(omega != self._omega):
            root = roots_of(omega[slot, i : i + 1], self._decay[slot, i : i + 1])[0, 0]
            moved.root[slot, i], moved.turn[slot, :, i] = root, np.exp(steps * root)
            moved.inverse[slot, i] = 1 / root
            moved.static[slot, i, 0] = tables.force[slot, 0, i] / omega[slot, i] ** 2
        return moved

    def _grow(self) -> None:
        """Make room for twice the states."""
        empty = _empty_tables(self.family.problem, self._omega.shape[1], slots=self._unit.modes.size)
        twice: dict[str, Any] = {
            name: np.concatenate([getattr(self._unit, name), getattr(empty, name)]) for name in _PER_SLOT
        }
        self._unit = self._unit._replace(**twice)

    def _fill(self, slot: int, state: UnitState, which: ContactState) -> None:
        """Write a state into its slot."""
        unit, n = self._unit, state.size
        roots, kind = roots_of(state.modes.omega, state.decay), kinds_of(state.modes.omega, state.decay)
        split = np.flatnonzero(kind == SPLIT)
        mode_of = np.concatenate([np.arange(n), split])
        terms = mode_of.size
        root = np.concatenate([roots[:, 0], roots[split, 1]])
        _, first = np.unique(unit.position, return_index=True)
        unit.modes[slot], unit.terms[slot] = n, terms
        unit.kind[slot, :n] = kind
        unit.mode_of[slot, :terms] = mode_of
        unit.root[slot, :terms] = root
        unit.inverse[slot, :terms] = np.divide(1.0, root, out=np.zeros(terms, dtype=complex), where=root != 0)
        unit.fastest[slot] = np.abs(root).max(initial=0.0)
        unit.turn[slot, :, :terms] = np.exp(np.outer(unit.longest * 0.5 ** np.arange(HALVINGS), root))
        unit.static[slot, :n] = static_answer(state.modal[0], state.modes.omega, state.decay)
        unit.force[slot, :, :n] = state.modal
        unit.weight[slot, :, :terms] = state.at_stops[first][:, mode_of]
        unit.constant[slot] = state.residual_at_stops[0, first]
        unit.closed[slot] = [k in which for k in range(unit.sign.size)]
        pad = self._omega.shape[1] - n
        self._omega = np.vstack([self._omega, np.pad(state.modes.omega, (0, pad))])
        self._decay = np.vstack([self._decay, np.pad(state.decay, (0, pad))])
        self._residual = np.concatenate([self._residual, state.residual_at_stops.T[None, first]])


@lru_cache(maxsize=64)
def slots_of(family: Family, free_modes: int, contact_modes: int) -> Slots:
    """The slots of a family for given numbers of modes; the last ones are kept."""
    return Slots(family, free_modes, contact_modes)


_PER_SLOT = Tables._fields[: Tables._fields.index("omega")]


def _empty_tables(problem: Problem, size: int, slots: int = _SPARE) -> Tables:
    """Tables without a state, for states of at most `size` modes."""
    harmonics, beam = harmonics_of(problem), problem.beam
    x = sorted({stop.x for stop in problem.stops})
    S, N, T, P, U, H = slots, size, 2 * size, len(problem.stops), len(x), harmonics.omega.size
    return Tables(
        modes=np.zeros(S, dtype=np.int64),
        terms=np.zeros(S, dtype=np.int64),
        kind=np.zeros((S, N), dtype=np.int64),
        mode_of=np.zeros((S, T), dtype=np.int64),
        root=np.zeros((S, T), dtype=complex),
        inverse=np.zeros((S, T), dtype=complex),
        fastest=np.zeros(S),
        turn=np.ones((S, HALVINGS, T), dtype=complex),
        static=np.zeros((S, N, 3)),
        harmonic=np.zeros((S, H, N), dtype=complex),
        force=np.zeros((S, 1 + H, N)),
        weight=np.zeros((S, U, T)),
        forced=np.zeros((S, U, H), dtype=complex),
        constant=np.zeros((S, U)),
        closed=np.zeros((S, P), dtype=np.bool_),
        next_slot=np.full((S, P), -1, dtype=np.int64),
        carry=np.zeros((S, P, N, N)),
        carry_residual=np.zeros((S, P, 1 + H, N)),
        omega=harmonics.omega,
        phase=harmonics.phase,
        harmonic_turn=np.ones((HALVINGS, H), dtype=complex),
        position=np.array([x.index(stop.x) for stop in problem.stops], dtype=np.int64),
        sign=np.array([stop.sign for stop in problem.stops], dtype=float),
        gap=np.array([stop.gap for stop in problem.stops], dtype=float),
        longest=math.sqrt(beam.m / beam.EI) * beam.length**2,
        order=np.zeros(0, dtype=np.int64),
    )


def mirrored(problem: Problem, state: ContactState) -> ContactState | None:
    """The state with every closed stop exchanged for its twin on the other side; None without such twins."""
    twins = []
    for k in state.closed:
        stop = problem.stops[k]
        same = [
            i
            for i, other in enumerate(problem.stops)
            if other.side != stop.side and (other.x, other.gap, other.stiffness) == (stop.x, stop.gap, stop.stiffness)
        ]
        if len(same) != 1:
            return None
        twins.append(same[0])
    return ContactState(tuple(twins))
