"""Problems of one's own under each kind of excitation, quick to solve, and their reports by coarse solvers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from functools import cache
from pathlib import Path
from typing import Any

import numpy as np
from small_joints import SHAKEN

from lapjoint import BaseMotion, Beam, Gravity, Mass, Material, Problem, Rectangle, StepLoad, Stop, UniformLoad
from lapjoint.problem import RecordBaseMotion
from lapjoint.problem.presets import lap_joint
from lapjoint.solver import make_solver
from validation.case import CaseResult
from validation.cases import own_problem
from validation.cases.own_problem import contacts_table
from validation.cases.transient import motion_drawing
from validation.report.write import write_reports
from validation.verdict import Check, Estimate

COARSE: dict[str, dict[str, int]] = {"analytic": {"n_modes": 4}, "fe": {"elements": 4}}
"""Options of the solvers: no accuracy is asked of these reports."""
OPTIONS = {"analytic": ("--n-modes", "4"), "fe": ("--elements", "4", "--solver", "fe")}
"""The same on the command line."""
DURATION = 3.0
"""Of motions under records and random excitation, s."""
STEEL = Material(youngs_modulus=2.05e11, density=7850.0)
BEAM = Beam(length=0.6, material=STEEL, section=Rectangle(breadth=0.04, height=0.012))
_BESIDE: Mapping[str, Any] = {
    "beam": BEAM,
    "stops": (
        Stop(name="pad above the clevis", x=0.45, side="top", gap=2e-4, stiffness=1e5, damping=30.0),
        Stop(name="bottom pad", x=0.45, side="bottom", gap=3e-4, stiffness=1e5, damping=20.0),
    ),
    "masses": (Mass(name="clevis", x=0.6, mass=0.8),),
}
RANDOM = SHAKEN.replace(**_BESIDE, title="A bracket, shaken at random")
RECORDED = SHAKEN.replace(
    **_BESIDE,
    title="A bracket under a record, gravity and steady loads",
    base_motion=RecordBaseMotion(
        quantity="acceleration", values=(8.0 * np.sin(np.arange(0.0, 121.0, 0.02) ** 1.1)).tolist(), rate=2000.0
    ),
    point_loads=(StepLoad(x=0.5, force=-2.0),),
    uniform_loads=(UniformLoad(start=0.2, to=0.4, force_per_length=-30.0),),
    gravity=Gravity(acceleration=-9.81),
)
PERIODIC = RANDOM.replace(
    title="A bracket, shaken by a sine", base_motion=BaseMotion(amplitude=5e-4, angular_frequency=150.0), point_loads=()
)
PROBLEMS = {"periodic": PERIODIC, "recorded": RECORDED, "random": RANDOM, "beams": lap_joint()}


@contextmanager
def coarse() -> Iterator[None]:
    """Solve own problems with the options `COARSE`."""
    fine, own_problem.SOLVERS = own_problem.SOLVERS, COARSE
    try:
        yield
    finally:
        own_problem.SOLVERS = fine


@cache
def lasting(kind: str) -> CaseResult:
    """The steady state of a problem, or the statistics of its motion."""
    problem = PROBLEMS[kind]
    with coarse():
        if problem.excitation_frequency is not None:
            return own_problem.steady(problem, "quick", lambda line: None)
        return own_problem.statistics(problem, "quick", lambda line: None, DURATION)


def contacts(problem: Problem) -> CaseResult:
    """Eight made-up contacts, and the first motion by coarse solvers."""
    made = [
        Check(
            f"contact {i}, {problem.stop_names[i % 2]}: {what}", unit, *(Estimate(i / 9, u, "?") for u in (1e-9, 2e-8))
        )
        for i in range(1, 9)
        for what, unit in (("impact", "s"), ("rebound", "s"), ("impulse", "N s"))
    ]
    both = [make_solver(name, **options).simulate(problem, 0.1, errors=False) for name, options in COARSE.items()]
    drawings = (motion_drawing("Motion from the initial state", *both),)
    title = "First contacts from the initial state"
    return CaseResult("transient", title, "Which?", tuple(made), answer=contacts_table(made), drawings=drawings)


def write_own_report(kind: str, output: Path) -> None:
    """The report of a problem: where it rests, its first contacts, and what lasts."""
    problem = PROBLEMS[kind]
    results = [contacts(problem), lasting(kind)]
    if own_problem.has_equilibrium(problem):
        results.insert(0, own_problem.equilibrium(problem, "quick", lambda line: None))
    output.mkdir(exist_ok=True)
    write_reports(results, "quick", output, 1.0, problem, "joint.toml --set stops.0.gap=2e-4")
