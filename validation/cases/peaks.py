"""The peaks of the impulse curve near 515, 820 and 2950 rad/s: their frequencies and heights."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import partial

import numpy as np
from scipy.optimize import minimize_scalar

import analytic
from lapjoint import Outcome, paper_joint
from lapjoint.machine.processes import process_pool
from lapjoint.problem import FloatArray
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import FE_ORDER, analytic_levels, fe_levels, refined_by
from validation.cases.steady import IMPULSE_ORDER
from validation.uncertainty import refined_estimate, refined_vector
from validation.verdict import Check, Criterion, ErrorSource, Estimate

NEAR = {515.0: 15.0, 820.0: 15.0, 2950.0: 40.0}
"""The paper's peak frequencies, and the half width in which each peak is sought, rad/s."""
TIP = 0  # P2, the bottom stop at the tip
SPACING = np.array([-1.0, -0.5, 0.0, 0.5, 1.0])  # Points about a peak, divided by half of the searched width


@dataclass(frozen=True)
class Peak:
    """A peak by one solver."""

    frequency: Estimate
    impulse: Estimate


def tip_impulse(solver: Solver, omega: float) -> float:
    """Magnitude of the tip stop's impulse per excitation period in the steady state, N s."""
    found = solver.steady_state(paper_joint(angular_frequency=omega), sensitivity=False, errors=False)
    assert found.outcome is Outcome.PERIODIC
    return abs(float(found.impulses[TIP]))


def centre(near: float) -> float:
    """The frequency of the peak by the analytic solver, to 0.1 rad/s."""
    reach, solver = NEAR[near], analytic.Solver()
    found = minimize_scalar(
        lambda omega: -tip_impulse(solver, omega),
        bounds=(near - reach, near + reach),
        method="bounded",
        options={"xatol": 0.1},
    )
    return float(found.x)


def top(omega: FloatArray, impulse: FloatArray) -> tuple[float, float]:
    """Position and height of the maximum of the quartic through five points."""
    middle, half = omega[2], omega[4] - omega[2]
    quartic = np.polynomial.Polynomial.fit((omega - middle) / half, impulse, 4, domain=[-1, 1])
    roots = quartic.deriv().roots()
    inside = roots[np.abs(roots.imag) < 1e-9].real
    inside = np.append(inside[np.abs(inside) <= 1], [-1.0, 1.0])
    best = inside[np.argmax(quartic(inside))]
    return float(middle + half * best), float(quartic(best))


def peak(near: float, at: float, solvers: Sequence[Solver], ratio: float, order: float) -> Peak:
    """A peak by solvers of rising resolution."""
    omega = at + SPACING * NEAR[near] / 2
    curves = np.array([[tip_impulse(solver, w) for w in omega] for solver in solvers])
    tops = np.array([top(omega, curve) for curve in curves])
    what = refined_by(solvers[-1])
    # The height has the error of the impulses from which it is computed.
    heights = refined_vector(
        np.column_stack([tops[:, 1], curves]), ratio, order, what, floor=1e-8, floor_source=ErrorSource.ORBIT
    )
    places = refined_estimate(tops[:, 0].tolist(), ratio, order, what, floor=1e-8, floor_source=ErrorSource.ORBIT)
    return Peak(places, heights[0])


def solve_peak(near: float, level: Level) -> tuple[float, Peak, Peak]:
    """One peak by both solvers."""
    at = centre(near)
    finest = {"quick": 40, "standard": 48, "full": 80}[level]
    exact = peak(near, at, analytic_levels(paper_joint(angular_frequency=at), 1.5), 1.5, IMPULSE_ORDER)
    return near, exact, peak(near, at, fe_levels(finest), 2.0, FE_ORDER)


def run(level: Level, say: Say) -> CaseResult:
    """All peaks, two at a time."""
    found = []
    with process_pool(2) as pool:
        for answer in pool.map(partial(solve_peak, level=level), NEAR):
            found.append(answer)
            say(f"near {answer[0]:g} rad/s")
    checks, criteria, rows = [], [], []
    for near, exact, fe in found:
        checks.append(Check(f"peak near {near:g} rad/s: frequency", "rad/s", exact.frequency, fe.frequency))
        checks.append(Check(f"peak near {near:g} rad/s: impulse of P2", "N s", exact.impulse, fe.impulse))
        criteria.append(
            Criterion(
                f"peak near {near:g} rad/s: within the range looked at",
                "rad/s",
                exact.frequency.value,
                near - NEAR[near] + 1,
                near + NEAR[near] - 1,
                "else there is no peak",
            )
        )
        rows.append(
            (
                f"{near:g}",
                *(f"{e.value:.7g} +- {e.uncertainty:.1g}" for e in _both(exact, fe)),
            )
        )
    return CaseResult(
        "peaks",
        "Peaks of the impulse curve",
        "Where the impulse of the tip stop, per excitation period in the steady state, is largest near the three peaks "
        "that the paper names, and how large it is there. A quartic through five frequencies about each peak, the same "
        "for both solvers, gives its top; three numbers of modes and three meshes give its uncertainty.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(
            table(
                "Peaks of the impulse of P2",
                ("paper", "frequency, analytic", "frequency, FE", "impulse, analytic", "impulse, FE"),
                rows,
            ),
        ),
    )


def _both(exact: Peak, fe: Peak) -> tuple[Estimate, ...]:
    return exact.frequency, fe.frequency, exact.impulse, fe.impulse
