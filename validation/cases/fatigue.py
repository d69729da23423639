"""Fatigue damage of a cantilever shaken at random, without stops: against counted signals and a narrow band's formula.

The stress at the root and at mid-span is Gaussian, and its spectrum is known in closed form.  Two beams are shaken: the
stress of one has a narrow band, that of the other has two modes.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint import Beam, Material, Problem, RandomBaseMotion, Rectangle, Support, ViscousDamping, statistics
from lapjoint.problem import SNLine
from validation.case import CaseResult, Level, Say, number, table
from validation.references.gaussian_rainflow import GaussianStress
from validation.references.shaken_cantilever import ShakenCantilever
from validation.statistics_estimates import estimate_of, joint_factor
from validation.verdict import Check, Criterion, Estimate, Kind

LENGTH, BREADTH, HEIGHT, MODULUS, DENSITY = 0.9, 0.02, 5e-3, 2.05e11, 7850.0
"""A strip of steel: m, m, m, Pa, kg/m3."""
MASS, STIFFNESS = DENSITY * BREADTH * HEIGHT, MODULUS * BREADTH * HEIGHT**3 / 12
LINE = SNLine(slope=3.0, reference_range=80e6, reference_cycles=2e6)
CYCLES = LINE.reference_cycles * LINE.reference_range**LINE.slope
SEEDS, SEED = 8, 50
SHARE = {"quick": 0.15, "standard": 1.0, "full": 4.0}  # of the durations below
COSTLY = 0.5
"""Fraction of the duration for finite elements, whose march takes several times as long."""
SIGNALS = {"quick": 16, "standard": 32, "full": 128}
SMEARED = 5e-3
"""Relative error of a root mean square by the smeared edges of the band, as in the case `random-linear`."""
STUDENT = 2.13
"""Factor from a standard error to a 95 % interval, of Student's t of 15 degrees of freedom: `SIGNALS` less one or
fewer."""

MOST = "no Gaussian stress does more damage than a narrow band with its root mean square and its crossings of zero"


@dataclass(frozen=True)
class Shaken:
    """A beam under a flat density of acceleration."""

    name: str
    damping: float
    """N s/m2."""
    band: tuple[float, float]
    """Hz."""
    duration: float
    """Length of each of `SEEDS` motions on the level "standard", s."""
    places: dict[str, float]
    """m."""
    solvers: dict[str, dict[str, int]]
    """Options of the solvers, which resolve all modes in the band."""

    @property
    def problem(self) -> Problem:
        """The beam as the solvers take it."""
        material = Material(youngs_modulus=MODULUS, density=DENSITY, fatigue=LINE)
        return Problem(
            beam=Beam(length=LENGTH, material=material, section=Rectangle(breadth=BREADTH, height=HEIGHT)),
            supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
            damping=ViscousDamping(coefficient=self.damping),
            base_motion=RandomBaseMotion(psd=tuple((f, 1.0) for f in self.band), seed=SEED),
        )

    def stress(self, x: float) -> GaussianStress:
        """The stress in closed form, on a grid so fine that 60 frequencies lie within a resonance."""
        beam = ShakenCantilever(LENGTH, STIFFNESS, MASS, self.damping)
        step = self.damping / MASS / (2 * math.pi) / 60
        lines = np.arange(math.ceil(self.band[0] / step), math.floor(self.band[1] / step) + 1)
        f = np.asarray(step * lines, dtype=np.float64)
        per_curvature = MODULUS * HEIGHT / 2
        return GaussianStress(f, np.abs(per_curvature * beam.answer(f, x, 2)) ** 2, LINE.slope, CYCLES)


NARROW = Shaken(
    "narrow band", 1.5, (3.0, 8.0), 600.0, {"the root": 0.0}, {"analytic": {"n_modes": 2}, "fe": {"elements": 3}}
)
WIDE = Shaken(
    "two modes",
    9.0,
    (2.0, 90.0),
    100.0,
    {"the root": 0.0, "mid-span": LENGTH / 2},
    {"analytic": {"n_modes": 4}, "fe": {"elements": 6}},
)


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers against the witnesses."""
    checks, criteria, rows = [], [], []
    factor = joint_factor(sum(len(one.places) * len(one.solvers) for one in (NARROW, WIDE)), 0.95)
    for shaken in (NARROW, WIDE):
        of = {where: shaken.stress(x) for where, x in shaken.places.items()}
        say(f"{shaken.name}, {SIGNALS[level]} signals")
        counted = {where: stress.simulated(SIGNALS[level], SEED) for where, stress in of.items()}
        for solver, options in shaken.solvers.items():
            duration = SHARE[level] * shaken.duration * (COSTLY if solver == "fe" else 1.0)
            say(f"{shaken.name}, {solver}, {SEEDS} motions of {duration:g} s")
            found = statistics(
                shaken.problem,
                solver,
                duration=duration,
                seeds=SEEDS,
                options=options,
                at=sorted(shaken.places.values()),
                quantities=["stress"],
            )
            missed = LINE.slope * SMEARED + float(found.damage_rate.attrs["sampling_error"])
            for where, x in shaken.places.items():
                estimate = estimate_of(found, "damage_rate", factor, missed, x=x)
                stress, (mean, error) = of[where], counted[where]
                name = f"damage a second at {where}, {shaken.name}: {solver}"
                how = f"{SIGNALS[level]} signals of the closed spectrum, counted as by ASTM E1049"
                witness = Estimate(mean, factor * STUDENT * error, how, Kind.OTHER_CODE)
                checks.append(Check(name, "1/s", estimate, witness))
                if shaken is NARROW:
                    checks.append(Check(f"{name}, formula", "1/s", estimate, _between(stress)))
                least = (estimate.value - estimate.uncertainty) / stress.narrow()
                criteria.append(Criterion(f"{name}, least value over Miles", "1", least, 0.0, 1.0, MOST))
                formulas = (stress.narrow(), stress.wirsching_light(), stress.dirlik())
                u = number(estimate.uncertainty, 2)
                rows.append((shaken.name, where, solver, estimate.value, u, mean, *formulas))
    return CaseResult(
        "fatigue",
        "Fatigue damage of random stress",
        "A cantilever with viscous damping under a band of white noise at its base, with an S-N line of slope 3. Its "
        "stress is Gaussian, with a spectrum in closed form. The damage of both solvers' motions is compared with "
        "that of random signals of this spectrum, whose cycles a program of its own counts; where the band is "
        "narrow, also with the formula of Miles, which holds up to the share that the width of the band can take. The "
        "formulas of Wirsching and Light and of Dirlik, fits without stated errors, stand beside for comparison.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(
            table(
                "Damage a second, 1/s",
                ("stress", "place", "solver", "found", "u", "signals", "narrow band", "Wirsching, Light", "Dirlik"),
                rows,
            ),
        ),
    )


def _between(stress: GaussianStress) -> Estimate:
    """The damage of a band that is nearly narrow: at most that of Miles, and at least that of ranges between successive
    extrema, which rainflow ranges exceed; these have g^(m - 1) of it (H. O. Madsen, S. Krenk, N. C. Lind, Methods of
    Structural Safety, 1986)."""
    most, least = stress.narrow(), stress.narrow() * stress.regularity ** (stress.slope - 1)
    how = f"Miles 1954, and the damage of ranges between extrema: {least:.4g} to {most:.4g}"
    return Estimate((most + least) / 2, (most - least) / 2, how, Kind.ANALYTICAL)
