"""Rigid bars between stops: both solvers, and the package that they share, against a witness of numpy and scipy
alone."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History, Problem, SteadyState
from lapjoint.orbits.exponent import exponent_of
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.references.rigid_bar import BarMotion, RigidBar
from validation.references.rigid_bar_orbits import mirrors_itself, multipliers, period_multiple, periodic
from validation.verdict import Check, Estimate, Kind

SOFT, RATIO = 2.5e5, 4.0
"""Bending stiffness, N m2, of the softer of two beams, and the ratio of the other's to it: both bend little."""
SOLVERS: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (
    analytic.Solver(n_modes=5),
    fe_lapjoint.Solver(elements=1),  # and a node at every support, stop and load: the bar hardly bends
)
CURVED = 0.2
"""Fraction of a change that is not proportional to 1 / EI: the next power is smaller by k L^3 / EI, at most 0.1
here."""
UNSURE = {"velocity": 1.0}  # As `CURVED`, for a number in which the ringing after an impact shows, with either sign
DURATION = 1.2  # Length of the motion from the initial state, s: two to five excitation periods
CONTACTS = 4  # Contacts compared one by one
TIMES = np.array([0.0, 0.23, 0.51, 0.77, 1.09])  # Times at which the motion is compared, s
ROUNDING = 1e-8  # Error of the witness by its differences and roots, divided by the largest number of its kind
CLOSED = 1e-8  # Error of the orbit, divided by the motion: ten times the largest residual of Newton's method
PASSED = 3  # Periods of a march without a deviation
FOLLOWED, MEASURED = 84, 64
"""Number of periods over which a deviation is followed, and number of the last of these that are measured."""
FOLLOWED_IN = "springs"  # Bar whose leading multiplier is real, so that every period has the same growth
EXACT = 1e-4  # Relative error of the growth along an orbit, measured after 20 periods, against the multiplier

SPRINGS = """
title = "Bar on two springs, all loads, two stops"
[beam]
length = 1.5
bending_stiffness = {stiffness}
mass_per_length = 4.0
[[supports]]
x = 0.0
translational = 900.0
[[supports]]
x = 1.2
translational = 1500.0
torsional = 130.0
[[stops]]
x = 1.5
side = "top"
gap = 2.1e-3
stiffness = 5200.0
[[stops]]
x = 0.3
side = "bottom"
gap = 1.7e-3
stiffness = 3100.0
[damping]
kind = "modal"
ratio = [0.03, 0.11, 0.6]
[base_motion]
amplitude = 4e-3
angular_frequency = 14.0
phase = 0.7
[[point_loads]]
kind = "step"
x = 0.9
force = 3.0
[[point_loads]]
kind = "sine"
x = 0.3
force = 5.0
angular_frequency = 14.0
phase = -0.4
[initial]
kind = "polynomial"
displacement = [1e-3, -5e-4]
velocity = [0.02, 0.01]
"""
MIRROR = """
title = "Bar on a pin between two equal stops, viscous damping"
[beam]
length = 1.5
bending_stiffness = {stiffness}
mass_per_length = 4.0
[[supports]]
x = 0.0
translational = inf
torsional = 600.0
[[stops]]
x = 1.2
side = "top"
gap = 1.5e-3
stiffness = 2400.0
[[stops]]
x = 1.2
side = "bottom"
gap = 1.5e-3
stiffness = 2400.0
[damping]
kind = "viscous"
coefficient = 6.0
[base_motion]
amplitude = 2e-3
angular_frequency = 14.0
phase = -0.5
"""
DOUBLED = """
title = "Bar on a pin against one stop, where the motion of one period is unstable"
[beam]
length = 1.5
bending_stiffness = {stiffness}
mass_per_length = 4.0
[[supports]]
x = 0.0
translational = inf
torsional = 450.0
[[stops]]
x = 1.2
side = "top"
gap = 1.0e-3
stiffness = 6000.0
[damping]
kind = "modal"
ratio = [0.05, 0.5]
[base_motion]
amplitude = 2e-3
angular_frequency = 26.0
phase = 0.3
"""
UNEVEN = MIRROR.replace("gap = 1.5e-3", "gap = 1.9e-3", 1)
"""A bar between stops of unequal gaps, where no motion mirrors itself."""
HARMONICS = (
    MIRROR.partition("[base_motion]")[0]
    + """[base_motion]
kind = "harmonics"
angular_frequency = 14.0
[[base_motion.harmonics]]
multiple = 1
amplitude = 2e-3
phase = -0.5
[[base_motion.harmonics]]
multiple = 2
amplitude = 2e-4
phase = 0.9
"""
)
"""A bar between equal stops, but with an even harmonic of the base, so that no motion mirrors itself."""
LADEN = """
title = "Bar of two segments with masses, under gravity, between a pressing stop, a stop, and a wall fixed in space"
[beam]
length = 1.5
contents_per_length = 0.9
added_mass_per_length = 0.6
[[beam.segments]]
to = 0.6
bending_stiffness = {stiffness}
mass_per_length = 5.0
[[beam.segments]]
to = 1.5
bending_stiffness = {stiffness}
mass_per_length = 2.2
[[supports]]
x = 0.0
translational = 1100.0
[[supports]]
x = 0.9
translational = 1400.0
torsional = 130.0
[[masses]]
x = 1.5
mass = 0.8
rotary_inertia = 0.05
[[masses]]
x = 0.6
mass = 1.3
[[stops]]
x = 0.3
side = "top"
gap = -1.5e-3
stiffness = 2600.0
[[stops]]
x = 1.2
side = "bottom"
gap = 2.6e-2
stiffness = 4200.0
[[stops]]
x = 1.5
side = "top"
gap = -4.0e-3
stiffness = 3300.0
fixed_to = "space"
[gravity]
acceleration = -2.7
[[uniform_loads]]
from = 0.75
force_per_length = -6.0
[[uniform_loads]]
from = 0.15
to = 0.45
force_per_length = 11.0
[damping]
kind = "modal"
ratio = [0.04, 0.07, 0.6]
[base_motion]
amplitude = 6e-3
angular_frequency = 13.0
phase = 0.4
[initial]
kind = "polynomial"
velocity = [0.03, -0.04]
"""
BARS = {
    "springs": SPRINGS,
    "mirror": MIRROR,
    "uneven": UNEVEN,
    "doubled": DOUBLED,
    "harmonics": HARMONICS,
    "laden": LADEN,
}


@dataclass(frozen=True)
class Quantity:
    """A number to be compared."""

    name: str
    unit: str
    kind: str
    """Kind of the number: numbers of a kind have similar sizes, and one uncertainty."""


@dataclass(frozen=True)
class Witnessed:
    """Motion and steady state of a bar by the witness."""

    bar: RigidBar
    motion: BarMotion
    """Motion from the initial state."""
    periodic: BarMotion
    """The steady state, over its own period."""
    multiple: int
    """Excitation periods of the steady state."""


def witnessed(text: str) -> Witnessed:
    """Motion and steady state of a rigid bar."""
    bar = RigidBar.from_toml(text.format(stiffness="inf"))
    multiple = period_multiple(bar)
    return Witnessed(bar, bar.march(DURATION), periodic(bar, multiple), multiple)


def quantities(it: Witnessed) -> list[tuple[Quantity, float]]:
    """All numbers of a bar by the witness."""
    found = []
    for i, contact in enumerate(it.motion.contacts[:CONTACTS]):
        name = f"contact {i + 1}"
        found += [
            (Quantity(f"{name}: stop", "1", "count"), float(contact.stop)),
            (Quantity(f"{name}: impact", "s", "time"), contact.start),
            (Quantity(f"{name}: rebound", "s", "time"), contact.end),
            (Quantity(f"{name}: impulse", "N s", "impulse"), contact.impulse),
            (Quantity(f"{name}: peak force", "N", "force"), contact.peak),
        ]
    for derivative, (what, unit) in enumerate((("displacement", "m"), ("velocity", "m/s"))):
        values = it.motion.evaluate(it.bar.length, TIMES, derivative)
        found += [
            (Quantity(f"{what} of the tip at {t:g} s", unit, what), float(value))
            for t, value in zip(TIMES, values, strict=True)
        ]
    found.append((Quantity("steady: excitation periods", "1", "count"), float(it.multiple)))
    found.append((Quantity("steady: symmetric", "1", "count"), float(mirrors_itself(it.periodic))))
    found.append((Quantity("steady: contacts", "1", "count"), float(it.periodic.closings)))
    for k, impulse in enumerate(it.periodic.impulses() / it.multiple):
        found.append((Quantity(f"steady: impulse of stop {k + 1} per excitation period", "N s", "steady"), impulse))
    leading = multipliers(it.periodic)[0]
    found.append((Quantity("steady: modulus of the leading multiplier", "1", "multiplier"), float(abs(leading))))
    if it.bar.damping_is_modal:  # else all multipliers have one modulus, and the leading one is arbitrary
        found.append((Quantity("steady: leading multiplier, real part", "1", "multiplier"), float(leading.real)))
    return found


def answers(history: History, steady: SteadyState, it: Witnessed) -> list[float]:
    """The numbers of `quantities` by a solver, in their order; NaN for a contact that is missing."""
    found: list[float] = []
    for i in range(len(it.motion.contacts[:CONTACTS])):
        if i < len(history.contacts):
            c = history.contacts[i]
            found += [float(c.stop), c.start, c.end, c.impulse, c.peak_force]
        else:
            found += [math.nan] * 5
    tip = history.problem.line.length
    found += [*history.displacement(tip, TIMES)[0], *history.velocity(tip, TIMES)[0]]
    found += [float(steady.period_multiple), float(steady.symmetric), float(_closings(steady.history))]
    leading = steady.multipliers[0] if steady.multipliers.size else math.nan
    found += [*steady.impulses, abs(leading)]
    return [*found, float(np.real(leading))] if it.bar.damping_is_modal else found


def _closings(history: History) -> int:
    """Number of contacts in one period of the motion; a contact at the section point counts once."""
    return sum(not contact.open_start for contact in history.contacts)


def to_the_limit(soft: FloatArray, stiff: FloatArray, kinds: Sequence[str]) -> tuple[FloatArray, FloatArray]:
    """Numbers of the rigid bar, extrapolated from two beams, and their uncertainty.  The effect of bending is
    proportional to 1 / EI, and the uncertainty is a fraction of the largest change of a kind."""
    change = stiff - soft
    largest = {kind: np.max(np.abs(change[[k == kind for k in kinds]])) for kind in kinds}
    return stiff + change / (RATIO - 1), np.array([UNSURE.get(kind, CURVED) * largest[kind] for kind in kinds])


def compared(label: str, text: str, say: Say) -> list[Check]:
    """One bar by both solvers against the witness."""
    it = witnessed(text)
    names, exact = zip(*quantities(it), strict=True)
    kinds = [quantity.kind for quantity in names]
    reference = np.array(exact)
    size = {kind: np.max(np.abs(reference[[k == kind for k in kinds]])) for kind in kinds}
    checks: list[Check] = []
    for solver in SOLVERS:
        levels = []
        for factor in (1.0, RATIO):
            problem = from_toml(text.format(stiffness=repr(SOFT * factor)))
            steady = solver.steady_state(problem, sensitivity=False, errors=False)
            levels.append(np.array(answers(solver.simulate(problem, DURATION, errors=False), steady, it), dtype=float))
            closes = Estimate(steady.residual, 0.0, "of the search")
            closed = Estimate(0.0, CLOSED, "a motion that repeats closes", Kind.ANALYTICAL)
            stiff = f"{SOFT * factor:g} N m2 stiff"
            checks.append(Check(f"{label}, residual, {stiff}: {solver.name}", "1", closes, closed))
            if factor == 1.0 and label == FOLLOWED_IN:
                checks += growth_on_orbit(label, solver, problem, steady)
        value, u = to_the_limit(levels[0], levels[1], kinds)
        for i, quantity in enumerate(names):
            how = f"{solver.name}, beams {SOFT:g} and {RATIO * SOFT:g} N m2 stiff, taken to the limit"
            found = Estimate(float(value[i]), float(u[i]), how)
            rounding = 0.0 if quantity.kind == "count" else ROUNDING * float(size[quantity.kind])
            witness = Estimate(float(reference[i]), rounding, "rigid bar, by numpy alone", Kind.ANALYTICAL)
            checks.append(Check(f"{label}, {quantity.name}: {solver.name}", quantity.unit, found, witness))
        say(f"{label}, {solver.name}")
    return checks


def growth_on_orbit(
    label: str, solver: analytic.Solver | fe_lapjoint.Solver, problem: Problem, steady: SteadyState
) -> Iterator[Check]:
    """The Lyapunov exponent of a stable orbit, from a deviation that is followed, against ln |multiplier| / period.
    The impulses of these marches are also compared."""
    period_map = solver.period_map(problem)
    start = steady.section_point
    deviation = np.ones(period_map.difference(start, start).size)
    found = period_map.followed(start, deviation / period_map.norm(deviation), FOLLOWED)
    growth = exponent_of(found.growth[-MEASURED:], period_map.period)
    leading = abs(steady.multipliers[0]) if steady.multipliers.size else math.nan
    rate = math.log(leading) / (max(steady.period_multiple, 1) * period_map.period)
    a = Estimate(growth.value, abs(rate) * EXACT, "a deviation followed along the orbit")
    b = Estimate(rate, abs(rate) * EXACT, "its Floquet multiplier")
    yield Check(f"{label}, Lyapunov exponent of the orbit: {solver.name}", "1/s", a, b)
    passed = period_map.march(start, 2 * PASSED).impulses / PASSED
    for k, steadily in enumerate(steady.impulses):
        reference = Estimate(float(steadily), abs(float(steadily)) * EXACT, "steady state")
        for how, impulses in (("march", passed), ("march with a deviation", found.impulses.mean(axis=0))):
            marched = Estimate(float(impulses[k]), 0.0, f"mean over a {how}")
            yield Check(f"{label}, mean impulse of stop {k + 1} over a {how}: {solver.name}", "N s", marched, reference)


def run(level: Level, say: Say) -> CaseResult:
    """All bars."""
    checks = [check for label, text in BARS.items() for check in compared(label, text, say)]
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.a.uncertainty:.1e}", f"{c.difference:.1e}") for c in checks]
    return CaseResult(
        "rigid-bar",
        "Rigid bars between stops",
        "Beams so stiff that they hardly bend, on springs and between stops, under base motion by a sine or harmonics, "
        "step and sine loads with phases, with initial displacements and velocities, by different damping ratios or "
        "viscous damping. The witness has one or two degrees of freedom and is computed by numpy alone, from the "
        "problem file's text: contacts, impulses, peak forces, steady states, multipliers by finite differences of its "
        "own march. Two bending stiffnesses, one four times the other, take each number to the rigid limit.",
        checks=tuple(checks),
        tables=(table("Rigid bars", ("quantity", "unit", "witness", "found", "u", "difference"), rows),),
    )
