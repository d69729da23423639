"""The initial state in modal coordinates, and motions that start from section points.

The initial shape is data, a polynomial or a spline, not a solution of the beam equation, so its inner products with the
modes alone are taken by quadrature.  `analytic.march.touching` says which stops are closed at t = 0.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.equilibrium import start_of
from analytic.march.coordinates import Coordinates
from analytic.march.depths import depths
from analytic.march.joint import Joint
from analytic.march.oscillator import away_from_resonance, forced_answer
from analytic.march.quadrature import projected
from analytic.march.tables import BoolArray, FlatState, IntArray, Tables
from analytic.march.touching import starting_state
from analytic.modes.normal_modes import NormalModes
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.equilibrium import RestingStart
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.compiled.compiling import njit_called
from lapjoint.errors import InputError
from lapjoint.problem import AtRest, FloatArray, Problem

TOUCHING = 1e-9  # relative shortfall of a closed stop below its gap up to which it stays closed; rounding is 1e-13
_AS_IT_WAS, _ANOTHER, _NOT_FINITE = 0, 1, 2
"""Results of `_settle`: the gaps imply the given contact state, or another one; or coordinates are not finite."""


def initial_coordinates(problem: Problem, modes: NormalModes) -> tuple[FloatArray, FloatArray]:
    """Modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s, ``(N,)``, of the initial state."""
    count = modes.omega.size
    if isinstance(problem.initial, AtRest):
        return np.zeros(count), np.zeros(count)
    initial = start_of(problem)
    return projected(problem, modes, initial.displacement_at), projected(problem, modes, initial.velocity_at)


def started(joint: Joint) -> Coordinates:
    """The coordinates of the initial state, in the contact state at t = 0."""
    state, held = starting_state(joint)
    q, v = initial_coordinates(joint.problem, joint.modal(state).modes)
    return Coordinates(state, *joint.from_modes(state, _at_rest(joint, state, q), v, 0.0), held)


def _at_rest(joint: Joint, state: ContactState, q: FloatArray) -> FloatArray:
    """Modal displacements, kg^1/2 m, ``(N,)``: in a static equilibrium those that the constant loads hold, to the bit.

    Rigid-body modes, which no load holds, keep their own `q`.
    """
    start = start_of(joint.problem)
    if not isinstance(start, RestingStart) or not start.kept_in(state):
        return q
    flat = joint.flat(state)
    return np.where(flat.omega > 0, flat.static[:, 0] * joint.sizes[0], q)


def resumed(joint: Joint, state: ContactState, values: FloatArray) -> SectionPoint:
    """A section point of a joint that may have other numbers of modes and other gaps, as a section point of this joint.

    `values`, ``(2, n)``, has its modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s, in `state`.  Modes that it
    lacks follow the loads, as they do once free motion has died out; for a closed stop, the gap is a load.  Modes that
    it has too many are left out.  The contact state is the one that the gaps of this joint imply.  `InputError` is
    raised where a value is not finite.
    """
    if joint.damped:
        return _resumed_damped(joint, state, np.asarray(values, dtype=float))
    flat, tables = joint.flat(state), joint.tables
    begin, pressed = np.empty((2, flat.kind.size)), np.empty(flat.closed.size, dtype=np.bool_)
    status = _settle(
        flat,
        joint.sizes,
        tables.omega,
        tables.phase,
        tables.position,
        tables.sign,
        tables.gap,
        np.ascontiguousarray(values, dtype=float),
        begin,
        pressed,
        joint.side,
    )
    if status == _NOT_FINITE:
        raise InputError("start: has coordinates that are not finite")
    if status == _AS_IT_WAS:
        return SectionPoint(state, begin)
    there = ContactState(tuple(np.flatnonzero(pressed).tolist()))
    now = translated(joint, Coordinates(state, begin[0], begin[1]), there)
    return SectionPoint(there, np.array((now.q, now.v)))


def _resumed_damped(joint: Joint, state: ContactState, values: FloatArray) -> SectionPoint:
    """`resumed` where modes may be coupled; a closed damped stop presses where its force does not pull."""
    if not np.isfinite(values).all():
        raise InputError("start: has coordinates that are not finite")
    begin = values.copy() if values.shape[1] == joint.count(state) else _of_other_modes(joint, state, values)
    slot, stops = joint.slot(state), joint.loaded.problem.structure.stops  # `slot` may replace the tables
    if not joint.sampled and _as_it_was(joint.tables, slot, len(stops), *begin):
        return SectionPoint(state, begin)
    theta, omega, modal = joint.harmonics.theta(0.0), joint.harmonics.omega, joint.modal(state)
    q, v = joint.in_modes(state, begin[0], begin[1], 0.0)
    left_out = joint.left_out(state)
    z = modal.at_stops @ q + left_out[0] + np.sin(theta) @ left_out[1:]
    rate = modal.at_stops @ v + (omega * np.cos(theta)) @ left_out[1:]
    closed, released = [], []
    for k, stop in enumerate(stops):
        depth, near = stop.sign * z[k] - stop.gap, TOUCHING * abs(stop.gap)
        if depth > (-near if k in state else 0.0):
            closed.append(k)
            force = depth + stop.damping / stop.stiffness * stop.sign * rate[k]
            if stop.damping > 0 and not stop.may_pull and force < (near if k in state.released else -near):
                released.append(k)
    there = ContactState(tuple(closed), tuple(released))
    if there == state:
        return SectionPoint(state, begin)
    now = translated(joint, Coordinates(state, begin[0], begin[1]), there)
    return SectionPoint(there, np.array((now.q, now.v)))


def _of_other_modes(joint: Joint, state: ContactState, values: FloatArray) -> FloatArray:
    """Coordinates ``(2, N)`` in a state from those of more or fewer modes; modes that are lacking follow the loads."""
    slot, n, part = joint.slot(state), joint.count(state), values.shape[1]
    tables, waves, m = joint.tables, np.exp(1j * joint.harmonics.theta(0.0)), min(n, part)
    begin = np.array(
        [
            tables.static[slot, :n, 0] + (waves @ tables.harmonic[slot, :, :n]).imag,
            tables.static[slot, :n, 1] + ((1j * tables.omega * waves) @ tables.harmonic[slot, :, :n]).imag,
        ]
    )
    if joint.coupled(state) is None:
        begin[:, :m] = values[:, :m]
        return begin
    other = np.array(joint.in_modes(state, begin[0], begin[1], 0.0))  # oscillators of more or fewer modes are others
    other[:, :m] = np.array(joint.in_modes(state, values[0], values[1], 0.0, part))[:, :m]
    return np.array(joint.from_modes(state, other[0], other[1], 0.0))


@njit_called()
def _as_it_was(tables: Tables, slot: int, stops: int, q: FloatArray, v: FloatArray) -> bool:
    """Whether coordinates ``(N,)`` in a state of a joint with damped stops press what the state presses, at t = 0.

    The first `stops` rows of the tables are those of gaps; those of forces count while a force may end or begin.
    """
    depth = depths(tables, slot, 0.0, q, v)
    for row in range(depth.size):
        d, near, closed = depth[row], TOUCHING * abs(tables.gap[row]), tables.closed[slot, row]
        if row < stops:
            if d <= -near if closed else d > 0:
                return False
        elif not tables.asleep[slot, row] and (d < -near if closed else d >= near):
            return False
    return True


@njit_called()
def _settle(
    flat: FlatState,
    sizes: FloatArray,
    omega: FloatArray,
    phase: FloatArray,
    position: IntArray,
    sign: FloatArray,
    gap: FloatArray,
    values: FloatArray,
    begin: FloatArray,
    pressed: BoolArray,
    side: float,
) -> int:
    """Write a state's coordinates to `begin`, ``(2, N)``, and the stops that they press to `pressed`, ``(P,)``.

    `sizes`, ``(1 + H + R,)``, are the factors of the unit loads; `omega`, rad/s, and `phase`, rad, ``(H,)``, are those
    of the harmonics; `position`, `sign` and `gap`, ``(P,)``, are those of the stops, as in `Tables`.  `values`, ``(2,
    n)``, has modal displacements, kg^1/2 m, and velocities, kg^1/2 m/s, of as many modes as there are.  `side` is as in
    `analytic.march.oscillator.away_from_resonance`.  Returned is `_AS_IT_WAS`, `_ANOTHER` or `_NOT_FINITE`.
    """
    for row in range(2):
        for i in range(values.shape[1]):
            if not math.isfinite(values[row, i]):
                return _NOT_FINITE
        for i in range(min(begin.shape[1], values.shape[1])):
            begin[row, i] = values[row, i]
    for i in range(values.shape[1], begin.shape[1]):
        begin[0, i], begin[1, i] = flat.static[i, 0] * sizes[0], flat.static[i, 1] * sizes[0]
        rate = flat.damping_rate[i]
        natural = away_from_resonance(flat.omega[i], rate, omega, side)
        for h in range(phase.size):
            answer = forced_answer(flat.force[1 + h, i] * sizes[1 + h], natural, rate, omega[h])
            wave = answer * complex(math.cos(phase[h]), math.sin(phase[h]))
            begin[0, i] += wave.imag
            begin[1, i] += omega[h] * wave.real
    status = _AS_IT_WAS
    for k in range(sign.size):
        u = position[k]
        z = flat.residual[u, 0] * sizes[0]
        for h in range(phase.size):
            z += flat.residual[u, 1 + h] * sizes[1 + h] * math.sin(phase[h])
        for i in range(begin.shape[1]):
            z += flat.weight[u, i] * begin[0, i]
        pressed[k] = sign[k] * z > (gap[k] - TOUCHING * abs(gap[k]) if flat.closed[k] else gap[k])
        if pressed[k] != flat.closed[k]:
            status = _ANOTHER
    return status


def translated(joint: Joint, begin: Coordinates, state: ContactState) -> Coordinates:
    """The motion, at a multiple of the period, in the modes of `state`; the part outside the span of these modes is
    left out."""
    if state == begin.state:
        return begin
    return Coordinates(state, *carried_over(joint, begin.state, state, begin.q, begin.v))


def carried_over(
    joint: Joint, old: ContactState, new: ContactState, q: FloatArray, v: FloatArray
) -> tuple[FloatArray, FloatArray]:
    """Coordinates ``(..., n_old)`` in `old`, at a multiple of the period, in the modes of `new`, ``(..., n_new)``.

    `q`, kg^1/2 m, and `v`, kg^1/2 m/s, are the coordinates of one motion or of many.  The part of the motion outside
    the span of the modes of `new` is left out.
    """
    if joint.damped:
        whole, load = joint.whole_passage(old, new)
        y = np.concatenate([q, v], axis=-1) @ whole.T + load[0].real
        y = y + (np.exp(1j * joint.harmonics.theta(0.0)) @ load[1:]).imag
        return y[..., : joint.count(new)], y[..., joint.count(new) :]
    passage, theta, omega = joint.passage(old, new), joint.harmonics.theta(0.0), joint.harmonics.omega
    left_out = np.concatenate([[1.0], np.sin(theta)]) @ passage.residual
    moving = (omega * np.cos(theta)) @ passage.residual[1:]
    if q.ndim == 1:  # a product of a matrix and a vector, to the bits that it has always had
        return passage.S @ q + left_out, passage.S @ v + moving
    return q @ passage.S.T + left_out, v @ passage.S.T + moving
