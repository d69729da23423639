"""The motion without contact, from which branches are followed: of a problem with its stops where they are."""

from __future__ import annotations

import pytest
from beams import with_stops

import analytic
from lapjoint import Problem, paper_joint
from lapjoint.campaigns import FREQUENCY
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import without_contact

GAP = 1e-3  # m, that of the paper's stops
QUIET = 5.0  # rad/s: no stop is touched


@pytest.mark.parametrize(("gap", "half_periods"), [(GAP, 1), (1.5 * GAP, 2)])
def test_stops_that_mirror_each_other_only_out_of_reach_make_no_symmetric_motion(gap: float, half_periods: int) -> None:
    """Pushed out of reach they differ in nothing; the motion is that of a whole period all the same."""

    def problem_at(omega: float) -> Problem:
        wide = 10.0  # so that nothing is touched
        return with_stops(paper_joint(angular_frequency=omega, gap=wide * GAP), {"gap": wide * gap})

    start = without_contact(ParameterRange(analytic.Solver(n_modes=6), problem_at, FREQUENCY, 1.0, 10.0), QUIET)
    assert start is not None
    assert start.half_periods == half_periods
