"""Claims about the numerics: intervals of bisection, and the off-diagonal entries of (29)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

import analytic
import fe_lapjoint
from lapjoint import FREE, paper_joint
from lapjoint.problem.presets import TABLE_4_DENSITY
from lapjoint.solver import Solver
from validation.ledger.entry import Entry, said


def numerical_entries() -> list[Entry]:
    """All claims about the numerics."""
    return [frequency_interval(), event_interval(), equation_29()]


def frequency_interval() -> Entry:
    """Whether frequencies can be bisected to the interval that is printed, in double precision."""
    omega = analytic.Solver().modes(paper_joint(density=TABLE_4_DENSITY), FREE, 3).angular_frequencies
    spacing, printed = np.spacing(omega), said("frequency interval")
    coarse = 2.0 ** np.ceil(np.log2(printed["printed"] / np.finfo(float).eps))  # from here on numbers lie farther apart
    return Entry(
        "frequency interval",
        {**printed, "largest spacing": float(spacing.max())},
        f"neighbouring double precision numbers lie {spacing[0]:.1e} apart at {omega[0]:.4g} rad/s and "
        f"{spacing[1]:.1e} at {omega[1]:.4g}: from {coarse:g} rad/s on no such interval exists",
        ", ".join(f"{value:.2g}" for value in spacing),
    )


def fastest_impact(solver: Solver) -> float:
    """Speed of the fastest impact from rest, base case of Table 6, m/s."""
    problem = paper_joint()
    history = solver.simulate(problem, 0.05, errors=False)
    impacts = [contact for contact in history.contacts if not contact.open_start]
    return max(abs(float(history.velocity(problem.structure.stops[c.stop].x, c.start)[0, 0])) for c in impacts)


def event_interval() -> Entry:
    """The printed interval of event times against the resolution of numbers at these times."""
    printed, gap = said("event interval"), min(stop.gap for stop in paper_joint().stops)
    speeds = [fastest_impact(solver) for solver in (analytic.Solver(), fe_lapjoint.Solver(elements=16))]
    travel = [speed * printed["printed"] for speed in speeds]
    return Entry(
        "event interval",
        {**printed, "analytic speed": speeds[0], "fe speed": speeds[1], "gap": gap},
        f"at the fastest impact from rest, {speeds[0]:.3g} m/s, it is {travel[0]:.0e} m of travel, "
        f"{travel[0] / gap:.0e} of a gap; both solvers here locate events closer still",
        f"{travel[0]:.1e} m",
        f"{travel[1]:.1e} m",
    )


def equation_29() -> Entry:
    """The answer of one damped oscillator by (29) as printed and as corrected, against its integration."""
    omega, Omega, ratio, force = 260.4, 515.0, 0.08, 1.0
    C = 2 * ratio * omega
    solution = solve_ivp(
        lambda t, y: [y[1], force * np.sin(Omega * t) - C * y[1] - omega**2 * y[0]],
        (0.0, 2.0),
        [0.0, 0.0],
        method="DOP853",
        rtol=1e-11,
        atol=1e-16,
        t_eval=np.linspace(2.0 - 4 * np.pi / Omega, 2.0, 400),
    )
    integrated = float(np.ptp(solution.y[0])) / 2
    corrected, printed = (float(force / np.hypot(omega**2 - Omega**2, off)) for off in (C * Omega, C * Omega**2))
    return Entry(
        "equation 29",
        {"integrated": integrated, "corrected": corrected, "printed": printed},
        f"amplitude of an oscillator of {omega:g} rad/s and ratio {ratio:g} driven at {Omega:g}: by direct integration "
        f"{integrated:.4g}, with C* omega {corrected:.4g}, with the printed C* omega^2 {printed:.4g}, which has "
        "not the units of its row either",
        f"{corrected:.4g}",
    )
