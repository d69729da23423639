"""A search for branches finds the same in whatever sequence its parts come to an end, and however many are ahead."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from lapjoint import Problem
from lapjoint.campaigns.branches import search
from lapjoint.campaigns.branches.search import Diagram, Part, Search
from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.branches.unknown import Reached

MANY = 41
"""Number of branches in all: a motion is a whole number, and lies on the branch of its remainder."""
FAILS = 5
"""The branch that cannot be followed."""


def motions(*values: int, half_periods: int | None = None) -> list[dict[str, Any]]:
    return [{"value": one, "half_periods": half_periods or 1 + one % MANY % 2} for one in values]


def made_start(spec: BranchSpec, number: int) -> dict[str, Any]:
    return {"starts": motions(*(number + k for k in range(number % 3)))}


def made_branch(spec: BranchSpec, start: dict[str, Any], progress: object) -> dict[str, Any]:
    own = start["value"] % MANY
    if own == FAILS:
        return {"starts": [], "points": [], "message": f"{own} cannot be followed"}
    points = [{"period_multiple": 1 + own % 2}] * (own % 7 + 1)
    unsprung = [["flip", float(own)]] if own % 8 == 0 else []
    return {
        "own": own,
        "points": points,
        "unsprung": unsprung,
        "starts": motions(*(3 * own + k for k in range(own % 6))),
    }


class MadeMotion:
    """A motion that lies on the branch of its remainder."""

    def __init__(self, spec: BranchSpec, plain: dict[str, Any]) -> None:
        self.start = SimpleNamespace(value=plain["value"])
        self.is_stable = bool(plain["value"] % 2)

    def lies_on(self, curve: int) -> bool:
        """Whether it is one of a branch."""
        return bool(self.start.value % MANY == curve)


@pytest.fixture(autouse=True)
def made(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(search, "solve_start", made_start)
    monkeypatch.setattr(search, "solve_branch", made_branch)
    monkeypatch.setattr(search, "Motion", MadeMotion)
    monkeypatch.setattr(search, "Curve", lambda spec, branch: branch["own"])


def spec_of(problem: Problem, effort: int) -> BranchSpec:
    return BranchSpec(problem, "base_motion.amplitude", 3e-4, 4e-4, starts=3, effort=effort)


def searched(spec: BranchSpec, ahead: int, rng: np.random.Generator | None = None) -> tuple[Diagram, list[str]]:
    """A whole search, and the names of its parts as they were done: one after the other, or in a random sequence."""
    whole, found, done = Search(spec, 0, ahead), dict[str, dict[str, Any]](), list[str]()
    under_way = whole.go_on(found)
    while under_way:
        part = under_way.pop(0 if rng is None else int(rng.integers(len(under_way))))
        assert part.name not in found
        found[part.name] = part.solved(spec)
        done.append(part.name)
        new = whole.go_on(found)
        known = {one.get("own") for one in found.values()}
        followed = [one.start["value"] % MANY for one in new if one.start is not None]
        assert sum(own in known for own in followed) <= (ahead > 1)  # the one whose turn has come, even if it was ahead
        under_way += new
        assert sum(one.start is not None for one in under_way) <= ahead + (ahead > 1)
    resumed = Search(spec, 0, ahead)
    assert not resumed.go_on(found)  # all is done
    assert resumed.diagram == whole.diagram
    return whole.diagram, done


@pytest.mark.parametrize("effort", [1000, 20, 5])
def test_a_search_finds_the_same_in_whatever_sequence_its_parts_end(problem: Problem, effort: int) -> None:
    spec = spec_of(problem, effort)
    alone, sequence = searched(spec, 1)
    own = [one["own"] for one in alone.branches]
    assert len(own) == len(set(own)) > 0
    assert (alone.left_out > 0) == (effort < 1000)
    ahead = 0
    for seed in range(60):
        rng = np.random.default_rng((31, seed))
        found, done = searched(spec, int(rng.integers(2, 9)), rng)
        assert found == alone
        assert set(done) >= set(sequence)
        ahead += done != sequence
    assert ahead


def test_all_that_springs_is_followed_and_what_is_not_is_told_once(problem: Problem) -> None:
    """The branches are those that remainders lead to from those of the starts."""
    spec = spec_of(problem, 1000)
    found, _ = searched(spec, 1)
    reached = {one["value"] % MANY for i in range(spec.size) for one in made_start(spec, i)["starts"]}
    while True:
        sprung = {3 * own + k for own in reached - {FAILS} for k in range(own % 6)}
        more = {one % MANY for one in sprung} - reached
        if not more:
            break
        reached |= more
    assert {one["own"] for one in found.branches} == reached - {FAILS}
    unsprung = [one["own"] for one in found.branches if one["unsprung"]]
    for own in unsprung:
        told = f"flip at base_motion.amplitude = {own:g}: no motion was found of the branch that springs there"
        assert found.failures.count(told) == 1
    failed = [why for why in found.failures if why.endswith(f"{FAILS} cannot be followed")]
    assert all(why.startswith("a motion at base_motion.amplitude = ") for why in failed)
    assert len(found.failures) == len(unsprung) + len(failed) == len(set(found.failures))


def test_what_random_starts_led_to_counts_what_they_alone_led_to(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A start is not alone on a branch to which an end, another start, or what springs from another branch leads."""
    to = [[1], [], [1, 3], [3], [5], [7], [8], []]

    def start(spec: BranchSpec, number: int) -> dict[str, Any]:
        return {"starts": motions(*to[number])}

    def branch(spec: BranchSpec, start: dict[str, Any], progress: object) -> dict[str, Any]:
        own = start["value"] % MANY
        sprung = {1: [1 + MANY], 8: [7, 11]}.get(own, [])
        return {"own": own, "points": [{"period_multiple": 1}], "unsprung": [], "starts": motions(*sprung)}

    monkeypatch.setattr(search, "solve_start", start)
    spec = BranchSpec(problem, "base_motion.amplitude", 3e-4, 4e-4, starts=6)
    monkeypatch.setattr(search, "solve_branch", branch)
    diagram, _ = searched(spec, 1)
    # 1 at an end and from 2; 3 from 2 and 3; 5 from 4 alone; 7 from 5, and from 8, to which the unstable start 6 leads.
    assert diagram.reached == Reached(5, 4, 1)
    assert len(diagram.branches) == 6


def test_a_search_that_resumes_does_nothing_again_and_finds_the_same(problem: Problem) -> None:
    spec, found = spec_of(problem, 1000), dict[str, dict[str, Any]]()
    alone, _ = searched(spec, 1)
    first = Search(spec, 0, 8)
    for part in first.go_on(found)[::-1]:
        found[part.name] = part.solved(spec)
    for part in first.go_on(found)[::-2]:
        found[part.name] = part.solved(spec)
    again = Search(spec, 0, 3)
    while left := again.go_on(found):
        assert not {part.name for part in left} & set(found)
        found |= {part.name: part.solved(spec) for part in left}
    assert again.diagram == alone


def test_a_motion_that_may_lie_on_a_branch_under_way_waits_while_there_are_others(
    problem: Problem, monkeypatch: pytest.MonkeyPatch
) -> None:
    def start(spec: BranchSpec, number: int) -> dict[str, Any]:
        akin, other = motions(0, 1, half_periods=1), motions(2, half_periods=2)
        return {"starts": akin + other if number == 0 else []}

    monkeypatch.setattr(search, "solve_start", start)
    spec = spec_of(problem, 1000)
    found = {part.name: part.solved(spec) for part in Search(spec, 0, 1).go_on({})}
    values = [
        [part.start["value"] for part in Search(spec, 0, ahead).go_on(found) if part.start] for ahead in (1, 2, 3)
    ]
    assert values == [[0], [0, 2], [0, 2, 1]]


@pytest.mark.parametrize("effort", [1000, 20])
def test_no_worker_waits_for_a_branch_that_takes_long_nor_follows_many_beyond_the_effort(
    problem: Problem, monkeypatch: pytest.MonkeyPatch, effort: int
) -> None:
    """The first branch takes as long as all others that are followed meanwhile; each has one point."""
    spec, most, ahead = spec_of(problem, effort), MANY - 1, 4

    def start(spec: BranchSpec, number: int) -> dict[str, Any]:
        return {"starts": motions(*range(most)) if number == 0 else []}

    def branch(spec: BranchSpec, start: dict[str, Any], progress: object) -> dict[str, Any]:
        return {"own": start["value"], "points": [{"period_multiple": 1}], "unsprung": [], "starts": []}

    monkeypatch.setattr(search, "solve_start", start)
    monkeypatch.setattr(search, "solve_branch", branch)
    whole, found = Search(spec, 0, ahead), dict[str, dict[str, Any]]()
    under_way: list[Part] = whole.go_on(found)
    meanwhile = 0
    while under_way:
        is_alone = len(under_way) == 1
        part = under_way.pop(-1 if under_way[0].name == "branch 0" else 0)
        meanwhile += part.start is not None and part.name != "branch 0" and "branch 0" not in found
        assert part.name != "branch 0" or is_alone
        found[part.name] = part.solved(spec)
        under_way += whole.go_on(found)
    assert meanwhile > ahead
    assert meanwhile < effort + ahead
    assert len(whole.diagram.branches) == min(most, effort)


def test_parts_at_further_values_are_named_by_the_value() -> None:
    assert [Part(0, 3).name, Part(0, 3, {}).name, Part(2, 1).name] == ["start 3", "branch 3", "value 2: start 1"]
