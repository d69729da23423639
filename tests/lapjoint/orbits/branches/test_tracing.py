"""A branch from one of its motions: its steps lose nothing, and lead to where it springs from another branch."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np
import pytest
from beams import unit_cantilever

import analytic
from lapjoint import FREQUENCY, Problem, Stop
from lapjoint.orbits.branches import tracing
from lapjoint.orbits.branches.bifurcations import Bifurcation, Stretch, flip_test, within
from lapjoint.orbits.branches.halves import half_difference
from lapjoint.orbits.branches.point import CurvePoint
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import Start, start_from
from lapjoint.orbits.branches.tracing import Limits, Traced, Way, one_way, trace

LOW, HIGH = 3.0, 3.1  # rad/s


@pytest.fixture(scope="module")
def of() -> ParameterRange:
    """A lightly damped cantilever with one stop, which repeats after two periods of slow excitation."""

    def problem_at(omega: float) -> Problem:
        return unit_cantilever(Stop(x=1.0, side="top", gap=1e-3, stiffness=100.0), omega=omega, ratio=0.02)

    return ParameterRange(analytic.Solver(n_modes=6), problem_at, FREQUENCY, LOW, HIGH)


@pytest.fixture(scope="module")
def first(of: ParameterRange) -> CurvePoint:
    """The motion of two periods at the low end, its tangent into the range."""
    start = start_from(of, LOW, of.resolution(LOW).map(LOW).initial(), 2)
    assert start is not None
    point = start.solved(of)
    assert point is not None
    assert point.problem.half_periods == 4
    return point if point.tangent[-1] > 0 else point.turned()


def test_each_step_is_as_long_as_its_end_lies_along_its_start_and_also_the_last_one(
    of: ParameterRange, first: CurvePoint, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A bifurcation beyond a length that is too short would be lost, and one that is too long leads past the end."""
    steps = list[Stretch]()

    def noted(step: Stretch) -> Iterator[Bifurcation]:
        steps.append(step)
        return within(step)

    monkeypatch.setattr(tracing, "within", noted)
    way = one_way(of, first, Limits())
    assert way.end == "bifurcation"
    assert steps[-1].end is way.points[-1]
    for step in steps:
        assert step.length == pytest.approx(step.start.arclength(step.end), rel=1e-6)


def test_where_a_branch_springs_its_halves_are_alike_and_its_mother_flips(
    of: ParameterRange, first: CurvePoint
) -> None:
    way = one_way(of, first, Limits())
    end = way.points[-1]
    missed = half_difference(end)
    assert missed is not None
    assert np.linalg.norm(missed) <= 1e-6  # by Newton's method, through what passages lose
    assert way.mother is not None
    mother = way.mother.solved(of)
    assert mother is not None
    assert mother.problem.half_periods == 2
    assert mother.value == pytest.approx(end.value, rel=1e-8)
    assert abs(flip_test(mother)) <= 1e-6


def test_a_curve_in_the_opposite_sequence_has_its_bifurcations_before_the_same_points(
    of: ParameterRange, first: CurvePoint
) -> None:
    way = one_way(of, first, Limits())
    back = way.turned()
    assert [point.value for point in back.points] == [point.value for point in reversed(way.points)]
    for one, other in zip(way.found, reversed(back.found), strict=True):
        assert one.what is other.what
        assert one.index + other.index == len(way.points)
    assert Way(back.points, back.found, back.end).turned().found == way.found


def test_the_limits_end_a_curve_as_effort(of: ParameterRange, first: CurvePoint) -> None:
    shares: list[float] = []
    way = one_way(of, first, Limits(4, shares.append))
    assert (way.end, len(way.points)) == ("effort", 4)
    assert shares == sorted(shares)
    assert 0 < shares[0] < 1


def test_a_branch_and_its_mother_lead_to_each_other(of: ParameterRange, first: CurvePoint) -> None:
    def traced(point: CurvePoint) -> Traced:
        found = trace(of, Start.at(point), 2)
        assert found is not None
        return found

    own = traced(first)
    assert "bifurcation" in own.ends
    (mother,) = [one for one in own.starts if one.half_periods == 2]
    there = trace(of, mother, 2)
    assert there is not None
    assert [value for value, _ in there.springs] == []
    daughters = [one.away_from for one in there.starts if one.half_periods == 4]
    values = [away[0] for away in daughters if away is not None]
    (sprung,) = [value for value, _ in own.springs]
    assert min(abs(value - sprung) for value in values) <= 1e-8 * sprung
