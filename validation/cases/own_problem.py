"""A user's own problem by both solvers: frequencies, equilibrium, first contacts, steady state and statistics."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

import analytic
import fe_lapjoint
import lapjoint
from lapjoint import Outcome, Problem, SteadyState, contact_states
from lapjoint.errors import InputError
from lapjoint.figures.text import error_text
from lapjoint.solver import make_solver
from lapjoint.summaries.blocks import Block, steady_blocks
from lapjoint.summaries.measure import duration_of
from lapjoint.summaries.statistics_blocks import statistics_blocks
from validation.case import CaseResult, Level, Say, Table, table
from validation.cases.both_answers import NONE, How, checks_of, tables_of
from validation.cases.motions import FE_ORDER, compare_contacts, longest_period
from validation.cases.steady import compare_steady
from validation.cases.transient import WITNESS_TOLERANCE, motion_drawing
from validation.coexistence import Motion, same_motion, why_they_differ
from validation.invariants import witness
from validation.orbit_invariants import steady_witness
from validation.report.page import significant
from validation.uncertainty import elements, refined_estimate
from validation.verdict import Check, ErrorSource, Estimate

SOLVERS: dict[str, dict[str, int]] = {"analytic": {}, "fe": {}}
"""Numerical options of the solvers, by their names; without options they are those of the command line."""
NAMES = ("analytic", "FE")
UNITS = {"quick": 4, "standard": 8, "full": 32}
"""Units, each of twenty decay times, of the statistics of random motion: four give intervals with three degrees of
freedom, eight are the fewest without a remark, and more than 32 are never made."""
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
    answer = [
        (f"{c.name} [{c.unit}]", *(f"{e.value:.8g} ± {error_text(e.uncertainty)}" for e in (c.a, c.b))) for c in checks
    ]
    return CaseResult(
        "equilibrium",
        "Static equilibrium",
        "Where the joint rests under gravity, constant loads and preload: forces of stops and supports, and "
        "displacements, each with the rounding error that its solver states.",
        checks=tuple(checks),
        answer=(table("Static equilibrium, while the base stands still", ("quantity", *NAMES), answer),),
        commands=("equilibrium {problem}", "equilibrium {problem} --solver fe"),
        tables=(table("Equilibrium", ("quantity", "unit", "analytic", "FE", "difference", "allowed"), rows),),
        notes=tuple(notes),
    )


def transient(problem: Problem, level: Level, say: Say) -> CaseResult:
    """The first contacts from the initial state."""
    say("from the initial state")
    duration = min(PERIODS * longest_period(problem), problem.longest)
    finest = 48 if level == "quick" else 64
    checks, exact, fe = compare_contacts(problem, duration, 8, finest, stated=True)
    tolerances = (WITNESS_TOLERANCE, WITNESS_TOLERANCE * (64 / finest) ** FE_ORDER)
    return CaseResult(
        "transient",
        "First contacts from the initial state",
        "Times and impulses of the first contacts, with uncertainty from three numbers of modes and three meshes.",
        checks=tuple(checks),
        criteria=tuple(
            item
            for history, tolerance in zip((exact, fe), tolerances, strict=True)
            for item in witness(history, tolerance, history.solver)
        ),
        answer=contacts_table(checks),
        drawings=(motion_drawing("Motion from the initial state", exact, fe),),
        notes=() if exact.contacts else ("No stop is touched in this time.",),
    )


def contacts_table(checks: Sequence[Check]) -> tuple[Table, ...]:
    """The contacts that both solvers have, two rows for each; none without contacts."""
    found: dict[str, dict[str, Check]] = {}
    for check in checks:
        contact, _, what = check.name.rpartition(": ")
        found.setdefault(contact, {})[what] = check
    columns = {"impact": "impact [s]", "rebound": "rebound [s]", "impulse": "impulse [N s]"}

    def text(check: Check | None, side: str) -> str:
        e = None if check is None else getattr(check, side)
        return NONE if e is None else f"{significant(e.value, e.uncertainty)} ± {error_text(e.uncertainty)}"

    rows = [
        (contact, name, *(text(each.get(what), side) for what in columns))
        for contact, each in found.items()
        for name, side in zip(NAMES, "ab", strict=True)
    ]
    heads = ("contact", "solver", *columns.values())
    return (table("First contacts from the initial state", heads, rows, grouped=True),) if rows else ()


def sizes(problem: Problem, blocks: Sequence[Block]) -> tuple[str, ...]:
    """How large the displacements are that the model takes as small, in a sentence."""
    rows = [row for block in blocks for row in block.rows if row.largest and row.of.startswith("displacement")]
    values = [number.value for row in rows for number in row.numbers[:1] if number is not None]
    if not values:
        return ()
    share = max(values) / min(beam.length for beam in problem.line.beams)
    of = "the length of the shortest beam" if problem.line.several else "the length of the beam"
    return (f"Small deflections: the largest displacement, relative to the base, is here {100 * share:.3g} % of {of}.",)


def steady(problem: Problem, level: Level, say: Say) -> CaseResult:
    """The steady state, if the excitation has one frequency."""
    say("steady state")
    found = [make_solver(name, **options).steady_state(problem) for name, options in SOLVERS.items()]
    return steady_by_both(problem, found, level, say)


def steady_by_both(problem: Problem, both: Sequence[SteadyState], level: Level, say: Say) -> CaseResult:
    """The comparison of the steady states that the two `SOLVERS` found."""
    solvers = [make_solver(name, **options) for name, options in SOLVERS.items()]
    one, other = both
    explanation = ""
    same = same_motion(one, other)
    if not same:
        say("why the two motions differ")
        explanation = why_they_differ(problem, Motion(solvers[0], one), Motion(solvers[1], other))
    notes = [outcome.value for outcome in dict.fromkeys((one.outcome, other.outcome))]
    a, b = (Estimate(float(found.period_multiple), 0.0, found.solver) for found in (one, other))
    checks = [Check("excitation periods after which it repeats (0: never)", "1", a, b, explanation=explanation)]
    say("peaks, forces and contacts")
    blocks = {name: steady_blocks(found) for name, found in zip(NAMES, (one, other), strict=True)}
    if Outcome.UNDECIDED in (one.outcome, other.outcome):
        notes.append("An undecided motion may still change: its numbers are not compared.")
    else:
        if not same:
            notes.append("The two motions differ: their impulses are compared, other numbers stand side by side.")
        compared = blocks if same else {name: each[:1] for name, each in blocks.items()}
        found, unknown = checks_of(compared, [_how(one), _how(other)], explanation)
        checks += found
        if unknown:
            notes.append(f"Numbers without a stated error by one of the solvers, which are not compared: {unknown}.")
    if explanation:
        notes.append(explanation)
    criteria = [it for found in (one, other) for it in steady_witness(found, WITNESS_TOLERANCE, found.solver)]
    if level != "quick":
        say("by three numbers of modes and three meshes")
        checks += _refined(problem)
    return CaseResult(
        "steady",
        "Steady state",
        "The motion that the march from the initial state leads to, as `lapjoint steady` prints it by each solver with "
        "its stated errors. Beyond the quick level, impulses are compared again, with uncertainty from three numbers "
        "of modes and three meshes.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        answer=tables_of(problem, blocks),
        certificate=(_certificates(one, other),),
        assumed=sizes(problem, blocks["analytic"]),
        commands=("steady {problem}", "steady {problem} --solver fe"),
        notes=tuple(notes),
    )


def _refined(problem: Problem) -> list[Check]:
    """Impulses with uncertainty from refinement; none where the motions differ, or do not repeat."""
    point = compare_steady(problem, 64)
    if point.explanation or Outcome.UNDECIDED in point.outcomes:
        return []
    names = [f"{name}, impulse by refinement" for name in problem.stop_names]
    return [Check(name, "N s", a, b) for name, a, b in zip(names, point.analytic, point.fe, strict=True)]


def _how(found: SteadyState) -> How:
    if found.period_multiple:
        return How(f"{found.solver}, {found.error_source}", ErrorSource.REFINEMENT)
    return How(f"{found.solver}, over a finite time", ErrorSource.FINITE_TIME, sampled=True)


def _certificates(*both: SteadyState) -> Table:
    """How each solver established its steady state."""

    def of(found: SteadyState) -> dict[str, str]:
        rows = {"outcome": found.outcome.value}
        if found.period_multiple:
            mirrored = ", mirrored after half of them" if found.symmetric else ""
            rows["repeats after, excitation periods"] = f"{found.period_multiple}{mirrored}"
            rows["fails to close by, of its size"] = f"{found.residual:.2g}"
        if found.multipliers.size:
            rows["largest Floquet multiplier (stable below 1)"] = f"{abs(found.multipliers[0]):.4f}"
        if found.exponent is not None:
            it = found.exponent
            rows["largest Lyapunov exponent, 1/s"] = f"{it.value:.4g} ± {it.standard_error:.2g}"
        if found.acceptance is not None:
            rows["accepted after, excitation periods"] = str(found.acceptance.periods)
            decided = {True: "yes", False: "no", None: "not measured"}[found.acceptance.sensitive]
            rows["could rounding have led to another motion?"] = decided
        if found.impulse_errors is not None:
            rows["errors"] = found.error_source
        return rows

    rows = [of(found) for found in both]
    keys = dict.fromkeys(key for each in rows for key in each)
    written = [(key, *(each.get(key, NONE) for each in rows)) for key in keys]
    return table("How the steady state was established", ("certificate", *NAMES), written)


def statistics_lasting(problem: Problem, level: Level, duration: float | None) -> float:
    """How long the motions last whose statistics are shown, s: as asked for, or else the record, or so long that
    `UNITS` units are left when the start has settled; at the quick level not longer than that.

    0 where a problem has neither record nor random excitation, or is not damped and has no record.
    """
    if not (problem.records or problem.random):
        return 0.0
    if duration is not None:
        return duration
    enough = duration_of(problem, make_solver("analytic", **SOLVERS["analytic"]), UNITS[level])
    if math.isfinite(problem.longest) and (level != "quick" or enough >= problem.longest):
        return problem.longest
    if not math.isfinite(enough):
        return 0.0
    digit = 10.0 ** (math.floor(math.log10(enough)) - 2)
    return float(f"{digit * math.ceil(enough / digit):.3g}")  # three digits, for whoever repeats it by hand


def statistics(problem: Problem, level: Level, say: Say, duration: float | None = None) -> CaseResult:
    """Statistics of the motion under records and random excitation."""
    title, lasting, found = "Statistics of the motion", statistics_lasting(problem, level, duration), {}
    question = (
        "Statistics of the motion under the same record, or the same realisation of the random excitation, as "
        "`lapjoint statistics` prints them by each solver with 95 % intervals. Impacts part the motions of the two "
        "solvers in the long run, so their statistics are compared within their intervals, widened so that all of them "
        "are to hold together."
    )
    for name, (solver, options) in zip(NAMES, SOLVERS.items(), strict=True):
        say(f"{lasting:g} s by {solver}")
        try:
            found[name] = lapjoint.statistics(problem, solver, duration=lasting, options=options)
        except InputError as error:
            if duration is not None:
                raise
            return CaseResult("statistics", title, question, notes=(f"There are no statistics. {error}",))
    blocks = {name: statistics_blocks(each, problem) for name, each in found.items()}
    how = [How(f"{each.attrs['solver_name']}, 95 % interval", ErrorSource.FINITE_TIME) for each in found.values()]
    checks, unknown = checks_of(blocks, how)
    notes = list(dict.fromkeys(line for each in found.values() for line in each.attrs["remarks"].split("\n") if line))
    if unknown:
        notes.append(f"Numbers without a finite interval by one of the solvers, which are not compared: {unknown}.")
    rows = [
        (title, *(text(each.attrs) for each in found.values()))
        for title, text in (
            ("solver", lambda of: of["solver_name"]),
            ("duration of the motion, s", lambda of: f"{of['duration']:g}"),
            ("left out at the start, s", lambda of: f"{of['settle']:.4g}"),
            ("units, from which intervals follow", lambda of: f"{of['units']} of {of['unit_duration']:.4g} s"),
            ("samples a second", lambda of: f"{of['rate']:.4g}"),
        )
    ]
    return CaseResult(
        "statistics",
        title,
        question,
        checks=tuple(checks),
        answer=tables_of(problem, blocks),
        certificate=(table("How long the motion is, and how its intervals were made", ("setting", *NAMES), rows),),
        assumed=sizes(problem, blocks["analytic"]),
        commands=tuple(f"statistics {{problem}} --duration {lasting:g}{end}" for end in ("", " --solver fe")),
        notes=tuple(notes),
    )
