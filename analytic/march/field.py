"""Displacement and its derivatives anywhere in a marched motion, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass, fields
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from analytic.march.contacts import contacts_of
from analytic.march.coupled import Coupled
from analytic.march.joint import Joint
from analytic.march.motion import Log
from analytic.march.ramp_segment import coordinates_on_ramps
from analytic.march.ramps import RampTables, on_block, ramp_tables
from analytic.march.tables import IntArray
from analytic.march.terms import start_all_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers import Field, History
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.dissipation import with_dissipation
from lapjoint.problem import FloatArray

_AT_ONCE = 2**20  # number of coordinates held at once, 8 MB for each time derivative
_LARGEST = 2048  # times in one matrix of terms, which keeps it below 20 MB with 500 modes


class TimesInState(NamedTuple):
    """Times at which the motion is in one state, and the modal coordinates then."""

    state: ContactState
    here: IntArray
    """Indices of these times among all times asked for, shape ``(m,)``."""
    which: IntArray
    """Index of the segment that holds each time, shape ``(m,)``."""
    q: FloatArray
    """q_i or a time derivative of q_i, kg^1/2 m divided by powers of s, shape ``(N, m)``."""
    sampled: FloatArray
    """The sampled forces, or their time derivative of the same order, N or N/m divided by powers of s, shape ``(R,
    m)``."""


class _Latest(NamedTuple):
    """The motion at the times asked for last."""

    t: FloatArray
    """The times, s, shape ``(m,)``."""
    parts: dict[int, list[TimesInState]]
    """The motion state by state, by the order of the time derivative."""


class _Memory:
    """The motion at the times asked for last, replaced as a whole, so that threads read times and motion together."""

    latest: _Latest | None = None


@dataclass(frozen=True, eq=False)
class ModalField:
    """z(x, t), m, of (19); see `lapjoint.answers.Field`.  Segments of one contact state are evaluated together.

    The modal coordinates at the times asked for last are kept, so that several positions and derivatives cost little
    more than one.
    """

    joint: Joint
    log: Log
    """The segments of the motion, without gaps in time."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x- and `dt`-th t-derivative of z: ``x``, shape ``(n,)``, and ``t``, ``(m,)``, give ``(n, m)``."""
        most = max(_AT_ONCE // self.log.q.shape[1], 1)
        if t.size > most:
            return np.concatenate([self(x, part, dx, dt) for part in np.split(t, range(most, t.size, most))], axis=1)
        result = np.empty((x.size, t.size))
        for part in self._parts(t, dt):
            shapes = self.joint.shapes_at(part.state, x, dx)
            result[:, part.here] = shapes.T @ part.q + self.rest(part, x, t[part.here], dx, dt)
        return result

    def __getstate__(self) -> dict[str, Any]:
        return {field.name: getattr(self, field.name) for field in fields(self)}

    def _parts(self, t: FloatArray, dt: int) -> list[TimesInState]:
        """The motion at given times, state by state; from the memory if these times were asked for last."""
        latest = self._memory.latest
        if latest is None or not np.array_equal(latest.t, t):
            latest = self._memory.latest = _Latest(t.copy(), {})
        if dt not in latest.parts:
            which = np.maximum(np.searchsorted(self.log.start, t, side="right") - 1, 0)
            if self._ramps is None:
                latest.parts[dt] = self._in_states(which, t, dt)
            else:
                latest.parts.update(enumerate(self._on_ramps(self._ramps, which, t)))
        return latest.parts[dt]

    def _in_states(self, which: IntArray, t: FloatArray, dt: int) -> list[TimesInState]:
        """Where no force is sampled: the motion at the times ``(m,)`` in segments ``(m,)``."""
        found, slot_at = [], self.log.slot[which]
        for slot in np.unique(slot_at).tolist():
            everywhere = np.flatnonzero(slot_at == slot)
            for here in np.split(everywhere, range(_LARGEST, everywhere.size, _LARGEST)):
                state, times = self.joint.state_in(slot), t[here]
                q = self._coordinates(slot, which[here], times, dt)
                it = self.joint.coupled(state)
                if it is not None:
                    rate = self._coordinates(slot, which[here], times, dt + 1)
                    q = self._uncoupled(it, q, rate, times, dt)
                found.append(TimesInState(state, here, which[here], q, np.zeros((0, here.size))))
        return found

    def _uncoupled(self, it: Coupled, P: FloatArray, V: FloatArray, t: FloatArray, dt: int) -> FloatArray:
        """The dt-th derivative of q_i, ``(N, m)``, of a coupled state from those of its coordinates, ``(N, m)``."""
        n = P.shape[0]
        return np.asarray(it.to[:n, :n] @ P + it.to[:n, n:] @ (V - self.joint.lags(it.lag, t, dt)))

    def rest(self, part: TimesInState, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        """The part of z, or of its derivative, that the modes leave out, at the times of `part`, shape ``(n, m)``."""
        harmonics = self.joint.harmonics
        omega = harmonics.omega[:, None]
        loads = omega**dt * np.sin(omega * t + harmonics.phase[:, None] + dt * np.pi / 2)
        constant = np.full((1, t.size), float(dt == 0))
        left_out = self.joint.residual_at(part.state, x, dx)
        return np.asarray(left_out.T @ np.concatenate([constant, loads, part.sampled]))

    def _coordinates(self, slot: int, which: IntArray, t: FloatArray, dt: int) -> FloatArray:
        """q_i or its dt-th derivative at the times ``(m,)`` of one state, shape ``(N, m)``."""
        tables, (segments, at) = self.joint.tables, np.unique(which, return_inverse=True)
        n, terms = int(tables.modes[slot]), tables.terms[slot]
        q, v = (np.ascontiguousarray(part[segments, :n]) for part in (self.log.q, self.log.v))
        start, count = self.log.start[segments], segments.size
        theta, c = np.zeros((count, tables.omega.size), dtype=complex), np.zeros((count, terms), dtype=complex)
        poly = np.zeros((count, n, 3))
        start_all_terms(tables, slot, start, q, v, theta, c, poly)
        s, root, omega = t - start[at], tables.root[slot, :terms, None], tables.omega[:, None]
        free = (c[at].T * root**dt * np.exp(root * s)).real
        result = free[:n] + _forced(tables.harmonic[slot, :, :n], theta[at].T, omega, s, dt)
        for exponent in range(dt, 3):
            result += poly[at, :, exponent].T * (math.perm(exponent, dt) * s ** (exponent - dt))
        np.add.at(result, tables.mode_of[slot, n:terms], free[n:])
        return np.asarray(result)

    @cached_property
    def _memory(self) -> _Memory:
        """The motion at the times asked for last, which changes no answer."""
        return _Memory()

    @cached_property
    def _ramps(self) -> RampTables | None:
        """What all states of the motion make of the ramps, with the block that it begins in."""
        blocks = self.joint.problem.forces.ramps
        return None if blocks is None else ramp_tables(self.joint, blocks.block_at(float(self.log.start[0])))

    def _on_ramps(self, made: RampTables, which: IntArray, t: FloatArray) -> list[list[TimesInState]]:
        """The motion and two time derivatives at times ``(m,)`` in segments ``(m,)``, block by block of the ramps."""
        order, log, blocks, first = np.lexsort((t, which)), self.log, self.joint.problem.forces.ramps, 0
        assert blocks is not None
        at, times = which[order], t[order]
        found = np.zeros((t.size, 4 if self.joint.damped else 3, log.q.shape[1]))
        while first < t.size:
            block = blocks.block_at(float(log.start[at[first]]))
            made = on_block(made, self.joint, block)
            after = int(np.searchsorted(log.start, block.end)) if block.end < blocks.end else log.start.size
            here = slice(first, int(np.searchsorted(at, after)))
            arrays = log.slot, log.start, log.q, log.v, at[here], times[here], found[here]
            coordinates_on_ramps(self.joint.tables, made, *arrays)
            first = here.stop
        loads = self.joint.sampled_loads(times)
        parts: list[list[TimesInState]] = [[], [], []]
        for slot in np.unique(log.slot[at]).tolist():
            state, i, n = self.joint.state_in(slot), np.flatnonzero(log.slot[at] == slot), self.joint.tables.modes[slot]
            it = self.joint.coupled(state)
            for dt in range(3):
                q = found[i, dt, :n].T
                if it is not None:
                    q = self._uncoupled(it, q, found[i, dt + 1, :n].T, times[i], dt)
                parts[dt].append(TimesInState(state, order[i], at[i], q, loads[dt][:, i]))
        return parts


def _forced(amplitude: ComplexArray, theta: ComplexArray, omega: FloatArray, s: FloatArray, dt: int) -> FloatArray:
    """The dt-th derivative of the answer to the harmonics, shape ``(N, m)``.

    `amplitude` is ``(H, N)``, `theta` holds exp(i theta_h) at s = 0, ``(H, m)``, `omega` is ``(H, 1)``.
    """
    waves = (1j * omega) ** dt * theta * np.exp(1j * omega * s)
    return np.asarray((amplitude.T @ waves).imag)


def history_of(name: str, joint: Joint, log: Log, field: Field | None = None) -> History:
    """A motion of at least one segment, marched with `depth`, as a History of a solver called `name`.

    `field` is z(x, t) of the motion, by default a `ModalField`.
    """
    switched = np.flatnonzero(log.stop[:-1] >= 0)
    states = {slot: joint.state_in(slot) for slot in np.unique(log.slot).tolist()}
    made = History(
        problem=joint.problem,
        solver=name,
        start=float(log.start[0]),
        end=float(log.end[-1]),
        switch_times=log.end[switched],
        states=tuple(states[slot] for slot in log.slot[np.append(0, switched + 1)].tolist()),
        contacts=contacts_of(joint, log),
        field=field or ModalField(joint, log),
        highest_mode=max(float(joint.flat(state).omega[-1]) for state in states.values()),
    )
    if not joint.damped:
        return made
    return with_dissipation(made, float(joint.tables.fastest.max()))
