"""The paper's joint, and joints like it, as one branch over the frequency, with the motions that steady states have."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
from lapjoint import Problem, paper_joint
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.campaigns.branches.solve import steady_state
from lapjoint.campaigns.grid import FREQUENCY, Axis, Grid
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.branches.bifurcations import Bifurcation
from lapjoint.orbits.branches.halves import half_difference
from lapjoint.orbits.branches.point import SAME, CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.sequence_changes import SequenceChange
from lapjoint.orbits.branches.starts import start_from
from lapjoint.orbits.branches.tracing import Limits, Traced, trace
from lapjoint.orbits.half_periods import HalfPeriods

SPANS = (0.04, 0.2), (np.exp(-1.0), np.exp(1.0)), (np.exp(-1.5), np.exp(1.5))
"""Damping ratios, and factors of the paper's gaps and stiffnesses, of random joints."""
AT_ONCE = 1e-7
"""Distance of a graze from a broken symmetry, over the frequency, within which the branch that springs may not be
found: it grazes a stop before any motion of it that is tried."""
TOLD = 1000.0
"""By how much more a motion must miss to mirror itself than the symmetric one that it springs from, which misses to by
what passages lose in a march, that a march judges the motion's period."""
POINTS = 25
"""Largest number of points of a branch that springs."""
BOTH = ("boundary", "boundary")


@in_one_thread
def traced(problem: Problem, low: float, high: float, most: int = 5000) -> tuple[ParameterRange, Traced | None]:
    """The branch of the motion from rest at the upper end of a range; None if that does not settle."""
    grid = Grid(problem, (Axis(FREQUENCY, (low, high)),))
    of = ParameterRange(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, low, high)
    start = start_from(of, high, of.resolution(high).map(high).initial(), 1)
    return of, None if start is None else trace(of, start, 1, Limits(most))


def of_the_joint(low: float, high: float) -> tuple[ParameterRange, Traced]:
    """The branch of the paper's joint, from end to end."""
    of, found = traced(paper_joint(), low, high)
    assert found is not None
    assert found.ends == BOTH
    return of, found


def check(found: Traced, points: int) -> None:
    """The steady states at some of the branch's own frequencies, drawn by a seed, have its impulses.

    Where the branch is unstable, or another motion stands beside it, a march from rest ends elsewhere: there the steady
    state is sought from the branch's own section point, and only stable points are drawn.
    """
    stable = [point for point in found.points if np.abs(point.multipliers).max() < 1]
    drawn = np.random.default_rng(13).choice(len(stable), size=min(points, len(stable)), replace=False)
    solver = analytic.Solver()
    for i in drawn.tolist():
        motion = steady_state(stable[i])
        steady = solver.steady_state(motion.problem, start=motion.section_point)
        assert steady.period_multiple == 1
        assert steady.impulse_errors is not None
        # The branch has its own number of modes, and with it an error of its own, as large as the steady state's.
        allowed = 2 * steady.impulse_errors + 1e-9 * np.abs(steady.impulses).max()
        assert (np.abs(steady.impulses - motion.impulses) <= allowed).all(), stable[i].value


@pytest.mark.thorough
def test_a_part_with_light_contacts_is_one_branch() -> None:
    _, found = of_the_joint(54.0, 75.0)
    assert any(not isinstance(one.what, Bifurcation) for one in found.found)
    check(found, 12)


@pytest.mark.thorough
def test_contacts_that_are_lost_one_after_the_other_end_no_branch() -> None:
    """Below 4.35 rad/s each of a dozen light contacts is lost within 1e-3 of the next one."""
    _, found = of_the_joint(4.29, 4.345)
    assert sum(not isinstance(one.what, Bifurcation) for one in found.found) > 1


@pytest.mark.thorough
@pytest.mark.parametrize(("low", "high"), [pytest.param(4.2, 95.0, marks=pytest.mark.slow), (95.0, 110.0)])
def test_from_broken_symmetries_branches_spring_and_end_where_motions_mirror_themselves(
    low: float, high: float
) -> None:
    """Its motions repeat after a period, as a march shows, and do not mirror themselves."""
    of, found = of_the_joint(low, high)
    broken = [one.what.point.value for one in found.found if one.what.kind == "flip"]
    sprung = [start.away_from[0] for start in found.starts if start.away_from is not None]
    missing = [one.point.value for one in found.unsprung]
    assert sorted([*sprung, *missing]) == sorted(broken)
    branches = [trace(of, start, 1, Limits(POINTS)) for start in found.starts]
    missing += [value for value, one in zip(sprung, branches, strict=True) if one is None]
    grazes = np.array([one.what.value for one in found.found if isinstance(one.what, SequenceChange)])
    assert all(np.abs(grazes / value - 1).min() <= AT_ONCE for value in missing)
    assert len(missing) < len(broken)
    meets, judged = np.array([*broken, *grazes]), 0
    for branch in (one for one in branches if one is not None):
        assert max(map(apart, branch.points)) > 10 * SAME
        assert all(np.abs(meets / value - 1).min() <= SAME for value, _ in branch.springs)  # as motions are one
        symmetric, _ = misses(of, *branch.springs[0])  # by what passages lose in a march
        farthest = max((one for one in branch.points if apart(one) < np.inf), key=apart)
        half, whole = misses(of, farthest.value, farthest.section())
        if half > TOLD * symmetric:
            assert whole < 0.1 * half
            judged += 1
    assert judged


def misses(of: ParameterRange, value: float, motion: SectionPoint) -> tuple[float, float]:
    """By how much marches of a motion miss to mirror it after half a period, and to repeat it after a period."""
    half = HalfPeriods(of.resolution(value).map(value))
    section = half.map.adopted(motion)
    mirrored, repeated = (half.apart(half.marched(section, count), section) for count in (1, 2))
    return mirrored, repeated


def apart(point: CurvePoint) -> float:
    """By how much a motion misses to mirror itself; infinite if its contacts do not."""
    difference = half_difference(point)
    return np.inf if difference is None else float(np.linalg.norm(difference))


@pytest.mark.slow
def test_the_whole_curve_is_one_branch_of_few_points() -> None:
    _, found = of_the_joint(1.0, 5000.0)
    assert len(found.points) <= 0.5 * 5000  # of the points of a sweep, which sees less
    check(found, 200)


def random_joint(number: int) -> Problem:
    """A joint like the paper's, with other damping, gaps and stiffnesses; some are not their own mirror images."""
    rng, joint = np.random.default_rng((7, number)), paper_joint()
    ratio, gaps, stiffness = (float(np.exp(rng.uniform(*np.log(span)))) for span in SPANS)
    uneven = rng.random() < 0.4
    stops = tuple(
        stop.model_copy(
            update={
                "gap": gaps * stop.gap * (float(np.exp(rng.uniform(-0.3, 0.3))) if uneven else 1.0),
                "stiffness": stiffness * stop.stiffness,
            }
        )
        for stop in joint.stops
    )
    return joint.replace(damping=joint.damping.model_copy(update={"ratio": ratio}), stops=stops)


@pytest.mark.slow
def test_no_branch_of_random_joints_from_an_end_of_the_range_is_a_ring_and_few_are_lost() -> None:
    found = [
        found for _, found in (traced(random_joint(i), 100.0, 5000.0, 600) for i in range(24)) if found is not None
    ]
    ends = [end for one in found for end in one.ends]
    assert "closed" not in ends
    assert all("boundary" in one.ends for one in found)
    assert ends.count("lost") <= 0.05 * len(ends)
