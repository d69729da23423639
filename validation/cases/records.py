"""Recorded base motion and forces: the interpolation between samples, and its motions by both solvers.

Between samples an acceleration and a force are linear, a velocity is a quadratic spline and a displacement a cubic
spline.  Both solvers use the knots of one interpolation, so a mistake in the knots would be in both.  The witness of
the case `pinned-beam` therefore reads the samples itself, and adds up one ramp for each knot.  Recorded sines are
compared with their closed form, and the motion of the base is integrated again.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np
from scipy.interpolate import CubicSpline

import analytic
import fe_lapjoint
from lapjoint import History, paper_joint
from lapjoint.problem import FloatArray, RecordBaseMotion, RecordLoad
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.cases.pinned_beam import LOADED, exact, found
from validation.references.panels import gauss_panels
from validation.references.pinned_beam import PinnedBeam, accelerations
from validation.verdict import Check, Criterion, Estimate, Kind

QUANTITIES = {"displacement": "m", "velocity": "m/s", "acceleration": "m/s2"}
BEAM = LOADED.split("[base_motion]")[0]
DURATION, RATE, OTHER_RATE = 0.06, 2000.0, 1300.0
"""Length, s, and sample rates, Hz: 120 samples of the base, 78 of a force."""
SOLVERS: tuple[analytic.Solver, fe_lapjoint.Solver] = (analytic.Solver(n_modes=24), fe_lapjoint.Solver(elements=32))
MISSED = {"displacement": 1e-5, "velocity": 3e-4, "slope": 1e-4}
"""Error of 24 modes, or 32 elements, for the beam between two pins, divided by the largest value of its kind."""
LEFT_OUT = 1e-8  # Truncation error of the witness, divided by the largest value of its kind
SINE, AMPLITUDE, SAMPLES = 170.0, 1.5e-3, 61  # Frequency, rad/s, amplitude, m, and number of samples, 0.17 rad apart
BY_SAMPLING = 1 / 12  # Mean error of a linear interpolant of a sine, divided by the sine and (omega h)^2
NEARLY = 0.3
"""Relative change of `BY_SAMPLING` by the ends of the record, the start from rest, and other waves of the beam."""
ROUNDED = 1e-9  # Relative rounding of integrals over some hundred knots
NOISE = 1e-6  # Noise of alternating samples of a velocity, m/s
GROWN = 8.0
"""Largest acceleration, divided by the noise and multiplied by the time between samples.  A spline that forgets past
samples gives 4 to 5; a spline that remembers every sample gives twice their number."""
STRAIGHT = 1e-9  # Mean and trend that may remain, divided by the largest acceleration
UNITS = {("acceleration", "g"): 9.80665, ("velocity", "mm/s"): 1e-3, ("displacement", "um"): 1e-6}
"""SI units in each unit; the standard acceleration of free fall is by the third CGPM, 1901."""
SHAKEN, SHAKEN_RATE, SHAKEN_SAMPLES = 200.0, 1e4, 301  # Acceleration, m/s2, sample rate, Hz, and number of samples
FIRST = 3  # Number of contacts that are compared; the next contact only grazes
COARSE: tuple[analytic.Solver, fe_lapjoint.Solver] = (analytic.Solver(n_modes=16), fe_lapjoint.Solver(elements=10))
"""Solvers for the contacts; both state their discretisation error."""


def noise(seed: int, count: int, size: float) -> FloatArray:
    """Independent samples of a normal distribution."""
    return size * np.random.default_rng(seed).standard_normal(count)


def written(values: FloatArray) -> str:
    """Samples as an array of a problem file."""
    return "[" + ", ".join(map(repr, values.tolist())) + "]"


def shaken() -> str:
    """The beam on two pins, shaken by a recorded acceleration, and by a recorded force of another rate."""
    base = noise(1, round(DURATION * RATE) + 1, 30.0)
    force = noise(2, round(DURATION * OTHER_RATE) + 1, 20.0)
    return (
        f'{BEAM}[base_motion]\nkind = "record"\nquantity = "acceleration"\nrate = {RATE}\nvalues = {written(base)}\n'
        f'[[point_loads]]\nkind = "record"\nx = 1.2\nrate = {OTHER_RATE}\nvalues = {written(force)}\n'
    )


def recorded(quantity: str) -> str:
    """The beam on a base whose recorded motion is a sine."""
    t = np.linspace(0.0, DURATION, SAMPLES)
    order = list(QUANTITIES).index(quantity)
    values = AMPLITUDE * SINE**order * np.sin(SINE * t + order * math.pi / 2)
    rate = (SAMPLES - 1) / DURATION
    return (
        f'{BEAM}[base_motion]\nkind = "record"\nquantity = "{quantity}"\nrate = {rate!r}\nvalues = {written(values)}\n'
    )


def moved() -> Iterator[Check]:
    """Both solvers against the sum over sines, with one ramp for each knot."""
    text, beam = shaken(), PinnedBeam.from_toml(shaken())
    points = [(x, t) for x in (0.3, 0.9) for t in (0.0213, 0.0577)]
    witness = np.array([exact(beam, x, t)[: len(MISSED)] for x, t in points])
    for solver in SOLVERS:
        history = solver.simulate(from_toml(text), DURATION, errors=False)
        for (x, t), values in zip(points, witness, strict=True):
            for name, unit, one, other, size in zip(
                MISSED, ("m", "m/s", "1"), found(history, x, t), values, np.abs(witness).max(axis=0), strict=False
            ):
                a = Estimate(one, MISSED[name] * size, solver.name)
                b = Estimate(other, LEFT_OUT * size, "sum over the sines, ramp by ramp", Kind.ANALYTICAL)
                yield Check(f"shaken, {name} at {x:g} m, {t:g} s: {solver.name}", unit, a, b)


def sines() -> Iterator[Criterion]:
    """A recorded sine against its closed form; the error is divided by the error that sampling explains."""
    sine = f"{BEAM}[base_motion]\namplitude = {AMPLITUDE}\nangular_frequency = {SINE}\n"
    beam, places, t = PinnedBeam.from_toml(sine), np.array([0.3, 0.9]), np.linspace(0.0, DURATION, 41)
    closed = np.array([[beam.evaluate(x, when) for when in t] for x in places.tolist()])
    share = (SINE * DURATION / (SAMPLES - 1)) ** 2 * float(np.abs(closed).max())
    for quantity in QUANTITIES:
        for solver in SOLVERS:
            motion = solver.simulate(from_toml(recorded(quantity)), DURATION, errors=False)
            error = float(np.abs(motion.displacement(places, t) - closed).max()) / share
            low = BY_SAMPLING * (1 - NEARLY) if quantity == "acceleration" else 0.0
            name = f"recorded {quantity} of a sine, error over (omega h)^2: {solver.name}"
            reason = "a twelfth where the acceleration is linear between samples; splines meet the sine better"
            yield Criterion(name, "1", error, low, BY_SAMPLING * (1 + NEARLY), reason)


def integrals() -> Iterator[Check]:
    """The motion of a base, recorded in several units, against the knots of the witness, integrated piece by piece."""
    samples, t = np.linspace(0.0, DURATION, SAMPLES), np.linspace(0.0, DURATION, 7)
    for seed, ((quantity, unit), factor) in enumerate(UNITS.items()):
        values = noise(seed, SAMPLES, 2.0)
        base = RecordBaseMotion(quantity=quantity, values=values, rate=(SAMPLES - 1) / DURATION, unit=unit)
        knots, a = accelerations(quantity, samples, factor * values)
        y, v = {
            "acceleration": (0.0, 0.0),
            "velocity": (0.0, factor * values[0]),
            "displacement": (factor * values[0], float(CubicSpline(samples, factor * values)(0.0, 1))),
        }[quantity]
        start = np.stack([y + v * t, np.full(t.size, v), np.zeros(t.size)])
        for n, (what, si) in enumerate(QUANTITIES.items()):
            exact = start[n] + [integral(knots, a, when, 2 - n) for when in t.tolist()]
            u = ROUNDED * float(np.abs(exact).max())
            for when, one, other in zip(t.tolist(), base.at(t, n).tolist(), exact.tolist(), strict=True):
                b = Estimate(other, u, "the witness's knots, integrated", Kind.ANALYTICAL)
                name = f"{what} of a base of which {quantity} was recorded in {unit}, {when:g} s"
                yield Check(name, si, Estimate(one, u, "the base"), b)


def integral(knots: FloatArray, a: FloatArray, t: float, times: int) -> float:
    """Integral of order `times`, 0 to 2, from 0 to t of a function that is linear between knots."""
    if times == 0:
        return float(np.interp(t, knots, a))
    edges = np.append(knots[knots < t], t)
    s, weights = gauss_panels(edges, 2)  # exact up to degree 3: the integrand has degree 2 at most
    return float(np.sum(weights * (t - s) ** (times - 1) * np.interp(s, knots, a)))


def forgotten() -> Iterator[Criterion]:
    """Noise of a recorded velocity in the acceleration, which must not be carried from sample to sample."""
    rate = (SAMPLES - 1) / DURATION
    values = NOISE * (-1.0) ** np.arange(SAMPLES)
    base = RecordBaseMotion(quantity="velocity", values=values, rate=rate)
    largest = float(np.abs(base.at(np.linspace(0.0, DURATION, 20 * SAMPLES), 2)).max())
    reason = "a spline whose knots lie between the samples forgets each of them"
    yield Criterion("noise of a velocity in the acceleration", "1", largest / (NOISE * rate), 1.0, GROWN, reason)


def taken_out() -> Iterator[Criterion]:
    """Mean and trend of a recorded acceleration, and of a recorded force, after their removal."""
    rate, x = (SAMPLES - 1) / DURATION, 1.0
    values = noise(7, SAMPLES, 2.0) + np.linspace(3.0, 5.0, SAMPLES)
    knots = np.linspace(0.0, DURATION, SAMPLES)
    for remove, moments in (("offset", 1), ("drift", 2)):
        base = RecordBaseMotion(quantity="acceleration", values=values, rate=rate, remove=remove)
        force = RecordLoad(x=x, values=values, rate=rate, remove=remove).force
        for what, left in (("acceleration", base.at(knots, 2)), ("force", force)):
            for n in range(moments):
                part = abs(integral(knots, left, DURATION, n + 1)) / DURATION ** (n + 1)
                name = f"record of {what} less its {remove}: {('mean', 'first moment')[n]} that is left"
                yield Criterion(name, "1", part / float(np.abs(values).max()), 0.0, STRAIGHT, "it was taken out")


def contacts() -> Iterator[Check]:
    """The first contacts of the paper's joint under one record, by both solvers, within the errors that they state."""
    values = noise(1, SHAKEN_SAMPLES, SHAKEN)
    base = RecordBaseMotion(quantity="acceleration", values=values, rate=SHAKEN_RATE)
    problem = paper_joint().replace(base_motion=base)
    one, other = (solver.simulate(problem, base.duration) for solver in COARSE)
    for i in range(FIRST):
        for name, unit in (("stop", "1"), ("start", "s"), ("impulse", "N s")):
            a, b = (stated(motion, i, name) for motion in (one, other))
            yield Check(f"paper's joint, contact {i + 1}: {name}", unit, a, b)


def stated(motion: History, i: int, name: str) -> Estimate:
    """A number of a contact with its stated error; NaN if there is no such contact."""
    if i >= len(motion.contacts):
        return Estimate(math.nan, 0.0, motion.solver)
    contact = motion.contacts[i]
    error = {"start": contact.start_error, "impulse": contact.impulse_error}.get(name, 0.0)
    return Estimate(float(getattr(contact, name)), error or 0.0, motion.solver)


def run(level: Level, say: Say) -> CaseResult:
    """Integrals, noise, trends, motions, sines and contacts under records."""
    items: list[Check | Criterion] = []
    for part in (integrals, forgotten, taken_out, moved, sines, contacts):
        say(part.__name__.replace("_", " "))
        items += part()
    checks = tuple(item for item in items if isinstance(item, Check))
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "records",
        "Recorded base motion and forces",
        "The motion of a recorded base is integrated again from its samples, in several units. A beam on two pins "
        "under two records is compared with a sum over sines, one ramp a knot, by numpy alone; sines that were "
        "recorded with their closed form, over the error that sampling explains; and the first contacts of the paper's "
        "joint, shaken by one record, by both solvers within the errors that they state.",
        checks=checks,
        criteria=tuple(item for item in items if isinstance(item, Criterion)),
        tables=(table("Records", ("quantity", "unit", "witness", "found", "difference", "allowed"), rows),),
    )
