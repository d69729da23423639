"""Joints with masses, steps, fluids, static loads, preload and stops in space: where both solvers say they settle, and
how they rest, agrees within their stated errors.

Their first contacts are compared in `test_first_contacts`, their certificates marched on in `test_population`, and
their errors judged in `test_error_estimates`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from functools import partial
from itertools import islice

import numpy as np
import pytest
from few_and_many import in_processes
from random_joints import DAMPED, real_joint
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import Outcome, Problem, SteadyState
from tests.cross.test_equilibria import check_agree, rested
from validation.coexistence import Motion, why_they_differ

pytestmark = pytest.mark.long_march

LONGEST = 500  # excitation periods, after which a motion that has not been told is not waited for
SOLVERS: tuple[AnySolver, ...] = (
    analytic.Solver(max_periods=LONGEST),
    fe_lapjoint.Solver(elements=10, max_periods=LONGEST),
)
SEED, DRAWN, COUNT = 6023, 320, 200  # joints drawn, and how many that both solvers decide on are compared
FEW = (7, 35)  # gravity, and several at once
FEW_DAMPED = (7,)
MORE = (5, 9, 15, 17)  # fluids, a uniform load, and several at once
REST = 10  # joints whose equilibria a quick run compares
MARGIN = 3.0  # of both stated errors together, which are estimates
DEVIATIONS = 4.0  # standard errors of mean impulses of motions that do not repeat
ROUNDING = 1e-8  # of the largest impulse: to which an orbit closes
MOST_MISSED = 0.03  # of all motions compared; stated errors are to cover 19 of 20, and here there are two


Drawn = Callable[[int, int], Problem]


@dataclass(frozen=True)
class Settled:
    """What both solvers say of where one joint settles."""

    title: str
    verdict: str
    """"agree", "beside" (they differ, and both exist), "undecided", or "apart" (they differ, unexplained)."""
    why: str


def settled(drawn: Drawn, index: int) -> Settled:
    """Both solvers on one problem, from rest."""
    problem = drawn(SEED, index)
    return judged(problem, *(solver.steady_state(problem, sensitivity=False) for solver in SOLVERS))


def judged(problem: Problem, one: SteadyState, other: SteadyState, solvers: tuple[AnySolver, ...] = SOLVERS) -> Settled:
    """What two solvers say of where a problem settles."""
    if Outcome.UNDECIDED in (one.outcome, other.outcome):
        return Settled(problem.title, "undecided", f"{one.outcome.name}, {other.outcome.name}")
    if (one.outcome, one.period_multiple) == (other.outcome, other.period_multiple):
        times = times_allowed(one, other)
        if times <= 1.0:
            return Settled(problem.title, "agree", "")
    motions = [Motion(solver, found) for solver, found in zip(solvers, (one, other), strict=True)]
    why = why_they_differ(problem, *motions)
    named = ", ".join(
        f"{it.outcome.name} {it.period_multiple} {it.impulses} +- {it.impulse_errors}" for it in (one, other)
    )
    return Settled(problem.title, "beside" if why else "apart", f"{named}; {why}")


def times_allowed(one: SteadyState, other: SteadyState) -> float:
    """The largest difference of impulses of two motions of one kind over what their errors allow."""
    assert one.impulse_errors is not None
    assert other.impulse_errors is not None
    size = float(np.abs([one.impulses, other.impulses]).max(initial=0.0))
    allowed = MARGIN * (one.impulse_errors + other.impulse_errors)
    if not one.period_multiple:
        allowed = DEVIATIONS * np.hypot(one.impulse_errors, other.impulse_errors)
    apart = np.abs(one.impulses - other.impulses)
    return float(np.max(apart / (allowed + ROUNDING * size + math.ulp(0.0)), initial=0.0))


def check(found: Iterable[Settled], count: int) -> None:
    """Fail unless of `count` joints that both solvers decide on nearly all agree, or their motions exist side by
    side."""
    decided = list(islice((it for it in found if it.verdict != "undecided"), count))
    apart = [f"{it.title}: {it.why}" for it in decided if it.verdict == "apart"]
    assert len(decided) == count
    assert len(apart) <= MOST_MISSED * count, "\n".join(apart)


@pytest.mark.parametrize(
    ("drawn", "members"),
    [pytest.param(real_joint, FEW + MORE, marks=pytest.mark.thorough), (DAMPED, FEW_DAMPED)],
)
def test_both_solvers_agree_where_a_few_real_joints_settle(drawn: Drawn, members: tuple[int, ...]) -> None:
    check(map(partial(settled, drawn), members), len(members))


@pytest.mark.slow
@pytest.mark.parametrize(("drawn", "drawn_of", "count"), [(real_joint, DRAWN, COUNT), (DAMPED, 160, 100)])
def test_both_solvers_agree_where_many_real_joints_settle(drawn: Drawn, drawn_of: int, count: int) -> None:
    check(in_processes(partial(settled, drawn), range(drawn_of)), count)


@pytest.mark.parametrize("drawn", [real_joint, DAMPED])
@pytest.mark.parametrize("count", [REST, pytest.param(COUNT, marks=pytest.mark.slow)])
def test_both_solvers_agree_how_real_joints_rest(drawn: Drawn, count: int) -> None:
    for index in range(count):
        found = rested(drawn(SEED, index))
        assert found is not None
        check_agree(*found)
