"""The least period of an orbit: what repeats sooner is found to, and what truncation parts is put together again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
from loose_pins import bar as loose_bar
from settled import orbit_of
from toy import Bar, bar
from witness import testify

import analytic
import fe_lapjoint
from lapjoint import Outcome, Problem, paper_joint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.least_period import over_least_period

pytestmark = pytest.mark.long_march


MAPS: dict[str, Any] = {
    "bar": lambda: Bar().period_map(bar(0.8, (0.5, 5.0), (-0.5, 5.0))),
    "analytic": lambda: analytic.Solver(n_modes=6).period_map(paper_joint()),
    "FE": lambda: fe_lapjoint.Solver(elements=3).period_map(paper_joint()),
}


@pytest.mark.parametrize("solver", MAPS)
@pytest.mark.parametrize("half_periods", [2, 3, 4, 6])
def test_a_symmetric_motion_is_found_again_over_half_a_period(solver: str, half_periods: int) -> None:
    map_ = MAPS[solver]()
    orbit = orbit_of(map_, half_periods, 30)
    shorter = over_least_period(HalfPeriods(map_), orbit)
    assert (shorter.half_periods, shorter.period_multiple, shorter.symmetric) == (1, 1, True)
    assert HalfPeriods(map_).apart(shorter.point, orbit.point) < 1e-6


@pytest.mark.parametrize(
    ("problem", "least", "settle"),
    [(bar(0.8, (0.5, 5.0)), 2, 30), (bar(3.0, (0.0, 20.0), ratio=0.03), 4, 100)],
    ids=["one period", "two periods"],
)
def test_without_the_symmetry_the_least_is_that_of_whole_periods(problem: Problem, least: int, settle: int) -> None:
    map_ = Bar().period_map(problem)
    for times in (2, 3):
        shorter = over_least_period(HalfPeriods(map_), orbit_of(map_, times * least, settle))
        assert (shorter.half_periods, shorter.period_multiple, shorter.symmetric) == (least, least // 2, False)
    alone = orbit_of(map_, least, settle)
    assert over_least_period(HalfPeriods(map_), alone) is alone


@pytest.mark.parametrize(
    ("omega", "gap", "amplitude", "n_modes", "outcome", "symmetric"),
    [
        (100.0, 1e-3, 5e-3, None, Outcome.CHATTERING, False),
        (100.0, 1e-3, 10e-3, 30, Outcome.PERIODIC, False),
        (220.0, 0.2e-3, 1e-3, None, Outcome.PERIODIC, True),
        (150.0, 0.2e-3, 1e-3, None, Outcome.PERIODIC, True),
        (150.0, 1e-3, 3e-3, None, Outcome.PERIODIC, True),
    ],
)
def test_the_multiple_is_the_least_and_the_half_period_that_mirrors_is_found(
    omega: float, gap: float, amplitude: float, n_modes: int | None, outcome: Outcome, symmetric: bool
) -> None:
    """Jumps of truncation part these motions into two or three, 1e-7 to 2e-4 of their size from each other."""
    problem = loose_bar(omega, gap, amplitude)
    one = analytic.Solver(n_modes=n_modes).steady_state(problem)
    other = fe_lapjoint.Solver(elements=12).steady_state(problem)
    for steady in (one, other):
        assert steady.outcome is outcome
        assert steady.period_multiple == 1
        assert steady.stable
        assert steady.residual <= 1e-3  # what truncation may part
    assert one.symmetric is symmetric
    x, half = np.linspace(0.0, 1.0, 5), one.history.end / 2
    t = np.linspace(0.01, 0.99, 20) * half
    z, later = one.history.displacement(x, t), one.history.displacement(x, t + half)
    assert bool(np.abs(z + later).max() < 1e-3 * np.abs(z).max()) is symmetric


@pytest.mark.parametrize("n_modes", [16, 19])
def test_a_chattering_motion_that_leaves_no_room_for_any_deviation_is_certified(n_modes: int) -> None:
    """With most numbers of modes it repeats to 1e-13, and yet some contact is so short that no forecast holds."""
    solver, problem = analytic.Solver(n_modes=n_modes), loose_bar(100.0, 1e-3, 5e-3)
    steady, period_map = solver.steady_state(problem, errors=False), solver.period_map(problem)
    assert (steady.outcome, steady.period_multiple) == (Outcome.CHATTERING, 1)
    assert testify(period_map, steady, 1 / period_map.lowest_damping_rate).verdict == "true"
