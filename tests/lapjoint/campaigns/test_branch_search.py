"""A search for branches finds the same in whatever sequence its parts come to an end, and however many are ahead."""

from __future__ import annotations

from collections import Counter
from typing import Any

import numpy as np
import pytest

from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import branch_search
from lapjoint.campaigns.branch_parts import Elsewhere
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


KINDS = 41
PLACES = [chr(1000 + i) + "abc"[i // 2 % 3] + "defgh"[i // 4 % 5] for i in range(KINDS)]
"""Of which places the branch of a remainder is made up: its own one, and others that it shares."""


@pytest.fixture(autouse=True)
def made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Motions are whole numbers, each of the branch of its remainder by 41; some fail, and most share places."""

    def start(plan: BranchPlan, number: int) -> dict[str, Any]:
        return {"seeds": [{"value": number + k, "count": counted(number + k)} for k in range(number % 3)]}

    def branch(plan: BranchPlan, seed: dict[str, Any], progress: object, lie: Elsewhere | None) -> dict[str, Any]:
        own = seed["value"] % KINDS
        if own == 5:
            return {"seeds": [], "points": [], "message": f"{own} cannot be followed"}
        curve = {"values": PLACES[own], "sections": "", "count": seed["count"], "bifurcations": [], "ends": []}
        assert lie is not None
        points = [{"period_multiple": 1 + own % 2}] * (own % 7 + 1)
        sprung = [{"value": 3 * own + k, "count": counted(3 * own + k), "away": (own, "")} for k in range(own % 6)]
        return curve | {"seeds": sprung, "unsprung": [], "points": points, "own": own} | lie.parts(curve)

    class Known:
        def __init__(self, plan: BranchPlan, others: dict[str, dict[str, Any]]) -> None:
            self._others = others

        def on(self, *_: object) -> frozenset[str]:
            raise AssertionError("nothing is followed here")

        def parts(self, curve: dict[str, Any]) -> dict[str, Any]:
            left, names = curve["values"], []
            for name, other in self._others.items():
                assert other["count"] == curve["count"]
                shared = {place for place in left if place in other["values"]}
                names += [name] if shared else []
                left = "".join(place for place in left if place not in shared)
            return {
                "elsewhere": [p for p in curve["values"] if p not in left],
                "joins": names,
                "asked": [*self._others],
            }

    def own_parts(plan: BranchPlan, one: dict[str, Any], others: list[dict[str, Any]]) -> list[dict[str, Any]]:
        known = {place for other in others for place in other["values"]}
        assert set(one["elsewhere"]) <= known  # nothing is left to a branch that is not there
        left = [place for place in one["values"] if place not in known]
        return [one | {"values": place} for place in left]

    def may_lie_on(plan: BranchPlan, one: dict[str, Any], other: dict[str, Any]) -> bool:
        return not set(one["values"]).isdisjoint(other["values"])

    monkeypatch.setattr(branch_search, "may_lie_on", may_lie_on)
    monkeypatch.setattr(branch_search, "solve_start", start)
    monkeypatch.setattr(branch_search, "solve_branch", branch)
    monkeypatch.setattr(branch_search, "Known", Known)
    monkeypatch.setattr(branch_search, "own_parts", own_parts)
    monkeypatch.setattr(branch_search, "is_known", lambda plan, seed, one: one.get("own") == seed["value"] % KINDS)


def counted(value: int) -> int:
    """Half periods of a motion: motions of one branch have as many."""
    return 1 + value % KINDS % 2


def number_of(name: str) -> int:
    return int(name.split(",")[0].split()[-1])


def searched(
    effort: int, ahead: int, at_once: int = 1, rng: np.random.Generator | None = None
) -> tuple[Diagram, list[str], int]:
    """A whole search, and the names of its parts as they were done: one after the other, or in a random sequence.

    And the most that were under way at once of those that spring from one branch.
    """
    own = plan(effort)
    search, found, done = Search(own, 0, ahead, at_once), dict[str, dict[str, Any]](), list[str]()
    under_way: list[Part] = search.go_on(found)
    given, most = {part.name for part in under_way}, 1
    while under_way:
        part = under_way.pop(0 if rng is None else int(rng.integers(len(under_way))))
        assert part.name not in found
        found[part.name] = part.solved(own)
        done.append(part.name)
        new = search.go_on(found)
        given |= {one.name for one in new}
        final = {number_of(name): other for name, other in found.items() if f"{name}, again" not in given}
        for one in new:  # none lies on a branch that comes earlier and has been followed
            earlier = [other["own"] for number, other in final.items() if "own" in other and number < one.number]
            assert one.seed is None or one.seed["value"] % KINDS not in earlier
        under_way += new
        assert sum(one.seed is not None for one in under_way) <= max(ahead, at_once)
        akin = Counter((one.seed.get("away"), one.seed["count"]) for one in under_way if one.seed and not one.again)
        most = max([most, *akin.values()])
    # Most starts lead to the same few branches, and those that spring from one may be one, or come together: they wait.
    assert most == 1 or at_once > 1
    diagram, resumed = search.diagram, Search(own, 0, ahead, at_once)
    while left := resumed.go_on(found):
        assert diagram.left_out  # else all is done
        found |= {part.name: part.solved(own) for part in left}
    assert resumed.diagram == diagram
    if not diagram.left_out:
        places = sorted(place for one in diagram.branches for place in one["values"])
        assert places == sorted({place for one in diagram.branches for place in PLACES[one["own"]]})
    return diagram, done, most


@pytest.mark.parametrize("effort", [1000, 20, 5])
def test_a_search_finds_the_same_in_whatever_sequence_its_parts_end(effort: int) -> None:
    alone, sequence, _ = searched(effort, 1)
    assert alone.branches
    assert (alone.left_out > 0) == (effort < 1000)
    again, together = 0, 0
    for seed in range(120):
        rng = np.random.default_rng((31, seed))
        found, done, most = searched(effort, int(rng.integers(2, 9)), int(rng.integers(1, 5)), rng)
        assert found == alone
        assert set(done) >= set(sequence)
        together += most > 1
        again += sum("again" in name for name in done)
    assert effort < 1000 or (again > 0 and together > 0)  # no worker is idle while there are any


def test_a_search_that_resumes_does_nothing_again_and_finds_the_same() -> None:
    own, found = plan(1000), dict[str, dict[str, Any]]()
    alone, _, _ = searched(1000, 1)
    search = Search(own, 0, 8, 4)
    under_way = search.go_on(found)
    for part in under_way[::-1]:
        found[part.name] = part.solved(own)
    again = Search(own, 0, 3, 1)
    left = again.go_on(found)
    while left:
        assert not {part.name for part in left} & set(found)
        found |= {part.name: part.solved(own) for part in left}
        left = again.go_on(found)
    assert again.diagram == alone


@pytest.mark.parametrize("facing", [True, False])
def test_few_branches_are_followed_twice_that_spring_at_neighbours(
    monkeypatch: pytest.MonkeyPatch, facing: bool
) -> None:
    """Beside one that was under way its other end was followed: a fifth of what was followed was thrown away.

    Be it known that both ends face each other, or only which number they have.
    """
    own, pairs = plan(1000), 30

    def start(plan: BranchPlan, number: int) -> dict[str, Any]:
        return {"seeds": [{"value": 0, "count": 1}] if number == 0 else []}

    def branch(plan: BranchPlan, seed: dict[str, Any], progress: object, lie: Elsewhere | None) -> dict[str, Any]:
        mine = (seed["value"] + 1) // 2
        ends = range(1, 2 * pairs + 1) if mine == 0 else []
        away = {k: {"away": (k + (-0.1, 0.1)[k % 2 == 0], "")} if facing else {} for k in ends}
        sprung = [{"value": k, "count": 2} | away[k] for k in ends]
        curve = {"values": chr(1000 + mine), "sections": "", "count": seed["count"], "bifurcations": [], "ends": []}
        assert lie is not None
        return (
            curve
            | {"seeds": sprung, "unsprung": [], "points": [{"period_multiple": 1}], "own": mine}
            | lie.parts(curve)
        )

    monkeypatch.setattr(branch_search, "solve_start", start)
    monkeypatch.setattr(branch_search, "solve_branch", branch)
    monkeypatch.setattr(
        branch_search, "is_known", lambda plan, seed, one: one.get("own") == (seed["value"] + 1) // 2 and seed["value"]
    )
    for seed in range(20):
        rng, found = np.random.default_rng((32, seed)), dict[str, dict[str, Any]]()
        search = Search(own, 0, 32, 2)
        under_way = search.go_on(found)
        while under_way:
            part = under_way.pop(int(rng.integers(min(2, len(under_way)))))
            found[part.name] = part.solved(own)
            under_way += search.go_on(found)
        assert len(search.diagram.branches) == pairs + 1
        followed = sum(name.startswith("branch") for name in found)
        assert followed <= pairs + 1 + 2


@pytest.mark.parametrize("effort", [1000, 20])
def test_no_worker_waits_for_a_branch_that_takes_long_nor_follows_many_beyond_the_effort(
    monkeypatch: pytest.MonkeyPatch, effort: int
) -> None:
    """One branch in thirty takes as long as all others of the thirty: here the first takes as long as all others.

    The second may lie on the first, and waits for it, be it that a worker idles then as the effort is spent.
    """
    own, many, ahead = plan(effort), 200, 4

    def start(plan: BranchPlan, number: int) -> dict[str, Any]:
        return {"seeds": [{"value": k, "count": max(k, 1)} for k in range(many)] if number == 0 else []}

    def branch(plan: BranchPlan, seed: dict[str, Any], progress: object, lie: Elsewhere | None) -> dict[str, Any]:
        curve = {"values": chr(1000 + seed["value"]), "sections": "", "count": seed["count"], "bifurcations": []}
        assert lie is not None
        more = {"seeds": [], "unsprung": [], "points": [{"period_multiple": 1}], "own": seed["value"], "ends": []}
        return curve | more | lie.parts(curve)

    monkeypatch.setattr(branch_search, "solve_start", start)
    monkeypatch.setattr(branch_search, "solve_branch", branch)
    monkeypatch.setattr(branch_search, "is_known", lambda plan, seed, one: one.get("own") == seed["value"])
    search, found = Search(own, 0, ahead, 2), dict[str, dict[str, Any]]()
    under_way = search.go_on(found)
    while under_way:
        part = under_way.pop(-1 if under_way[0].name == "branch 0" else 0)
        found[part.name] = part.solved(own)
        if part.name == "branch 0":
            before = len(found) - 1 - own.size
        under_way += search.go_on(found)
    assert before == (many - 1 if effort > many else effort + ahead - 2)
    assert len(search.diagram.branches) == min(many, effort)
