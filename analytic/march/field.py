"""Displacement and its derivatives anywhere in a marched motion, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic.march.contacts import contacts_of
from analytic.march.joint import Joint
from analytic.march.march import March, Segment
from analytic.march.terms import set_phases, start_terms
from analytic.modes.beam_functions import ComplexArray
from lapjoint.answers import Field, History
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class ModalField:
    """z(x, t), m, of (19), segment by segment; see `lapjoint.answers.Field`."""

    joint: Joint
    segments: tuple[Segment, ...]
    """The motion, without gaps in time."""

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x- and `dt`-th t-derivative of z: ``x``, shape ``(n,)``, and ``t``, ``(m,)``, give ``(n, m)``."""
        starts = np.array([segment.start for segment in self.segments])
        which = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
        result = np.empty((x.size, t.size))
        for i in np.unique(which):
            here = which == i
            result[:, here] = self._segment(self.segments[i], x, t[here], dx, dt)
        return result

    def _segment(self, segment: Segment, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        """z or a derivative of it within one segment, shape ``(n, m)``."""
        loads = np.concatenate([np.full((1, t.size), float(dt == 0)), self._loads(t, dt)])
        shapes = self.joint.modal(segment.state).modes.shapes(x, dx)
        residual = self.joint.residual(segment.state)(x, dx)
        return np.asarray(shapes.T @ self._coordinates(segment, t, dt) + residual.T @ loads)

    def _loads(self, t: FloatArray, dt: int) -> FloatArray:
        """sin(theta_h) or its dt-th derivative at the times ``(m,)``, shape ``(H, m)``."""
        harmonics = self.joint.harmonics
        omega = harmonics.omega[:, None]
        return np.asarray(omega**dt * np.sin(omega * t + harmonics.phase[:, None] + dt * np.pi / 2))

    def _coordinates(self, segment: Segment, t: FloatArray, dt: int) -> FloatArray:
        """q_i or its dt-th derivative at the times ``(m,)``, shape ``(N, m)``."""
        tables, slot = self.joint.tables, self.joint.slot(segment.state)
        n, terms = tables.modes[slot], tables.terms[slot]
        theta, c, poly = np.zeros(tables.omega.size, dtype=complex), np.zeros(terms, dtype=complex), np.zeros((n, 3))
        set_phases(tables, segment.start, theta)
        start_terms(tables, slot, theta, segment.q, segment.v, c, poly)
        s, root, omega = t - segment.start, tables.root[slot, :terms, None], tables.omega[:, None]
        free = (c[:, None] * root**dt * np.exp(root * s)).real
        powers = np.stack([_power_derivative(exponent, s, dt) for exponent in range(3)])
        q = free[:n] + poly @ powers + _forced(tables.harmonic[slot, :, :n], theta, omega, s, dt)
        np.add.at(q, tables.mode_of[slot, n:terms], free[n:])
        return np.asarray(q)


def _forced(amplitude: ComplexArray, theta: ComplexArray, omega: FloatArray, s: FloatArray, dt: int) -> FloatArray:
    """The dt-th derivative of the answer to the harmonics, shape ``(N, m)``.

    `amplitude` is ``(H, N)``, `theta` holds exp(i theta_h) at s = 0, ``(H,)``, `omega` is ``(H, 1)``.
    """
    waves = (1j * omega) ** dt * theta[:, None] * np.exp(1j * omega * s)
    return np.asarray((amplitude.T @ waves).imag)


def _power_derivative(exponent: int, s: FloatArray, dt: int) -> FloatArray:
    """The dt-th derivative of s^exponent, in the shape of `s`."""
    if dt > exponent:
        return np.zeros_like(s)
    factor = float(np.prod(np.arange(exponent - dt + 1, exponent + 1), initial=1.0))
    return np.asarray(factor * s ** (exponent - dt))


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
    )
