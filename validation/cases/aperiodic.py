"""Lightly damped joints whose motion never repeats: both solvers certify it, with one exponent."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from scipy.stats import t as student_t

import analytic
import fe_lapjoint
from lapjoint import ModalDamping, Outcome, PolynomialShape, Problem, SteadyState, ViscousDamping, paper_joint
from lapjoint.answers import Exponent
from lapjoint.machine.processes import process_pool
from validation.case import CaseResult, Level, Say, table
from validation.verdict import Check, Criterion, ErrorSource, Estimate

JOINTS = {
    "modal damping 0.002, 700 rad/s": paper_joint(angular_frequency=700.0).replace(damping=ModalDamping(ratio=0.002)),
    "viscous damping 100 N s/m2, 1100 rad/s": paper_joint(angular_frequency=1100.0).replace(
        damping=ViscousDamping(coefficient=100.0)
    ),
}
STARTS = 12
"""Number of motions of each joint by the analytic solver, from rest and with a moving tip at the start.  The scatter of
their exponents is the uncertainty of one measurement; the stated standard error of one motion can be half of this
scatter, because intermittent chaos has few independent parts."""
SPEED = 1e-3  # Initial speed of the tip in the second motion, m/s; the k-th motion starts with k - 1 times as much
FEWEST = 10  # Least number of certified motions from which an exponent is taken
PROBABILITY = 0.99  # Probability with which the interval of an exponent contains the exponent


def solve(which: str, problem: Problem, elements: int, speed: float = 0.0) -> SteadyState:
    """The steady motion by the solver named, of a beam whose tip starts at `speed`, m/s."""
    problem = problem.replace(initial=PolynomialShape(velocity=(0.0, 0.0, speed / problem.line.length**2)))
    if which == "analytic":
        return analytic.Solver().steady_state(problem, errors=False)
    return fe_lapjoint.Solver(elements=elements).steady_state(problem, errors=False)


def exponents(several: Sequence[Exponent], single: Exponent) -> tuple[Estimate, Estimate]:
    """Mean exponent of several motions with different starts, and the exponent of one motion by another solver, both in
    1/s, with intervals from the scatter of the several exponents."""
    values = np.array([exponent.value for exponent in several])
    times = np.array([exponent.time for exponent in several])
    factor = float(student_t.ppf((1 + PROBABILITY) / 2, values.size - 1))
    scatter = float(values.std(ddof=1))
    errors = (
        scatter / math.sqrt(values.size),
        max(single.standard_error, scatter * math.sqrt(float(times.mean()) / single.time)),
    )
    told = (f"mean of {values.size} motions", f"over {single.periods} periods")
    found = [
        Estimate(value, factor * error, how, parts=((ErrorSource.FINITE_TIME, factor * error),))
        for value, error, how in zip((float(values.mean()), single.value), errors, told, strict=True)
    ]
    return found[0], found[1]


def run(level: Level, say: Say) -> CaseResult:
    """Both joints by both solvers."""
    # With 8 elements the chaos of the second joint ends after some thousand periods: the mesh is another system.
    elements = {"quick": 16, "standard": 16, "full": 32}[level]
    checks, criteria, rows = [], [], []
    with process_pool(2) as pool:
        futures = {
            label: [
                pool.submit(solve, "fe", problem, elements),
                *(pool.submit(solve, "analytic", problem, elements, i * SPEED) for i in range(STARTS)),
            ]
            for label, problem in JOINTS.items()
        }
        for label, every in futures.items():
            fe, *exact = [future.result() for future in every]
            say(label)
            for steady in (exact[0], fe):
                certified = float(steady.outcome is Outcome.APERIODIC)
                reason = "nothing repeats, and nearby motions part"
                criteria.append(
                    Criterion(f"{label}: certified aperiodic, {steady.solver}", "1", certified, 1, 1, reason)
                )
            known = [one.exponent for one in exact if one.outcome is Outcome.APERIODIC and one.exponent is not None]
            reason = "from rest, and from tips that move at first"
            criteria.append(Criterion(f"{label}: motions certified", "1", len(known), FEWEST, STARTS, reason))
            if len(known) < FEWEST or fe.exponent is None:
                continue
            a, b = exponents(known, fe.exponent)
            checks.append(Check(f"{label}: largest Lyapunov exponent", "1/s", a, b))
            rows.append(
                (label, exact[0].solver, f"{a.value:.3g}", f"{a.uncertainty:.2g}", sum(e.periods for e in known))
            )
            rows.append((label, fe.solver, f"{b.value:.3g}", f"{b.uncertainty:.2g}", fe.exponent.periods))
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
                ("joint", "solver", "exponent (1/s)", "uncertainty (1/s)", "periods"),
                rows,
            ),
        ),
    )
