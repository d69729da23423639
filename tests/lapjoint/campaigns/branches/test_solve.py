"""The parts of a search: what starts lead to, and what is said of a branch."""

from __future__ import annotations

import json
from dataclasses import replace
from typing import Any

import pytest

from lapjoint.campaigns.branches import solve
from lapjoint.campaigns.branches.solve import solve_branch, solve_start
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.errors import SolverError
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import Start
from lapjoint.orbits.branches.tracing import Limits


def test_both_ends_of_the_range_lead_to_the_motion_from_rest_and_to_that_without_contact_if_no_stop_is_in_its_way(
    spec: BranchSpec,
) -> None:
    """The graze lies within the range."""
    low, high = (solve_start(spec, number)["starts"] for number in range(2))
    assert [one["stops"] for one in low] == [[], []]
    assert [one["stops"] for one in high] == [[0, 0]]
    assert [one["unknowns"][-1] for one in (*low, *high)] == [spec.first, spec.first, spec.last]


def test_random_starts_are_those_of_the_seed(spec: BranchSpec) -> None:
    first, again = (solve_start(spec, 2) for _ in range(2))
    assert first == again
    assert [one["unknowns"][-1] for one in first["starts"]] == [spec.value_of(2)]
    assert spec.value_of(2) != spec.value_of(3)


def test_a_branch_is_values_that_json_gives_back(plain: dict[str, Any]) -> None:
    once = json.dumps(plain)
    assert json.dumps(json.loads(once)) == once
    assert len(plain["values"]) == len(plain["points"])
    assert plain["ends"] == ["boundary", "boundary"]
    assert not plain["unsprung"]
    assert not plain["starts"]


def test_a_motion_that_newton_does_not_find_again_is_said(spec: BranchSpec, monkeypatch: pytest.MonkeyPatch) -> None:
    (start, *_) = solve_start(spec, 0)["starts"]
    monkeypatch.setattr(solve, "trace", lambda *_: None)
    found = solve_branch(spec, start)
    assert not found["points"]
    assert found["message"] == "Newton's method does not find the motion again"


@pytest.mark.parametrize("from_grazes", [False, True])
def test_motions_beside_grazes_are_looked_for_if_asked(
    spec: BranchSpec, monkeypatch: pytest.MonkeyPatch, from_grazes: bool
) -> None:
    limits = list[Limits]()

    def noted(of: ParameterRange, start: Start, most: int, given: Limits) -> None:
        limits.append(given)

    (start, *_) = solve_start(spec, 0)["starts"]
    monkeypatch.setattr(solve, "trace", noted)
    solve_branch(replace(spec, from_grazes=from_grazes), start)
    assert [one.from_grazes for one in limits] == [from_grazes]


def test_a_solver_that_stops_is_said_with_its_message(spec: BranchSpec, monkeypatch: pytest.MonkeyPatch) -> None:
    def stops(*args: object) -> None:
        raise SolverError("stopped at t = 0.1 s")

    (start, *_) = solve_start(spec, 0)["starts"]
    monkeypatch.setattr(solve, "trace", stops)
    assert solve_branch(spec, start) == {"starts": [], "points": [], "message": "stopped at t = 0.1 s"}


def test_progress_ascends_to_the_whole_range(spec: BranchSpec, plain: dict[str, Any]) -> None:
    shares: list[float] = []
    solve_branch(spec, solve_start(spec, 0)["starts"][0], shares.append)
    assert 0 < min(shares) < max(shares) <= 1
