"""An elastic beam on springs between stops: energy, momentum and angular momentum, from the motion alone."""

from __future__ import annotations

import analytic
import fe_lapjoint
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say
from validation.invariants import witness
from validation.verdict import Criterion

JOINT = """
title = "Elastic beam on springs between three stops, viscous damping, all loads"
[beam]
length = 1.4
bending_stiffness = 90.0
mass_per_length = 2.2
[[supports]]
x = 0.2
translational = 700.0
torsional = 25.0
[[supports]]
x = 1.1
translational = 1200.0
[[stops]]
x = 1.4
side = "top"
gap = 2e-3
stiffness = 4000.0
[[stops]]
x = 0.6
side = "bottom"
gap = 1.5e-3
stiffness = 2500.0
[[stops]]
x = 0.0
side = "bottom"
gap = 2.5e-3
stiffness = 3000.0
[damping]
kind = "viscous"
coefficient = 3.0
[base_motion]
amplitude = 4e-3
angular_frequency = 21.0
phase = -0.8
[[point_loads]]
kind = "step"
x = 0.9
force = -2.0
[[point_loads]]
kind = "sine"
x = 0.4
force = 3.0
angular_frequency = 37.0
phase = 0.9
[initial]
kind = "polynomial"
displacement = [1e-3, -2e-3, 1e-3]
velocity = [0.03, -0.02]
"""
DURATION = 0.4  # Length of the motion, s, in which all three stops have contacts
TOLERANCE = 1e-4  # Relative error of quadrature, and of the truncation at switches


def run(level: Level, say: Say) -> CaseResult:
    """The balances by both solvers."""
    problem, criteria = from_toml(JOINT), []
    for solver, label in ((analytic.Solver(n_modes=16), "analytic"), (fe_lapjoint.Solver(elements=8), "FE")):
        say(label)
        history = solver.simulate(problem, DURATION, errors=False)
        criteria += witness(history, TOLERANCE, solver.name)
        struck = float(len({contact.stop for contact in history.contacts}))
        criteria.append(Criterion(f"{solver.name}: stops that are struck", "1", struck, 3, 3, "else little is shown"))
    return CaseResult(
        "balance",
        "Energy and momentum of an elastic beam between stops",
        "Supports that all give way and viscous damping leave no force that the motion does not tell. So energy is "
        "accounted for, and with the impulses as they are stated momentum and angular momentum are, too.",
        criteria=tuple(criteria),
    )
