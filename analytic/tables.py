"""The contact states of a joint as flat arrays, in the form that the compiled march takes.

Each state has a slot.  Its motion is a sum of terms p_t(s) = c_t exp(lambda_t s): one for each mode, and a second for
each mode that is damped above critical; the harmonic loads turn besides.  Slots are filled when a motion first
reaches their state: of the many sets of stops that could be closed, a motion meets few.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from analytic.state import SPLIT, Harmonics, Passage, StateModel
from lapjoint.contact import ContactState
from lapjoint.problem import Problem

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


def empty_tables(problem: Problem, harmonics: Harmonics, size: int, longest: float) -> Tables:
    """Tables without a state, for states of at most `size` modes."""
    x = sorted({stop.x for stop in problem.stops})
    S, N, T, P, U, H = _SPARE, size, 2 * size, len(problem.stops), len(x), harmonics.omega.size
    steps = longest * 0.5 ** np.arange(HALVINGS)
    return Tables(
        modes=np.zeros(S, dtype=np.int64),
        terms=np.zeros(S, dtype=np.int64),
        kind=np.zeros((S, N), dtype=np.int64),
        mode_of=np.zeros((S, T), dtype=np.int64),
        root=np.zeros((S, T), dtype=complex),
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
        harmonic_turn=np.exp(1j * np.outer(steps, harmonics.omega)),
        position=np.array([x.index(stop.x) for stop in problem.stops], dtype=np.int64),
        sign=np.array([stop.sign for stop in problem.stops], dtype=float),
        gap=np.array([stop.gap for stop in problem.stops], dtype=float),
        longest=longest,
    )


_PER_SLOT = Tables._fields[: Tables._fields.index("omega")]


def grown(tables: Tables) -> Tables:
    """The same tables with twice the slots."""
    twice: dict[str, Any] = {name: np.concatenate([getattr(tables, name)] * 2) for name in _PER_SLOT}
    twice["next_slot"][tables.modes.size :] = -1
    return tables._replace(**twice)


def fill_state(tables: Tables, slot: int, model: StateModel, stops: int) -> None:
    """Write a state into its slot."""
    n = model.size
    split = np.flatnonzero(model.kind == SPLIT)
    terms = n + split.size
    mode_of = np.concatenate([np.arange(n), split])
    roots = np.concatenate([model.roots[:, 0], model.roots[split, 1]])
    _, first = np.unique(tables.position, return_index=True)
    tables.modes[slot], tables.terms[slot] = n, terms
    tables.kind[slot, :n] = model.kind
    tables.mode_of[slot, :terms] = mode_of
    tables.root[slot, :terms] = roots
    tables.turn[slot, :, :terms] = model.turning(roots, tables.longest, HALVINGS)
    tables.static[slot, :n] = model.static
    tables.harmonic[slot, :, :n] = model.harmonic
    tables.force[slot, 0, :n], tables.force[slot, 1:, :n] = model.F0, model.Fh
    tables.weight[slot, :, :terms] = model.at_stops[first][:, mode_of]
    forced = model.at_stops @ model.harmonic.T + model.residual_at_stops[1:].T
    tables.forced[slot] = forced[first]
    tables.constant[slot] = model.residual_at_stops[0, first]
    tables.closed[slot] = [k in model.state for k in range(stops)]


def fill_passage(tables: Tables, slot: int, stop: int, target: int, passage: Passage) -> None:
    """Write the passage from a slot to another by the switch of one stop."""
    new, old = passage.S.shape
    tables.carry[slot, stop, :new, :old] = passage.S
    tables.carry_residual[slot, stop, :, :new] = passage.residual
    tables.next_slot[slot, stop] = target


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
