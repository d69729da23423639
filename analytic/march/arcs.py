r"""A motion with a given contact sequence: arcs of given durations in closed form, whatever the gaps do meanwhile.

Arc i begins at the time t_i with y = (q, v) in the modes of its contact state, and lasts d_i seconds, of either sign.
With the answer f(t) of the modes to the harmonics the deviations of its start and end are

    dy = w + f'(t) dt,    dt_i = dd_0 + ... + dd_(i-1),

where w is what travels as the free motion does.  At the end the duration of the arc adds the rate of the motion, which
is f'(t) and the rate of the free motion.  After the passage y_new = S y + b(t) the deviation is S dy + b'(t) dt, and

    w_new = S w + (S f_old' + b' - f_new') dt

with one vector in the bracket for all durations before.  A parameter of the problem may change the harmonics while
times keep their ratios to the excitation period, so that the phases theta stay.  Its deviation is one more w, with
dy = w + df, where df is the change of the answer at fixed phases.

Joints with damped stops have arcs of their own, see `analytic.march.coupled_arcs`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import NamedTuple

import numpy as np

from analytic.march.change import Change, add_forced_change, changes_of_answers, forced_change
from analytic.march.coupled_arcs import CoupledArcs
from analytic.march.joint import Joint
from analytic.march.known_states import KnownStates
from analytic.march.mean_rates import mean_rate, mean_rate_at_stop
from analytic.march.switching import switch
from analytic.march.tables import BoolArray, IntArray, Tables
from analytic.march.tangent import flow
from analytic.march.terms import drift_at_stops, set_phases, start_terms, state_from_terms, turn_exactly
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.compiled.arrays import complex_zeros, put, zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.arcs import Chain, ContactSequence
from lapjoint.orbits.compiled_intervals import Motion
from lapjoint.problem import FloatArray, Problem

_SEQUENCES = 256
"""Number of contact sequences cached in flat form, about the number on one or two curves; each takes a kilobyte."""
_NO_CHANGE = Change(0.0, np.zeros(0))
"""The change of an excitation that has no parameter."""


class _FlatSequence(NamedTuple):
    """A contact sequence as compiled functions take it: ``M`` events between ``M + 1`` arcs; not to be written to."""

    slot: IntArray
    """The contact state of each arc, shape ``(M + 1,)``."""
    stop: IntArray
    """The stop that switches at each event, shape ``(M,)``."""
    returning: BoolArray
    """Whether each event is of the stop of the event before, shape ``(M,)``."""


@dataclass(frozen=True)
class JointArcs:
    """The arcs of a joint whose excitation has a period; see `lapjoint.orbits.arcs.Arcs`."""

    joint: Joint
    period: float
    """The excitation period, s."""

    @cached_property
    def _coupled(self) -> CoupledArcs:
        """The arcs, if a stop is damped."""
        return CoupledArcs(self.joint)

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self.joint.problem

    @in_one_thread
    def chain(
        self,
        sequence: ContactSequence,
        start: FloatArray,
        time: float,
        durations: FloatArray,
        derivatives: bool = True,
        number: str | None = None,
    ) -> Chain:
        """Follow the arcs of a contact sequence. See `lapjoint.orbits.arcs.Arcs.chain`."""
        if self.joint.damped:
            return self._coupled.chain(sequence, start, time, durations, derivatives)
        flat = self._flat(sequence)
        tables, arcs, n = self.joint.tables, flat.slot.size, start.size
        rows, times, events = np.empty((arcs + 1, 2 * tables.kind.shape[1])), np.empty(arcs), np.empty(arcs - 1)
        rows[0, :n] = start
        sizes = 2 * tables.modes[flat.slot]
        known = self.joint.change_by(number) if derivatives and number is not None else None
        change = _NO_CHANGE if known is None else Change(known.frequency, known.sizes)
        own = int(known is not None)
        columns = own + n + arcs if derivatives else 0
        end_by, events_by = np.zeros((int(sizes[-1]), columns)), np.zeros((arcs - 1, columns))
        _chain(
            tables,
            change,
            *flat,
            float(time),
            np.ascontiguousarray(durations, dtype=float),
            rows,
            times,
            events,
            end_by,
            events_by,
        )
        starts = tuple(row[:size] for row, size in zip(rows[:-1], sizes.tolist(), strict=True))
        end = rows[arcs, : end_by.shape[0]]
        if not derivatives:
            return Chain(starts, times, end, events)
        by_number = np.concatenate([end_by[:, 0], events_by[:, 0]]) if own else None
        return Chain(starts, times, end, events, end_by[:, own:], events_by[:, own:], by_number)

    def motion(self, sequence: ContactSequence, chain: Chain, durations: FloatArray) -> Motion:
        """The displacement at the stops as sums of exponentials. See `lapjoint.orbits.arcs.Arcs.motion`."""
        slots = np.array([self.joint.slot(state) for state in sequence.states], dtype=np.int64)
        tables = self.joint.tables
        M, U, K = slots.size, tables.forced.shape[1], int(tables.terms[slots].max()) + tables.omega.size
        rows = np.zeros((M, 2 * tables.kind.shape[1]))
        for row, start in zip(rows, chain.starts, strict=True):
            row[: start.size] = start
        motion = Motion(
            start=chain.times - chain.times[0],
            duration=np.array(durations, dtype=float),
            rates=np.zeros((M, K), dtype=complex),
            amplitudes=np.zeros((M, K), dtype=complex),
            weights=np.zeros((M, U, K), dtype=complex),
            polynomial=np.empty((M, U, 3)),
            orientation=np.where(tables.closed[slots], -1.0, 1.0) * ~tables.asleep[slots],
        )
        _write_motion(tables, slots, chain.times, rows, motion)
        return motion

    def later(self, state: ContactState, start: FloatArray, time: float, duration: float) -> FloatArray:
        """The motion some time later in the same state. See `lapjoint.orbits.arcs.Arcs.later`."""
        return self.chain(ContactSequence(state), start, time, np.array([duration]), derivatives=False).end

    def point(self, state: ContactState, coordinates: FloatArray) -> SectionPoint:
        """A state of the motion as a section point. See `lapjoint.orbits.arcs.Arcs.point`."""
        return SectionPoint(state, coordinates.reshape(2, -1).copy())

    def coordinates(self, point: SectionPoint) -> FloatArray:
        """The coordinates of a section point. See `lapjoint.orbits.arcs.Arcs.coordinates`."""
        return point.coordinates.flatten()

    def unit_norms(self, state: ContactState) -> FloatArray:
        """Sizes of units of the coordinates. See `lapjoint.orbits.arcs.Arcs.unit_norms`."""
        n = self.joint.count(state)
        return np.repeat([1.0, self.period / (2 * math.pi)], n)

    def _flat(self, sequence: ContactSequence) -> _FlatSequence:
        """A sequence in flat form; every switch in it is made known to the tables."""
        found, joint = _known_sequence(self.joint.known, sequence), self.joint
        if found is not None:
            return found
        slots = [joint.slot(state) for state in sequence.states]
        for slot, stop in zip(slots[:-1], sequence.stops, strict=True):
            if joint.tables.next_slot[slot, stop] < 0:
                joint.connect(slot, stop)
        return _flattened(slots, sequence)


@lru_cache(maxsize=_SEQUENCES)
def _known_sequence(known: KnownStates, sequence: ContactSequence) -> _FlatSequence | None:
    """A sequence in flat form, in tables that begin with known states; None if one of its switches is unknown."""
    states, stops = sequence.states, sequence.stops
    switches = zip(states, stops, strict=False)
    if sequence.first not in known.slots or not set(switches).issubset(known.switches):
        return None
    return _flattened([known.slots[state] for state in states], sequence)


def _flattened(slots: list[int], sequence: ContactSequence) -> _FlatSequence:
    """A sequence of contact states in these slots, in flat form."""
    stops, returning = np.array(sequence.stops, dtype=np.int64), np.array(sequence.returning, dtype=np.bool_)
    return _FlatSequence(np.array(slots, dtype=np.int64), stops, returning)


@njit_called(vectorised=True)
def _chain(
    tables: Tables,
    change: Change,
    slots: IntArray,
    stops: IntArray,
    returning: BoolArray,
    time: float,
    durations: FloatArray,
    rows: FloatArray,
    times: FloatArray,
    events: FloatArray,
    end_by: FloatArray,
    events_by: FloatArray,
) -> None:
    """Follow ``M + 1`` arcs from the time `time`, s; `slots`, `stops` and `returning` are as `_FlatSequence` has them.

    `change` says how the harmonics change with a parameter; without a harmonic, no derivative by a parameter is found.
    `durations`, s, ``(M + 1,)``, is how long each arc lasts.  `rows`, ``(M + 2, 2 N)``, has (q, v), kg^1/2 m and kg^1/2
    m/s, at the first start, and takes those at each start and at the end, each in the modes of its state.  `times`, s,
    ``(M + 1,)``, takes when each arc begins; `events`, m or m/s, ``(M,)``, the left sides of the equations.  `end_by`,
    ``(2 N_end, n + M + 1)``, and `events_by`, ``(M, n + M + 1)``, take the derivatives, with the one by the parameter,
    if it is asked for, in the first column; without columns no derivative is found.
    """
    most, arcs, carried, own = tables.kind.shape[1], slots.size, end_by.shape[1] > 0, min(change.size.size, 1)
    n = max(end_by.shape[1] - arcs, 0)
    theta, after, unturned = complex_zeros(tables.omega.size), complex_zeros(tables.omega.size), complex_zeros(0)
    first, term, poly = complex_zeros(2 * most), complex_zeros(2 * most), zeros((most, 3))
    q, v, row, rates = zeros(most), zeros(most), zeros(2 * most), zeros(2 * most)
    here = zeros((2 * tables.modes[slots[0]], n))
    for j in range(here.shape[1] - own):
        here[j, own + j] = 1.0
    _read(rows[0], tables.modes[slots[0]], q, v)
    set_phases(tables, time, theta)
    changes = changes_of_answers(tables, change, slots[: own * arcs])
    if own:
        add_forced_change(tables, change, changes, slots[0], theta, -1.0, here[:, 0])
    for i in range(arcs):
        slot, d, size = slots[i], durations[i], tables.modes[slots[i]]
        times[i] = time
        start_terms(tables, slot, theta, q, v, first, poly)
        put(term, first)
        turn_exactly(tables.root[slot], tables.omega, tables.terms[slot], d, term, unturned)
        time += d
        set_phases(tables, time, after)
        state_from_terms(tables, slot, after, d, term, poly, q, v)
        there = here
        if carried:
            there = zeros((2 * size, n + i + 1))
            live = flow(tables, slot, d, here, there)
            _free_rates(tables, slot, d, term, poly, rates)
            for j in range(2 * size):
                there[j, n + i] = rates[j]
                if own:
                    there[j, 0] -= change.omega * d * rates[j]
        if i == arcs - 1:
            break
        k = stops[i]
        u, sign = tables.position[k], tables.sign[k]
        if returning[i]:
            events[i], by_duration, by_time = mean_rate_at_stop(tables, slot, u, d, theta, first, poly, row)
            events[i] *= sign
            if carried:
                _apply(row, sign, here, n, by_time, events_by[i])
                events_by[i, n + i] = sign * by_duration
                if own:
                    events_by[i, 0] -= sign * change.omega * d * by_duration
                    events_by[i, 0] += sign * _change_of_mean_rate(tables, change, changes, slot, u, d, theta, after)
        else:
            z, by_time = _at_stop(tables, slot, u, after, q, row)
            events[i] = sign * z - tables.gap[k]
            if carried:
                _apply(row, sign, there, n, by_time, events_by[i])
                for h in range(own * after.size):
                    events_by[i, 0] += sign * (forced_change(tables, change, changes, slot, u, h) * after[h]).imag
        switch(tables, slot, k, after, q, v)
        if carried:
            here = _passed(tables, slot, k, after, live, n, there)
            if own:
                _add_passage_change(tables, change, changes, slot, k, after, here)
        put(theta, after)
        _write(rows[i + 1], tables.modes[slots[i + 1]], q, v)
    last = slots[arcs - 1]
    _write(rows[arcs], tables.modes[last], q, v)
    if carried:
        _forced_rates(tables, last, after, rates)
        for j in range(2 * tables.modes[last]):
            put(end_by[j], there[j])
            for c in range(n, end_by.shape[1]):
                end_by[j, c] += rates[j]
        if own:
            add_forced_change(tables, change, changes, last, after, 1.0, end_by[:, 0])


@njit_inner()
def _read(row: FloatArray, n: int, q: FloatArray, v: FloatArray) -> None:
    """Read `q` and `v` of `n` modes from `row`, where the velocities follow the displacements."""
    for i in range(n):
        q[i], v[i] = row[i], row[n + i]


@njit_inner()
def _write(row: FloatArray, n: int, q: FloatArray, v: FloatArray) -> None:
    """Write `q` and `v` of `n` modes to `row`, the velocities after the displacements."""
    for i in range(n):
        row[i], row[n + i] = q[i], v[i]


@njit_inner()
def _free_rates(tables: Tables, slot: int, s: float, term: ComplexArray, poly: FloatArray, rates: FloatArray) -> None:
    """Write d(q, v)/dt, ``(2 N,)``, without the forced motion, `s` seconds after the start; `term` holds the terms
    then."""
    n = tables.modes[slot]
    for i in range(n):
        rates[i], rates[n + i] = poly[i, 1] + 2 * s * poly[i, 2], 2 * poly[i, 2]
    for t in range(tables.terms[slot]):
        i, rate = tables.mode_of[slot, t], tables.root[slot, t] * term[t]
        rates[i] += rate.real
        rates[n + i] += (tables.root[slot, t] * rate).real


@njit_inner()
def _forced_rates(tables: Tables, slot: int, theta: ComplexArray, rates: FloatArray) -> None:
    """Write d(q, v)/dt of the answer to the harmonics at phases `theta`, shape ``(2 N,)``."""
    n = tables.modes[slot]
    for i in range(n):
        rates[i], rates[n + i] = 0.0, 0.0
    for h in range(theta.size):
        omega = tables.omega[h]
        for i in range(n):
            wave = tables.harmonic[slot, h, i] * theta[h]
            rates[i] += omega * wave.real
            rates[n + i] -= omega * omega * wave.imag


@njit_inner()
def _at_stop(
    tables: Tables, slot: int, u: int, theta: ComplexArray, q: FloatArray, row: FloatArray
) -> tuple[float, float]:
    """Displacement at a position of stops, m, and its rate, m/s, at fixed (q, v) less the forced motion.

    `row`, shape ``(2 N,)``, takes the derivatives of the displacement by (q, v), kg^-1/2.
    """
    n = tables.modes[slot]
    z, by_time = tables.constant[slot, u], 0.0
    for h in range(theta.size):
        wave: complex = tables.forced[slot, u, h]
        by_time += tables.omega[h] * (wave * theta[h]).real
        for i in range(n):
            wave -= tables.weight[slot, u, i] * tables.harmonic[slot, h, i]
        z += (wave * theta[h]).imag
    for i in range(n):
        z += tables.weight[slot, u, i] * q[i]
        row[i], row[n + i] = tables.weight[slot, u, i], 0.0
    return z, by_time


@njit_inner()
def _apply(row: FloatArray, sign: float, w: FloatArray, n: int, by_time: float, values: FloatArray) -> None:
    """Write `sign` times the product of a row with deviations `w`, and add `by_time` in the columns from `n` on."""
    for c in range(w.shape[1]):
        values[c] = sign * by_time if c >= n else 0.0
    for j in range(w.shape[0]):
        factor = sign * row[j]
        if factor != 0.0:
            for c in range(w.shape[1]):
                values[c] += factor * w[j, c]


@njit_inner()
def _passed(tables: Tables, old: int, k: int, theta: ComplexArray, live: int, n: int, there: FloatArray) -> FloatArray:
    """Deviations w after a switch, of the deviations `there` before, which are 0 for modes from `live` on."""
    new = tables.next_slot[old, k]
    n_old, n_new, columns = tables.modes[old], tables.modes[new], there.shape[1]
    row = tables.passage[old, k]
    S, onto, here = tables.carry[row], tables.carry_residual[row], zeros((2 * n_new, columns))
    part = zeros((n_new, live))
    for j in range(n_new):
        for i in range(live):
            part[j, i] = S[j, i]
    if live > 0:
        np.dot(part, there[:live], here[:n_new])
        np.dot(part, there[n_old : n_old + live], here[n_new:])
    before, jump = zeros(2 * n_old), zeros(2 * n_new)
    _forced_rates(tables, old, theta, before)
    _forced_rates(tables, new, theta, jump)
    for j in range(n_new):
        x, y = -jump[j], -jump[n_new + j]
        for i in range(n_old):
            x += S[j, i] * before[i]
            y += S[j, i] * before[n_old + i]
        for h in range(theta.size):
            x += onto[1 + h, j] * tables.omega[h] * theta[h].real
            y -= onto[1 + h, j] * tables.omega[h] ** 2 * theta[h].imag
        for c in range(n, columns):
            here[j, c] += x
            here[n_new + j, c] += y
    return here


@njit_inner()
def _change_of_mean_rate(
    tables: Tables,
    change: Change,
    changes: ComplexArray,
    slot: int,
    u: int,
    d: float,
    theta: ComplexArray,
    after: ComplexArray,
) -> float:
    """Change of the harmonics' part of the mean rate at a position of stops with the parameter, at a fixed duration."""
    total = 0.0
    for h in range(theta.size):
        mean, turning = mean_rate(complex(0.0, tables.omega[h]), d)[0], change.omega * tables.omega[h]
        total += (forced_change(tables, change, changes, slot, u, h) * theta[h] * mean).imag
        total += turning * (tables.forced[slot, u, h] * after[h]).real
    return total


@njit_inner()
def _add_passage_change(
    tables: Tables, change: Change, changes: ComplexArray, old: int, k: int, theta: ComplexArray, here: FloatArray
) -> None:
    """Add S df_old + db - df_new, the parameter's part at a switch, to the first column of `here`."""
    new, row = tables.next_slot[old, k], tables.passage[old, k]
    n_old, n_new = tables.modes[old], tables.modes[new]
    S, onto, before = tables.carry[row], tables.carry_residual[row], zeros(2 * n_old)
    add_forced_change(tables, change, changes, old, theta, 1.0, before)
    add_forced_change(tables, change, changes, new, theta, -1.0, here[:, 0])
    for j in range(n_new):
        for i in range(n_old):
            here[j, 0] += S[j, i] * before[i]
            here[n_new + j, 0] += S[j, i] * before[n_old + i]
        for h in range(theta.size):
            here[j, 0] += onto[1 + h, j] * change.size[h] * theta[h].imag
            here[n_new + j, 0] += onto[1 + h, j] * tables.omega[h] * (change.omega + change.size[h]) * theta[h].real


@njit_called()
def _write_motion(tables: Tables, slots: IntArray, times: FloatArray, rows: FloatArray, motion: Motion) -> None:
    """Write the terms of ``S`` arcs at the positions of the stops to the arrays of `motion`.

    `slots`, ``(S,)``, holds the contact state of each arc, `times`, s, ``(S,)``, when it begins, and `rows`, ``(S, 2
    N)``, (q, v), kg^1/2 m and kg^1/2 m/s, then.
    """
    most, theta = tables.kind.shape[1], complex_zeros(tables.omega.size)
    q, v, poly = zeros(most), zeros(most), zeros((most, 3))
    for i in range(slots.size):
        slot, free = slots[i], tables.terms[slots[i]]
        _read(rows[i], tables.modes[slot], q, v)
        set_phases(tables, times[i], theta)
        start_terms(tables, slot, theta, q, v, motion.amplitudes[i], poly)
        drift_at_stops(tables, slot, poly, motion.polynomial[i])
        for t in range(free):
            motion.rates[i, t] = tables.root[slot, t]
        for h in range(theta.size):
            motion.rates[i, free + h] = complex(0.0, tables.omega[h])
            motion.amplitudes[i, free + h] = theta[h]
        for u in range(motion.weights.shape[1]):
            for t in range(free):
                motion.weights[i, u, t] = tables.weight[slot, u, t]
                if tables.owner is not None:
                    motion.weights[i, u, t] = complex(tables.weight[slot, u, t], tables.twist[slot, u, t])
            for h in range(theta.size):
                forced = tables.forced[slot, u, h]
                motion.weights[i, u, free + h] = complex(forced.imag, -forced.real)
