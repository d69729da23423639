"""A cantilever shaken at random, without stops: stationary root mean squares against integrals in closed form."""

from __future__ import annotations

import math
from dataclasses import dataclass
from statistics import NormalDist

import numpy as np
import xarray as xr

from lapjoint import Beam, Problem, RandomBaseMotion, Support, ViscousDamping, statistics
from validation.case import CaseResult, Level, Say, number, table
from validation.references.shaken_cantilever import ShakenCantilever
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
DURATION = {"quick": 40.0, "standard": 300.0, "full": 1200.0}
"""Of each of `SEEDS` motions, s."""
RATE = 150.0
"""Samples a second, Hz: root mean squares have no bias at any rate, and this one is above twice the second mode."""
SMEARED = 5e-3
"""Relative, of a root mean square: edges of the band that a filter smears, and what straight lines between samples of
the excitation add at 7 times the highest frequency."""


@dataclass(frozen=True)
class Quantity:
    """A root mean square."""

    name: str
    unit: str
    variable: str
    """In the dataset of statistics."""
    x: float
    """m."""
    exact: float


def quantities() -> list[Quantity]:
    """All of them, by the closed form."""
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


def joint_factor(count: int, level: float) -> float:
    """By how much an interval is wider if `count` of them are to hold together, as often as each alone (Bonferroni).

    Parameters
    ----------
    count : int
        Number of intervals.
    level : float
        Probability with which each alone holds its value.

    Returns
    -------
    float
        1 or more.
    """
    each = NormalDist()
    return each.inv_cdf(1 - (1 - level) / (2 * count)) / each.inv_cdf((1 + level) / 2)


def estimate_of(found: xr.Dataset, variable: str, factor: float, smeared: float, **where: object) -> Estimate:
    """A value of a dataset of statistics, with its interval as uncertainty.

    Parameters
    ----------
    found : xarray.Dataset
        From `lapjoint.statistics`.
    variable : str
        Its variable.
    factor : float
        By which intervals are widened, to hold together.
    smeared : float
        Relative uncertainty besides, of the excitation.
    **where : object
        Which place or stop, as `xarray.DataArray.sel` or ``isel`` takes them.

    Returns
    -------
    Estimate
        The value, and half the width of its interval.
    """
    value = found[variable].sel(where, method="nearest") if "x" in where else found[variable].isel(where)
    both = found[f"{variable}_interval"]
    both = both.sel(where, method="nearest") if "x" in where else both.isel(where)
    half = float(np.abs(both.values - float(value)).max())
    units = f"{found.attrs['units']} units of {found.attrs['unit_duration']:.3g} s"
    how = f"{found.attrs['solver']}, {units}, interval widened by {factor:.2f}"
    return Estimate(float(value), factor * half + smeared * abs(float(value)), how)


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
