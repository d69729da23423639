"""Does a march from rest end on the motion that the search certifies?

The search is shared by both solvers.  If it accepts a motion too early, accepts an unstable motion, or assumes a
symmetry that does not exist, both solvers are wrong in the same way.  Each solver is therefore compared with its own
march: with `simulate`, which uses neither orbits nor Newton's method, over so many decay times that nothing of the
transient is left.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History, ModalDamping, Problem, SteadyState
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.orbit_invariants import steady_witness
from validation.verdict import Check, Criterion, Estimate, Kind

Solver = analytic.Solver | fe_lapjoint.Solver
SOLVERS: tuple[Solver, ...] = (analytic.Solver(n_modes=6), fe_lapjoint.Solver(elements=3))
"""Coarse solvers, as each solver is compared only with itself."""
DECAY_TIMES = 20.0
"""Length of a march in decay times of the slowest free vibration: exp(-20) = 2e-9 of its transient is left.  A motion
with contacts may decay more slowly than free vibration; with the slowest multiplier here, 0.93 over three periods, less
is left."""
WATCHED = 24  # Periods at the end of a march whose section points are compared
LONGEST = 8  # Largest period multiple that is tried
SAME = 1e-3  # Distance of two equal section points, divided by the size of the motion; other phases differ by more
EQUAL = 1e-4  # Relative difference of impulses between the march and the orbit; coarse modes leave jumps at switches
POINTS = 9  # Points along the beam at which section points are compared
WITNESS = 0.05  # Relative error of energy and impulses with six modes, or three elements

JOINT = """
title = "{title}"
[beam]
length = 1.0
bending_stiffness = 1.0
mass_per_length = 1.0
[[supports]]
x = 0.0
translational = inf
torsional = inf
[damping]
kind = "modal"
ratio = {ratio}
[base_motion]
amplitude = 1e-3
angular_frequency = {omega}
"""
STOP = """
[[stops]]
x = {x}
side = "{side}"
gap = {gap}
stiffness = {stiffness}
"""
FIRST = 3.5160152685  # First natural frequency of the cantilever, rad/s


def joint(title: str, times: float, ratio: float, *stops: tuple[float, str, float, float]) -> Problem:
    """A cantilever of unit stiffness, mass and length, excited at a multiple of its first frequency."""
    text = JOINT.format(title=title, ratio=ratio, omega=repr(times * FIRST))
    for x, side, gap, stiffness in stops:
        text += STOP.format(x=x, side=side, gap=gap, stiffness=stiffness)
    return from_toml(text)


JOINTS = {
    "early contacts": joint("A late end on three periods", 4.5, 0.01, (1.0, "top", 3e-3, 100.0)),
    "three periods": joint(
        "A stable motion of one period beside it", 4.976706, 0.02, (1.0, "top", 1.849372330525e-3, 29.229075838)
    ),
    "uneven": joint(
        "Gaps that differ by a fifth", 3.2, 0.05, (1.0, "top", 4.7e-4, 30.0), (1.0, "bottom", 5.64e-4, 30.0)
    ),
    "twins": joint(
        "Equal gaps, light damping", 2.555, 0.02, (1.0, "top", 9.873e-4, 100.0), (1.0, "bottom", 9.873e-4, 100.0)
    ),
}
"""The first joint has a stable motion without contact, to which a march seems near at first.  The second has a stable
motion of one period, but rest is not in its basin.  No motion of the third mirrors itself.  The motion of the fourth
mirrors itself, and a search that misses this calls the motion not symmetric."""

CHAOTIC = {"chaos": joint("Never the same again", 5.8, 0.008, (1.0, "top", 6e-3, 200.0))}
"""A joint whose exponent is ten standard errors above zero, and for which no stable motion was found."""

FINE: dict[str, Solver] = {
    SOLVERS[0].name: analytic.Solver(n_modes=24),
    SOLVERS[1].name: fe_lapjoint.Solver(elements=12),
}
"""Solvers four times as fine: their errors are at most a sixteenth, because errors fall with the second power or
faster."""
ESTIMATED = ("uneven",)  # Joints whose stated errors are judged: the march ends on one orbit at every resolution
LAVISH = 60.0  # Largest stated error, divided by the true error: the stated error is a bound, but must be informative


@dataclass(frozen=True)
class End:
    """The end of a march from rest."""

    multiple: int
    """Excitation periods after which the motion repeats; 0 if it does not repeat within `LONGEST`."""
    impulses: FloatArray
    """Impulse of each stop per excitation period, N s, shape ``(stops,)``."""
    periods: int
    """Excitation periods that were marched."""


def decay_time(problem: Problem) -> float:
    """Decay time of the slowest free vibration, s."""
    assert isinstance(problem.damping, ModalDamping)
    return 1 / (float(problem.damping.ratios(1)[0]) * FIRST)


def end_of_march(solver: Solver, problem: Problem) -> End:
    """The end of a march from rest, so long that nothing of the transient is left."""
    period = problem.require_excitation_period("march")
    # a number of periods that every tried multiple divides
    periods = math.ceil(DECAY_TIMES * decay_time(problem) / period) + WATCHED
    history = solver.simulate(problem, periods * period, errors=False)
    multiple = repeats(history, periods, period)
    last = WATCHED // max(multiple, 1) * max(multiple, 1)
    return End(multiple, impulses_after(history, (periods - last) * period) / last, periods)


def repeats(history: History, periods: int, period: float) -> int:
    """The period multiple of the last section points; 0 if they do not repeat within `LONGEST` periods."""
    x = np.linspace(0.0, history.problem.line.length, POINTS)
    t = period * np.arange(periods - WATCHED, periods + 1, dtype=float)
    points = np.concatenate([history.displacement(x, t), history.velocity(x, t) * period / (2 * math.pi)])
    apart = [float(np.abs(points[:, n:] - points[:, :-n]).max()) for n in range(1, LONGEST + 1)]
    near = SAME * float(np.abs(points).max())
    return next((n for n, distance in enumerate(apart, start=1) if distance <= near), 0)


def impulses_after(history: History, start: float) -> FloatArray:
    """Impulse of each stop after a time, N s; of a contact at this time, the later part, by the integral of its
    force."""
    total = np.zeros(len(history.problem.stops))
    for contact in history.contacts:
        if contact.start >= start:
            total[contact.stop] += contact.impulse
        elif contact.end > start:
            t = np.linspace(start, contact.end, 401)
            total[contact.stop] -= np.trapezoid(
                history.contact_force(t)[contact.stop], t
            )  # the sign is of the force on the beam
    return total


def compared(label: str, solver: Solver, steady: SteadyState, end: End) -> Iterator[Check | Criterion]:
    """The motion found by the search, against the end of the march; the search must not have needed a longer march."""
    how = f"march of {end.periods} periods"
    found = Estimate(float(steady.period_multiple), 0.0, "search")
    marched = Estimate(float(end.multiple), 0.0, how, Kind.ANALYTICAL)
    yield Check(f"{label}, excitation periods: {solver.name}", "1", found, marched)
    assert steady.acceptance is not None
    name = f"{label}, excitation periods until it is accepted: {solver.name}"
    reason = "an orbit that the march leaves is dropped at once, so that another is looked for"
    yield Criterion(name, "1", float(steady.acceptance.periods), 0.0, float(end.periods), reason)
    size = float(np.abs(end.impulses).max(initial=0.0))
    for k, (one, other) in enumerate(zip(steady.impulses, end.impulses, strict=True)):
        found = Estimate(float(one), 0.0, "search")
        marched = Estimate(float(other), EQUAL * size, how)
        yield Check(f"{label}, impulse of stop {k + 1} per excitation period: {solver.name}", "N s", found, marched)


def lasting(label: str, solver: Solver, problem: Problem) -> Iterator[Check | Criterion]:
    """A motion that does not repeat, against the end of a march, and the time over which its exponent was measured."""
    steady, end = solver.steady_state(problem, sensitivity=False, errors=False), end_of_march(solver, problem)
    found = Estimate(float(steady.period_multiple), 0.0, "search")
    marched = Estimate(float(end.multiple), 0.0, f"march of {end.periods} periods", Kind.ANALYTICAL)
    yield Check(f"{label}, excitation periods (0: it does not repeat): {solver.name}", "1", found, marched)
    name = f"{label}, decay times over which it is seen not to repeat: {solver.name}"
    lasted = steady.exponent.time / decay_time(problem) if steady.exponent is not None else 0.0
    reason = "what repeats in the end may look like chaos for long"
    yield Criterion(name, "1", lasted, DECAY_TIMES * (1 - SAME), math.inf, reason)


def estimated(label: str, solver: Solver, problem: Problem, steady: SteadyState) -> Iterator[Criterion]:
    """Stated errors of impulses, divided by true errors, which a finer solver shows."""
    fine = FINE[solver.name].steady_state(problem, sensitivity=False, errors=False)
    assert steady.impulse_errors is not None
    true = float(np.abs(steady.impulses - fine.impulses).max())
    stated = float(steady.impulse_errors.max())
    reason = f"a bound, and of use; the true error by {fine.solver}"
    yield Criterion(f"{label}, stated error over the true one: {solver.name}", "1", stated / true, 1.0, LAVISH, reason)


def run(level: Level, say: Say) -> CaseResult:
    """All joints by both solvers."""
    items: list[Check | Criterion] = []
    for label, problem in JOINTS.items():
        for solver in SOLVERS:
            steady = solver.steady_state(problem, sensitivity=False, errors=label in ESTIMATED)
            items += compared(label, solver, steady, end_of_march(solver, problem))
            items += steady_witness(steady, WITNESS, f"{label}, {solver.name}")
            if label in ESTIMATED:
                items += estimated(label, solver, problem, steady)
        say(label)
    for label, problem in CHAOTIC.items():  # the search is shared, so one solver is enough
        items += lasting(label, SOLVERS[0], problem)
        say(label)
    checks = tuple(item for item in items if isinstance(item, Check))
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "settled",
        "What a march from rest ends on",
        "The search accepts a motion as soon as it can prove that the march is bound for it. Here each solver marches "
        f"on from rest, without a search, over {DECAY_TIMES:g} decay times of its slowest free vibration: the period "
        "multiple and the impulses of the last periods are compared with those of the motion that was found. Where a "
        "joint's orbit is the same at every resolution, stated errors of coarse solvers are compared with true ones. "
        "One joint never repeats, and the search must have seen that for as long.",
        checks=checks,
        criteria=tuple(item for item in items if isinstance(item, Criterion)),
        tables=(table("Ends of marches", ("quantity", "unit", "marched", "found", "difference", "allowed"), rows),),
    )
