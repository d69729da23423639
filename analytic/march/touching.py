r"""Which stops are closed at t = 0, also where the beam touches a stop and derivatives of the gap function vanish.

A stop beyond its gap is closed.  Where the beam is at the gap, the first time derivative of the gap function that is
not 0 decides: if it is positive, the stop is closed from t = 0 on; if it is negative, the beam departs and the stop is
open; if all vanish, the beam rests at the gap and the stop is open.  The initial state gives displacement and velocity.
The higher derivatives are sums over the modes, by the equation of motion:

    q_i''      = F_i     - a(Phi_i, z)  - 2 zeta_i omega_i q_i'
    q_i'''     = F_i'    - a(Phi_i, z') - 2 zeta_i omega_i q_i''
    q_i^(n+2)  = F_i^(n) - omega_i^2 q_i^(n) - 2 zeta_i omega_i q_i^(n+1),    n > 1,

where a(Phi_i, z) is the elastic energy that a mode and the initial shape have in common.  It equals omega_i^2 q_i, and
is free of rounding where the beam is displaced as a rigid body.  A derivative that is below its rounding error counts
as 0.  A stop that one order closes drives the higher ones by its spring, so the contact state follows from order to
order.

The modes that are left out follow the loads at once here, but not in truth at t = 0: within a period of the fastest
mode they may take the beam to the wrong side of a stop.  For that period a stop is held if the second or a higher
derivative decides.
"""

from __future__ import annotations

import math

import numpy as np

from analytic.equilibrium import start_of
from analytic.march.joint import Joint
from analytic.march.quadrature import mass_weighted, over_beam
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.equilibrium import RestingStart
from lapjoint.problem import FloatArray, Problem

HIGHEST = 6
"""Highest order of a derivative that is looked at: a force that begins with t^4 moves a beam at rest in this order."""
_ROUNDING = 64 * float(np.finfo(float).eps)
"""Rounding error of a sum of some hundred terms, relative to the sum of their moduli."""
Rounded = tuple[FloatArray, FloatArray]
"""Values with their rounding errors, of the same shape and unit."""
_NOTHING: Rounded = np.zeros(1), np.zeros(1)


def starting_state(joint: Joint) -> tuple[ContactState, tuple[int, ...]]:
    """The contact state at t = 0, and the stops that a beam at rest touches then and presses, or departs from.

    Of the stops touched, closed or open, the second or a higher derivative decides.
    """
    problem = joint.problem
    closed, touching = by_displacement_and_velocity(problem)
    held: list[int] = []
    order = 2
    while touching and order <= HIGHEST:
        value, error = _derivative(joint, ContactState(tuple(closed)), order)
        decided = [k for k in touching if abs(value[k]) > error[k]]
        closed += [k for k in decided if problem.structure.stops[k].sign * value[k] > 0]
        held += decided
        touching = [k for k in touching if k not in decided]
        order += 1
    return ContactState(tuple(closed), _pulling(problem, closed)), tuple(held)


def _pulling(problem: Problem, closed: list[int]) -> tuple[int, ...]:
    """The closed damped stops whose spring and damper would pull at t = 0, although they may not."""
    found, initial, (base, _), (speed, _) = [], start_of(problem), base_motion(problem, 0), base_motion(problem, 1)
    for k in closed:
        stop = problem.structure.stops[k]
        depth = stop.sign * (stop.seen(initial.displacement_at) + stop.base_share * base) - stop.gap
        rate = stop.sign * (stop.seen(initial.velocity_at) + stop.base_share * speed)
        if stop.damping > 0 and not stop.may_pull and stop.stiffness * depth + stop.damping * rate < 0:
            found.append(k)
    return tuple(found)


def by_displacement_and_velocity(problem: Problem) -> tuple[list[int], list[int]]:
    """The stops that the initial state closes, and the undecided ones, at whose gap the beam is at rest."""
    closed, touching, initial = [], [], start_of(problem)
    along = problem.line.grid(65)
    far, fast = (float(np.abs(shape(along)).max()) for shape in (initial.displacement_at, initial.velocity_at))
    (base, of_base), (speed, of_speed) = (base_motion(problem, order) for order in (0, 1))
    for k, stop in enumerate(problem.structure.stops):
        seen = abs(stop.base_share)
        depth = stop.sign * (stop.seen(initial.displacement_at) + stop.base_share * base) - stop.gap
        rate = stop.sign * (stop.seen(initial.velocity_at) + stop.base_share * speed)
        at_gap = abs(depth) <= _ROUNDING * far + seen * of_base
        if isinstance(initial, RestingStart) and initial.pressed(k):
            closed.append(k)
        elif at_gap and abs(rate) <= _ROUNDING * fast + seen * of_speed:
            touching.append(k)
        elif rate > 0 if at_gap else depth > 0:
            closed.append(k)
    return closed, touching


def base_motion(problem: Problem, order: int) -> tuple[float, float]:
    """A time derivative of the base that stops fixed in space see at t = 0, and its rounding error, m/s^order."""
    value = error = 0.0
    for wave in problem.moved_stops:
        size = wave.amplitude * wave.angular_frequency**order
        value += (
            size * (math.sin(wave.phase), math.cos(wave.phase), -math.sin(wave.phase), -math.cos(wave.phase))[order % 4]
        )
        error += _ROUNDING * size * abs(wave.phase)
    blocks = problem.forces.ramps
    if blocks is not None and blocks.base is not None and order < 4:
        value = float(blocks.base_at(np.zeros(1))[order, 0])
        error = _ROUNDING * abs(value)
    return value, error


def _derivative(joint: Joint, state: ContactState, order: int) -> Rounded:
    """A time derivative of what the gaps of the stops see at t = 0, of order 2 or higher, m/s^order, ``(P,)``."""
    modal = joint.modal(state)
    square, it = modal.modes.omega**2, joint.coupled(state)
    known = [_NOTHING, _velocities(joint, state)]  # of each order; q itself is not needed
    with np.errstate(over="ignore", invalid="ignore"):  # a value that is not finite decides nothing
        for n in range(order - 1):
            elastic = _elastic(joint, state, n) if n < 2 else _times(square, known[n])
            v = known[n + 1]
            drag = _times(2 * modal.damping_rate, v) if it is None else _product(it.D, v)
            known.append(_difference(_force(joint, state, n), elastic, drag))
        value, error = known[order]
        shapes, seen = modal.at_stops, np.array([stop.base_share for stop in joint.problem.structure.stops])
        base, of_base = base_motion(joint.problem, order)
        return shapes @ value + seen * base, np.abs(shapes) @ (error + _ROUNDING * np.abs(value)) + seen * of_base


def _times(factor: FloatArray, one: Rounded) -> Rounded:
    """A rounded product."""
    value = factor * one[0]
    return value, factor * one[1] + _ROUNDING * np.abs(value)


def _product(matrix: FloatArray, one: Rounded) -> Rounded:
    """A rounded product with a matrix."""
    value, size = matrix @ one[0], np.abs(matrix)
    return value, size @ one[1] + _ROUNDING * (size @ np.abs(one[0]))


def _difference(first: Rounded, *others: Rounded) -> Rounded:
    """Values less other values, 0 where the rest is below its rounding error."""
    value, error = first[0].copy(), first[1].copy()
    for other in others:
        value -= other[0]
        error += other[1]
    return _or_nothing(value, error)


def _or_nothing(value: FloatArray, error: FloatArray) -> Rounded:
    """Values with their errors, or exactly 0 where all of them are below their errors."""
    return (value, error) if np.any(np.abs(value) > error) else (np.zeros_like(value), np.zeros_like(error))


def _force(joint: Joint, state: ContactState, n: int) -> Rounded:
    """A time derivative of the modal forces at t = 0, kg^1/2 m/s^(2 + n), shape ``(N,)``."""
    loads, harmonics = joint.modal(state).force * joint.sizes[:, None], joint.harmonics
    turned = (np.sin, np.cos, lambda angle: -np.sin(angle), lambda angle: -np.cos(angle))[n % 4]
    power = harmonics.omega**n
    factor = [np.array([float(n == 0)]), power * turned(harmonics.phase)]
    largest = [factor[0], power * (1 + np.abs(harmonics.phase))]
    if joint.sampled:
        blocks = joint.problem.forces.ramps
        assert blocks is not None
        ramps = blocks.at(np.zeros(1))[n][0] if n < 2 else np.zeros(len(blocks.forces))
        base = [] if blocks.base is None else [base_motion(joint.problem, n)[0]]
        factor += [ramps, np.array(base)]
        largest += [np.abs(part) for part in factor[-2:]]
    size = np.concatenate(largest) @ np.abs(loads).max(axis=1, initial=0.0)
    return _or_nothing(np.concatenate(factor) @ loads, np.full(loads.shape[1], _ROUNDING * size))


def _velocities(joint: Joint, state: ContactState) -> Rounded:
    """Modal velocities at t = 0, kg^1/2 m/s, shape ``(N,)``."""
    problem, modes = joint.problem, joint.modal(state).modes
    return _summed(mass_weighted(problem, modes, start_of(problem).velocity_at))


def _elastic(joint: Joint, state: ContactState, n: int) -> Rounded:
    """a(Phi_i, z) of the initial displacement, or of the velocity where `n` is 1, kg^1/2 m/s^(2 + n), ``(N,)``."""
    problem, modes = joint.problem, joint.modal(state).modes
    initial = start_of(problem)
    shape = (initial.displacement_at, initial.velocity_at)[n]
    x, weights = over_beam(problem, modes)
    springs = [(it.x, 0, it.translational) for it in problem.structure.supports]
    springs += [(it.x, 1, it.torsional) for it in problem.structure.supports]
    pairs: list[tuple[tuple[tuple[float, float], ...], int, float]] = [
        (((it.first, -1.0), (it.second, 1.0)), 0, it.translational) for it in problem.structure.links
    ]
    pairs += [(((it.first, -1.0), (it.second, 1.0)), 1, it.torsional) for it in problem.structure.links]
    pairs += [(stop.reading, 0, stop.stiffness) for stop in (problem.structure.stops[k] for k in state.closed)]
    parts = [(problem.line.EI_at(x) * modes.shapes(x, 2) * weights, shape(x, 2))]
    for place, derivative, stiffness in springs:
        if 0 < stiffness < math.inf:
            at = np.array([place])
            parts.append((stiffness * modes.shapes(at, derivative), shape(at, derivative)))
    for reading, derivative, stiffness in pairs:
        if 0 < stiffness < math.inf:
            at, factors = np.array([x for x, _ in reading]), np.array([factor for _, factor in reading])
            moved = modes.shapes(at, derivative) @ factors
            parts.append((stiffness * moved[:, None], np.array([shape(at, derivative) @ factors])))
    return _summed(parts)


def _summed(parts: list[tuple[FloatArray, FloatArray]]) -> Rounded:
    """The sum of products of arrays, ``(N, points)`` and ``(points,)`` each."""
    total, size = (
        np.sum([one @ other for one, other in each], axis=0)
        for each in (parts, [(np.abs(one), np.abs(other)) for one, other in parts])
    )
    return _or_nothing(total, _ROUNDING * size)
