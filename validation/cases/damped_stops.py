"""Damped stops on bars that hardly bend, against closed forms and one degree of freedom marched by numpy alone.

SDND108 (V5.01.108) with its damper of 5 N s/m is compared for both laws: a stop that may pull, as the document has it,
and one that never does.  A free bar rebounds with the coefficient of restitution of the closed form.  A bar between two
damped stops has a cycle, whose impulses, energies and multipliers the witness gives.

Bars on a pin without a spring meet stops that never pull in the analytic solver alone: FE cannot form the exponentials
of a released state whose bending is so much faster than its rigid-body mode.  The cycle compares that law in FE.

A branch of that cycle is followed in the amplitude of the base, from a motion without contact through the graze of the
closed form, back over a fold, and on to both stops.  Motions along it, of which some are unstable, are those of the
witness from their own first state, and so are their multipliers.
"""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, ModalDamping, PolynomialShape, Problem, StepLoad, Stop, Support
from lapjoint.answers import History
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.sequence_changes import SequenceChange
from lapjoint.orbits.branches.starts import start_from
from lapjoint.orbits.branches.tracing import Limits, trace
from validation.case import CaseResult, Level, Say, table
from validation.invariants import witness
from validation.references.damped_oscillator import DampedOscillator, DampedStop, restitution
from validation.verdict import Check, Criterion, Estimate, Kind

STIFF = 1e12
"""Bending stiffness, N m2, of a bar of 1 m: a stop of 100 N/m bends it by 3e-11 of the stop's penetration."""
EXACT = 1e-9  # Relative error of a bar so stiff, and of the witness: nine digits
OF_CYCLE = 1e-6  # The same for a cycle on stops of some 1000 N/m by a bar of 1e9 N m2, and its differences
SOLVERS: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (analytic.Solver(n_modes=1), fe_lapjoint.Solver(elements=1))
"""One mode leaves the bending out; one element has three modes, of which two bend, at 1e6 rad/s."""
PUBLISHED = {True: (0.924038825, -1.882140798), False: (0.865701747, -1.851108433)}
"""Release, s, and displacement at 1 s, m, by whether the stop may pull: as SDND108 prints, and without tension."""
RATIOS = ((0.02, False), (0.3, False), (0.9, False), (1.5, False), (4.0, False), (20.0, False), (0.3, True))
"""Damping ratio of a mass on the stop, and whether the stop may pull; 20 hardly rebounds."""
AMPLITUDE, FROM, TO, BEGIN = "base_motion.amplitude", 5e-4, 3e-3, 6e-4
"""What the branch is followed in: its path, the ends of its range, and where it begins, without contact; m."""
EVERY = 9  # Every so manieth motion along the branch is compared
ALONG = 1e-5
"""Relative tolerance of multipliers along the branch, ten times that of the cycle: beside a graze they change fast, and
the witness takes them from differences."""
WITNESSED = 1e-6  # Tolerance of the invariants of a motion that hardly bends


def bar(damping: float, may_pull: bool, force: float) -> Problem:
    """A bar on a pin whose tip moves as 1 kg, at 1 m/s towards a stop of 100 N/m 2 m below, under a force, N."""
    stop = Stop(x=1.0, side="bottom", gap=2.0, stiffness=100.0, damping=damping, may_pull=may_pull)
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=STIFF, mass_per_length=3.0),
        supports=(Support(x=0.0, translational=math.inf),),
        stops=(stop,),
        damping=ModalDamping(ratio=(0.0, 0.9)),  # of the bending alone, which would ring on the stop
        point_loads=(StepLoad(x=1.0, force=-force),) if force else (),
        initial=PolynomialShape(velocity=(0.0, -1.0)),
    )


def cycle() -> tuple[Problem, DampedOscillator]:
    """A bar between two damped stops, of which one may pull, and the same as one degree of freedom."""
    top = Stop(x=1.0, side="top", gap=0.004, stiffness=900.0, damping=12.0)
    bottom = Stop(x=1.0, side="bottom", gap=0.006, stiffness=500.0, damping=9.0, may_pull=True)
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=1e9, mass_per_length=3.0),
        supports=(Support(x=0.0, translational=math.inf, torsional=60.0),),
        stops=(top, bottom),
        damping=ModalDamping(ratio=(0.02, 0.9)),
        base_motion=BaseMotion(amplitude=0.006, angular_frequency=11.0),
    )
    stops = tuple(DampedStop(s.sign, s.gap, s.stiffness, s.damping, s.may_pull) for s in (top, bottom))
    return problem, DampedOscillator(1.0, 60.0, 0.02, 1.5 * 0.006 * 11.0**2, 11.0, stops)


def check(name: str, unit: str, found: float, exact: float, how: str, error: float = EXACT) -> Check:
    """A number of a solver against a closed form or the witness."""
    a = Estimate(found, error * abs(exact), "a bar that hardly bends")
    return Check(name, unit, a, Estimate(exact, error * abs(exact), how, Kind.ANALYTICAL))


def falling(solver: analytic.Solver | fe_lapjoint.Solver, may_pull: bool) -> tuple[list[Check], History]:
    """SDND108 with a damper of 5 N s/m by one solver, and its motion."""
    history = solver.simulate(bar(5.0, may_pull, 10.0), 1.0, errors=False)
    end, z = PUBLISHED[may_pull]
    law = "may pull" if may_pull else "never pulls"
    released = history.contacts[0].end if history.contacts else math.nan
    how = "SDND108" if may_pull else "closed form"
    return [
        check(f"SDND108, {law}, release: {solver.name}", "s", released, end, how),
        check(f"SDND108, {law}, tip at 1 s: {solver.name}", "m", float(history.displacement(1.0, 1.0)[0, 0]), z, how),
    ], history


def rebound(solver: analytic.Solver | fe_lapjoint.Solver, ratio: float, may_pull: bool) -> list[Check]:
    """A free bar against a damped stop by one solver."""
    history = solver.simulate(bar(20.0 * ratio, may_pull, 0.0), 8.0, errors=False)
    time, speed = restitution(ratio, may_pull)
    name = f"damping ratio {ratio:g}{', may pull' if may_pull else ''}"
    lost = history.contacts[0].dissipated if history.contacts else math.nan
    lasting = history.contacts[0].duration if history.contacts else math.nan
    left = float(history.velocity(1.0, 8.0)[0, 0])
    how = "closed form"
    of_speed = Estimate(left, 10 * EXACT, "a bar that hardly bends")
    return [
        Check(f"{name}, rebound: {solver.name}", "m/s", of_speed, Estimate(speed, 0.0, how, Kind.ANALYTICAL)),
        check(f"{name}, duration: {solver.name}", "s", lasting, float(time) / 10, how, 100 * EXACT),
        check(f"{name}, energy lost: {solver.name}", "J", lost, (1 - speed**2) / 2, how, 10 * EXACT),
    ]


def branch(solver: analytic.Solver | fe_lapjoint.Solver) -> list[Check | Criterion]:
    """The branch of the cycle in the amplitude of the base, by one solver."""
    problem, oscillator = cycle()
    grid = Grid(problem, (Axis(AMPLITUDE, (BEGIN,)),))
    of = ParameterRange(solver, lambda value: grid.with_values((value,)), AMPLITUDE, FROM, TO)
    begin = start_from(of, BEGIN, solver.period_map(grid.with_values((BEGIN,))).initial(), 1)
    found = None if begin is None else trace(of, begin, 1, Limits(max_points=200))
    ends = found.ends if found else ()
    items: list[Check | Criterion] = [
        Criterion(
            f"branch, ends of the range that it reaches: {solver.name}", "1", ends.count("boundary"), 2, 2, "both"
        )
    ]
    if found is None or not found.found:
        return items
    w, own = oscillator.omega, math.sqrt(oscillator.stiffness / oscillator.mass)
    gain = 1.5 * w**2 / abs(own**2 - w**2 + 2j * oscillator.ratio * own * w)
    graze = oscillator.stops[0].gap / gain
    first = found.found[0].what
    value = first.value if isinstance(first, SequenceChange) else math.nan
    items.append(check(f"branch, graze: {solver.name}", "m", value, graze, "closed form", OF_CYCLE))
    for point in found.points[::EVERY]:
        history = point.problem.resolution.map(point.value).history(point.section(), 1)
        state = np.array([history.evaluate(1.0, 0.0, dt=dt)[0, 0] for dt in (0, 1)])
        here = replace(oscillator, force=1.5 * point.value * w**2)
        passed = here.march(state, 0.0, here.period)
        size = float(np.abs(state / [1.0, w]).max())
        for k, name in enumerate(("displacement", "velocity over omega")):
            a, b = (Estimate(float(z[k]) / w**k, OF_CYCLE * size, "after a period") for z in (state, passed.state))
            items.append(Check(f"branch, {point.value:.6g} m, {name}: {solver.name}", "m", a, b))
        mine, exact = (float(np.abs(values).max()) for values in (point.multipliers, here.multipliers(state)))
        label = f"branch, {point.value:.6g} m, largest multiplier: {solver.name}"
        items.append(check(label, "1", mine, exact, "by numpy alone", ALONG))
    return items


def run(level: Level, say: Say) -> CaseResult:
    """Both laws and both solvers, at every level."""
    checks: list[Check] = []
    criteria: list[Criterion] = []
    problem, oscillator = cycle()
    start = oscillator.cycle(15)
    passed, leading = oscillator.march(start, 0.0, oscillator.period), oscillator.multipliers(start)[0]
    for solver in SOLVERS:
        say(solver.name)
        laws = (True, False) if isinstance(solver, analytic.Solver) else (True,)
        for may_pull in laws:
            more, history = falling(solver, may_pull)
            checks += more
            criteria += witness(
                history, WITNESSED, f"SDND108, {'may pull' if may_pull else 'never pulls'}, {solver.name}"
            )
        for ratio, may_pull in RATIOS:
            if may_pull in laws:
                checks += rebound(solver, ratio, may_pull)
        steady = solver.steady_state(problem, errors=False, sensitivity=False)
        for k in range(2):
            for name, unit, found, exact in (
                ("impulse", "N s", steady.impulses, passed.impulses),
                ("energy lost", "J", steady.dissipated, passed.lost),
            ):
                label = f"cycle, {name} of stop {k + 1}: {solver.name}"
                checks.append(check(label, unit, float(found[k]), float(exact[k]), "by numpy alone", OF_CYCLE))
        own = complex(steady.multipliers[0]) if steady.multipliers.size else complex(math.nan)
        for name, found_, exact_ in (
            ("real part", own.real, leading.real),
            ("magnitude of the imaginary part", abs(own.imag), abs(leading.imag)),
        ):
            label = f"cycle, {name} of the leading multiplier: {solver.name}"
            checks.append(check(label, "1", found_, float(np.float64(exact_)), "by numpy alone", 10 * OF_CYCLE))
        for item in branch(solver):
            (checks if isinstance(item, Check) else criteria).append(item)  # type: ignore[arg-type]
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}") for c in checks]
    return CaseResult(
        "damped-stops",
        "Damped stops",
        "Bars on a pin that hardly bend meet damped stops: SDND108 by both laws, to nine digits; free bars, which "
        "rebound with the coefficient of restitution of the closed form; and a cycle between two stops, with its "
        "branch, against one degree of freedom by numpy alone.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("Damped stops", ("quantity", "unit", "reference", "found", "difference"), rows),),
    )
