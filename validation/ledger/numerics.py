"""Claims about the numerics: intervals of bisection, and the off-diagonal entries of (29)."""

from __future__ import annotations

import numpy as np
from scipy.integrate import solve_ivp

import analytic
from lapjoint import FREE, paper_joint
from lapjoint.problem.presets import TABLE_4_DENSITY
from validation.ledger.entry import Entry, Ruling

FREQUENCY_INTERVAL, EVENT_INTERVAL = 7.38e-15, 2.2e-11  # rad/s and s, as printed


def numerical_entries() -> list[Entry]:
    """All of them."""
    return [frequency_interval(), event_interval(), equation_29()]


def frequency_interval() -> Entry:
    """Whether frequencies can be bisected to the interval that is printed, in double precision."""
    omega = analytic.Solver().modes(paper_joint(density=TABLE_4_DENSITY), FREE, 3).angular_frequencies
    spacing = np.spacing(omega)
    return Entry(
        "Section 3",
        "frequencies bisected to intervals of 7.38e-15 rad/s",
        "7.38e-15",
        ", ".join(f"{value:.2g}" for value in spacing),
        "",
        "",
        Ruling.OVERTURNED,
        f"neighbouring double precision numbers lie {spacing[0]:.1e} apart at {omega[0]:.4g} rad/s and "
        f"{spacing[1]:.1e} at {omega[1]:.4g}: from 64 rad/s on no such interval exists",
        "numpy.spacing",
    )


def event_interval() -> Entry:
    """What the printed interval of event times is worth."""
    problem = paper_joint()
    history = analytic.Solver().simulate(problem, 0.05, errors=False)
    impacts = [contact for contact in history.contacts if not contact.open_start]
    speeds = [abs(float(history.velocity(problem.stops[c.stop].x, c.start)[0, 0])) for c in impacts]
    travel = max(speeds) * EVENT_INTERVAL
    return Entry(
        "Section 3",
        "times of contact bisected to 2.2e-11 s",
        "2.2e-11",
        f"{travel:.1e} m",
        "",
        "",
        Ruling.CONFIRMED,
        f"enough: at the fastest impact from rest, {max(speeds):.3g} m/s, it is {travel:.0e} m of travel; both solvers "
        "here locate events closer still",
        "transient",
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
    corrected, printed = (force / np.hypot(omega**2 - Omega**2, off) for off in (C * Omega, C * Omega**2))
    return Entry(
        "Equation (29)",
        "off-diagonal entries C* omega^2",
        f"{printed:.4g}",
        f"{corrected:.4g}",
        "",
        "",
        Ruling.MISPRINT,
        f"amplitude of an oscillator of {omega:g} rad/s and ratio {ratio:g} driven at {Omega:g}: by direct integration "
        f"{integrated:.4g}, as with C* omega; the printed entry has not the units of its row either",
        "tests/analytic/test_march.py",
    )
