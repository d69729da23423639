"""Branches and basins: grazes, folds and flips by both solvers, against closed forms, other codes and plain marches.

The branch of a cantilever under a stop has a graze, whose amplitude has a closed form, and two folds.  A bar against
one stop flips where the leading multiplier of a rigid bar, by numpy alone, passes -1.  A bar that touches its stop once
a period has a fold where the amplitude of the bilinear oscillator, as a function of the duration of its contact, is
extreme.  On either side of a fold or a flip, and from every start of a small basin, a plain march must end on the
motion of the branch or of the basin.  `branch_births` has symmetry breaking and tori, `branch_ends` the ends of
branches.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import replace
from statistics import NormalDist
from typing import Any

import numpy as np
import xarray as xr
from scipy.optimize import brentq

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, PolynomialShape, Problem, Stop, Support, ViscousDamping, basins, branch, confirm
from lapjoint.answers import SectionPoint
from lapjoint.campaigns.confirm.table import VERDICTS
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, number, table
from validation.cases.branch_births import over_births
from validation.cases.branch_ends import over_ends
from validation.cases.branch_found import AMPLITUDE, BARS, Found, bifurcations, sure, to_rigid
from validation.cases.rigid_bar import DOUBLED, RATIO, SOFT
from validation.references.bilinear_map import BilinearMap, Piece
from validation.references.rigid_bar import RigidBar
from validation.references.rigid_bar_orbits import multipliers, periodic
from validation.references.shaken_cantilever import ShakenCantilever
from validation.verdict import Check, Criterion, Estimate, Kind

BEAM = ShakenCantilever(length=1.0, stiffness=1.0, mass=1.0, damping=0.8)
GAP, OMEGA = 1e-3, 5.0  # Gap, m, and excitation frequency, rad/s
AMPLITUDES = (3.15e-4, 3.45e-4)
"""Amplitudes of the base, m: both folds, 3.20e-4 and 3.36e-4, and the graze lie between them."""
FREQUENCY = "base_motion.angular_frequency"
SOLVERS: dict[str, tuple[dict[str, int], Any]] = {
    "analytic": ({"n_modes": 8}, analytic.Solver(n_modes=8)),
    "fe": ({"elements": 4}, fe_lapjoint.Solver(elements=4)),
}
SEQUENCE = ("grazing", "fold", "fold")  # Bifurcations on the branch that begins without contact, in order
CLOSED = 1e-10
"""Tolerance of the first graze, divided by the amplitude: the motion is linear, and Newton's method is exact to
rounding."""
BESIDE = 4e-3
"""Distance of marches from a fold, divided by the parameter there.  The length of transients goes as one over the root
of this distance."""
MARCHED = 300  # Length of a march in excitation periods, in which a multiplier of 0.96 decays to 1e-5
AT_GRAZE = 1e-3
"""Distance of a point just before the graze, divided by the amplitude: finer solvers have the graze slightly
elsewhere."""
SETTLED = 1e-7  # Relative error near a fold of an orbit that closes to 1e-9
APPROACH = 5
"""Number of steps of the amplitude from the end of the range to the upper fold: a larger change would throw the beam
against its stop."""
PRESSED = 5e-4  # Impulse per period between the impulses of the motions on either side of a fold, N s
FLIPS = (22.95, 23.25)  # Range of frequencies, rad/s, that contains the flip of the bar at 23.14
DOUBLE = 1.016
"""Frequency, divided by the frequency of the flip, at which a march from rest reaches the motion of two periods; at
lower frequencies it reaches another motion, of three periods."""
REPEATS = 1e-3
"""Tolerance of repetition, divided by an impulse: the impulses of a motion of two periods differ by 5 % at `BESIDE`."""
SPAN = (
    2.85e-4,
    3.7e-4,
)  # m, of the amplitude of the base, around both folds of a bar that touches its stop once a period
PINNED = """
title = "Bar on a pin beside one stop: a fold of its motions of one contact"
[beam]
length = {length}
bending_stiffness = {stiffness}
mass_per_length = {mass}
[[supports]]
x = 0.0
translational = inf
torsional = {torsional}
[[stops]]
x = {place}
side = "top"
gap = {gap}
stiffness = {stop}
[damping]
kind = "modal"
ratio = {ratio}
[base_motion]
amplitude = 2.85e-4
angular_frequency = {omega}
"""
BAR = {
    "length": 1.5,  # m
    "mass": 4.0,  # kg/m
    "torsional": 450.0,  # N m
    "place": 1.2,  # m
    "gap": 1e-3,  # m
    "stop": 1200.0,  # N/m
    "ratio": 0.05,
    "omega": 13.0,  # rad/s, above the 10 of its free vibration
}
CROSSED = 1e-6  # Error of the frequency at which the witness's multiplier is -1, by finite differences, rad/s
BASIN = """
title = "Bar on a pin beside one stop: two motions"
[beam]
length = 1.5
bending_stiffness = 1e6
mass_per_length = 4.0
[[supports]]
x = 0.0
translational = inf
torsional = 450.0
[[stops]]
x = 1.2
side = "top"
gap = 2e-3
stiffness = 3000.0
[damping]
kind = "viscous"
coefficient = 2.0
[base_motion]
amplitude = 1e-3
angular_frequency = 17.0
"""
PLACE, GRID = 1.2, (6, 6)
"""Position at which the starts are displaced, m, and numbers of starts along each axis of the grid."""
LONG = 200  # Length of a march in periods, in which a deviation decays by e^-18
TOGETHER = 3  # Periods after which motions of one period and of three both repeat
SAME = 1e-5  # Rest of a deviation, and of a start not bent as the static shape, divided by the largest impulse


def cantilever(amplitude: float) -> Problem:
    """The cantilever under its stop, with a base of the given amplitude in m."""
    return Problem(
        title="Cantilever that comes to its stop",
        beam=Beam(length=BEAM.length, bending_stiffness=BEAM.stiffness, mass_per_length=BEAM.mass),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        stops=(Stop(x=BEAM.length, side="top", gap=GAP, stiffness=50.0),),
        damping=ViscousDamping(coefficient=BEAM.damping),
        base_motion=BaseMotion(amplitude=amplitude, angular_frequency=OMEGA),
    )


def over_folds(say: Say) -> Iterator[Check | Criterion]:
    """The cantilever over the amplitude of its base."""
    answer = BEAM.answer(np.array([OMEGA / (2 * math.pi)]), BEAM.length, 0)[0]
    closed = Estimate(GAP / (OMEGA**2 * abs(answer)), 0.0, "gap over |H|, no modes summed", Kind.ANALYTICAL)
    of: dict[str, list[Found]] = {}
    for solver, (options, made) in SOLVERS.items():
        say(f"cantilever, {solver}")
        data = branch(cantilever(AMPLITUDES[0]), AMPLITUDE, *AMPLITUDES, solver=solver, options=options)
        of[solver] = bifurcations(data, solver)
        as_wanted = [one.kind for one in of[solver]] == list(SEQUENCE)
        yield Criterion(f"graze, fold and fold (1: yes): {solver}", "1", float(as_wanted), 1, 1, "in this sequence")
        if not as_wanted:
            continue
        graze, up, down = of[solver]
        touched = float(graze.stop == 0 and graze.after == "persists")
        yield Criterion(f"the stop is touched, and the branch persists (1: yes): {solver}", "1", touched, 1, 1, "")
        yield Check(f"first graze: {solver}", "m", graze.value, closed)
        if solver == "analytic":
            away = abs(graze.value.value / closed.value - 1)
            yield Criterion("first graze, off closed form: analytic", "1", away, 0.0, CLOSED, "of an arc that is exact")
            yield from by_the_other(data)
        yield from sure("cantilever, bifurcation", solver, of[solver])
        ends = float(data.sizes["branch_number"])
        yield Criterion(
            f"branches, from both ends of the range: {solver}", "1", ends, 1, 1, "both lead to the same one"
        )
        yield from beside_graze(data, graze.value.value, solver)
        yield from last_point(data, made, solver)
        yield from stabilities(data, solver)
        yield from beside_folds(made, up.value.value, down.value.value, solver)
    for i, (one, other) in enumerate(zip(*of.values(), strict=False)):
        name = f"cantilever, bifurcation {i + 1}, {one.kind}: both solvers"
        yield Check(name, "m", one.value, other.value)


def by_the_other(data: xr.Dataset) -> Iterator[Criterion]:
    """The bifurcations of the analytic solver, located again by finite elements from the motions that it stores."""
    found = confirm(data, solver="fe", options=SOLVERS["fe"][0])
    not_so = np.count_nonzero(found["verdict"].values != VERDICTS.index("agrees"))
    reason = "each is where the analytic solver has it, within both errors"
    yield Criterion("cantilever, bifurcations that finite elements do not confirm", "1", float(not_so), 0, 0, reason)
    yield Criterion("cantilever, bifurcations looked for", "1", float(found["verdict"].size), 3, 3, "all of them")


def stabilities(data: xr.Dataset, solver: str) -> Iterator[Criterion]:
    """Motions are stable except between the folds; contacts begin at the graze, and all points are periodic."""
    mine = data["branch"].values == 0
    impulse, number = data["impulse"].values[mine, 0], np.arange(mine.sum())
    _, up, down = data["bifurcation_point"].values[data["bifurcation_branch"].values == 0].tolist()
    wrong = np.count_nonzero(data["stable"].values[mine] == ((number >= up) & (number < down)))
    yield Criterion(f"points whose stability is not that of their part: {solver}", "1", float(wrong), 0, 0, "none")
    falls = np.count_nonzero(np.diff(impulse) < -1e-9 * impulse.max())
    yield Criterion(f"steps along the branch in which the impulse falls: {solver}", "1", float(falls), 0, 0, "it grows")
    worst = float(data["residual"].values.max())
    yield Criterion(f"largest residual of the branch: {solver}", "1", worst, 0.0, 1e-9, "every point closes")


def beside_graze(data: xr.Dataset, graze: float, solver: str) -> Iterator[Criterion]:
    """The graze lies at its point; there is no contact before it, and one after."""
    point = int(data["bifurcation_point"][0])
    apart = abs(float(data["base_motion_amplitude"][point]) / graze - 1)
    yield Criterion(f"the graze's point, off the graze: {solver}", "1", apart, 0.0, AT_GRAZE, "it lies at it")
    contacts = data["contact_count"].values[data["branch"].values == 0]
    wrong = np.count_nonzero(contacts[:point]) + np.count_nonzero(contacts[point + 1 :] == 0)
    yield Criterion(f"points without their contact, or with one too early: {solver}", "1", float(wrong), 0, 0, "")


def last_point(data: xr.Dataset, solver: Any, name: str) -> Iterator[Check]:
    """Impulse and largest force at the end of the range, against the steady state of a march from rest."""
    steady = solver.steady_state(cantilever(AMPLITUDES[1]), sensitivity=False, errors=False)
    marched = {
        "impulse": ("N s", float(steady.impulses[0])),
        "peak_force": ("N", max(contact.peak_force for contact in steady.history.contacts)),
    }
    for what, (unit, value) in marched.items():
        a = Estimate(float(data[what][-1, 0]), 0.0, "branch")
        b = Estimate(value, SETTLED * value, "steady state from rest")
        yield Check(f"{what.replace('_', ' ')} at the end of the branch: {name}", unit, a, b)


def beside_folds(solver: Any, up: float, down: float, name: str) -> Iterator[Criterion]:
    """A plain march up over one fold and back over the other, each step from the end of the previous step."""
    end = None
    for amplitude in np.linspace(AMPLITUDES[0], (1 - BESIDE) * up, APPROACH)[:-1]:
        _, end = settled(solver, cantilever(float(amplitude)), end)
    marches = [
        ("below the upper fold", (1 - BESIDE) * up, False),
        ("above the upper fold", (1 + BESIDE) * up, True),
        ("above the lower fold", (1 + BESIDE) * down, True),
        ("below the lower fold", (1 - BESIDE) * down, False),
    ]
    for where, value, pressed in marches:
        impulse, end = settled(solver, cantilever(value), end)
        low, high = (PRESSED, math.inf) if pressed else (0.0, PRESSED)
        reason = "a march from the motion before"
        yield Criterion(f"impulse a period, {where}: {name}", "N s", impulse, low, high, reason)


def settled(solver: Any, problem: Problem, start: SectionPoint | None) -> tuple[float, SectionPoint]:
    """Impulse of the first stop in a period after a long march, N s, and the section point at its end."""
    map_ = solver.period_map(problem)
    end = map_.march(map_.initial() if start is None else map_.adopted(start), 2 * MARCHED).end
    return float(map_.march(end, 2).impulses[0]), end


def rigid_flip() -> float:
    """Frequency at which the leading multiplier of the rigid bar is -1, rad/s, by numpy alone."""
    text = DOUBLED.format(stiffness="inf")

    def beyond(omega: float) -> float:
        bar = RigidBar.from_toml(text.replace("angular_frequency = 26.0", f"angular_frequency = {omega!r}"))
        return float(multipliers(periodic(bar))[0].real) + 1.0

    return float(brentq(beyond, *FLIPS, xtol=1e-9))


def over_flips(say: Say) -> Iterator[Check | Criterion]:
    """The bar over the frequency at two bending stiffnesses, against the rigid bar; both solvers at one stiffness."""
    own: dict[str, list[Found]] = {}
    by_stiffness = []
    for solver, (options, made) in BARS.items():
        for factor in (1.0, RATIO) if solver == "analytic" else (1.0,):
            say(f"bar, {solver}, {SOFT * factor:g} N m2")
            problem = from_toml(DOUBLED.format(stiffness=repr(SOFT * factor)))
            found = bifurcations(branch(problem, FREQUENCY, *FLIPS, solver=solver, options=options), solver)
            there = [one.kind for one in found] == ["flip"]
            name = f"one flip (1: yes), {SOFT * factor:g} N m2: {solver}"
            yield Criterion(name, "1", float(there), 1, 1, "no other bifurcation is in the range")
            if not there:
                return
            if solver == "analytic":
                by_stiffness.append(replace(found[0].value, uncertainty=0.0))
            if factor == 1.0:
                own[solver] = found
                yield from beside_flip(made, problem, found[0].value.value, solver)
                yield from sure("bar, bifurcation", solver, found)
    one, other = (found[0].value for found in own.values())
    yield Check("bar, flip: both solvers", "rad/s", one, other)
    a = to_rigid(by_stiffness[0], by_stiffness[1], SOFT)
    b = Estimate(rigid_flip(), CROSSED, "multiplier of the rigid bar, by numpy alone", Kind.ANALYTICAL)
    yield Check("bar, flip: analytic, against the rigid bar", "rad/s", a, b)


def closed_folds() -> list[float]:
    """Amplitudes, m, ascending, that are extreme for the rigid bar as a function of the duration of its contact."""
    mass, free = BAR["mass"] * BAR["length"] / 3, BAR["torsional"] / BAR["length"] ** 2
    lever = BAR["place"] / BAR["length"]
    both = free + BAR["stop"] * lever**2
    level = BAR["stop"] * lever * BAR["gap"] / both
    pieces = [
        Piece(mass, 2 * BAR["ratio"] * math.sqrt(stiffness * mass), stiffness, rest)
        for stiffness, rest in ((free, 0.0), (both, level))
    ]
    load = BAR["mass"] * BAR["length"] / 2
    known = BilinearMap(pieces[0], pieces[1], lever, BAR["gap"], load, BAR["omega"])
    return sorted(one.amplitude for one in known.folds() if known.exists(one))


def over_contacts(say: Say) -> Iterator[Check | Criterion]:
    """A bar that touches its stop once a period, over the amplitude, at two bending stiffnesses, against closed
    form."""
    exact, folds = closed_folds(), dict[tuple[str, float], list[Estimate]]()
    for solver, factor in (("analytic", 1.0), ("analytic", RATIO), ("fe", 1.0)):
        say(f"bar of one contact, {solver}, {SOFT * factor:g} N m2")
        problem = from_toml(PINNED.format(stiffness=repr(SOFT * factor), **BAR))
        found = bifurcations(branch(problem, AMPLITUDE, *SPAN, solver=solver, options=BARS[solver][0]), solver)
        values = [one.value for one in found if one.kind == "fold"]
        name = f"folds of the bar of one contact, {SOFT * factor:g} N m2: {solver}"
        yield Criterion(name, "1", float(len(values)), len(exact), len(exact), "as the closed form has")
        if len(values) != len(exact):
            return
        yield from sure(f"bar of one contact, {SOFT * factor:g} N m2, bifurcation", solver, found)
        folds[solver, factor] = sorted(values, key=lambda one: one.value)
    both = zip(folds["analytic", 1.0], folds["fe", 1.0], strict=True)
    for i, (one, other) in enumerate(both):
        yield Check(f"bar of one contact, fold {i + 1}: both solvers", "m", one, other)
    limits = zip(folds["analytic", 1.0], folds["analytic", RATIO], exact, strict=True)
    for i, (soft, stiff, value) in enumerate(limits):
        a = to_rigid(soft, stiff, SOFT)
        b = Estimate(value, 0.0, "amplitude as a function of the duration of contact", Kind.ANALYTICAL)
        yield Check(f"bar of one contact, fold {i + 1}: analytic, against the bilinear oscillator", "m", a, b)


def beside_flip(solver: Any, problem: Problem, flip: float, name: str) -> Iterator[Criterion]:
    """A plain march down over the flip: the motion has two periods above it, and one below."""
    assert isinstance(problem.base_motion, BaseMotion)
    end = None
    for where, omega, multiple in (("far above", DOUBLE, 2), ("above", 1 + BESIDE, 2), ("below", 1 - BESIDE, 1)):
        moved = problem.base_motion.model_copy(update={"angular_frequency": omega * flip})
        map_ = solver.period_map(problem.replace(base_motion=moved))
        end = map_.march(map_.initial() if end is None else map_.adopted(end), 4 * MARCHED).end
        ends = [end, *(map_.march(end, 2 * n).end for n in (1, 2))]
        impulses = [float(map_.march(one, 2).impulses[0]) for one in ends]
        once, twice = (abs(impulses[n] - impulses[0]) / max(impulses) for n in (1, 2))
        found = 1 if once < REPEATS else 2 if twice < REPEATS else 0
        reason = "a march from rest far above it, and on"
        yield Criterion(f"periods, {where} the flip: {name}", "1", float(found), multiple, multiple, reason)


def basin(say: Say) -> Iterator[Check | Criterion]:
    """The motion in which each start of a grid ends, against a long march from each start."""
    say("basins")
    problem, solver = from_toml(BASIN), BARS["analytic"][1]
    found = basins(
        problem, plane=f"z({PLACE:g}),v({PLACE:g})", grid=GRID, options=dict(BARS["analytic"][0]), solver="analytic"
    )
    impulses, bound = found["impulse"].values[:, 0], found["motion"].values
    size = float(impulses.max())
    yield Criterion("basins, motions", "1", float(impulses.size), 2, 2, "of one period, and of three")
    yield Criterion("basins, starts that are bound to none", "1", float((bound < 0).sum()), 0, 0, "nothing is chaotic")
    for k in range(impulses.size):
        share = float((bound == k).mean())
        ends = (float(found[f"fraction_{end}"][k]) for end in ("low", "high"))
        parts = (float(found["fraction"][k]), *ends)
        exact_ones = (share, *wilson(share, bound.size))
        for what, one, other in zip(("share", "its lower end", "its upper end"), parts, exact_ones, strict=True):
            b = Estimate(other, 1e-12, "counted, and Wilson's interval as roots", Kind.ANALYTICAL)
            yield Check(f"basins, motion {k + 1}, {what}", "1", Estimate(one, 0.0, "basins"), b)
    wrong = 0
    for i, z in enumerate(found["first"].values.tolist()):
        for j, v in enumerate(found["second"].values.tolist()):
            start = PolynomialShape(displacement=(0.0, z / PLACE), velocity=(0.0, v / PLACE))
            map_ = solver.period_map(problem.replace(initial=start))
            end = map_.march(map_.initial(), 2 * LONG).end
            mean = float(map_.march(end, 2 * TOGETHER).impulses[0]) / TOGETHER
            wrong += not (bound[i, j] >= 0 and abs(mean - impulses[bound[i, j]]) <= SAME * size)
    reason = "each is bound to the motion to which its own march comes"
    yield Criterion("basins, starts whose march ends elsewhere", "1", float(wrong), 0, 0, reason)


def wilson(share: float, count: int) -> tuple[float, float]:
    """Wilson's interval at 95 %: the fractions p whose distance from `share` is 1.96 standard deviations."""
    z2 = NormalDist().inv_cdf(0.975) ** 2 / count
    low, high = sorted(np.roots([1 + z2, -2 * share - z2, share**2]).real.tolist())
    return low, high


def run(level: Level, say: Say) -> CaseResult:
    """Grazes, folds, flips, basins, births and ends of branches."""
    items = [*over_folds(say), *over_flips(say), *over_contacts(say), *over_births(say), *over_ends(say), *basin(say)]
    checks = tuple(item for item in items if isinstance(item, Check))
    rows = [(c.name, c.unit, number(c.a.value, 10), number(c.b.value, 10), number(c.allowed, 2)) for c in checks]
    return CaseResult(
        "branches",
        "Branches, bifurcations and basins",
        "Periodic motions are followed over a number of the problem by both solvers: a cantilever over a graze, whose "
        "amplitude is closed form, and over two folds; a bar over a flip, which is where the leading multiplier of a "
        "rigid bar, by numpy alone, passes -1; a bar of one contact a period over two folds, where the amplitude of "
        "the bilinear oscillator, in closed form over the duration of its contact, is extreme; a bar whose symmetry "
        "breaks, and one whose motion becomes a torus, where multipliers in closed form leave the unit circle; a "
        "joint like the paper's on which contacts are made very lightly, whose range must lie on branches or be told "
        "not to. Finite elements confirm the analytic bifurcations of the cantilever from stored motions. On either "
        "side of each fold and flip, and from each start of a small basin of two motions, a plain march ends as "
        "the branch or the basin says.",
        checks=checks,
        criteria=tuple(item for item in items if isinstance(item, Criterion)),
        tables=(table("Bifurcations and shares", ("quantity", "unit", "one", "other", "allowed"), rows),),
    )
