r"""Periodic motions: Newton's method on the period map, and Floquet multipliers.

The state at a multiple of the period, y = (q, v) in the modes of the contact state at that time, is mapped by
P(y) over n periods.  The monodromy matrix dP/dy is the product of the closed-form flow of each segment, and at
each switch

    dy_new = [ J + (J f_old + b - f_new) (grad h . -1 / h') ] dy_old

where J is the linear part of the passage, b the rate of its time-dependent part, f the rates of y on both sides,
and h the gap function whose root sets the time of the switch.  Under modal damping f jumps at a switch even though
the spring force does not.

A fixed point is accepted only if it is stable, all multipliers within the unit circle: then it is a motion that
marching would lead to.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from analytic import kernel
from analytic.march import Compiled, Joint, March, Segment, march
from analytic.state import StateModel
from lapjoint.contact import ContactState
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress

_NEAR = 1e-2
"""Newton starts only where the march has come this near to repeating, relative to the motion: of several motions
that coexist it then finds the one that the march leads to."""


@dataclass(frozen=True)
class Orbit:
    """A periodic motion, or the best that was found."""

    order: int
    """Excitation periods per period of the motion; 0 if none was found."""
    residual: float
    multipliers: FloatArray
    motion: March
    """One period of the motion, from t = 0; the last periods marched if none was found."""


@dataclass(frozen=True)
class Search:
    """How hard to look for a steady state."""

    tolerance: float
    max_order: int
    max_periods: int


@dataclass(frozen=True)
class Section:
    """The state at a multiple of the excitation period."""

    state: ContactState
    q: FloatArray
    v: FloatArray

    @property
    def y(self) -> FloatArray:
        """q and v in one array, shape ``(2 N,)``."""
        return np.concatenate([self.q, self.v])

    def moved(self, y: FloatArray) -> Section:
        """The same contact state with other coordinates ``y``."""
        return Section(self.state, y[: self.q.size].copy(), y[self.q.size :].copy())


def flow_matrix(model: StateModel, s: float) -> FloatArray:
    """d(q, v)(s) / d(q, v)(0) within one state, shape ``(2 N, 2 N)``."""
    first, second = model.roots[:, 0], model.roots[:, 1]
    equal = first == second  # a free rigid body: q + v s
    apart = np.where(equal, 1.0, first - second)
    e1, e2 = np.exp(first * s), np.exp(second * s)
    sine = np.where(equal, s * e1, (e1 - e2) / apart).real
    cosine = np.where(equal, e1, (first * e2 - second * e1) / apart).real
    sine_rate = np.where(equal, e1, (first * e1 - second * e2) / apart).real
    cosine_rate = np.where(equal, 0.0, first * second * (e2 - e1) / apart).real
    n = model.size
    matrix = np.zeros((2 * n, 2 * n))
    i = np.arange(n)
    matrix[i, i], matrix[i, n + i] = cosine, sine
    matrix[n + i, i], matrix[n + i, n + i] = cosine_rate, sine_rate
    return matrix


def _rates(joint: Joint, it: Compiled, t: float, q: FloatArray, v: FloatArray) -> FloatArray:
    """d(q, v)/dt in one state, shape ``(2 N,)``."""
    model, theta = it.model, joint.harmonics.theta(t)
    stiffness = (model.roots[:, 0] * model.roots[:, 1]).real
    damping = -(model.roots[:, 0] + model.roots[:, 1]).real
    return np.concatenate([v, model.F0 + np.sin(theta) @ model.Fh - damping * v - stiffness * q])


def monodromy(joint: Joint, motion: March) -> FloatArray:
    """d(q, v) at the end by d(q, v) at the start of a marched motion, shape ``(2 N_end, 2 N_start)``."""
    product = np.eye(2 * motion.segments[0].q.size)
    for now, after in zip(motion.segments, (*motion.segments[1:], None), strict=True):
        product = flow_matrix(joint.state(now.state).model, now.end - now.start) @ product
        if after is not None:
            product = saltation(joint, now, after) @ product
    return product


def saltation(joint: Joint, before: Segment, after: Segment) -> FloatArray:
    """Jump of a small deviation at the switch between two segments, shape ``(2 N_new, 2 N_old)``."""
    t, stop = before.end, before.switched
    old, new = joint.state(before.state), joint.state(after.state)
    passage, harmonics = joint.passage(before.state, after.state), joint.harmonics
    n_old, n_new = old.model.size, new.model.size
    J = np.zeros((2 * n_new, 2 * n_old))
    J[:n_new, :n_old] = passage.S
    J[n_new:, n_old:] = passage.S
    theta, omega = harmonics.theta(t), harmonics.omega
    moving = np.concatenate(
        [
            (omega * np.cos(theta)) @ passage.residual[1:],
            (-(omega**2) * np.sin(theta)) @ passage.residual[1:],
        ]
    )
    q, v = _end_of(joint, before)
    jump = J @ _rates(joint, old, t, q, v) + moving - _rates(joint, new, t, after.q, after.v)
    orientation = joint.sign[stop] * (-1.0 if stop in before.state else 1.0)
    gradient = np.concatenate([orientation * old.model.at_stops[stop], np.zeros(n_old)])
    return np.asarray(J - np.outer(jump, gradient) / before.rate)


def _end_of(joint: Joint, segment: Segment) -> tuple[FloatArray, FloatArray]:
    it, harmonics = joint.state(segment.state), joint.harmonics
    model, theta = it.model, harmonics.theta(segment.start)
    c, poly = kernel.amplitudes(
        segment.q, segment.v, theta, harmonics.omega, it.kind, model.roots, model.static, model.harmonic
    )
    s = segment.end - segment.start
    q, v = kernel.state_at(s, c, poly, theta, harmonics.omega, it.kind, model.roots, model.harmonic)
    return q, v


def find_orbit(
    joint: Joint,
    start: Section,
    period: float,
    search: Search,
    progress: Progress | None,
) -> Orbit:
    """March from `start`, try Newton at lengthening intervals, and accept the first stable periodic motion."""
    now, marched, stretch = start, 0, 8
    while True:
        motion = march(joint, now.state, 0.0, now.q, now.v, stretch * period)
        now = Section(motion.state, motion.q, motion.v)
        marched += stretch
        if progress is not None:
            progress(marched, search.max_periods)
        for order in range(1, search.max_order + 1):
            orbit = _newton(joint, now, order, period, search.tolerance)
            if orbit is not None:
                return _shortest(joint, orbit, period, search.tolerance)
        if marched >= search.max_periods:
            last = march(joint, now.state, 0.0, now.q, now.v, search.max_order * period)
            return Orbit(0, _residual(now, last, period), np.zeros(0), last)
        stretch = min(2 * stretch, search.max_periods - marched)


def _scale(section: Section, period: float) -> float:
    """Size of the motion in energy-like units: displacements, and velocities times period / 2 pi."""
    return float(np.linalg.norm(section.q) + np.linalg.norm(section.v) * period / (2 * np.pi)) + 1e-300


def _residual(section: Section, motion: March, period: float) -> float:
    if motion.state != section.state:
        return np.inf
    difference = np.linalg.norm(motion.q - section.q) + np.linalg.norm(motion.v - section.v) * period / (2 * np.pi)
    return float(difference) / _scale(section, period)


def _shortest(joint: Joint, orbit: Orbit, period: float, tolerance: float) -> Orbit:
    """The same motion over its least period: an orbit found over n periods may repeat after a part of them."""
    first = orbit.motion.segments[0]
    for order in range(1, orbit.order):
        if orbit.order % order == 0:
            shorter = _newton(joint, Section(first.state, first.q, first.v), order, period, tolerance)
            if shorter is not None:
                return shorter
    return orbit


def _newton(joint: Joint, guess: Section, order: int, period: float, tolerance: float) -> Orbit | None:
    """A stable orbit of `order` periods near `guess`, or None."""
    now, allowed = guess, _NEAR
    for _ in range(12):
        motion = march(joint, now.state, 0.0, now.q, now.v, order * period)
        residual = _residual(now, motion, period)
        if not residual <= allowed:
            return None
        matrix = monodromy(joint, motion)
        if residual < tolerance:
            multipliers = np.sort(np.abs(np.linalg.eigvals(matrix)))[::-1]
            return Orbit(order, residual, multipliers, motion) if multipliers[0] < 1 else None
        allowed = 2 * max(residual, 1e-6)
        end = np.concatenate([motion.q, motion.v])
        now = now.moved(now.y + np.linalg.solve(np.eye(end.size) - matrix, end - now.y))
    return None
