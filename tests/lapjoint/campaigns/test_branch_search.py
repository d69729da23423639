"""A search for branches finds the same in whatever sequence its parts come to an end, and however many are ahead."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import branch_search
from lapjoint.campaigns.branch_plan import BranchPlan
from lapjoint.campaigns.branch_search import Diagram, Part, Search


def plan(effort: int) -> BranchPlan:
    problem = Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        damping=ViscousDamping(coefficient=0.8),
        base_motion=BaseMotion(amplitude=3e-4, angular_frequency=5.0),
    )
    return BranchPlan(problem, "base_motion.amplitude", 3e-4, 4e-4, starts=3, effort=effort)


@pytest.fixture(autouse=True)
def made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Motions are whole numbers, each of the branch of its remainder by 7; some fail, and one is cut by another."""

    def start(plan: BranchPlan, number: int) -> dict[str, Any]:
        return {"seeds": [{"value": number + k, "count": counted(number + k)} for k in range(number % 3)]}

    def branch(plan: BranchPlan, seed: dict[str, Any], progress: object = None) -> dict[str, Any]:
        own = seed["value"] % 7
        if own == 5:
            return {"seeds": [], "points": [], "message": f"{own} cannot be followed"}
        points = [{"period_multiple": 1 + own % 2}] * (own + 1)
        sprung = [{"value": 10 * own + k, "count": counted(10 * own + k), "away": own} for k in range(own)]
        return {"seeds": sprung, "points": points, "own": own}

    monkeypatch.setattr(branch_search, "solve_start", start)
    monkeypatch.setattr(branch_search, "solve_branch", branch)

    def own_parts(plan: BranchPlan, one: dict[str, Any], others: list[dict[str, Any]]) -> list[dict[str, Any]]:
        known = {other["own"] for other in others}
        return [] if one["own"] in known else [one] * (2 if one["own"] == 4 and 2 in known else 1)

    monkeypatch.setattr(branch_search, "own_parts", own_parts)
    monkeypatch.setattr(branch_search, "is_known", lambda plan, seed, one: one.get("own") == seed["value"] % 7)


def counted(value: int) -> int:
    """Half periods of a motion: motions of one branch have as many."""
    return 1 + value % 7 % 2


def searched(effort: int, ahead: int, rng: np.random.Generator | None = None) -> tuple[Diagram, list[str]]:
    """A whole search, and the names of its parts as they were done: one after the other, or in a random sequence."""
    own = plan(effort)
    search, found, done = Search(own, 0, ahead), dict[str, dict[str, Any]](), list[str]()
    under_way: list[Part] = search.go_on(found)
    while under_way:
        part = under_way.pop(0 if rng is None else int(rng.integers(len(under_way))))
        assert part.name not in found
        found[part.name] = part.solved(own)
        done.append(part.name)
        new = search.go_on(found)
        for one in new:  # none lies on a branch that comes earlier and has been followed
            earlier = [other for name, other in found.items() if "own" in other and int(name.split()[-1]) < one.number]
            assert one.seed is None or all(one.seed["value"] % 7 != other["own"] for other in earlier)
        under_way += new
        assert sum(one.seed is not None for one in under_way) <= ahead
        seeds = [one.seed for one in under_way if one.seed is not None]
        from_starts = [seed["count"] for seed in seeds if "away" not in seed]
        assert len(from_starts) == len(set(from_starts))  # most starts lead to the same few branches
        sprung = {(seed["away"], seed["value"]) for seed in seeds if "away" in seed}
        close = [(away, value + by) for away, value in sprung for by in (1, 2)]
        assert not sprung & set(close)  # they may be the two ends of one
    return search.diagram, done


@pytest.mark.parametrize("effort", [1000, 20, 5])
def test_a_search_finds_the_same_in_whatever_sequence_its_parts_end(effort: int) -> None:
    alone, sequence = searched(effort, 1)
    assert alone.branches
    assert (alone.left_out > 0) == (effort < 1000)
    for seed in range(40):
        rng = np.random.default_rng((31, seed))
        found, done = searched(effort, int(rng.integers(2, 9)), rng)
        assert found == alone
        assert set(done) >= set(sequence)


def test_a_search_that_resumes_does_nothing_again_and_finds_the_same() -> None:
    own, found = plan(1000), dict[str, dict[str, Any]]()
    alone, _ = searched(1000, 1)
    search = Search(own, 0, 8)
    under_way = search.go_on(found)
    for part in under_way[::-1]:
        found[part.name] = part.solved(own)
    again = Search(own, 0, 3)
    left = again.go_on(found)
    while left:
        assert not {part.name for part in left} & set(found)
        found |= {part.name: part.solved(own) for part in left}
        left = again.go_on(found)
    assert again.diagram == alone
