"""From a problem and the options of the OpenSees solver to modes, to a motion, and to the motion that remains."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import ContactState
from lapjoint.answers.steady_state import Outcome, SectionPoint, SteadyState, impulses_per_period, periodic_outcome
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.solver import Progress
from validation.peers.opensees_motion import along, history_of
from validation.peers.opensees_script import mesh
from validation.peers.process import in_another_process

SCRIPT = "validation.peers.opensees_script"
HINT = "pip install 'lapjoint[opensees]', and on Debian apt install libblas3 liblapack3"


def ask(question: str, *arguments: Any) -> Any:
    """The answer of a function of `opensees_script`, run in another process."""
    return in_another_process(f"{SCRIPT}:{question}", arguments, "OpenSees", HINT)


@dataclass(frozen=True)
class ElementShapes:
    """Mode shapes of the mesh; see `lapjoint.answers.ModeShapes`."""

    nodes: FloatArray
    """Positions, m, shape ``(n,)``."""
    vectors: FloatArray
    """Displacements and slopes of the nodes, kg^-1/2 and kg^-1/2 / m, shape ``(n, 2, modes)``."""

    def __call__(self, x: FloatArray, derivative: int = 0) -> FloatArray:
        """Shapes or their x-derivative, shape ``(modes, n)``; see `lapjoint.answers.ModeShapes`."""
        return along(self.nodes, self.vectors, np.asarray(x, dtype=float), derivative).T


class Options(Protocol):
    """The numerical options of `validation.peers.opensees.Solver`, which says what each is."""

    @property
    def name(self) -> str: ...
    @property
    def elements(self) -> int: ...
    @property
    def dt(self) -> float: ...
    @property
    def max_period_multiple(self) -> int: ...
    @property
    def max_periods(self) -> int: ...
    @property
    def repeats(self) -> float: ...


def modes(solver: Options, problem: Problem, state: ContactState, count: int) -> Modes:
    """The lowest `count` modes of a contact state: angular frequencies, rad/s, ascending, and mass-normalised shapes,
    kg^-1/2."""
    free = 2 * mesh(problem, solver.elements).size
    free -= sum(math.isinf(k) for s in problem.supports for k in (s.translational, s.torsional))
    if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= free:
        raise InputError(f"count = {count!r}: must be an integer from 1 to {free}, the degrees of freedom")
    nodes, omega, vectors = ask("eigen", problem, solver.elements, state, count)
    raw = ElementShapes(nodes, np.moveaxis(vectors, 0, -1))
    points, weights = _gauss(nodes)
    sizes = np.sqrt(problem.beam.m * (raw(points) ** 2 @ weights))
    return Modes(state, omega, ElementShapes(nodes, raw.vectors / sizes))


def simulate(solver: Options, problem: Problem, duration: float, progress: Progress | None) -> History:
    """The motion from rest over `duration` s; `progress` is called at the start and at the end with the time marched
    and the duration, s."""
    if progress is not None:
        progress(0.0, duration)
    history = history_of(problem, solver.name, ask("motion", problem, solver.elements, duration, solver.dt))
    if progress is not None:
        progress(duration, duration)
    return history


def steady_state(solver: Options, problem: Problem, progress: Progress | None) -> SteadyState:
    """The motion that remains, as far as a march can tell."""
    if progress is not None:
        progress(0.0, 1.0)
    options = (solver.elements, solver.dt, solver.repeats, solver.max_period_multiple, solver.max_periods)
    multiple, residual, record = ask("settled", problem, *options)
    history = history_of(problem, solver.name, record)
    coordinates = np.array([record.values[0].ravel(), record.rates[0].ravel()])
    if progress is not None:
        progress(1.0, 1.0)
    return SteadyState(
        problem=problem,
        solver=solver.name,
        outcome=periodic_outcome(history) if multiple else Outcome.UNDECIDED,
        period_multiple=multiple,
        symmetric=bool(multiple) and _mirrored(history, solver.repeats),
        residual=residual,
        multipliers=np.zeros(0, dtype=complex),
        exponent=None,
        section_point=SectionPoint(history.states[0], coordinates),
        history=history,
        impulses=impulses_per_period(history, multiple),
    )


def _mirrored(history: History, repeats: float) -> bool:
    """Whether half of the motion mirrors the other half, to ten times what it repeats to."""
    x, half = np.linspace(0.0, history.problem.beam.length, 9), (history.end - history.start) / 2
    t = np.linspace(history.start, history.start + half, 50)
    one, other = history.displacement(x, t), history.displacement(x, np.minimum(t + half, history.end))
    return bool(np.abs(one + other).max() <= 10 * repeats * np.abs(one).max())


def _gauss(nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights that integrate squares of cubics on every element."""
    x, w = np.polynomial.legendre.leggauss(4)
    half = np.diff(nodes)[:, None] / 2
    return (nodes[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()
