"""What branches depend on: everything that is asked is part of the identity, and nothing else is."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from lapjoint import Axis
from lapjoint.campaigns.branches.spec import BranchSpec, range_of


@pytest.mark.parametrize(
    "other",
    [
        {"first": 3.1e-4},
        {"last": 3.9e-4},
        {"max_period_multiple": 2},
        {"starts": 1},
        {"seed": 1},
        {"errors": True},
        {"max_points": 8},
        {"effort": 8},
        {"also_over": Axis("stops.*.gap", (1e-3, 2e-3))},
        {"from_grazes": True},
    ],
)
def test_a_search_for_something_else_is_another_one(spec: BranchSpec, other: dict[str, Any]) -> None:
    assert replace(spec).fingerprint == spec.fingerprint
    assert replace(spec, **other).fingerprint != spec.fingerprint


def test_a_search_that_leaves_out_what_springs_at_grazes_is_the_one_before_there_was_a_choice(spec: BranchSpec) -> None:
    assert "from_grazes" not in spec.identity


def test_a_range_is_made_once(spec: BranchSpec) -> None:
    assert range_of(replace(spec)) is range_of(spec)
    assert range_of(replace(spec, options={"n_modes": 1})) is not range_of(spec)


def test_starts_lie_at_both_ends_and_then_anywhere_within_the_range(spec: BranchSpec) -> None:
    down = replace(spec, first=spec.last, last=spec.first, starts=20)
    values = [down.value_of(i) for i in range(down.size)]
    assert values[:2] == [spec.last, spec.first]
    assert len(set(values)) == 22
    assert all(spec.first < value < spec.last for value in values[2:])


def test_at_a_value_of_a_second_number_the_problem_has_that_value(spec: BranchSpec) -> None:
    both = replace(spec, also_over=Axis("stops.*.gap", (1e-3, 2e-3)))
    assert both.values == 2
    assert [both.at(i).problem.stops[0].gap for i in range(2)] == [1e-3, 2e-3]
    assert both.at(0).also_over is None
    assert spec.at(0) is spec
