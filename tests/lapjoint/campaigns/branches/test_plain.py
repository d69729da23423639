"""Motions and bifurcations come back from JSON with the same bits."""

from __future__ import annotations

import json
from collections.abc import Iterator
from typing import Any, get_args

import numpy as np
import pytest

from lapjoint import FREQUENCY, BaseMotion, Problem
from lapjoint.campaigns.branches.plain import (
    located_of,
    plain_curve,
    plain_located,
    plain_start,
    problem_of,
    start_of,
    unknowns_of,
)
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.orbits.branches.bifurcations import Kind
from lapjoint.orbits.branches.errors import Located, again, carried, resolution_of, value_of
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.sequence_changes import SequenceChange
from lapjoint.orbits.branches.starts import Start, start_from
from lapjoint.orbits.branches.tracing import Traced, trace

ALIKE = 1e-9
"""Distance of values over the scale of the parameter: motions are solved to 1e-9 of their size."""


AS_ENDED = {"birth": "end", "split": "merge"}
"""What a graze comes back as: from the side with a contact, or a flight, more."""


def followed(of: ParameterRange, value: float) -> Traced:
    start = start_from(of, value, of.resolution(value).map(value).initial(), 1)
    assert start is not None
    found = trace(of, start, 1)
    assert found is not None
    return found


@pytest.fixture(scope="module")
def traced(spec: BranchSpec) -> Traced:
    """The branch of the cantilever: a graze and two folds."""
    return followed(range_of(spec), spec.first)


@pytest.fixture(scope="module")
def hard(problem: Problem) -> BranchSpec:
    """The same against a hard stop, slowly driven: flips, Neimark-Sackers, and contacts that split."""
    stops = (problem.stops[0].model_copy(update={"stiffness": 500.0}),)
    slow = problem.replace(stops=stops, base_motion=BaseMotion(amplitude=4e-4, angular_frequency=5.0))
    return BranchSpec(slow, FREQUENCY, 5.0, 5.4, options={"n_modes": 8}, errors=False)


def through_json(plain: Any) -> Any:
    return json.loads(json.dumps(plain))


def test_a_start_comes_back_with_the_same_bits(spec: BranchSpec) -> None:
    of = range_of(spec)
    start = start_from(of, spec.last, of.resolution(spec.last).map(spec.last).initial(), 1)
    assert start is not None
    there = start.solved(of)
    assert there is not None
    one = Start.at(there, (there.value, there.section()))
    back = start_of(through_json(plain_start(one)))
    assert (back.sequence, back.half_periods, back.phase, back.tied) == (
        one.sequence,
        one.half_periods,
        one.phase,
        one.tied,
    )
    np.testing.assert_array_equal(back.unknowns, one.unknowns)
    assert back.direction is not None
    assert one.direction is not None
    np.testing.assert_array_equal(back.direction, one.direction)
    assert back.away_from is not None
    assert back.away_from[0] == there.value
    np.testing.assert_array_equal(back.away_from[1].coordinates, there.section().coordinates)


def test_the_knots_of_a_curve_come_back_as_solutions_of_their_equations(spec: BranchSpec, traced: Traced) -> None:
    of, points = range_of(spec), traced.points
    plain = through_json(plain_curve(of, [(point, i % 2 == 0) for i, point in enumerate(points)]))
    for i, (point, knot) in enumerate(zip(points, plain["knots"], strict=True)):
        problem = problem_of(of, plain["equations"][knot[0]], point.problem.half_periods)
        assert (problem.sequence, problem.phase, problem.tied) == (
            point.problem.sequence,
            point.problem.phase,
            point.problem.tied,
        )
        assert problem.resolution is point.problem.resolution
        np.testing.assert_array_equal(unknowns_of(knot), point.u)
        assert knot[2] == (i % 2 == 0)
    assert len(plain["equations"]) < len(points)  # each is written once


def checked(of: ParameterRange, what: Located) -> None:
    """Compare what was located with what comes back from JSON."""
    plain = through_json(plain_located(of, what))
    back = located_of(of, plain)
    assert back is not None
    assert back.kind == AS_ENDED.get(what.kind, what.kind)
    assert resolution_of(back) is resolution_of(what)
    assert abs(value_of(back) - value_of(what)) <= ALIKE * resolution_of(what).scale(value_of(what))
    assert through_json(plain_located(of, back)) is not None


def located(traced: Traced) -> Iterator[Located]:
    for one in traced.found:
        yield one.what


def test_folds_and_grazes_come_back_with_their_values(spec: BranchSpec, traced: Traced) -> None:
    kinds = set()
    for what in located(traced):
        checked(range_of(spec), what)
        kinds.add(what.kind)
    assert kinds == {"fold", "birth"}


def test_what_a_finer_resolution_located_comes_back_at_that_resolution(spec: BranchSpec, traced: Traced) -> None:
    for what in located(traced):
        finer = resolution_of(what).finer
        assert finer is not None

        def carry(point: Any, resolution: Any = finer[1]) -> Any:
            return carried(point, resolution)

        there = again(what, carry)
        assert there is not None
        assert resolution_of(there) is finer[1]
        checked(range_of(spec), there)


def test_all_kinds_come_back_with_their_values(hard: BranchSpec) -> None:
    kinds = set()
    for what in located(followed(range_of(hard), hard.first)):
        checked(range_of(hard), what)
        kinds.add(what.kind)
    assert {*get_args(Kind), "birth", "end", "split"} <= kinds


def test_a_graze_whose_other_side_is_not_known_has_no_motion(spec: BranchSpec, traced: Traced) -> None:
    (birth,) = (what for what in located(traced) if isinstance(what, SequenceChange))
    lost = SequenceChange("birth", birth.stops, birth.before, None)
    assert plain_located(range_of(spec), lost) is None
