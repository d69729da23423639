"""Random excitation as a signal: its spectrum, its integrals over time, and the independence of its parts.

Long stretches of an acceleration of the base and of two forces, all with one seed, are analysed as measured signals: by
root mean squares, by the power in bands and outside them, and by correlations.  The mean square of a Gaussian signal of
density S over a time T has the relative standard error

    sqrt(integral of S^2 df / T) / integral of S df.
"""

from __future__ import annotations

import itertools
import math
from collections.abc import Iterator

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import Beam, ModalDamping, Problem, RandomBaseMotion, RandomLoad, RecordBaseMotion, RecordLoad, Support
from lapjoint.problem import FloatArray
from validation.case import CaseResult, Level, Say, number, table
from validation.references.log_log_density import LogLogDensity
from validation.statistics_estimates import joint_factor
from validation.verdict import Check, Criterion, Estimate, Kind

PSD = ((10.0, 2e-3), (40.0, 3e-2), (80.0, 5e-3))
"""Breakpoints, Hz and g2/Hz or kN2/Hz: the slopes are so steep that any other interpolation gives other powers."""
UNITS = {"acceleration": ("g2/Hz", 9.80665), "force": ("kN2/Hz", 1000.0)}
"""Unit of the density, and SI units in its root; the acceleration of free fall is by the third CGPM, 1901."""
SEED, RATE = 5, 640.0
"""Seed, and samples per second, Hz, eight times the highest frequency: straight lines between samples reduce the
density there by a tenth."""
SAMPLES = {"quick": 2**18, "standard": 2**20, "full": 2**22}
BANDS = (12.0, 16.0, 20.0, 26.0, 33.0, 40.0, 48.0, 57.0, 67.0, 76.0)
"""Edges of the bands, Hz; the ends of the density, which a filter smears, lie outside."""
SMEARED = 4e-3  # Relative error of a root mean square by the edges, smeared over a twentieth of the lowest frequency
TWO_SIGMA = 1.96  # Standard deviations that a normal variable exceeds 5 times in 100
OUTSIDE = (1.25 * PSD[-1][0], RATE / 2)  # Range far from the smeared edge, up to half the sample rate, Hz
LET_THROUGH = 1e-8
"""Largest density in `OUTSIDE`, divided by the largest density.  The filter leaks 1e-10; a jump in the signal would
give 1e-4."""
APART = 5.0
"""Time, s, after which the signal is uncorrelated with itself: 50 periods of its lowest frequency; the edges of the
band need two."""
CHANCE = 7.0
"""Standard deviations that the largest correlation at 1e6 lags exceeds by chance only once in 4e5 cases."""
ROUNDING = 1e-10
"""Rounding of sums of filtered noise, divided by its largest value: the filter has as many taps as there are samples in
13 s."""
SOLVERS: tuple[analytic.Solver, fe_lapjoint.Solver] = (analytic.Solver(n_modes=3), fe_lapjoint.Solver(elements=2))
BEAM = Beam(length=0.7, bending_stiffness=30.0, mass_per_length=0.9)
MARCHED, LOOKED_AT, OTHER_RATE = 14.0, 1401, 500.0
"""Length of the march of a beam, s; number of times at which it is evaluated; sample rate of the force on it, Hz.
Random signals are generated in blocks, and passed on in other blocks of some seconds."""
SAME = 1e-9  # Rounding, divided by the largest value, between thousands of knots of blocks and of records


def base(seed: int = SEED) -> RandomBaseMotion:
    """The motion of a base."""
    return RandomBaseMotion(psd=PSD, unit=UNITS["acceleration"][0], rate=RATE, seed=seed)


def load() -> RandomLoad:
    """A force; its position has no effect on the signal."""
    return RandomLoad(x=0.0, psd=PSD, unit=UNITS["force"][0], rate=RATE, seed=SEED)


def density(measured: str) -> LogLogDensity:
    """The density in SI units, by the witness."""
    si = UNITS[measured][1] ** 2
    return LogLogDensity(tuple((f, s * si) for f, s in PSD))


def mean_square(knots: FloatArray) -> float:
    """Mean square of a signal that is linear between samples, shape (n,)."""
    a, b = knots[:-1], knots[1:]
    return float(np.mean(a * a + a * b + b * b) / 3)


def levels(t: FloatArray) -> Iterator[tuple[str, str, float, float, float]]:
    """Name, unit, value, exact value and relative standard error of each root mean square."""
    signals = {
        ("acceleration of the base", "m/s2"): (base().at(t, 2), density("acceleration"), 0),
        ("velocity of the base", "m/s"): (base().at(t, 1), density("acceleration"), -1),
        ("displacement of the base", "m"): (base().at(t, 0), density("acceleration"), -2),
        ("first force", "N"): (load().realisation(0).at(t), density("force"), 0),
        ("second force", "N"): (load().realisation(1).at(t), density("force"), 0),
    }
    for (name, unit), (values, of, rates) in signals.items():
        square = of.integral(rates)
        error = math.sqrt(of.integral(rates, 2) / t[-1]) / square
        yield f"RMS {name}", unit, math.sqrt(mean_square(values)), math.sqrt(square), error / 2


def bands(t: FloatArray) -> Iterator[tuple[str, str, float, float, float]]:
    """Root mean squares of the acceleration in bands, against the density of a signal that is linear between
    samples."""
    a, f = base().at(t, 2), np.asarray(np.fft.rfftfreq(t.size, 1 / RATE), dtype=float)
    found = np.abs(np.fft.rfft(a)) ** 2 * (2 / t.size**2) * np.sinc(f / RATE) ** 4
    wanted = density("acceleration").at(f) * (RATE / t.size)
    for low, high in itertools.pairwise(BANDS):
        here = (f >= low) & (f < high)
        exact, error = wanted[here].sum(), math.sqrt(np.sum(wanted[here] ** 2)) / wanted[here].sum()
        name = f"RMS from {low:g} to {high:g} Hz"
        yield name, "m/s2", math.sqrt(found[here].sum()), math.sqrt(exact), error / 2


def integrals(t: FloatArray) -> Iterator[Criterion]:
    """Velocity and displacement against the acceleration, which is linear between the samples, integrated."""
    one, h = base(), 1 / RATE
    y, v, a = (one.at(t, n) for n in range(3))
    change = np.diff(a)
    off = []
    for share in (0.5, 1.0):  # fraction of the time to the next sample
        when, s = t[:-1] + share * h, share * h
        by_velocity = v[:-1] + s * (a[:-1] + share * change / 2)
        by_displacement = y[:-1] + s * v[:-1] + s**2 * (a[:-1] / 2 + share * change / 6)
        off.append((f"velocity of the base, {share:g} of a sample on", one.at(when, 1) - by_velocity, v))
        off.append((f"displacement of the base, {share:g} of a sample on", one.at(when, 0) - by_displacement, y))
    for name, error, values in off:
        worst = float(np.abs(error).max() / np.abs(values).max())
        reason = "it is the integral of the acceleration, over edges of blocks too"
        yield Criterion(f"{name}, less its integral", "1", worst, 0.0, ROUNDING, reason)


def outside(t: FloatArray) -> Criterion:
    """The largest density far above the band, divided by the largest within, from stretches under a Hann window."""
    a, n = base().at(t, 2), 2**12
    parts = a[: t.size // n * n].reshape(-1, n) * np.hanning(n)
    power, f = np.mean(np.abs(np.fft.rfft(parts)) ** 2, axis=0), np.fft.rfftfreq(n, 1 / RATE)
    far = power[(f >= OUTSIDE[0]) & (f <= OUTSIDE[1])].max() / power.max()
    return Criterion("density above the band, over the largest", "1", float(far), 0.0, LET_THROUGH, "a filter's leak")


def correlations(t: FloatArray) -> Iterator[Criterion]:
    """The largest correlation, at any lag, of signals that must be independent, in standard deviations."""
    one, of = base().at(t, 2), density("acceleration")
    others = {
        "base and base, more than 5 s apart": one,
        "base and first force": load().realisation(0).at(t),
        "base and second force": load().realisation(1).at(t),
        "base and the base of the next seed": base(SEED + 1).at(t, 2),
    }
    sigma = math.sqrt(of.integral(0, 2) / (2 * t[-1])) / of.integral(0)
    whole = np.fft.rfft(one, 2 * t.size)
    for name, other in others.items():
        both = np.fft.irfft(whole * np.conj(np.fft.rfft(other, 2 * t.size)))
        lags = np.arange(both.size)
        far = np.minimum(lags, both.size - lags) > (APART * RATE if other is one else -1)
        most = np.abs(both[far]).max() / np.linalg.norm(one) / np.linalg.norm(other)
        yield Criterion(f"correlation, {name}", "sigma", float(most / sigma), 0.0, CHANCE, "all are independent")
    first, second = load().realisation(0).at(t), load().realisation(1).at(t)
    both = np.fft.irfft(np.fft.rfft(first, 2 * t.size) * np.conj(np.fft.rfft(second, 2 * t.size)))
    most = np.abs(both).max() / np.linalg.norm(first) / np.linalg.norm(second)
    yield Criterion(
        "correlation, first and second force", "sigma", float(most / sigma), 0.0, CHANCE, "all are independent"
    )


def edges() -> Iterator[Criterion]:
    """A beam under a random base and force, block by block, against the same beam under records of the same samples."""
    force = RandomLoad(x=BEAM.length, psd=PSD, rate=OTHER_RATE, seed=SEED)
    clamped = Support(x=0.0, translational=math.inf, torsional=math.inf)
    shaken = Problem(
        beam=BEAM, supports=(clamped,), damping=ModalDamping(ratio=0.02), base_motion=base(), point_loads=(force,)
    )
    times = [np.arange(math.ceil(MARCHED * rate) + 2) / rate for rate in (RATE, OTHER_RATE)]
    recorded = shaken.replace(
        base_motion=RecordBaseMotion(quantity="acceleration", values=base().at(times[0], 2), rate=RATE),
        point_loads=(RecordLoad(x=BEAM.length, values=force.realisation(0).at(times[1]), rate=OTHER_RATE),),
    )
    t = np.linspace(0.0, MARCHED, LOOKED_AT)
    for solver in SOLVERS:
        one, other = (
            solver.simulate(it, MARCHED, errors=False).displacement(BEAM.length, t) for it in (shaken, recorded)
        )
        worst = float(np.abs(one - other).max() / np.abs(other).max())
        name = f"tip under blocks less that under one record, over the largest: {solver.name}"
        yield Criterion(name, "1", worst, 0.0, SAME, "the same samples")


def run(level: Level, say: Say) -> CaseResult:
    """Levels, bands, integrals, leakage, correlations and edges of blocks."""
    t = np.arange(SAMPLES[level]) / RATE
    say(f"{t[-1]:.0f} s of a signal")
    found = [*levels(t), *bands(t)]
    factor = joint_factor(len(found), 0.95)
    checks, rows = [], []
    for name, unit, value, exact, error in found:
        u = (factor * TWO_SIGMA * error + SMEARED) * exact
        closed = Estimate(exact, 0.0, "the density, integrated", Kind.ANALYTICAL)
        checks.append(Check(name, unit, Estimate(value, u, f"{t[-1]:.0f} s of the signal"), closed))
        rows.append((name, unit, exact, value, number(u, 2)))
    say("correlations, and a beam")
    return CaseResult(
        "random-signal",
        "Random excitation as a signal",
        "An acceleration of the base and two forces, by one density with slopes and by one seed. "
        "Root mean squares, also of what is integrated over time, and the power in bands are compared with integrals "
        "of the density; intervals are those of a Gaussian signal watched for so long, widened so that all of them "
        "hold together in 95 % of cases. Signals that are to be independent must not be correlated at any lag, and "
        "what passes outside of the band is bounded. A beam under the signal, which comes in blocks, moves as under a "
        "record of it.",
        checks=tuple(checks),
        criteria=(*integrals(t[: 2**17]), outside(t), *correlations(t), *edges()),
        tables=(table("Root mean squares", ("quantity", "unit", "by the density", "found", "u"), rows),),
    )
