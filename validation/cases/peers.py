"""Other solvers as witnesses: frequencies and first contacts by analytic solver, finite elements, and each peer.

A peer is another installed solver that is named on the command line.  Its method `refined` refines it twice.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from itertools import combinations

import analytic
import fe_lapjoint
from lapjoint import FREE, ContactState, Problem, ViscousDamping, contact_states, paper_joint
from lapjoint.answers import Contact
from lapjoint.cli.arguments import named_solver
from lapjoint.errors import InputError, SolverError
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import (
    ANALYTIC_ORDER,
    FE_ORDER,
    analytic_levels,
    complete,
    contact_estimates,
    fe_levels,
    longest_period,
    refined_by,
)
from validation.uncertainty import refined_estimate
from validation.verdict import Check, Estimate, Kind

MODES, CONTACTS = 5, 4
DURATION = 0.015  # Length of the damped joint's motion, s: the first contacts
MARGIN = 1.02  # Length of the march, divided by the end of the last contact: coarse solutions are late
PERIODS = 1.5  # Periods of the excitation or the slowest motion, for a user's problem
RATIO, PEER_ORDER = 2.0, 2.0
"""Refinement from one level of a peer to the next, and the assumed order of convergence, that of a fixed time step."""
FREQUENCY_ORDER = 4.0  # Order of frequencies of cubic beam elements, which all present peers have
ELASTIC_FLOOR, RIGID_FLOOR = 1e-8, 1e-4
"""Error of a frequency, divided by the highest compared frequency: eigenvalue solvers round omega^2 relative to the
highest mode of the whole mesh, and the zeros of rigid-body modes show the root of this error."""

Levels = dict[str, tuple[list[Solver], float, float]]
"""For each name of a solver: three solvers from coarse to fine, the ratio of refinement, and the order."""


def damped_joint() -> Problem:
    """The paper's joint with viscous damping, which all programs can represent."""
    return paper_joint().replace(damping=ViscousDamping(coefficient=2000.0))


def check_peers(names: tuple[str, ...]) -> None:
    """Raise InputError unless every peer is installed and answers."""
    for name in names:
        try:
            named_solver(name).modes(paper_joint(), FREE, 1)
        except (InputError, SolverError) as error:
            raise InputError(f"--peers {name}: {error}") from None


def levels(problem: Problem, peers: tuple[str, ...], finest: int) -> Levels:
    """All solvers, each at three resolutions."""
    found: Levels = {
        "analytic": ([*analytic_levels(problem, 1.5)], 1.5, ANALYTIC_ORDER),
        "FE": ([*fe_levels(finest)], 2.0, FE_ORDER),
    }
    for name in peers:
        solver = named_solver(name)
        found[name] = ([solver.refined(1 / RATIO), solver, solver.refined(RATIO)], RATIO, PEER_ORDER)
    return found


def marked(estimate: Estimate, name: str) -> Estimate:
    """The estimate, marked as that of another code if it is by a peer."""
    return estimate if name in ("analytic", "FE") else replace(estimate, kind=Kind.OTHER_CODE)


def pairs(name: str, unit: str, answers: dict[str, Estimate]) -> list[Check]:
    """Every solver against every other."""
    return [
        Check(f"{name}: {one} against {two}", unit, answers[one], answers[two]) for one, two in combinations(answers, 2)
    ]


def frequencies(
    problem: Problem, state: ContactState, peers: tuple[str, ...]
) -> Iterator[tuple[str, dict[str, Estimate]]]:
    """Each of the lowest frequencies of a state, by all solvers."""
    exact = analytic.Solver().modes(problem, state, MODES).angular_frequencies
    series: dict[str, list[Solver]] = {"FE": [fe_lapjoint.Solver(elements=n) for n in (16, 32, 64)]}
    series |= {name: [named_solver(name).refined(factor) for factor in (1 / RATIO, 1.0, RATIO)] for name in peers}
    found = {n: [s.modes(problem, state, MODES).angular_frequencies for s in solvers] for n, solvers in series.items()}
    for i in range(MODES):
        answers = {"analytic": Estimate(float(exact[i]), 1e-12 * float(exact[i]), "roots bracketed by their count")}
        for name, values in found.items():
            what = refined_by(series[name][-1])
            estimate = refined_estimate([float(v[i]) for v in values], RATIO, FREQUENCY_ORDER, what, 1e-8)
            floor = (RIGID_FLOOR if exact[i] == 0 else ELASTIC_FLOOR) * float(exact[-1])
            answers[name] = marked(replace(estimate, uncertainty=estimate.uncertainty + floor), name)
        yield f"{state.name(problem)}, omega_{i + 1}", answers


def first_contacts(
    problem: Problem, duration: float, chosen: Levels, say: Say
) -> Iterator[tuple[str, str, dict[str, Estimate]]]:
    """Start and impulse of the first contacts, by all solvers, as long as all have contacts of the same stop."""
    runs: dict[str, list[list[Contact]]] = {}
    for name, (solvers, _, _) in chosen.items():
        say(f"first contacts, {name}")
        runs[name] = [complete(solver.simulate(problem, duration, errors=False), CONTACTS) for solver in solvers]
    every = [run for series in runs.values() for run in series]
    for i in range(min(map(len, every))):
        if len({run[i].stop for run in every}) > 1:
            return
        found = {
            name: contact_estimates(runs[name], ratio, order, refined_by(solvers[-1]), i)
            for name, (solvers, ratio, order) in chosen.items()
        }
        label = f"contact {i + 1}, {problem.stop_names[every[0][i].stop]}"
        for quantity, unit in (("start", "s"), ("impulse", "N s")):
            yield f"{label}: {quantity}", unit, {n: marked(answer[quantity], n) for n, answer in found.items()}


def duration_of(problem: Problem) -> float:
    """End of the last contact compared, at most some periods of the excitation or the slowest motion, s."""
    longest = PERIODS * longest_period(problem)
    contacts = complete(analytic.Solver().simulate(problem, longest, errors=False), CONTACTS)
    return min(longest, MARGIN * max(c.end for c in contacts)) if len(contacts) == CONTACTS else longest


def run(problem: Problem | None, peers: tuple[str, ...], level: Level, say: Say) -> CaseResult:
    """The damped joint, or a user's problem, by all solvers."""
    checks, rows, notes = [], [], []
    this, duration = (damped_joint(), DURATION) if problem is None else (problem, duration_of(problem))

    def compare(name: str, unit: str, answers: dict[str, Estimate]) -> None:
        checks.extend(pairs(name, unit, answers))
        rows.append((name, unit, *(f"{e.value:.8g} +- {e.uncertainty:.1e}" for e in answers.values())))

    for state in dict.fromkeys((FREE, contact_states(this)[-1])):
        say(f"frequencies, {state.name(this)}")
        for name, answers in frequencies(this, state, peers):
            compare(name, "rad/s", answers)
    try:
        for name, unit, answers in first_contacts(this, duration, levels(this, peers, 64), say):
            compare(name, unit, answers)
    except InputError as error:
        notes.append(f"No motion was compared: {error}")
        say(notes[-1])
    return CaseResult(
        "peers",
        f"Other solvers: {', '.join(peers)}",
        "Natural frequencies of the free state and of one with stops closed, and start and impulse of the first "
        "contacts from rest: by both solvers and by others, every one against every other. A peer is refined twice by "
        f"the factor {RATIO:g}, elements and time step; no more than order {PEER_ORDER:g} is relied on for its motion, "
        "that of a fixed time step, though cubic elements may show a higher one.",
        checks=tuple(checks),
        tables=(table("Three ways", ("quantity", "unit", "analytic", "FE", *peers), rows),),
        notes=tuple(notes),
    )
