"""Steady-state impulses of the four stops over the paper's range of frequencies, base case of Table 6."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from lapjoint import Outcome, Problem, SteadyState, paper_joint
from lapjoint.figures.style import entitle
from lapjoint.machine.processes import process_pool
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import FE_ORDER, analytic_levels, fe_levels, refined_by
from validation.cases.transient import WITNESS_TOLERANCE
from validation.coexistence import Motion, same_motion, why_they_differ
from validation.orbit_invariants import steady_witness
from validation.report.drawing import COLOURS, draw
from validation.uncertainty import Refined, refined_vector
from validation.verdict import Check, Criterion, ErrorSource, Estimate

if TYPE_CHECKING:
    from matplotlib.axes import Axes

FEWER = (5.0, 100.0, 250.0, 515.0, 820.0, 1000.0, 1400.0, 2060.0, 2950.0, 3500.0, 4200.0, 5000.0)
MORE = (*FEWER, 1800.0, 2500.0, 3250.0, 4500.0)
IMPULSE_ORDER = 6.0
"""Order of the analytic impulses in the number of modes (tests/analytic/test_steady_state.py)."""


@dataclass(frozen=True)
class Point:
    """Both answers at one frequency."""

    omega: float
    period_multiple: int
    """Excitation periods per period of the motion, analytic."""
    multiplier: float
    """Largest modulus of the Floquet multipliers, analytic."""
    outcomes: tuple[Outcome, Outcome]
    analytic: tuple[Estimate, ...]
    fe: tuple[Estimate, ...]
    criteria: tuple[Criterion, ...]
    same_period: Check
    """Comparison of the numbers of excitation periods after which both motions repeat."""
    explanation: str = ""
    """The known reason if the two solvers end on different motions; else empty."""


def _finest(level: Level) -> int:
    return {"quick": 48, "standard": 80, "full": 96}[level]


def solve_point(omega: float, level: Level) -> Point:
    """The paper's joint at one frequency."""
    return compare_steady(paper_joint(angular_frequency=omega), _finest(level))


def compare_steady(problem: Problem, finest: int) -> Point:
    """Steady states by three numbers of modes and three meshes."""
    omega = problem.excitation_frequency or math.nan
    exact = [solver.steady_state(problem, sensitivity=False, errors=False) for solver in analytic_levels(problem, 1.5)]
    fe = [solver.steady_state(problem, sensitivity=False, errors=False) for solver in fe_levels(finest)]
    label, explanation = f"{omega:g} rad/s", ""
    if not same_motion(exact[-1], fe[-1]):
        solvers = analytic_levels(problem, 1.5)[-1], fe_levels(finest)[-1]
        explanation = why_they_differ(problem, Motion(solvers[0], exact[-1]), Motion(solvers[1], fe[-1]))
    a, b = (Estimate(float(found[-1].period_multiple), 0.0, found[-1].solver) for found in (exact, fe))
    same_period = Check(f"{label}: excitation periods per period", "1", a, b, explanation=explanation)
    return Point(
        omega,
        exact[-1].period_multiple,
        float(abs(exact[-1].multipliers[0])) if exact[-1].multipliers.size else math.nan,
        (exact[-1].outcome, fe[-1].outcome),
        _estimates(exact, 1.5, IMPULSE_ORDER, refined_by(analytic_levels(problem, 1.5)[-1])),
        _estimates(fe, 2.0, FE_ORDER, refined_by(fe_levels(finest)[-1])),
        (
            *steady_witness(exact[-1], WITNESS_TOLERANCE, f"{label}, {exact[-1].solver}"),
            *steady_witness(fe[-1], WITNESS_TOLERANCE, f"{label}, {fe[-1].solver}"),
        ),
        same_period,
        explanation,
    )


def _estimates(levels: list[SteadyState], ratio: float, order: float, refined: Refined) -> tuple[Estimate, ...]:
    impulses = np.array([steady.impulses for steady in levels])
    # Newton's method ends at 1e-9 of the motion, and an impulse is some per cent of the largest possible one.
    return refined_vector(impulses, ratio, order, refined, floor=1e-8, floor_source=ErrorSource.ORBIT)


def run(level: Level, say: Say) -> CaseResult:
    """All frequencies, two at a time."""
    points, frequencies = [], FEWER if level == "quick" else tuple(sorted(MORE))
    with process_pool(2) as pool:
        for point in pool.map(partial(solve_point, level=level), frequencies):
            points.append(point)
            say(f"{point.omega:g} rad/s")
    return report(points)


def report(points: list[Point]) -> CaseResult:
    """Checks, table and figure of the compared frequencies."""
    names = paper_joint().stop_names
    checks: list[Check] = []
    criteria: list[Criterion] = []
    rows = []
    for point in points:
        cap = 1e-3 if point.omega <= 3000 else 1e-2
        label = f"{point.omega:g} rad/s"
        criteria += point.criteria
        checks.append(point.same_period)
        for name, a, b in zip(names, point.analytic, point.fe, strict=True):
            checks.append(Check(f"{label}: impulse of {name}", "N s", a, b, cap=cap))
            rows.append(
                (
                    f"{point.omega:g}",
                    name,
                    a.value,
                    f"{a.uncertainty:.1e}",
                    b.value,
                    f"{b.uncertainty:.1e}",
                    f"{checks[-1].relative:.1e}",
                    point.period_multiple,
                    f"{point.multiplier:.3f}",
                )
            )
    columns = ("omega", "stop", "analytic", "u", "FE", "u", "difference", "period", "largest multiplier")
    return CaseResult(
        "steady",
        "Steady-state impulses, 5 to 5000 rad/s",
        "From rest both solvers march, then find the periodic motion by Newton's method on the period map. They accept "
        "it only if all its Floquet multipliers lie within the unit circle, and the march is bound for it at every "
        "later time. Impulses are per excitation period. Three numbers of modes and three meshes give each its "
        "uncertainty; besides, the two must agree to 0.1 % up to 3000 rad/s and to 1 % above.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("Impulse per excitation period, N s", columns, rows),),
        drawings=(draw("Steady-state impulses per excitation period", lambda axes: _paint(axes, points)),),
    )


def _paint(axes: Axes, points: list[Point]) -> None:
    omega = [point.omega for point in points]
    for k, (name, marker) in enumerate(zip(paper_joint().stop_names, ("o", "s", "o", "s"), strict=True)):
        style = "-" if k % 2 == 0 else "--"
        axes.plot(
            omega,
            [p.analytic[k].value / 1e3 for p in points],
            style,
            color=COLOURS["analytic"],
            lw=1,
            label=f"{name}, analytic",
        )
        axes.plot(
            omega,
            [p.fe[k].value / 1e3 for p in points],
            marker,
            color=COLOURS["fe"],
            ms=4,
            mfc="none",
            label=f"{name}, FE",
        )
    axes.set(xlabel="excitation frequency [rad/s]", ylabel="impulse [kN s]")
    entitle(axes)
