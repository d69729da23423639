"""Contacts of bars that do not ring: with an overdamped mode, and with a rigid-body mode that no spring holds.

Each solver has special formulas for these modes: in the march, in the search for contacts, and for deviations.  Both
solvers are so fine here that only errors in these formulas can make them differ.
"""

from __future__ import annotations

import math

import numpy as np

import analytic
import fe_lapjoint
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.cases.rigid_bar import MIRROR, SOFT
from validation.verdict import Check, Estimate, Kind

SLUGGISH = MIRROR.replace("coefficient = 6.0", "coefficient = 150.0").replace("amplitude = 2e-3", "amplitude = 2e-2")
"""A bar whose first mode is damped more than critically: 2 m omega = 92 N s/m2."""
HINGED = (
    MIRROR.replace("torsional = 600.0\n", "")
    + """
[[point_loads]]
kind = "step"
x = 1.0
force = 4.0
"""
)
"""A bar that a load presses against one of the stops, and that the base throws off the stop."""
BARS = {"sluggish": SLUGGISH, "hinged": HINGED}
SOLVERS: tuple[analytic.Solver, fe_lapjoint.Solver] = (analytic.Solver(n_modes=12), fe_lapjoint.Solver(elements=4))
DURATION = 1.2  # Length of the motion, s
CONTACTS = 4  # Contacts compared one by one
FINE = 1e-5  # Error of modes and elements, divided by the largest number of a kind; a nearly rigid bar hardly bends
QUANTITIES = (("stop", "1"), ("impact", "s"), ("rebound", "s"), ("impulse", "N s"), ("peak force", "N"))


def compared(label: str, text: str) -> list[Check]:
    """One bar by both solvers."""
    problem, found = from_toml(text.format(stiffness=repr(SOFT))), []
    for solver in SOLVERS:
        history = solver.simulate(problem, DURATION, errors=False)
        rows = [(float(c.stop), c.start, c.end, c.impulse, c.peak_force) for c in history.contacts[:CONTACTS]]
        steady = solver.steady_state(problem, sensitivity=False, errors=False)
        found.append((np.array(rows), np.append(steady.impulses, np.abs(steady.multipliers[:1]))))
    (a, a_steady), (b, b_steady) = found
    checks = []
    for k, (name, unit) in enumerate(QUANTITIES):
        u = FINE * float(np.abs(b[:, k]).max())
        for i in range(len(b)):
            one = Estimate(float(a[i, k]) if i < len(a) else math.nan, u, SOLVERS[0].name)
            other = Estimate(float(b[i, k]), u, SOLVERS[1].name)
            checks.append(Check(f"{label}, contact {i + 1}: {name}", unit, one, other))
    for name, one, other in zip(
        ("impulse of stop 1", "impulse of stop 2", "multiplier"), a_steady, b_steady, strict=True
    ):
        u = FINE * float(np.abs(b_steady).max())
        reference = Estimate(float(other), u, SOLVERS[1].name, Kind.CROSS_METHOD)
        checks.append(Check(f"{label}, steady: {name}", "SI", Estimate(float(one), u, SOLVERS[0].name), reference))
    return checks


def run(level: Level, say: Say) -> CaseResult:
    """Both bars."""
    checks = [check for label, text in BARS.items() for check in compared(label, text)]
    rows = [(c.name, c.unit, c.a.value, c.b.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "slow-modes",
        "Bars that do not ring",
        "Nearly rigid bars between two stops, one with an overdamped mode, one hinged without any spring: such modes "
        "have formulas of their own in each solver. Contacts and steady states of both are compared.",
        checks=tuple(checks),
        tables=(table("Bars that do not ring", ("quantity", "unit", "analytic", "FE", "difference", "allowed"), rows),),
    )
