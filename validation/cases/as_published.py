"""Does the published scheme march, settle and measure as the paper says?

The ledger of the paper's claims uses this scheme.  In the scheme, the part of the displacement that the modes of the
next contact state cannot represent is frozen at each switch; no other solver has this.  Four comparisons test the
scheme.  A nearly rigid bar, whose frozen part is negligible, has a witness of numpy alone.  The rule for a settled
motion is applied again to the recorded cycles.  A march from a section point must repeat the march from rest.  Losses
at switches are integrated along the beam.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from analytic.published.initial_state import started
from analytic.published.joint import PublishedJoint
from analytic.published.loss import frozen_part
from analytic.published.solver import PublishedScheme
from analytic.published.steady import Patience, settling
from lapjoint import Problem, paper_joint
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.cases.rigid_bar import CURVED, MIRROR, RATIO, SOFT, to_the_limit, witnessed
from validation.verdict import Check, Estimate, Kind

SCHEME = PublishedScheme()
FREQUENCIES = (400.0, 515.0, 1398.0)
"""Frequencies of the paper's joint, rad/s; at the first one the stop at mid-span settles last."""
ONE_SIDED = 400.0  # Frequency, rad/s, at which the motion without the bottom stops repeats after five periods
REPEATS = 20  # Number of repetitions of a settled motion: each repeats the previous one, and the last repeats the first
ROUNDING = 1e-9  # Relative rounding of a march that starts anew at a section point, and of sums over cycles
CONTACTS = 2  # Contacts of the bar that are compared
SWITCHES = 12  # Switches whose losses are integrated along the beam
SHORTLY = 1e-9  # Time before and after a switch at which velocities are evaluated, s
INTEGRATED = 1e-5  # Error of the integrals by `SHORTLY` and by Gauss points, divided by the kinetic energy


def paper(omega: float, sides: tuple[str, ...] = ("top", "bottom")) -> Problem:
    """The paper's joint at a frequency, with the stops of some sides."""
    joint = paper_joint()
    assert joint.base_motion is not None
    base = joint.base_motion.model_copy(update={"angular_frequency": omega})
    return joint.replace(base_motion=base, stops=tuple(stop for stop in joint.stops if stop.side in sides))


def rigid() -> Iterator[Check]:
    """Contacts of a bar between two stops, extrapolated to the rigid limit, against the witness."""
    it, levels = witnessed(MIRROR), []
    for factor in (1.0, RATIO):
        problem = from_toml(MIRROR.format(stiffness=repr(SOFT * factor)))
        found = SCHEME.simulate(problem, it.motion.contacts[CONTACTS].start).contacts[:CONTACTS]
        levels.append(np.array([(c.start, c.end, c.impulse) for c in found]).ravel())
    kinds = ("time", "time", "impulse") * CONTACTS
    value, u = to_the_limit(levels[0], levels[1], kinds)
    exact = [number for c in it.motion.contacts[:CONTACTS] for number in (c.start, c.end, c.impulse)]
    for i, (name, unit) in enumerate((("impact", "s"), ("rebound", "s"), ("impulse", "N s")) * CONTACTS):
        a = Estimate(float(value[i]), float(u[i]), f"to the rigid limit, {CURVED:g} of the change uncertain")
        b = Estimate(exact[i], 0.0, "rigid bar, by numpy alone", Kind.ANALYTICAL)
        yield Check(f"bar, contact {i // 3 + 1}: {name}", unit, a, b)


def settled(label: str, problem: Problem) -> Iterator[Check]:
    """The cycles of a motion that settles against the rule, against its History, and against a march from rest."""
    assert problem.excitation_frequency is not None
    period, stops = 2 * math.pi / problem.excitation_frequency, len(problem.structure.stops)
    joint = PublishedJoint(problem, SCHEME.free_modes, SCHEME.contact_modes)
    most = SCHEME.max_period_multiple
    how_long = Patience(SCHEME.tolerance, most, SCHEME.max_periods, SCHEME.patience, SCHEME.shortest)
    found = settling(joint, started(joint, None), period, how_long)
    cycles = len(found.rows)
    after, multiple = first_settled(found.rows, stops, most)
    yield same(f"{label}: cycles until settled", "1", cycles, after, 0.0, "the rule, applied again")
    yield same(f"{label}: period multiple", "1", found.period_multiple, multiple, 0.0, "the rule, applied again")
    steady = SCHEME.steady_state(problem)
    whole = SCHEME.simulate(problem, (cycles + found.period_multiple) * period)
    z = np.array([stop.x for stop in problem.structure.stops])
    t = period * np.linspace(0.0, found.period_multiple, 7)[1:-1]
    resumed, marched = steady.history.displacement(z, t), whole.displacement(z, cycles * period + t)
    apart, size = float(np.abs(resumed - marched).max()), float(np.abs(marched).max())
    how = "the march from rest"
    yield same(
        f"{label}: displacement from the section point on, less that of it", "m", apart, 0.0, ROUNDING * size, how
    )
    impulses = SCHEME.simulate(problem, cycles * period).impulses()
    for k, stop in enumerate(problem.structure.stops):
        summed = stop.sign * stop.stiffness * float(found.rows[:, k].sum())
        u = ROUNDING * float(np.abs(impulses).max())
        yield same(
            f"{label}: impulse of {problem.stop_names[k]} over all cycles", "N s", summed, float(impulses[k]), u, how
        )


def first_settled(rows: FloatArray, stops: int, most: int) -> tuple[int, int]:
    """Number of cycles after which a motion has settled by the rule, and its period multiple; zeros if it has not
    settled."""

    def alike(one: int, other: int) -> bool:
        return all(
            np.abs(rows[one, part] - rows[other, part]).max() <= SCHEME.tolerance * np.abs(rows[one, part]).max()
            for part in (slice(stops), slice(stops, None))
        )

    for n in range(len(rows)):
        for p in range(1, most + 1):
            first = n - REPEATS * p
            if first >= 0 and alike(n, first) and all(alike(k, k - p) for k in range(first + 1, n + 1) if k >= p):
                return n + 1, p
    return 0, 0


def same(name: str, unit: str, found: float, reference: float, u: float, how: str) -> Check:
    """A number of the scheme against an independent value."""
    return Check(name, unit, Estimate(found, u, SCHEME.name), Estimate(reference, 0.0, how, Kind.CROSS_METHOD))


def left_behind() -> Iterator[Check]:
    """Displacement and velocity lost at switches, against integrals along the beam of the motion before and after
    them."""
    problem = paper(FREQUENCIES[0])
    history, beam = SCHEME.simulate(problem, 2 * math.pi / FREQUENCIES[0] * 3), problem.line
    measured = frozen_part(history)
    nodes, weights = np.polynomial.legendre.leggauss(16)
    ends = np.linspace(0.0, beam.length, 21)  # the stops are among them
    half = np.diff(ends)[:, None] / 2
    x, w = (ends[:-1, None] + half * (1 + nodes)).ravel(), beam.m * (half * weights).ravel()
    for i, t in enumerate(measured.time[:SWITCHES]):
        before, after = (history.velocity(x, t + late)[:, 0] ** 2 @ w for late in (-SHORTLY, SHORTLY))
        name, how = f"switch {i + 1}", "integrated along the beam"
        lost = float((before - after) / before)
        yield same(f"{name}: share of kinetic energy lost", "1", float(measured.kinetic[i]), lost, INTEGRATED, how)
        state = history.states[i + 1]
        count = SCHEME.contact_modes if state.closed else SCHEME.free_modes
        shapes, z = SCHEME.modes(problem, state, count).shapes(x), history.displacement(x, t + SHORTLY)[:, 0]
        rest = z - (shapes @ (w * z)) @ shapes
        share = math.sqrt(float(rest**2 @ w) / float(z**2 @ w))
        yield same(
            f"{name}: share of displacement frozen", "1", float(measured.displacement[i]), share, INTEGRATED, how
        )


def run(level: Level, say: Say) -> CaseResult:
    """The scheme by itself."""
    checks = [*rigid(), *left_behind()]
    for omega in FREQUENCIES:
        checks += settled(f"{omega:g} rad/s", paper(omega))
    checks += settled(f"{ONE_SIDED:g} rad/s, one side", paper(ONE_SIDED, ("top",)))
    say("bar, switches, settling")
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "as-published",
        "The scheme as published, by itself",
        "No other solver has the frozen shape of the published scheme. A nearly rigid bar, taken to the limit, has its "
        "contacts compared with those of a witness; the rule for a settled motion is applied again to the cycles "
        "recorded; a march begun anew at a section point is compared with that from rest; and what the first switches "
        "lose is integrated along the beam.",
        checks=tuple(checks),
        tables=(table("As published", ("quantity", "unit", "reference", "found", "difference", "allowed"), rows),),
    )
