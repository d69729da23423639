"""What of a branch is its own: nothing where it is followed again, and what comes before where it joins another."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns import branch_overlap
from lapjoint.campaigns.branch_overlap import Known, may_lie_on, own_parts
from lapjoint.campaigns.branch_parts import family_of, lies_on, solve_branch, solve_start
from lapjoint.campaigns.branch_plan import BranchPlan
from lapjoint.campaigns.point import section_from
from lapjoint.orbits.branches import continuation
from lapjoint.orbits.branches.tracing import Seed

PLAN = BranchPlan(
    # A viscously damped cantilever with one stop: one branch, with a graze and two folds.
    Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        damping=ViscousDamping(coefficient=0.8),
        base_motion=BaseMotion(amplitude=3e-4, angular_frequency=5.0),
    ),
    "base_motion.amplitude",
    3e-4,
    4e-4,
    options={"n_modes": 3},
    errors=False,
)


@pytest.fixture(scope="module")
def whole() -> dict[str, Any]:
    return solve_branch(PLAN, solve_start(PLAN, 0)["seeds"][0])


@pytest.fixture(scope="module")
def again(whole: dict[str, Any]) -> dict[str, Any]:
    """The same branch, followed from another of its motions."""
    i = len(whole["points"]) // 3
    found = solve_branch(PLAN, {"value": whole["values"][i], "section": whole["sections"][i], "count": whole["count"]})
    assert found["values"] != whole["values"]
    return found


def piece(branch: dict[str, Any], first: int, last: int) -> dict[str, Any]:
    """The points of a branch from one to another, both included."""
    return branch | {key: branch[key][first : last + 1] for key in ("values", "points", "sections")}


def test_nothing_of_a_branch_that_is_followed_again_is_its_own(whole: dict[str, Any], again: dict[str, Any]) -> None:
    assert own_parts(PLAN, again, [whole]) == []
    assert own_parts(PLAN, whole, [piece(whole, 0, 5), again]) == []
    assert own_parts(PLAN, piece(whole, 0, len(whole["points"]) // 3), [whole]) == []


@pytest.mark.parametrize("step", [2, 3, 4])
def test_each_motion_lies_on_the_branch_with_few_of_its_points(whole: dict[str, Any], step: int) -> None:
    """Where it folds between two of them, motions have numbers beyond both, and the chord does not lead to them."""
    few = whole | {key: whole[key][::step] for key in ("values", "points", "sections")}
    motions = zip(whole["values"], whole["sections"], strict=True)
    seeds = [Seed(value, section_from(section), whole["count"]) for value, section in motions]
    last = 1 + step * (len(few["points"]) - 1)  # none lies behind its last point
    assert all(lies_on(family_of(PLAN), seed, few) for seed in seeds[:last])


def test_a_branch_that_meets_no_other_is_all_its_own(whole: dict[str, Any]) -> None:
    assert own_parts(PLAN, whole, []) == [whole]
    assert own_parts(PLAN, whole, [whole | {"count": 2 * whole["count"]}]) == [whole]


@pytest.mark.parametrize("seed", range(12))
def test_what_does_not_lie_on_parts_of_the_branch_is_its_own(whole: dict[str, Any], seed: int) -> None:
    """Others hold up to two stretches of it: the rest is its own, up to the first motion on them at either end."""
    rng, n = np.random.default_rng((77, seed)), len(whole["points"])
    known = np.zeros(n, dtype=bool)
    others = list[dict[str, Any]]()
    for _ in range(rng.integers(1, 3)):
        first, last = sorted(rng.choice(n, 2, replace=False).tolist())
        if last - first < n // 4:  # so short a one may lie between the motions that are asked
            continue
        known[first : last + 1] = True
        others.append(piece(whole, first, last))
    parts = own_parts(PLAN, whole, others)
    own = np.zeros(n, dtype=bool)
    seen = list[tuple[float, str]]()
    for part in parts:
        first = whole["values"].index(part["values"][0])
        last = first + len(part["values"]) - 1
        assert part["values"] == whole["values"][first : last + 1]
        begins, ends = (end == "joins" for end in part["ends"])
        assert begins == (first > 0)
        assert known[first] == begins
        assert ends == (last < n - 1)
        assert known[last] == ends
        own[first + begins : last + 1 - ends] = True
        for one in part["bifurcations"]:
            assert 0 < one["index"] < len(part["points"]) or (one["index"] == 0 and not begins)
            seen.append((one["value"], one["kind"]))
    wrong = np.flatnonzero(own == known)
    runs = np.split(wrong, np.flatnonzero(np.diff(wrong) > 1) + 1)
    assert all(run.size <= 3 for run in runs)  # so near to an end, or to another cut, no motion is asked
    assert len(seen) == len(set(seen))
    listed = [
        (one["value"], one["kind"]) for one in whole["bifurcations"] if own[one["index"] - 1 : one["index"] + 1].all()
    ]
    assert set(listed) <= set(seen)


@pytest.mark.parametrize("seed", range(12))
def test_what_lies_on_branches_that_are_known_is_not_looked_at_and_the_rest_is_as_it_was(
    whole: dict[str, Any], seed: int
) -> None:
    rng, n = np.random.default_rng((78, seed)), len(whole["points"])
    others = dict[str, dict[str, Any]]()
    for name in "ab"[: rng.integers(1, 3)]:
        first, last = sorted(rng.choice(n, 2, replace=False).tolist())
        others[name] = piece(whole, first, last)
    i = int(rng.integers(n))
    motion = {"value": whole["values"][i], "section": whole["sections"][i], "count": whole["count"]}
    all_of_it = solve_branch(PLAN, motion)
    found = solve_branch(PLAN, motion, None, Known(PLAN, others))
    assert all(found[key] == all_of_it[key] for key in ("values", "sections", "ends"))
    inside = {j for first, last in found["elsewhere"] for j in range(first + 1, last + 1)}
    assert found["bifurcations"] == [one for one in all_of_it["bifurcations"] if one["index"] not in inside]
    known = list(others.values())
    assert bool(found["joins"]) == bool(found["elsewhere"]) == (own_parts(PLAN, all_of_it, known) != [all_of_it])
    for own in own_parts(PLAN, found, known):
        first = whole_index(found, own)
        begins = own["ends"][0] == "joins"
        mine = [one for one in all_of_it["bifurcations"] if first + begins <= one["index"] < first + len(own["values"])]
        assert [one | {"index": one["index"] + first} for one in own["bifurcations"]] == mine
        for part in own_parts(PLAN, own, known):  # all of it is its own
            assert len(part["values"]) >= len(own["values"]) - 2 * 3


def whole_index(whole: dict[str, Any], part: dict[str, Any]) -> int:
    return int(whole["values"].index(part["values"][0]))


def test_a_branch_that_comes_to_another_twice_loses_what_lies_between(whole: dict[str, Any]) -> None:
    n = len(whole["points"])
    low, high = n // 3, 2 * n // 3
    first, last = own_parts(PLAN, whole, [piece(whole, low, high)])
    assert first["ends"] == [whole["ends"][0], "joins"]
    assert first["values"] == whole["values"][: low + 1]
    assert last["ends"] == ["joins", whole["ends"][1]]
    assert last["values"] == whole["values"][high:]


@pytest.mark.parametrize(
    ("own", "other", "kept"),
    [
        (None, None, False),
        (("flip", 2.0, 1e-6), None, True),
        (("flip", 2.0, 1e-6), ("flip", 2.0 + 1.9e-6, 1e-6), False),
        (("flip", 2.0, 1e-6), ("flip", 2.0 + 2.1e-6, 1e-6), True),
        (("flip", 2.0, 1e-6), ("fold", 2.0, 1e-6), True),
        (("flip", 2.0, np.inf), None, False),
        (("unresolved", 2.0, 1e-6), None, False),
    ],
)
def test_a_little_that_another_leaves_out_is_kept_for_its_bifurcations(
    monkeypatch: pytest.MonkeyPatch,
    own: tuple[str, float, float] | None,
    other: tuple[str, float, float] | None,
    kept: bool,
) -> None:
    """Of 320 motions, all but ten between two sixteenths of the way lie on the other branch, a fold just before."""

    def listed(one: tuple[str, float, float], index: int) -> dict[str, Any]:
        return {**dict(zip(("kind", "value", "error"), one, strict=True)), "index": index, "stop": -1}

    apart = range(143, 153)
    monkeypatch.setattr(branch_overlap._Whole, "lies_on", lambda self, i, other: i not in apart)
    points = {key: list(range(320)) for key in ("values", "points", "sections")}
    before = listed(("fold", 1.0, 1e-6), apart[0] - 1)
    mine = [before] + [listed(one, apart[5]) for one in (own,) if one is not None]
    branch = {**points, "count": 2, "ends": ["boundary", "boundary"], "bifurcations": mine, "elsewhere": []}
    others = [listed(one, apart[5]) for one in (other,) if one is not None]
    parts = own_parts(PLAN, branch, [branch | {"bifurcations": others}])
    found = [(part["values"][0], part["values"][-1], [one["kind"] for one in part["bifurcations"]]) for part in parts]
    assert found == ([(apart[0] - 1, apart[-1] + 1, ["flip"])] if kept else [])


@pytest.mark.parametrize("count", range(3, 12))
def test_ends_of_a_short_branch_that_stick_out_are_not_its_own(monkeypatch: pytest.MonkeyPatch, count: int) -> None:
    """Two that end at one bifurcation end at some distance from it."""
    points = {key: list(range(count)) for key in ("values", "points", "sections")}
    branch = {**points, "count": 2, "ends": ["bifurcation", "bifurcation"], "bifurcations": [], "elsewhere": []}
    monkeypatch.setattr(branch_overlap._Whole, "lies_on", lambda self, i, other: 0 < i < count - 1)
    assert own_parts(PLAN, branch, [branch]) == []


@pytest.mark.parametrize("seed", range(12))
@pytest.mark.parametrize("broken_off", [False, True])
def test_a_curve_ends_once_it_goes_on_as_a_branch_that_is_known(
    whole: dict[str, Any], monkeypatch: pytest.MonkeyPatch, seed: int, broken_off: bool
) -> None:
    """Its own parts are those before; where the other breaks off, it goes on, as it may lead beyond."""
    rng, n, often = np.random.default_rng((79, seed)), len(whole["points"]), 3
    monkeypatch.setattr(continuation, "_KNOWN", often)
    first, last = n // 3 + int(rng.integers(4)), n - 1 - int(rng.integers(4))
    other = piece(whole, first, last) | {"ends": ["joins", "lost" if broken_off else "boundary"]}
    i = int(rng.integers(first - 3))
    motion = {"value": whole["values"][i], "section": whole["sections"][i], "count": whole["count"]}
    all_of_it = solve_branch(PLAN, motion)
    found = solve_branch(PLAN, motion, None, Known(PLAN, {"a": other}))
    own, mine = own_parts(PLAN, all_of_it, [other]), own_parts(PLAN, found, [other])
    if broken_off:
        assert found["values"] == all_of_it["values"]
        assert [part["values"] for part in mine] == [part["values"] for part in own]
        return
    assert sorted(found["ends"]) == sorted([all_of_it["ends"][0], "joins"])
    left = len(all_of_it["values"]) - len(found["values"])
    assert left > 0
    assert found["values"] in (all_of_it["values"][left:], all_of_it["values"][:-left])
    (there,) = found["elsewhere"]
    assert there[1] - there[0] <= 3 * often  # it is noticed soon
    first_own = [part for part in own if set(part["values"]) <= set(found["values"])]
    assert [part["values"] for part in mine] == [part["values"] for part in first_own]
    assert [part["bifurcations"] for part in mine] == [part["bifurcations"] for part in first_own]
    assert mine


def test_a_branch_that_would_have_ended_as_another_is_noticed_without_it(
    whole: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each motion that was asked on the way is among those that tell whether one that was not known matters."""
    monkeypatch.setattr(continuation, "_KNOWN", 3)
    n = len(whole["points"])
    motion = {"value": whole["values"][0], "section": whole["sections"][0], "count": whole["count"]}
    alone = solve_branch(PLAN, motion, None, Known(PLAN, {}))
    assert len(alone["probes"]) >= 3 + (len(alone["values"]) - 1) // 5  # across a graze there are several at once
    for first in range(2, n - 10):
        other = piece(whole, first, first + 8) | {"ends": ["joins", "joins"]}
        known = solve_branch(PLAN, motion, None, Known(PLAN, {"a": other}))
        assert may_lie_on(PLAN, alone, other) or known["values"] == alone["values"]
