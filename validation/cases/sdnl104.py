"""An outside benchmark: Code_Aster's validation case SDNL104 (V5.02.104)."""

from __future__ import annotations

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History, sdnl104
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import analytic_levels, fe_levels, refined_by
from validation.cases.transient import WITNESS_TOLERANCE, motion_drawing
from validation.invariants import witness
from validation.references.panels import gauss_panels
from validation.references.reading import printed
from validation.uncertainty import refined_estimate
from validation.verdict import Check, Estimate

DURATION = 0.2  # Length of the motion, s
AT = 0.16  # Time at which the kinetic energy is compared, s
QUANTITIES = {
    "first contact": ("s", "first_contact"),
    "release": ("s", "release"),
    "impulse": ("N s", "impulse"),
    "kinetic energy at 0.16 s": ("J", "kinetic_energy"),
}
"""Unit, and key in the references."""


def answers(history: History) -> tuple[float, ...]:
    """The four quantities, in the order of QUANTITIES."""
    first = history.contacts[0]
    points, weights = gauss_panels(np.linspace(0.0, 1.0, 33), 20)
    speed = history.velocity(points, AT)[:, 0]
    return first.start, first.end, abs(first.impulse), float(history.problem.line.m / 2 * (weights @ speed**2))


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers against the converged values and against each other."""
    problem, finest = sdnl104(), {"quick": 64, "standard": 128, "full": 256}[level]
    say("analytic and FE")
    # An undamped beam under a step load rings in all its modes, also in modes that a mesh resolves badly.  Motions
    # therefore converge more slowly than frequencies, and only second order is assumed.
    solvers: dict[str, tuple[list[analytic.Solver] | list[fe_lapjoint.Solver], float, float]] = {
        "analytic": (analytic_levels(problem, 1.5), 1.5, 3.0),
        "FE": (fe_levels(finest), 2.0, 2.0),
    }
    estimates: dict[str, list[Estimate]] = {}
    histories = {}
    for name, (levels, ratio, order) in solvers.items():
        runs = [solver.simulate(problem, DURATION, errors=False) for solver in levels]
        histories[name] = runs[-1]
        values = list(zip(*(answers(run) for run in runs), strict=True))
        estimates[name] = [refined_estimate(v, ratio, order, refined_by(levels[-1]), 1e-9) for v in values]
    checks, rows = [], []
    for i, (quantity, (unit, key)) in enumerate(QUANTITIES.items()):
        given = printed("sdnl104 answers", key)
        reference = given.estimate()
        for name in solvers:
            checks.append(Check(f"{quantity}: {name} against reference", unit, estimates[name][i], reference))
        checks.append(Check(f"{quantity}: analytic against FE", unit, estimates["analytic"][i], estimates["FE"][i]))
        rows.append(
            (
                quantity,
                unit,
                given.text,
                *(f"{estimates[n][i].value:.9g} +- {estimates[n][i].uncertainty:.1e}" for n in solvers),
            )
        )
    return CaseResult(
        "sdnl104",
        "Outside benchmark: SDNL104",
        "A cantilever under a step force of -1000 N falls on one stop, undamped. The reference values come from a "
        "program apart from both solvers, which the report names; the point values of V5.02.104 come from 10 elements "
        "and dt = 1e-4 s and are not converged.",
        checks=tuple(checks),
        criteria=tuple(
            item for history in histories.values() for item in witness(history, WITNESS_TOLERANCE, history.solver)
        ),
        tables=(table("SDNL104", ("quantity", "unit", "reference", "analytic", "FE"), rows),),
        drawings=(motion_drawing("SDNL104: the tip", histories["analytic"], histories["FE"]),),
    )
