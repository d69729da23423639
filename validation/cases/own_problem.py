"""A user's own problem: frequencies, static equilibrium, first contacts and steady state by both solvers."""

from __future__ import annotations

import math

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import Outcome, Problem, contact_states
from lapjoint.errors import InputError
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import FE_ORDER, compare_contacts, longest_period
from validation.cases.steady import compare_steady
from validation.cases.transient import WITNESS_TOLERANCE, contact_table, motion_drawing
from validation.invariants import witness
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Check, ErrorSource, Estimate

MODES = 6
PERIODS = 6  # Periods of the excitation or the slowest motion in which contacts are sought
MOST_STATES = 32


def frequencies(problem: Problem, level: Level, say: Say) -> CaseResult:
    """The lowest frequencies of every contact state."""
    meshes = (16, 32, 64)
    checks, rows = [], []
    for state in contact_states(problem)[:MOST_STATES]:
        say(state.name(problem))
        exact = analytic.Solver().modes(problem, state, MODES).angular_frequencies
        found = [fe_lapjoint.Solver(elements=n).modes(problem, state, MODES).angular_frequencies for n in meshes]
        for i in range(MODES):
            u = 1e-12 * float(exact[i])
            a = Estimate(
                float(exact[i]), u, "roots bracketed by their count, to rounding", parts=((ErrorSource.ROUNDING, u),)
            )
            b = refined_estimate([float(f[i]) for f in found], 2.0, FE_ORDER, elements(meshes[-1]), 1e-8)
            checks.append(Check(f"{state.name(problem)}: omega_{i + 1}", "rad/s", a, b))
            rows.append(
                (state.name(problem), i + 1, a.value, b.value, f"{checks[-1].relative:.1e}", a.value / (2 * math.pi))
            )
    return CaseResult(
        "frequencies",
        "Natural frequencies of the contact states",
        "Analytic frequencies against those of three meshes.",
        checks=tuple(checks),
        tables=(
            table(
                "Natural angular frequencies, rad/s, and frequencies, Hz",
                ("state", "mode", "analytic", "FE", "difference", "Hz"),
                rows,
            ),
        ),
    )


def has_equilibrium(problem: Problem) -> bool:
    """Whether a problem has static loads or preload, and rests under them."""
    if not problem.forces.constant and all(stop.gap >= 0 for stop in problem.stops):
        return False
    try:
        analytic.Solver().equilibrium(problem)
    except InputError:  # nothing resists the loads
        return False
    return True


def equilibrium(problem: Problem, level: Level, say: Say) -> CaseResult:
    """Where the joint rests under its static loads, while the base stands still."""
    say("static equilibrium")
    both = [solver.equilibrium(problem) for solver in (analytic.Solver(), fe_lapjoint.Solver())]
    line, stops = problem.line, problem.structure.stops
    places = sorted({*line.ends, *(x for stop in stops for x, _ in stop.reading)})
    numbers: list[tuple[str, str, list[tuple[float, float]]]] = []
    for k, name in enumerate(problem.stop_names):
        pushed = [(float(it.contact_forces[k]), float(it.errors.contact_forces[k])) for it in both]
        numbers.append((f"force of {name}", "N", pushed))
    for x in places:
        moved = [(float(it.displacement(np.array([x]))[0]), it.errors.displacement) for it in both]
        numbers.append((f"displacement at {line.place(x)} m", "m", moved))
    for x in sorted(
        {support.x for support in problem.structure.supports}
    ):  # supports at one place share their force at will
        here = [i for i, support in enumerate(problem.structure.supports) if support.x == x]
        held = [(float(it.support_forces[here].sum()), float(it.errors.support_forces[here].sum())) for it in both]
        numbers.append((f"force of the support at {line.place(x)} m", "N", held))
    for i, link in enumerate(problem.structure.links):
        where = f"{line.place(link.first)} to {line.place(link.second)}"
        for name, unit in (("force", "N"), ("moment", "N m")):
            joined = [
                (float(getattr(it, f"link_{name}s")[i]), float(getattr(it.errors, f"link_{name}s")[i])) for it in both
            ]
            numbers.append((f"{name} of the link {where}", unit, joined))
    checks = []
    for name, unit, found in numbers:
        a, b = (Estimate(value, u, it.error_source) for (value, u), it in zip(found, both, strict=True))
        checks.append(Check(name, unit, a, b))
    notes = [sentence for sentence in dict.fromkeys(it.other_equilibria for it in both) if sentence]
    rows = [(c.name, c.unit, c.a.value, c.b.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "equilibrium",
        "Static equilibrium",
        "Where the joint rests under gravity, constant loads and preload: forces of stops and supports, and "
        "displacements, each with the rounding error that its solver states.",
        checks=tuple(checks),
        tables=(table("Equilibrium", ("quantity", "unit", "analytic", "FE", "difference", "allowed"), rows),),
        notes=tuple(notes),
    )


def transient(problem: Problem, level: Level, say: Say) -> CaseResult:
    """The first contacts from the initial state."""
    say("from the initial state")
    duration = min(PERIODS * longest_period(problem), problem.longest)
    checks, exact, fe = compare_contacts(problem, duration, 8, 48 if level == "quick" else 64, stated=True)
    return CaseResult(
        "transient",
        "First contacts from the initial state",
        "Times and impulses of the first contacts, with uncertainty from three numbers of modes and three meshes.",
        checks=tuple(checks),
        criteria=tuple(item for history in (exact, fe) for item in witness(history, WITNESS_TOLERANCE, history.solver)),
        tables=(contact_table(checks),),
        drawings=(motion_drawing("Motion from the initial state", exact, fe),),
        notes=() if exact.contacts else ("No stop is touched in this time.",),
    )


def steady(problem: Problem, level: Level, say: Say) -> CaseResult:
    """The steady state, if the excitation has one frequency."""
    say("steady state")
    point = compare_steady(problem, 40 if level == "quick" else 64)
    notes = [outcome.value for outcome in dict.fromkeys(point.outcomes)]
    checks, rows = [point.same_period], []
    if point.explanation:
        notes.append(point.explanation)
    if Outcome.UNDECIDED not in point.outcomes:
        for name, a, b in zip(problem.stop_names, point.analytic, point.fe, strict=True):
            checks.append(Check(f"impulse of {name}", "N s", a, b, explanation=point.explanation))
            rows.append((name, a.value, f"{a.uncertainty:.1e}", b.value, f"{b.uncertainty:.1e}"))
    else:
        notes.append("Impulses of a motion that does not repeat cannot be compared one by one.")
    columns = ("stop", "analytic", "u", "FE", "u")
    return CaseResult(
        "steady",
        "Steady state",
        "Periodic motion that the march from the initial state leads to; impulses per excitation period.",
        checks=tuple(checks),
        criteria=point.criteria,
        tables=(table("Impulse per excitation period, N s", columns, rows),),
        notes=tuple(notes),
    )
