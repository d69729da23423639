"""One degree of freedom between elastic stops under white noise: density and crossings against the Gibbs density.

The mass is a bar on a pin that hardly bends, with a torsional spring.  With m L^3 / 3 = I, its tip u obeys

    u'' + (C / m) u' + (kt / I) u + (forces of stops) L^2 / I = -(3/2) a.

Further stops, with 1e-12 of the spring's stiffness, count how often u crosses their gaps, and for how long u is beyond.
"""

from __future__ import annotations

import math
import warnings

import numpy as np
import xarray as xr

from lapjoint import Beam, Problem, RandomBaseMotion, Stop, Support, ViscousDamping, statistics
from lapjoint.errors import ExcitationWarning
from validation.case import CaseResult, Level, Say, number, table
from validation.references.gibbs import Gibbs
from validation.references.panels import gauss_panels
from validation.statistics_estimates import estimate_of, joint_factor
from validation.verdict import Check, Criterion, Estimate, Kind

LENGTH, MASS = 1.0, 3.0
INERTIA = MASS * LENGTH**3 / 3
STIFF = 1e7
"""Bending stiffness, N m2: bending makes the bar's springs softer by 1e-4, far below any interval here.  A stiffer bar
rings so fast that finite elements need eight times as long."""
OSCILLATOR = Gibbs(omega=20.0, gamma=4.0, density=0.3, top=(0.05, 3000.0), bottom=(0.03, 900.0))
LEVELS = (0.0, 0.02)  # Further displacements whose crossings are counted, m
FEATHER = 1e-12  # Stiffness of a stop that only counts crossings, divided by the spring's stiffness at the tip
BANDS = ((0.2, 25.0), (0.1, 50.0), (0.05, 100.0), (0.025, 200.0), (0.0125, 400.0))
"""Bands of the excitation, Hz; the first whose bias is small enough is used."""
SMALL = 0.2  # Largest bias by the limited band, divided by an interval
SEED, SEEDS = 7, 8
DURATION = {"quick": 50.0, "standard": 80.0, "full": 500.0}  # Length of each of `SEEDS` motions, s
SOLVERS = {"analytic": {"n_modes": 1}, "fe": {"elements": 1}}
SHARE = {"analytic": 1.0, "fe": 0.25}
"""Fraction of the duration for each solver, by its cost; on the quick level, only `random-linear` has finite
elements."""


def bar(band: tuple[float, float]) -> Problem:
    """The oscillator as a bar under excitation in a band of Hz: its elastic stops first, then the stops that count
    crossings."""
    it, per_mass = OSCILLATOR, INERTIA / LENGTH**2
    spring = it.omega**2 * INERTIA
    density = 4 * math.pi * it.density / 1.5**2  # one-sided, per Hz, of the base's acceleration
    stops = (
        Stop(name="top", x=LENGTH, side="top", gap=it.top[0], stiffness=it.top[1] * per_mass),
        Stop(name="bottom", x=LENGTH, side="bottom", gap=it.bottom[0], stiffness=it.bottom[1] * per_mass),
        *(Stop(name=f"{u:g} m", x=LENGTH, side="top", gap=u, stiffness=FEATHER * spring / LENGTH**2) for u in LEVELS),
    )
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", ExcitationWarning)  # the bar is not meant to bend
        return Problem(
            title="A bar on a pin between two elastic stops, under random motion of its base",
            beam=Beam(length=LENGTH, bending_stiffness=STIFF, mass_per_length=MASS),
            supports=(Support(x=0.0, translational=math.inf, torsional=spring),),
            stops=stops,
            damping=ViscousDamping(coefficient=it.gamma * MASS),
            base_motion=RandomBaseMotion(psd=tuple((f, density) for f in band), seed=SEED),
        )


def bias(band: tuple[float, float]) -> tuple[float, float]:
    """Error of the root mean squares of u and u' in a band (Hz), relative to white noise, for the oscillator without
    stops."""
    edges = 2 * math.pi * np.concatenate([np.linspace(band[0], 10.0, 60), np.geomspace(10.0, band[1], 30)[1:]])
    omega, weight = gauss_panels(edges, 40)
    it = OSCILLATOR
    square = 2 * it.density / ((it.omega**2 - omega**2) ** 2 + (it.gamma * omega) ** 2)
    displacement, speed = math.sqrt(weight @ square), math.sqrt(weight @ (omega**2 * square))
    return abs(displacement * it.omega / it.speed - 1), abs(speed / it.speed - 1)


def shaken(
    solver: str, options: dict[str, int], duration: float, exact: dict[str, float], say: Say
) -> tuple[xr.Dataset, tuple[float, float], float]:
    """Statistics over `duration` s under the first band with a small enough bias, this band in Hz, and the larger bias
    of u and u', divided by its interval; `exact` has both root mean squares by their names in the dataset."""

    def over_interval(band: tuple[float, float]) -> float:
        return max(left_out / width for left_out, width in zip(bias(band), widths, strict=True))

    bands = list(BANDS)
    while True:
        band = bands.pop(0)
        say(f"{solver}, {band[0]:g} to {band[1]:g} Hz")
        found = statistics(bar(band), solver, duration=duration, seeds=SEEDS, options=options, at=[LENGTH])
        widths = [estimate_of(found, name, 1.0, 0.0, x=LENGTH).uncertainty / value for name, value in exact.items()]
        part = over_interval(band)
        if part <= SMALL or not bands:
            return found, band, part
        # Intervals hardly depend on the band: a band whose bias is too large for them is not tried.
        bands = [other for other in bands if over_interval(other) <= SMALL] or bands[-1:]


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers against the density."""
    it = OSCILLATOR
    gaps = {"top": it.top[0], "bottom": it.bottom[0], **{f"{u:g} m": u for u in LEVELS}}
    exact = {
        "displacement_rms": math.sqrt(it.mean(2)),
        "velocity_rms": it.speed,
    }
    solvers = {name: given for name, given in SOLVERS.items() if name != "fe" or level != "quick"}
    checks, criteria, rows = [], [], []
    factor = joint_factor(len(solvers) * (2 * len(gaps) + len(exact)), 0.95)
    for solver, options in solvers.items():
        found, band, part = shaken(solver, options, DURATION[level] * SHARE[solver], exact, say)
        criteria.append(
            Criterion(f"bias of the band over the interval: {solver}", "1", part, 0.0, SMALL, "of root mean squares")
        )
        smeared = sum(bias(band))
        pairs: list[tuple[str, str, Estimate, float]] = []
        for variable, value in exact.items():
            unit = "m" if variable.startswith("displacement") else "m/s"
            estimate = estimate_of(found, variable, factor, smeared, x=LENGTH)
            pairs.append((variable.replace("_", " "), unit, estimate, value))
        for stop, (name, gap) in enumerate(gaps.items()):
            side = -1 if name == "bottom" else 1
            beyond = it.probability(gap, math.inf) if side > 0 else it.probability(-math.inf, -gap)
            rate = estimate_of(found, "contact_rate", factor, smeared, stop=stop)
            time = estimate_of(found, "contact_time", factor, smeared, stop=stop)
            pairs.append((f"crossings of {side * gap:g} m", "1/s", rate, it.upcrossings(side * gap)))
            pairs.append((f"share of time beyond {side * gap:g} m", "1", time, beyond))
        for name, unit, estimate, value in pairs:
            closed = Estimate(value, 0.0, "Gibbs density", Kind.ANALYTICAL)
            checks.append(Check(f"{name}: {solver}", unit, estimate, closed))
            rows.append((name, unit, solver, value, estimate.value, number(estimate.uncertainty, 2)))
    return CaseResult(
        "random-stops",
        "One mass between stops under white noise",
        "The stationary density of one degree of freedom between elastic stops under white noise is known exactly, "
        "whatever the stops. A bar that hardly bends is that mass. How often and how long it is beyond its stops, and "
        "beyond displacements where a stop of no account counts, is compared with that density. The band of the noise "
        "is widened until what it leaves out is a fifth of an interval or less.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("Density and crossings", ("quantity", "unit", "solver", "exact", "found", "u"), rows),),
    )
