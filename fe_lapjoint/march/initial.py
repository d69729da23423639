r"""The initial state on the mesh: nodal values and slopes of z(x, 0) and z_t(x, 0), and the stops closed then.

Where the beam is at a stop, the gap function h(t) begins with the first of its time derivatives that is not 0, and the
sign of this derivative says whether the stop is closed.  On the mesh, from displacements u and velocities u',

    M u'' = f - K u - C u',    M u''' = f' - K u' - C u'',    M u'''' = f'' - K u'' - C u''', ...

in the modes of the contact state.  K u of the initial shape is taken from its curvature, which a rigid-body
displacement does not have: differences of nodal values would leave their rounding error times a frequency squared.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from fe_lapjoint.equilibrium import start_of
from fe_lapjoint.march.coupled import Coupled
from fe_lapjoint.march.coupled_modes import acting
from fe_lapjoint.march.model import Model
from fe_lapjoint.march.system import System
from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.equilibrium import RestingStart
from lapjoint.problem import FloatArray

ShapeFunction = Callable[..., FloatArray]
_ORDERS = 6
"""Number of time derivatives of a gap function that are examined, from the velocity on.

On a beam at rest, a force that begins with its fourth derivative appears in the sixth derivative of the gap.
"""
_DIGITS_LOST = 64 * float(np.finfo(float).eps)
"""Bound on the rounding error of a sum of some hundred addends, relative to the sum of their moduli."""


def initial_state(model: Model) -> ContactState:
    """The stops that are pressed at t = 0, or that the beam touches at t = 0 and then presses.

    A stop is open if the beam touches it and no derivative examined differs from 0.
    """
    initial, stops = start_of(model.problem), model.problem.structure.stops
    base, of_base = _base_motion(model, 0)
    z = np.array([it.seen(initial.displacement_at) for it in stops]) + base
    gaps = model.sign * z - model.gap
    size = float(np.abs(initial.displacement_at(model.assembly.nodes)).max())
    pressing = {k for k in range(len(stops)) if isinstance(initial, RestingStart) and initial.pressed(k)}
    undecided = {k for k in range(len(stops)) if abs(gaps[k]) <= _DIGITS_LOST * size + of_base[k]} - pressing
    closed = tuple(k for k in range(len(stops)) if k in pressing or (k not in undecided and gaps[k] > 0))
    state = _with_released(model, ContactState(closed))
    for order in range(1, _ORDERS + 1):
        if not undecided:
            break
        rate, error = _derivative(model, state, order)
        known = {k for k in undecided if abs(rate[k]) > error[k]}
        pressed = tuple(k for k in known if model.sign[k] * rate[k] > 0)
        undecided, state = undecided - known, _with_released(model, ContactState(state.closed + pressed))
    return state


def _with_released(model: Model, state: ContactState) -> ContactState:
    """The state with the damped stops released that would pull at t = 0, although they may not."""
    released = []
    for k in model.damped:
        stop, depth, rate = model.problem.structure.stops[k], *_depth_and_rate(model, k)
        if k in state and not stop.may_pull and stop.stiffness * depth + stop.damping * rate < 0:
            released.append(k)
    return ContactState(state.closed, tuple(released))


def _depth_and_rate(model: Model, k: int) -> tuple[float, float]:
    """How far the beam is beyond the gap of a stop at t = 0, m, and how fast it goes there, m/s."""
    initial, stop = start_of(model.problem), model.problem.structure.stops[k]
    shapes = initial.displacement_at, initial.velocity_at
    z, rate = (float(stop.seen(shape) + _base_motion(model, n)[0][k]) for n, shape in enumerate(shapes))
    return stop.sign * z - stop.gap, stop.sign * rate


def _derivative(model: Model, state: ContactState, order: int) -> tuple[FloatArray, FloatArray]:
    """The time derivative of an order of what the gaps of the stops see at t = 0, and its rounding error, m/s^order,
    ``(P,)`` each."""
    initial, system, (base, of_base) = start_of(model.problem), model.system(state), _base_motion(model, order)
    if order == 1:
        rate = [stop.seen(initial.velocity_at) for stop in model.problem.structure.stops]
        fastest = float(np.abs(initial.velocity_at(model.assembly.nodes)).max())
        return np.array(rate) + base, _DIGITS_LOST * fastest + of_base
    v = initial_coordinates(model.assembly, system)[system.omega.size :]
    x, of_x = np.zeros_like(v), np.zeros_like(v)  # 0: `_elastic_forces` replaces K u and K u'
    v, of_v = _cleared(v, np.full_like(v, _DIGITS_LOST * float(np.linalg.norm(v))))
    with np.errstate(over="ignore", invalid="ignore"):  # comparisons with infinity or NaN decide nothing
        for n in range(order - 1):
            pull, of_pull = system.omega**2 * x, system.omega**2 * of_x
            if n < 2:
                shape = initial.displacement_at if n == 0 else initial.velocity_at
                pull, of_pull = _elastic_forces(model.assembly, system, shape)
            push, of_push = _forces(system, n)
            drag, of_drag = system.drag(v[:, None])[:, 0], 2 * system.damping_rate * of_v
            if isinstance(system, Coupled):
                of_drag = np.abs(system.D) @ of_v
            error = of_push + of_pull + of_drag + _DIGITS_LOST * (np.abs(pull) + np.abs(drag))
            (x, of_x), (v, of_v) = (v, of_v), _cleared(push - pull - drag, error)
        reading = np.abs(system.stops)
        return system.stops @ v + base, reading @ of_v + _DIGITS_LOST * (reading @ np.abs(v)) + of_base


def _base_motion(model: Model, order: int) -> tuple[FloatArray, FloatArray]:
    """A time derivative of y at t = 0 as each stop's gap sees it, and its rounding error, m/s^order, ``(P,)`` each."""
    shares = np.array([stop.base_share for stop in model.problem.structure.stops])
    sizes = [(wave.amplitude * wave.angular_frequency**order, wave.phase) for wave in model.problem.moved_stops]
    total = sum(size * (1j**order * np.exp(1j * phase)).imag for size, phase in sizes)
    if model.problem.forces.seen is not None and model.problem.forces.ramps is not None and order < 4:
        y = float(model.problem.forces.ramps.base_at(np.zeros(1))[order, 0])
        total, sizes = total + y, [*sizes, (abs(y), 0.0)]
    return shares * total, np.abs(shares) * _DIGITS_LOST * sum(size * (1 + abs(phase)) for size, phase in sizes)


def _cleared(values: FloatArray, errors: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The values and their errors; zeros in place of both where no value exceeds its error."""
    return (values, errors) if np.any(np.abs(values) > errors) else (np.zeros_like(values), np.zeros_like(errors))


def _forces(system: System, order: int) -> tuple[FloatArray, FloatArray]:
    """A time derivative of the modal forces at t = 0, and its rounding error, kg^1/2 m/s^(2 + order), ``(n,)`` each."""
    power = system.driven**order
    total = (system.loads @ (power * 1j**order * np.exp(1j * system.phase))).imag
    size = np.abs(system.loads).max(axis=0, initial=0.0) @ (power * (1 + np.abs(system.phase)))
    parts = [system.constant] if order == 0 else []
    if system.ramps is not None:
        parts.append(system.ramps.at(np.zeros(1), order)[:, 0])
    for part in parts:
        total, size = total + part, size + np.abs(part).max()
    return _cleared(total, np.full_like(total, _DIGITS_LOST * size))


def _elastic_forces(assembly: Assembly, system: System, shape: ShapeFunction) -> tuple[FloatArray, FloatArray]:
    """K u of a shape of the beam in modal coordinates, and its rounding error, kg^1/2/s2 times the unit of the
    shape."""
    x, weight = assembly.strain_points
    bent = weight * shape(x, 2)
    rows, k = assembly.springs(acting(system.state))
    at_nodes = _nodal(assembly, shape)
    strained, loaded = assembly.curvature @ system.vectors, k[:, None] * (rows @ system.vectors)
    felt = rows @ at_nodes
    total = strained.T @ bent + loaded.T @ felt
    size = np.abs(strained).T @ np.abs(bent) + np.abs(loaded).T @ np.abs(felt)
    return _cleared(total, _DIGITS_LOST * size)


def initial_coordinates(assembly: Assembly, system: System) -> FloatArray:
    """(q, q') at t = 0 by Hermite interpolation on the mesh, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    initial = start_of(assembly.problem)
    shapes = initial.displacement_at, initial.velocity_at
    q, v = (system.vectors.T @ (assembly.mass @ _nodal(assembly, shape)) for shape in shapes)
    if isinstance(initial, RestingStart) and initial.kept_in(system.state):
        held = system.omega > 0  # these modes rest where the constant loads hold them, to the bit
        q[held] = system.constant[held] / system.omega[held] ** 2
    return np.concatenate([q, v])


def _nodal(assembly: Assembly, shape: ShapeFunction) -> FloatArray:
    """The free degrees of freedom of a shape, by Hermite interpolation, in the unit of the shape, ``(n,)``."""
    L = assembly.problem.line.length
    return np.stack([shape(assembly.nodes), L * shape(assembly.nodes, 1)], axis=1).ravel()[assembly.free]
