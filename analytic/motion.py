"""Displacement and its derivatives anywhere in a marched motion, in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic import kernel
from analytic.march import Joint, March, Segment, contacts_of
from analytic.state import StateModel
from lapjoint.answers import History
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class ModalField:
    """z(x, t) of (19), segment by segment; see `lapjoint.answers.Field`."""

    joint: Joint
    segments: tuple[Segment, ...]

    def __call__(self, x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        """The `dx`-th x-derivative of the `dt`-th t-derivative of z, shape ``(n, m)``."""
        starts = np.array([segment.start for segment in self.segments])
        which = np.maximum(np.searchsorted(starts, t, side="right") - 1, 0)
        result = np.empty((x.size, t.size))
        for i in np.unique(which):
            here = which == i
            result[:, here] = self._segment(self.segments[i], x, t[here], dx, dt)
        return result

    def _segment(self, segment: Segment, x: FloatArray, t: FloatArray, dx: int, dt: int) -> FloatArray:
        model = self.joint.model(segment.state)
        coordinates = self._coordinates(model, segment, t, dt)
        loads = np.concatenate([np.full((1, t.size), float(dt == 0)), self._loads(t, dt)])
        shapes = model.modes.shapes(x, dx)
        return np.asarray(shapes.T @ coordinates + model.residual(x, dx).T @ loads)

    def _loads(self, t: FloatArray, dt: int) -> FloatArray:
        """sin(theta_h) or its dt-th derivative, shape ``(H, m)``."""
        harmonics = self.joint.harmonics
        omega = harmonics.omega[:, None]
        return np.asarray(omega**dt * np.sin(omega * t + harmonics.phase[:, None] + dt * np.pi / 2))

    def _coordinates(self, model: StateModel, segment: Segment, t: FloatArray, dt: int) -> FloatArray:
        """q_i or its dt-th derivative, shape ``(N, m)``."""
        harmonics = self.joint.harmonics
        theta = harmonics.theta(segment.start)
        c, poly = kernel.amplitudes(
            segment.q, segment.v, theta, harmonics.omega, model.kind, model.roots, model.static, model.harmonic
        )
        s = t - segment.start
        free = c[:, :, None] * model.roots[:, :, None] ** dt * np.exp(model.roots[:, :, None] * s)
        powers = np.stack([_power_derivative(order, s, dt) for order in range(3)])
        turning = (1j * harmonics.omega[:, None]) ** dt * np.exp(1j * (theta[:, None] + harmonics.omega[:, None] * s))
        return np.asarray(free.sum(axis=1).real + poly @ powers + (model.harmonic.T @ turning).imag)


def _power_derivative(order: int, s: FloatArray, dt: int) -> FloatArray:
    """The dt-th derivative of s^order."""
    if dt > order:
        return np.zeros_like(s)
    factor = float(np.prod(np.arange(order - dt + 1, order + 1), initial=1.0))
    return np.asarray(factor * s ** (order - dt))


def history_of(problem: Problem, name: str, joint: Joint, motion: March) -> History:
    """A marched motion as the History that everybody reads."""
    segments = motion.segments
    switched = [i for i, segment in enumerate(segments[:-1]) if segment.switched >= 0]
    return History(
        problem=problem,
        solver=name,
        start=segments[0].start,
        end=segments[-1].end,
        switch_times=np.array([segments[i].end for i in switched]),
        states=(segments[0].state, *(segments[i + 1].state for i in switched)),
        contacts=contacts_of(motion),
        field=ModalField(joint, segments),
    )
