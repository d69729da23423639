"""From a problem and a solver's options to modes, to a motion, and to the motion that remains."""

from __future__ import annotations

from typing import TYPE_CHECKING

from fe_lapjoint.certificate import certificate, read_section
from fe_lapjoint.march.field import history_of
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.march import march
from fe_lapjoint.march.model import Model
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes
from fe_lapjoint.modes.mesh import mesh_nodes
from fe_lapjoint.modes.shapes import ElementShapes
from fe_lapjoint.steady import find
from fe_lapjoint.turns import Point, Turns
from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import Section, SteadyState
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solver import Progress

if TYPE_CHECKING:
    from fe_lapjoint.solver import Solver


def modes(solver: Solver, problem: Problem, state: ContactState, count: int) -> Modes:
    """The lowest modes of a contact state."""
    assembly = _assembly(solver, problem)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= assembly.free.size:
        raise InputError(f"count = {count!r}: allowed are 1 to {assembly.free.size}, the modes of this mesh")
    omega, vectors = eigenmodes(assembly, state)
    return Modes(state, omega[:count], ElementShapes(assembly, vectors[:, :count]))


def simulate(solver: Solver, problem: Problem, duration: float, progress: Progress | None) -> History:
    """The motion from the initial state."""
    model, first = begin(solver, problem)
    motion = march(model, first.state, first.y, 0.0, duration, progress=progress)
    return history_of(solver.name, model, motion)


def steady_state(solver: Solver, problem: Problem, start: Section | None, progress: Progress | None) -> SteadyState:
    """The motion that remains; the excitation of `problem` has one frequency."""
    assert problem.excitation_frequency is not None
    model, first = begin(solver, problem)
    turns = Turns(model, problem.excitation_frequency)
    near = start is not None and start.coordinates.shape == (2, first.y.size // 2)
    if start is not None and near:
        first = turns.settled(read_section(model, start))
    found = find(turns, first, near=near, max_order=solver.max_order, max_periods=solver.max_periods, progress=progress)
    return certificate(solver.name, turns, found, solver.max_order)


def _assembly(solver: Solver, problem: Problem) -> Assembly:
    return Assembly(problem, mesh_nodes(problem, solver.elements, solver.nodes))


def begin(solver: Solver, problem: Problem) -> tuple[Model, Point]:
    """The model of a problem, and its initial state."""
    assembly = _assembly(solver, problem)
    model = Model(problem, assembly, solver.method, solver.rtol, solver.atol)
    state = initial_state(assembly)
    return model, Point(state, initial_coordinates(assembly, model.system(state)))
