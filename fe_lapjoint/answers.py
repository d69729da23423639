"""Modes, marches and the period map of a problem, computed with the options of a solver."""

from __future__ import annotations

from collections.abc import Iterator
from typing import Protocol

from fe_lapjoint.march.field import history_of
from fe_lapjoint.march.initial import initial_coordinates, initial_state
from fe_lapjoint.march.march import march, window_of
from fe_lapjoint.march.model import Model
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.eigenmodes import eigenmodes
from fe_lapjoint.modes.mesh import mesh_nodes
from fe_lapjoint.modes.shapes import ElementShapes
from fe_lapjoint.period_map import PeriodMap
from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solver import Progress

_WINDOWS = 16
"""Windows of the search for contacts in one stretch of a streamed motion; a stretch has some tens to hundreds of
contacts."""
_KNOTS = 32768
"""Limit of sample times (knots) of the forces in one stretch; the motion is kept at one knot of 64."""
_ROUNDINGS = 1e-12
"""A stretch that would end within this fraction of the duration before the end of the motion is the last one."""


class Options(Protocol):
    """The numerical options of `fe_lapjoint.Solver`, which says what each is."""

    @property
    def name(self) -> str: ...
    @property
    def elements(self) -> int: ...
    @property
    def nodes(self) -> tuple[float, ...] | None: ...
    @property
    def method(self) -> str: ...
    @property
    def rtol(self) -> float: ...
    @property
    def atol(self) -> float: ...


def modes(solver: Options, problem: Problem, state: ContactState, count: int) -> Modes:
    """The `count` lowest modes of a contact state; an InputError if the mesh has fewer degrees of freedom."""
    assembly = _assembly(solver, problem)
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= assembly.free.size:
        raise InputError(f"count = {count!r}: allowed are 1 to {assembly.free.size}, the modes of this mesh")
    omega, vectors = eigenmodes(assembly, state)
    return Modes(state, omega[:count], ElementShapes(assembly, vectors[:, :count]))


def simulate(solver: Options, problem: Problem, duration: float, progress: Progress | None) -> History:
    """The motion from the initial state to `duration`, s, with its contacts."""
    if problem.excitation_frequency is not None:
        return period_map(solver, problem).simulated(duration, progress)
    model = _model(solver, problem)
    state = initial_state(model)
    y = initial_coordinates(model.assembly, model.system(state))
    motion = march(model, state, y, 0.0, duration, progress=progress)
    return history_of(solver.name, model, [motion], duration)


def stream(solver: Options, problem: Problem, duration: float, progress: Progress | None) -> Iterator[History]:
    """The motion from the initial state to `duration`, s, stretch by stretch; see `lapjoint.solver.Streams.stream`."""
    if problem.excitation_frequency is not None:
        stretches = period_map(solver, problem).streamed(duration)
    else:
        stretches = _marched(solver, problem, duration)
    for stretch in stretches:
        yield stretch
        if progress is not None:
            progress(stretch.end, duration)


def _marched(solver: Options, problem: Problem, duration: float) -> Iterator[History]:
    """The stretches of a motion under loads without a common period."""
    model = _model(solver, problem)
    state = initial_state(model)
    y, t = initial_coordinates(model.assembly, model.system(state)), 0.0
    while t < duration:
        end = _stretch_end(model, t, duration)
        motion = march(model, state, y, t, end)
        yield history_of(solver.name, model, [motion], duration)
        state, y, t = motion.state, motion.y, end


def _stretch_end(model: Model, t: float, duration: float) -> float:
    """End, s, of the stretch that begins at `t`: some windows later, and with sampled forces at the last knot within
    them."""
    end = t + _WINDOWS * window_of(model, FREE)
    if model.problem.forces.ramps is not None:
        time = model.block_at(t)[0].time
        within = time[(time > t) & (time <= end)][:_KNOTS]
        end = float(within[-1]) if within.size else end
    return duration if end >= duration * (1 - _ROUNDINGS) else end


def period_map(solver: Options, problem: Problem) -> PeriodMap:
    """The period map of a problem whose excitation has a period, by the exact method."""
    return PeriodMap(_model(solver, problem), solver.name)


def _model(solver: Options, problem: Problem) -> Model:
    return Model(problem, _assembly(solver, problem), solver.method, solver.rtol, solver.atol)


def _assembly(solver: Options, problem: Problem) -> Assembly:
    return Assembly(problem, mesh_nodes(problem, solver.elements, solver.nodes))
