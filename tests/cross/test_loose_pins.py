"""A bar between two equally loose pins: symmetries hold its march at motions that no such bar can keep to.

The problem is its own mirror image, left for right and top for bottom, and a march from rest begins where every
symmetry is kept.  Where the symmetric motion repels what is not symmetric, the answer is the motion next to it.
"""

from __future__ import annotations

import numpy as np
import pytest
from loose_pins import bar
from witness import testify

import analytic
import fe_lapjoint
from lapjoint import Outcome, PolynomialShape, Problem, SteadyState
from lapjoint.problem import AtRest, FloatArray

pytestmark = pytest.mark.long_march

ASKEW = PolynomialShape(displacement=(2e-5, -1e-5))  # the bar's ends 20 and 10 um off


def by_end(impulses: FloatArray) -> FloatArray:
    """Impulses at the bottom and the top of the end that is struck less, then of the other."""
    return np.array(sorted(impulses.reshape(2, 2).tolist(), key=lambda end: float(end[1])))


def marched(problem: Problem, solver: analytic.Solver, periods: int) -> FloatArray:
    """Impulses of the last period of a march that begins a little askew, the bar's ends 20 and 10 um off."""
    period = problem.require_excitation_period("march")
    history, total = solver.simulate(problem.replace(initial=ASKEW), periods * period), np.zeros(4)
    for contact in history.contacts:  # no contact of this motion is under way at the end of a period
        if history.end - period <= contact.start:
            total[contact.stop] += contact.impulse
    return total


@pytest.fixture(scope="module")
def certified() -> SteadyState:
    return analytic.Solver().steady_state(bar(300.0))


def test_a_march_that_repeats_is_not_called_aperiodic(certified: SteadyState) -> None:
    assert (certified.outcome, certified.period_multiple) == (Outcome.PERIODIC, 1)
    assert certified.stable
    assert certified.exponent is None


def test_what_remains_is_what_a_march_from_a_start_askew_comes_to(certified: SteadyState) -> None:
    # 60 periods leave 0.71^60 = 1e-9 of the transient; bisections of truncation, 1e-5 each, remain.
    last = marched(bar(300.0), analytic.Solver(), 60)
    assert by_end(last) == pytest.approx(by_end(certified.impulses), rel=1e-3)
    left, right = by_end(certified.impulses)[:, 1]
    assert right > 1.2 * left


def test_more_modes_and_finite_elements_find_the_same_motion(certified: SteadyState) -> None:
    for solver in (analytic.Solver(n_modes=30), fe_lapjoint.Solver(elements=24)):
        other = solver.steady_state(bar(300.0))
        assert (other.outcome, other.period_multiple, other.symmetric) == (Outcome.PERIODIC, 1, certified.symmetric)
        # 11 modes by a criterion of 1e-5, of impulses that a near-by bifurcation makes some ten times as sensitive
        assert by_end(other.impulses) == pytest.approx(by_end(certified.impulses), rel=2e-3)


@pytest.mark.parametrize("askew", [pytest.param(False, marks=pytest.mark.thorough), True])
def test_chaos_that_dies_by_chance_is_named_for_what_it_does(askew: bool) -> None:
    """From rest, left and right move alike and do not repeat; askew, the bar settles to a period of one at last.

    After how many hundred periods hangs on rounding; what is certified of either march must be true of it all the same.
    """
    problem = bar(375.0).replace(initial=ASKEW if askew else AtRest())
    solver = analytic.Solver()
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    judgement = testify(period_map, steady, 1 / period_map.lowest_damping_rate)
    assert judgement.verdict != "false", judgement.why
    if steady.period_multiple:
        assert steady.period_multiple == 1
        # The motion of period one, or its mirror images: impulses by a march of 2000 periods with 32 modes.
        assert steady.impulse_errors is not None
        assert np.sort(np.abs(steady.impulses)) == pytest.approx(
            [0.34217839, 0.34217839, 0.35909316, 0.35909316], abs=float(steady.impulse_errors.max())
        )


@pytest.mark.thorough
def test_narrow_chaos_is_told_from_a_march_that_is_held() -> None:
    """It wanders by 0.3 % only; pushed ten times as far it comes back, as it does with more modes."""
    for n_modes in (None, 16):
        steady = analytic.Solver(n_modes=n_modes).steady_state(bar(212.5, 1e-3, 3e-3))
        assert steady.outcome is Outcome.APERIODIC
        assert steady.exponent is not None
        assert steady.exponent.value == pytest.approx(14.7, abs=2.0)  # finite elements: 14.7 +- 0.6


@pytest.mark.thorough
@pytest.mark.parametrize("omega", [190.0, 220.0])  # left and right part in the first, top and bottom in the second
def test_finite_elements_leave_a_motion_that_repels_too_slowly_for_rounding(omega: float) -> None:
    """The multipliers are 1.035 and 1.043: from 1e-16 it takes a thousand periods to be seen."""
    steady = fe_lapjoint.Solver(elements=2).steady_state(bar(omega))
    assert (steady.outcome, steady.period_multiple) == (Outcome.PERIODIC, 1)
    assert steady.stable
    ends = np.abs(steady.impulses.reshape(2, 2))
    assert np.ptp(ends, axis=0 if omega == 190.0 else 1).min() > 1e-4 * ends.max()
