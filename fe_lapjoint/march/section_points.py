"""Section points on a mesh, which hold displacements and slopes of the nodes and their rates, and modal coordinates."""

from __future__ import annotations

import numpy as np

from fe_lapjoint.march.model import Model
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem


def section_point(model: Model, state: ContactState, y: FloatArray) -> SectionPoint:
    """The section point of (q, q') in the modes of a contact state, kg^1/2 m and kg^1/2 m/s, shape ``(2 n,)``."""
    assembly = model.assembly
    return SectionPoint(state, assembly.full(y.reshape(2, -1) @ model.system(state).vectors.T), assembly.nodes)


def coordinates_of(model: Model, point: SectionPoint) -> FloatArray:
    """(q, q') of a section point on this mesh in the modes of its contact state, kg^1/2 m and kg^1/2 m/s, ``(2 n,)``.

    A section point of another mesh, or of a joint with other stops, gives an InputError.
    """
    assembly = model.assembly
    if not np.array_equal(understood(model.problem, point), assembly.nodes):
        raise InputError("start: is a section point of another mesh; `adopted` gives one of this mesh")
    free = point.coordinates[:, assembly.free]
    return np.asarray((free @ model.weighted(point.state)).ravel())


def understood(problem: Problem, point: SectionPoint) -> FloatArray:
    """The nodes of a section point on any mesh, m; an InputError if it is not valid, or if the problem lacks its
    stops."""
    coordinates, nodes = np.asarray(point.coordinates), point.nodes
    if nodes is None or nodes.ndim != 1 or coordinates.shape != (2, 2 * nodes.size):
        raise InputError("start: is no section point of a finite element solver")
    foreign = [k for k in point.state.closed if not 0 <= k < len(problem.structure.stops)]
    if foreign:
        most = len(problem.structure.stops)
        raise InputError(f"start: has stop {foreign[0] + 1} closed; allowed are the stops of the problem, 1 to {most}")
    if not (np.isfinite(coordinates).all() and np.isfinite(nodes).all()):
        raise InputError("start: has coordinates that are not finite")
    if nodes.size < 2 or nodes[0] != 0.0 or np.any(np.diff(nodes) <= 0):
        raise InputError("start: has nodes that do not ascend from 0")
    return nodes
