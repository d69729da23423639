"""A cantilever shaken at random, without stops: stationary root mean squares against integrals in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass

from lapjoint import Beam, Problem, RandomBaseMotion, Support, ViscousDamping, statistics
from validation.case import CaseResult, Level, Say, number, table
from validation.references.shaken_cantilever import ShakenCantilever
from validation.statistics_estimates import estimate_of, joint_factor
from validation.verdict import Check, Estimate, Kind

BEAM = ShakenCantilever(length=0.9, stiffness=40.0, mass=0.8, damping=9.0)
LOW, HIGH, DENSITY = 2.0, 90.0, 0.5
"""Band, Hz, and density, (m/s2)^2/Hz: two modes lie in it, at 4.9 and 30.6 Hz."""
SEED, SEEDS = 20, 8
SHAKEN = Problem(
    title="Cantilever under random motion of its base",
    beam=Beam(length=BEAM.length, bending_stiffness=BEAM.stiffness, mass_per_length=BEAM.mass),
    supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
    damping=ViscousDamping(coefficient=BEAM.damping),
    base_motion=RandomBaseMotion(psd=((LOW, DENSITY), (HIGH, DENSITY)), seed=SEED),
)
SOLVERS = {"analytic": {"n_modes": 10}, "fe": {"elements": 12}}
DURATION = {"quick": 40.0, "standard": 100.0, "full": 600.0}  # Length of each of `SEEDS` motions, s
RATE = 150.0
"""Samples a second, Hz, more than twice the second mode; root mean squares have no bias at any rate."""
SMEARED = 5e-3
"""Relative error of a root mean square by the smeared edges of the band, and by the power that straight lines between
samples of the excitation add at 7 times the highest frequency."""


@dataclass(frozen=True)
class Quantity:
    """A root mean square."""

    name: str
    unit: str
    variable: str
    """Name in the dataset of statistics."""
    x: float
    """m."""
    exact: float


def quantities() -> list[Quantity]:
    """All root mean squares by the closed form."""
    L, band = BEAM.length, (LOW, HIGH, DENSITY)
    found = []
    for x, where in ((L, "the tip"), (L / 2, "mid-span")):
        for rates, (name, unit) in enumerate((("displacement", "m"), ("velocity", "m/s"))):
            exact = math.sqrt(BEAM.mean_square(*band, x, 0, rates))
            found.append(Quantity(f"{name} of {where}", unit, name, x, exact))
        exact = math.sqrt(BEAM.absolute_mean_square(*band, x))
        found.append(Quantity(f"absolute acceleration of {where}", "m/s2", "absolute_acceleration", x, exact))
    for x, where in ((0.0, "the root"), (L / 2, "mid-span")):
        exact = BEAM.stiffness * math.sqrt(BEAM.mean_square(*band, x, 2, 0))
        found.append(Quantity(f"moment at {where}", "N m", "moment", x, exact))
    return found


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers against the integrals."""
    wanted = quantities()
    checks, rows = [], []
    factor = joint_factor(len(wanted) * len(SOLVERS), 0.95)
    for solver, options in SOLVERS.items():
        say(f"{solver}, {SEEDS} motions of {DURATION[level]:g} s")
        places = sorted({quantity.x for quantity in wanted})
        found = statistics(SHAKEN, solver, duration=DURATION[level], seeds=SEEDS, options=options, at=places, rate=RATE)
        for quantity in wanted:
            estimate = estimate_of(found, f"{quantity.variable}_rms", factor, SMEARED, x=quantity.x)
            exact = Estimate(quantity.exact, 0.0, "integral over the band, no modes summed", Kind.ANALYTICAL)
            checks.append(Check(f"RMS {quantity.name}: {solver}", quantity.unit, estimate, exact))
            rows.append(
                (quantity.name, quantity.unit, solver, exact.value, estimate.value, number(estimate.uncertainty, 2))
            )
    return CaseResult(
        "random-linear",
        "Random shaking without stops",
        "A cantilever with viscous damping under a band of white noise at its base. Its stationary root mean squares "
        "are integrals over the band of a closed form in which no modes are summed. Intervals are those of `lapjoint "
        "statistics`, widened so that all of them hold together in 95 % of cases; half a percent is allowed for the "
        "edges of the band.",
        checks=tuple(checks),
        tables=(table("Root mean squares", ("quantity", "unit", "solver", "exact", "found", "u"), rows),),
    )
