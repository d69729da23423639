"""OpenSees as a third solver: numerical options, and the three questions that it answers.

OpenSees knows neither gaps, nor contacts, nor this package: it marches the beam at a fixed step with Newmark's method,
and contacts are read off its record.  It has global state and may abort its process, so it always runs in another
process.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from lapjoint.answers import History, Modes
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.steady_state import Outcome, SectionPoint, SteadyState, impulses_per_period, periodic_outcome
from lapjoint.errors import InputError
from lapjoint.problem import AtRest, FloatArray, ModalDamping, Problem
from lapjoint.problem.problem import require_one_beam
from lapjoint.solver import MODES, Progress
from validation.peers.opensees_motion import along, history_of
from validation.peers.opensees_script import mesh
from validation.peers.process import in_another_process

SCRIPT = "validation.peers.opensees_script"
HINT = "pip install 'lapjoint[opensees]', and on Debian apt install libblas3 liblapack3"
MOST_ELEMENTS = 400
"""Largest number of elements: 80 of them with dt = 1e-6 s take 418 s of wall time for a second of motion."""
MOST_STEPS = 1_000_000  # Most steps of a march or an excitation period: each is recorded at every node


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


@dataclass(frozen=True)
class Solver:
    """OpenSees: elasticBeamColumn with consistent mass, gap springs, Newmark's average acceleration at a fixed step."""

    elements: int = 40
    """About how many elements over the beam; every support and stop gets a node besides."""
    dt: float = 4e-6
    """Time step, s; shortened a little so that the duration, or the excitation period, is a multiple of it."""
    repeats: float = 1e-6
    """A steady state is reached when displacements, velocities and impulses return to this fraction of their size."""
    max_period_multiple: int = 8
    """Longest periodic motion sought, in excitation periods."""
    max_periods: int = 500
    """Most excitation periods marched in search of a steady state."""

    def __post_init__(self) -> None:
        for field, most in (("elements", MOST_ELEMENTS), ("max_period_multiple", 100), ("max_periods", 10**5)):
            value = getattr(self, field)
            if isinstance(value, bool) or not isinstance(value, int) or not 1 <= value <= most:
                raise InputError(f"{field} = {value!r}: must be an integer from 1 to {most}")
        for field in ("dt", "repeats"):
            value = getattr(self, field)
            if not 0 < value < 1:
                raise InputError(f"{field} = {value!r}: must lie between 0 and 1")

    @property
    def name(self) -> str:
        """Name and options in a line."""
        return f"OpenSees ({self.elements} elements, dt = {self.dt:g} s)"

    def refined(self, factor: float) -> Solver:
        """This solver with `factor` times the elements and a time step shorter by `factor`.  See
        `lapjoint.solver.Solver.refined`."""
        return replace(self, elements=max(1, math.ceil(self.elements * factor)), dt=self.dt / factor)

    def modes(self, problem: Problem, state: ContactState = FREE, count: int = MODES) -> Modes:
        """The lowest `count` modes of a contact state by OpenSees' dense eigensolver.  See
        `lapjoint.solver.Solver.modes`."""
        check_beam(problem)
        free = 2 * mesh(problem, self.elements).size
        free -= sum(math.isinf(k) for s in problem.structure.supports for k in (s.translational, s.torsional))
        if isinstance(count, bool) or not isinstance(count, int) or not 1 <= count <= free:
            raise InputError(f"count = {count!r}: must be an integer from 1 to {free}, the degrees of freedom")
        nodes, omega, vectors = ask("eigen", problem, self.elements, state, count)
        raw = ElementShapes(nodes, np.moveaxis(vectors, 0, -1))
        points, weights = _gauss(nodes)
        sizes = np.sqrt(problem.line.m * (raw(points) ** 2 @ weights))
        return Modes(state, omega, ElementShapes(nodes, raw.vectors / sizes))

    def simulate(
        self, problem: Problem, duration: float, *, errors: bool = True, progress: Progress | None = None
    ) -> History:
        """The motion from rest over `duration` s.  No errors are estimated and `errors` is not used.  See
        `lapjoint.solver.Solver.simulate`."""
        if not (math.isfinite(duration) and duration > 0):
            raise InputError(f"duration = {duration!r}: must be positive and finite, in s")
        check_problem(problem)
        if duration / self.dt > MOST_STEPS:
            raise InputError(f"dt = {self.dt!r}: {duration:g} s would take more than {MOST_STEPS} steps")
        duration = float(duration)
        if progress is not None:
            progress(0.0, duration)
        history = history_of(problem, self.name, ask("motion", problem, self.elements, duration, self.dt))
        if progress is not None:
            progress(duration, duration)
        return history

    def steady_state(
        self,
        problem: Problem,
        *,
        start: SectionPoint | None = None,
        sensitivity: bool = True,
        errors: bool = True,
        progress: Progress | None = None,
    ) -> SteadyState:
        """The first motion of a march from rest that comes back to itself, to within `repeats`, without multipliers and
        errors; `start`, `sensitivity` and `errors` go unused.  See `lapjoint.solver.Solver.steady_state`."""
        period = problem.require_excitation_period("steady state")
        check_problem(problem)
        if period / self.dt > MOST_STEPS:
            raise InputError(f"dt = {self.dt!r}: an excitation period would take more than {MOST_STEPS} steps")
        if progress is not None:
            progress(0.0, 1.0)
        options = (self.elements, self.dt, self.repeats, self.max_period_multiple, self.max_periods)
        multiple, residual, record = ask("settled", problem, *options)
        history = history_of(problem, self.name, record)
        coordinates = np.array([record.values[0].ravel(), record.rates[0].ravel()])
        if progress is not None:
            progress(1.0, 1.0)
        return SteadyState(
            problem=problem,
            solver=self.name,
            outcome=periodic_outcome(history) if multiple else Outcome.UNDECIDED,
            period_multiple=multiple,
            symmetric=bool(multiple) and _mirrored(history, self.repeats),
            residual=residual,
            multipliers=np.zeros(0, dtype=complex),
            exponent=None,
            section_point=SectionPoint(history.states[0], coordinates),
            history=history,
            impulses=impulses_per_period(history, multiple),
        )


def check_beam(problem: Problem) -> None:
    """Refuse what modes OpenSees is not asked for: of several beams, and of one with masses, or with steps."""
    require_one_beam(problem, "the OpenSees solver works")
    if problem.structure.masses:
        raise InputError("masses: the OpenSees solver knows beams without masses only")
    if len({(piece.EI, piece.inertia) for piece in problem.line.pieces}) > 1:
        raise InputError("beam.segments: the OpenSees solver knows beams of one stiffness and mass only")


def check_problem(problem: Problem) -> None:
    """Refuse a problem that OpenSees cannot express, or that it starts wrongly, as it begins with zero acceleration."""
    check_beam(problem)
    for name, loads in (("gravity", problem.gravity), ("uniform_loads", problem.uniform_loads)):
        if loads:
            raise InputError(f"{name}: the OpenSees solver knows base motion only")
    if isinstance(problem.damping, ModalDamping):
        raise InputError('damping.kind = "modal": OpenSees has it for one state only; allowed are "viscous" and "none"')
    if problem.point_loads:
        raise InputError("point_loads: the OpenSees solver knows base motion only")
    if not isinstance(problem.initial, AtRest):
        raise InputError(f'initial.kind = "{problem.initial.kind}": the OpenSees solver starts at rest only')
    for what, parts in (("a record", problem.records), ("random", problem.random)):
        if parts:
            raise InputError(f"{next(iter(parts))}: is {what}; the OpenSees solver knows sums of sines only")
    for i, stop in enumerate(problem.structure.stops):
        if stop.in_space:
            raise InputError(
                f'stops[{i}].fixed_to = "space": the OpenSees solver knows stops that move with the base only'
            )
        if stop.gap < 0:
            raise InputError(
                f"stops[{i}].gap = {stop.gap:g}: must be 0 or more, as OpenSees starts without acceleration"
            )
    base = problem.base_motion
    for i, wave in enumerate(() if base is None else base.waves):
        if base is not None and wave.phase:
            path = "base_motion" if base.kind == "sine" else f"base_motion.harmonics[{i}]"
            raise InputError(f"{path}.phase = {wave.phase:g}: must be 0, as OpenSees starts without acceleration")


def _mirrored(history: History, repeats: float) -> bool:
    """Whether half of the motion mirrors the other half, to ten times the tolerance of repetition."""
    x, half = np.linspace(0.0, history.problem.line.length, 9), (history.end - history.start) / 2
    t = np.linspace(history.start, history.start + half, 50)
    one, other = history.displacement(x, t), history.displacement(x, np.minimum(t + half, history.end))
    return bool(np.abs(one + other).max() <= 10 * repeats * np.abs(one).max())


def _gauss(nodes: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Gauss points and weights that integrate squares of cubics on every element."""
    x, w = np.polynomial.legendre.leggauss(4)
    half = np.diff(nodes)[:, None] / 2
    return (nodes[:-1, None] + half * (1 + x)).ravel(), (half * w).ravel()
