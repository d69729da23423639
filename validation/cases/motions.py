"""Motions from rest: contacts of one problem by both solvers, each with its uncertainty."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import replace

import analytic
import fe_lapjoint
from lapjoint import FREE, History, Problem
from lapjoint.answers import Contact
from lapjoint.solver import Solver
from validation.uncertainty import Refined, refined_estimate
from validation.verdict import Check, ErrorSource, Estimate

ANALYTIC_ORDER = 5.0
"""Order of convergence of event times in the number of modes, the least order of all numbers: impulses have the order 7
(tests/analytic/test_steady_state.py)."""
FE_ORDER = 4.0
EVENT_FLOOR = 2.2e-11  # Error with which both solvers locate a switch, s


def analytic_levels(problem: Problem, ratio: float) -> list[analytic.Solver]:
    """Solvers with the default number of modes divided by `ratio`, the default number, and the number times `ratio`."""
    free, _ = analytic.Solver().mode_counts(problem)
    return [analytic.Solver(n_modes=max(4, round(free * ratio**power))) for power in (-1, 0, 1)]


def fe_levels(finest: int) -> list[fe_lapjoint.Solver]:
    """Solvers with a quarter, a half and all of `finest` elements."""
    return [fe_lapjoint.Solver(elements=n) for n in (finest // 4, finest // 2, finest)]


def refined_by(solver: Solver) -> Refined:
    """The refinement of a solver: of its modes, of its mesh or, for a peer, its own."""
    by_kind = {analytic.Solver: ErrorSource.MODES, fe_lapjoint.Solver: ErrorSource.MESH}
    return Refined(by_kind.get(type(solver), ErrorSource.REFINEMENT), solver.name)


def longest_period(problem: Problem) -> float:
    """The excitation period, s; without excitation, the period of the slowest elastic mode of the free beam."""
    if problem.excitation_frequency is not None:
        return 2 * math.pi / problem.excitation_frequency
    found = (
        analytic.Solver().modes(problem, FREE, 4).angular_frequencies
    )  # two of them can be rigid-body modes, with frequency 0
    return 2 * math.pi / float(found[found > 0][0])


def complete(history: History, count: int) -> list[Contact]:
    """The first contacts that ended within the history."""
    return [contact for contact in history.contacts if not contact.open_end][:count]


def contact_estimates(
    contacts: Sequence[Sequence[Contact]], ratio: float, order: float, refined: Refined, i: int
) -> dict[str, Estimate]:
    """Start, end and impulse of the i-th contact from refined solutions, coarse to fine.  Changes may cancel by chance,
    so the uncertainty is at least that of every earlier contact, and at least the stated error of the finest
    solution."""

    def estimate(field: str, j: int) -> Estimate:
        found = refined_estimate([getattr(run[j], field) for run in contacts], ratio, order, refined)
        stated = _stated(contacts[-1], field, j)
        if not found.uncertainty < stated < math.inf:
            return found
        how = f"{refined.what}, as the solver states"
        return replace(found, uncertainty=stated, how=how, parts=((refined.source, stated),))

    times = [estimate(field, j) for j in range(i + 1) for field in ("start", "end")]
    impulses = [estimate("impulse", j) for j in range(i + 1)]
    found = {"start": _carried(times[:-1]), "end": _carried(times), "impulse": _carried(impulses)}
    for field in ("start", "end"):
        parts = (*found[field].parts, (ErrorSource.EVENT_TIMES, EVENT_FLOOR))
        found[field] = replace(found[field], uncertainty=found[field].uncertainty + EVENT_FLOOR, parts=parts)
    return found


def _stated(contacts: Sequence[Contact], field: str, j: int) -> float:
    """The stated error of a solution, or 0; for a rebound, the larger error of the impacts before and after it."""
    if field == "impulse":
        return contacts[j].impulse_error or 0.0
    impacts = contacts[j : j + 2] if field == "end" else contacts[j : j + 1]
    return max(contact.start_error or 0.0 for contact in impacts)


def _carried(estimates: Sequence[Estimate]) -> Estimate:
    """The last of several estimates of a motion, with the largest of their uncertainties."""
    last, worst = estimates[-1], max(estimates, key=lambda estimate: estimate.uncertainty)
    if worst.uncertainty == last.uncertainty:
        return last
    return replace(worst, value=last.value, how=f"{worst.how}, at an earlier contact")


def compare_contacts(
    problem: Problem, duration: float, count: int, finest: int, cap: float | None = None, stated: bool = False
) -> tuple[list[Check], History, History]:
    """Checks of the first `count` contacts, and the finest histories of both solvers.  With `stated`, uncertainties are
    at least the stated errors of the finest solutions, which costs one finer march; the checks end with the impact of a
    contact of which one of them says that it does not resolve it."""

    def marched(solvers: Sequence[Solver]) -> list[History]:
        return [one.simulate(problem, duration, errors=stated and one is solvers[-1]) for one in solvers]

    exact, fe = marched(analytic_levels(problem, 1.5)), marched(fe_levels(finest))
    checks: list[Check] = []
    runs = [complete(history, count) for history in (*exact, *fe)]
    names, shortest = problem.stop_names, min(len(run) for run in runs)
    for i in range(shortest):
        if len({run[i].stop for run in runs}) > 1:
            break
        a = contact_estimates(runs[:3], 1.5, ANALYTIC_ORDER, refined_by(analytic_levels(problem, 1.5)[-1]), i)
        b = contact_estimates(runs[3:], 2.0, FE_ORDER, refined_by(fe_levels(finest)[-1]), i)
        label = f"contact {i + 1}, {names[runs[-1][i].stop]}"
        checks.append(Check(f"{label}: impact", "s", a["start"], b["start"]))
        if any(math.isinf(runs[finest_run][i].impulse_error or 0.0) for finest_run in (2, 5)):
            break
        checks.append(Check(f"{label}: rebound", "s", a["end"], b["end"]))
        checks.append(Check(f"{label}: impulse", "N s", a["impulse"], b["impulse"], cap=cap))
    return checks, exact[-1], fe[-1]
