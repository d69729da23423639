"""Lightly damped joints whose motion never repeats: both solvers certify it, with one exponent."""

from __future__ import annotations

import analytic
import fe_lapjoint
from lapjoint import ModalDamping, Outcome, Problem, SteadyState, ViscousDamping, paper_joint
from lapjoint.processes import process_pool
from validation.case import CaseResult, Level, Say, table
from validation.verdict import Check, Criterion, ErrorSource, Estimate

JOINTS = {
    "modal damping 0.002, 700 rad/s": paper_joint(angular_frequency=700.0).replace(damping=ModalDamping(ratio=0.002)),
    "viscous damping 100 N s/m2, 1100 rad/s": paper_joint(angular_frequency=1100.0).replace(
        damping=ViscousDamping(coefficient=100.0)
    ),
}
COVERAGE = 4.0  # standard errors: the blocks of a chaotic motion are few, and not independent


def solve(which: str, problem: Problem, elements: int) -> SteadyState:
    """The motion that remains, by the solver named."""
    if which == "analytic":
        return analytic.Solver().steady_state(problem, errors=False)
    return fe_lapjoint.Solver(elements=elements).steady_state(problem, errors=False)


def run(level: Level, say: Say) -> CaseResult:
    """Both joints by both solvers."""
    # With 8 elements the chaos of the second joint dies away after some thousand periods: another system.
    elements = {"quick": 16, "standard": 16, "full": 32}[level]
    checks, criteria, rows = [], [], []
    with process_pool(2) as pool:
        futures = {
            label: [pool.submit(solve, which, problem, elements) for which in ("analytic", "fe")]
            for label, problem in JOINTS.items()
        }
        for label, pair in futures.items():
            found = [future.result() for future in pair]
            say(label)
            estimates = []
            for steady in found:
                certified = float(steady.outcome is Outcome.APERIODIC)
                reason = "nothing repeats, and nearby motions part"
                criteria.append(
                    Criterion(f"{label}: certified aperiodic, {steady.solver}", "1", certified, 1, 1, reason)
                )
                assert steady.exponent is not None
                value, error, periods = steady.exponent.value, steady.exponent.standard_error, steady.exponent.periods
                how = f"{steady.solver}, over {periods} periods"
                parts = ((ErrorSource.FINITE_TIME, COVERAGE * error),)
                estimates.append(Estimate(value, COVERAGE * error, how, parts=parts))
                rows.append((label, steady.solver, f"{value:.3g}", f"{error:.2g}", periods))
            checks.append(Check(f"{label}: largest Lyapunov exponent", "1/s", estimates[0], estimates[1]))
    return CaseResult(
        "aperiodic",
        "Motions that never repeat",
        "With the paper's damping ratio of 0.08 every motion of the joint settles. With a fortieth of it, or with "
        "viscous damping as light at high frequency, some are chaotic. No two solvers can follow such a motion for "
        "long, but the rate at which nearby motions part, the largest Lyapunov exponent, is a property of the joint: "
        "both measure it by carrying a small deviation through every flow and over every switch.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(
            table(
                "Largest Lyapunov exponents",
                ("joint", "solver", "exponent (1/s)", "standard error (1/s)", "periods"),
                rows,
            ),
        ),
    )
