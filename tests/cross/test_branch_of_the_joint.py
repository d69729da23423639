"""The paper's joint as one branch: at its own frequencies the steady states have its impulses within stated errors."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
from lapjoint import paper_joint
from lapjoint.answers.branches import Branch
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import Traced, trace

FREQUENCY = "base_motion.angular_frequency"


def family_between(low: float, high: float) -> Family:
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (low, high)),))
    return Family(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, low, high)


def traced(family: Family) -> Traced:
    """The branch of the motion from rest at the upper end of a range."""
    seed = seed_from(family, family.high, family.at(family.high).map.initial(), 1)
    assert seed is not None
    found = trace(family, seed, most_multiple=1, errors=False)
    assert found is not None
    return found


def branch_between(low: float, high: float) -> Branch:
    return traced(family_between(low, high)).branch


def check(branch: Branch, points: int) -> None:
    """The steady states from rest at some of the branch's own frequencies, drawn by a seed, have its impulses.

    Where the branch is unstable, or another motion stands beside it, a march from rest ends elsewhere: there the steady
    state is sought from the branch's own section point, and only stable points are drawn.
    """
    stable = [point for point in branch.points if point.motion.stable]
    drawn = np.random.default_rng(13).choice(len(stable), size=min(points, len(stable)), replace=False)
    solver = analytic.Solver()
    for i in drawn.tolist():
        point = stable[i]
        steady = solver.steady_state(point.motion.problem, start=point.motion.section_point)
        assert steady.period_multiple == 1
        assert steady.impulse_errors is not None
        # The branch has its own number of modes, and with it an error of its own, as large as the steady state's.
        allowed = 2 * steady.impulse_errors + 1e-9 * np.abs(steady.impulses).max()
        assert (np.abs(steady.impulses - point.motion.impulses) <= allowed).all(), point.value


@pytest.mark.thorough
def test_a_part_with_light_contacts_is_one_branch() -> None:
    branch = branch_between(54.0, 75.0)
    assert branch.ends == ("boundary", "boundary")
    assert any(one.kind == "grazing" for one in branch.bifurcations)
    check(branch, 12)


@pytest.mark.thorough
def test_contacts_that_are_lost_one_after_the_other_are_grazes_and_not_gaps() -> None:
    # Below 4.35 rad/s each of a dozen light contacts is lost within 1e-3 of the next one: damping forces jump there,
    # and the curve turns sharply just before each.  Ten parts were left out before that was known.
    branch = branch_between(4.29, 4.345)
    kinds = [one.kind for one in branch.bifurcations]
    assert branch.ends == ("boundary", "boundary")
    assert "grazing" in kinds
    left_out = sum(2 * one.error for one in branch.bifurcations if one.kind == "unresolved")
    assert left_out <= 2e-5  # rad/s


@pytest.mark.parametrize(
    ("low", "high", "least"), [pytest.param(4.2, 50.0, 5, marks=pytest.mark.thorough), (50.0, 110.0, 7)]
)
def test_from_each_broken_symmetry_a_branch_springs(low: float, high: float, least: int) -> None:
    """One of its motions repeats after a period, as a march shows, and does not mirror itself."""
    family = family_between(low, high)
    found = traced(family)
    broken = [one.value for one in found.branch.bifurcations if one.kind == "symmetry breaking"]
    assert len(broken) >= least
    assert not found.unsprung
    assert [seed.away_from is not None and seed.away_from[0] for seed in found.seeds] == broken
    for seed in found.seeds:
        half = family.at(seed.value)
        point = half.map.adopted(seed.point)
        missed = [half.apart(half.marched(point, count), point) for count in (1, 2)]
        assert missed[0] > 1e-6
        assert missed[1] < 1e-9
        assert missed[1] < 1e-3 * missed[0]
        assert seed.value == pytest.approx(seed.away_from[0] if seed.away_from else 0.0, rel=1e-3)


@pytest.mark.slow
def test_the_whole_curve_is_one_branch_of_few_points() -> None:
    branch = branch_between(1.0, 5000.0)
    assert branch.ends == ("boundary", "boundary")
    assert len(branch.points) <= 2000  # a sweep of 5000 points sees less
    left_out = sum(2 * one.error for one in branch.bifurcations if one.kind == "unresolved")
    assert left_out <= 0.1  # rad/s of 5000
    check(branch, 200)
