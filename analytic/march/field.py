"""Displacement and its derivatives anywhere in a marched motion, in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from analytic.march.contacts import contacts_of
from analytic.march.joint import Joint
from analytic.march.march import March, Segment
from analytic.march.ramp_segment import coordinates_on_ramps
from analytic.march.ramps import RampTables, on_block, ramp_tables
from analytic.march.tables import IntArray
from analytic.march.terms import start_all_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers import Field, History
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray

_AT_ONCE = 2048  # times evaluated at once, so that what is held for them stays below 20 MB with 500 modes


@dataclass(frozen=True)
class ModalField:
    """z(x, t), m, of (19); see `lapjoint.answers.Field`.  Segments of one contact state are evaluated together."""

    joint: Joint
    segments: tuple[Segment, ...]
    """The motion, without gaps in time."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x- and `dt`-th t-derivative of z: ``x``, shape ``(n,)``, and ``t``, ``(m,)``, give ``(n, m)``."""
        which = np.maximum(np.searchsorted(self._starts, t, side="right") - 1, 0)
        result, state_at = np.empty((x.size, t.size)), self._state_of[which]
        for i in np.unique(state_at):
            state, here = self._states[i], np.flatnonzero(state_at == i)
            for part in np.split(here, range(_AT_ONCE, here.size, _AT_ONCE)):
                result[:, part] = self._in_state(state, which[part], x, t[part], dx, dt)
        return result

    @cached_property
    def _starts(self) -> FloatArray:
        """When each segment starts, s."""
        return np.array([segment.start for segment in self.segments])

    @cached_property
    def _states(self) -> tuple[ContactState, ...]:
        """The states of the segments, each once."""
        return tuple(dict.fromkeys(segment.state for segment in self.segments))

    @cached_property
    def _state_of(self) -> IntArray:
        """The index in `_states` of each segment's state."""
        index = {state: i for i, state in enumerate(self._states)}
        return np.array([index[segment.state] for segment in self.segments])

    def _in_state(
        self, state: ContactState, which: IntArray, x: FloatArray, t: FloatArray, dx: int, dt: int
    ) -> FloatArray:
        """z or a derivative of it at ``m`` times in segments `which`, ``(m,)``, of one state; shape ``(n, m)``."""
        shapes = self.joint.modal(state).modes.shapes(x, dx)
        return np.asarray(shapes.T @ self._coordinates(state, which, t, dt) + self._rest(state, which, x, t, dx, dt))

    def _rest(self, state: ContactState, which: IntArray, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        """What the modes leave out of z, or of a derivative of it, shape ``(n, m)``."""
        harmonics = self.joint.harmonics
        omega = harmonics.omega[:, None]
        loads = omega**dt * np.sin(omega * t + harmonics.phase[:, None] + dt * np.pi / 2)
        constant = np.full((1, t.size), float(dt == 0))
        return np.asarray(self.joint.residual(state)(x, dx).T @ np.concatenate([constant, loads, self._sampled(t, dt)]))

    def _sampled(self, t: FloatArray, dt: int) -> FloatArray:
        """The dt-th derivative of the sampled forces at the times ``(m,)``, shape ``(R, m)``."""
        ramps = self.joint.problem.forces.ramps
        if ramps is None or dt == 2:
            return np.zeros((len(self.joint.problem.forces.sampled), t.size))
        return np.asarray(ramps.at(t)[dt].T)

    def _coordinates(self, state: ContactState, which: IntArray, t: FloatArray, dt: int) -> FloatArray:
        """q_i or its dt-th derivative at the times ``(m,)``, shape ``(N, m)``."""
        tables, slot, (segments, at) = self.joint.tables, self.joint.slot(state), np.unique(which, return_inverse=True)
        n, terms = int(tables.modes[slot]), tables.terms[slot]
        q, v = (np.stack([getattr(self.segments[i], name) for i in segments]) for name in "qv")
        start, count = self._starts[segments], segments.size
        if self.joint.problem.forces.ramps is not None:
            order, result = np.lexsort((t, at)), np.zeros((t.size, tables.kind.shape[1]))
            self._on_ramps(slot, start, q, v, at[order], t[order], dt, result)
            return np.asarray(result[np.argsort(order), :n].T)
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

    def _on_ramps(
        self,
        slot: int,
        start: FloatArray,
        q: FloatArray,
        v: FloatArray,
        which: IntArray,
        t: FloatArray,
        dt: int,
        result: FloatArray,
    ) -> None:
        """Write q_i or its dt-th derivative at ascending times in segments of one state, block by block of the ramps.

        Arguments are those of `analytic.march.ramp_segment.coordinates_on_ramps`: a segment lies in one block.
        """
        blocks, made, first = self.joint.problem.forces.ramps, self._ramps, 0
        assert blocks is not None
        assert made is not None
        while first < t.size:
            block = blocks.block_at(float(start[which[first]]))
            after = int(np.searchsorted(start, block.end)) if block.end < blocks.end else start.size
            last = int(np.searchsorted(which, after))
            here, made = slice(first, last), on_block(made, self.joint, block)
            coordinates_on_ramps(self.joint.tables, made, slot, start, q, v, which[here], t[here], dt, result[here])
            first = last

    @cached_property
    def _ramps(self) -> RampTables | None:
        """What all states of the motion make of the ramps, with the block that it begins in."""
        blocks = self.joint.problem.forces.ramps
        return None if blocks is None else ramp_tables(self.joint, blocks.block_at(float(self._starts[0])))


def _forced(amplitude: ComplexArray, theta: ComplexArray, omega: FloatArray, s: FloatArray, dt: int) -> FloatArray:
    """The dt-th derivative of the answer to the harmonics, shape ``(N, m)``.

    `amplitude` is ``(H, N)``, `theta` holds exp(i theta_h) at s = 0, ``(H, m)``, `omega` is ``(H, 1)``.
    """
    waves = (1j * omega) ** dt * theta * np.exp(1j * omega * s)
    return np.asarray((amplitude.T @ waves).imag)


def history_of(name: str, motion: March, field: Field | None = None) -> History:
    """A marched motion as a History.

    Parameters
    ----------
    name : str
        Name and options of the solver.
    motion : March
        The motion, recorded with `depth`.
    field : Field, optional
        z(x, t) of the motion; by default a `ModalField`.

    Returns
    -------
    History
        The motion with its contacts.
    """
    segments = motion.segments
    switched = [i for i, segment in enumerate(segments[:-1]) if segment.switched >= 0]
    return History(
        problem=motion.joint.problem,
        solver=name,
        start=segments[0].start,
        end=segments[-1].end,
        switch_times=np.array([segments[i].end for i in switched]),
        states=(segments[0].state, *(segments[i + 1].state for i in switched)),
        contacts=contacts_of(motion),
        field=field or ModalField(motion.joint, segments),
        highest_mode=max(float(motion.joint.modal(state).modes.omega[-1]) for state in {s.state for s in segments}),
    )
