"""The initial state on the mesh: nodal values and slopes of z(x, 0) and z_t(x, 0), and the stops closed then."""

from __future__ import annotations

import numpy as np

from fe_lapjoint.march.system import System
from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray


def initial_state(assembly: Assembly) -> ContactState:
    """The stops that are pressed at t = 0, or touched by a beam that moves against them.

    Parameters
    ----------
    assembly : Assembly
        The problem on a mesh.

    Returns
    -------
    ContactState
        The stops that are closed.
    """
    problem, closed = assembly.problem, []
    for k, stop in enumerate(problem.stops):
        at = np.array(stop.x)
        z, speed = (float(f(at)) * stop.sign for f in (problem.initial.displacement_at, problem.initial.velocity_at))
        if z > stop.gap or (z == stop.gap and stop.gap > 0 and speed > 0):
            closed.append(k)
    return ContactState(tuple(closed))


def initial_coordinates(assembly: Assembly, system: System) -> FloatArray:
    """The initial state in modal coordinates, by Hermite interpolation on the mesh.

    Parameters
    ----------
    assembly : Assembly
        The problem on a mesh.
    system : System
        The contact state at t = 0, with ``n`` modes.

    Returns
    -------
    FloatArray, shape (2 n,)
        (q, q') at t = 0, kg^1/2 m and kg^1/2 m/s.
    """
    initial, L = assembly.problem.initial, assembly.problem.beam.length
    parts = []
    for shape in (initial.displacement_at, initial.velocity_at):
        u = np.stack([shape(assembly.nodes), L * shape(assembly.nodes, 1)], axis=1).ravel()[assembly.free]
        parts.append(system.vectors.T @ (assembly.mass @ u))
    return np.concatenate(parts)
