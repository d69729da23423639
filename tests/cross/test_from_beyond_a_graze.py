"""A graze whose motion touches the stop already is found by another solver from its other side.

Under modal damping the number goes as a root of the penetration on the side that touches, and multipliers grow without
bound towards the graze; on the other side the map is smooth.  Three motions are those of a file of `lapjoint branch`
for the paper's joint with a quarter of its damping: with a multiplier of 1.2e5, one that misses to repeat in half its
time by 6e-7 of its size, and one by 2e-4.
"""

from __future__ import annotations

import json
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import pytest
from branch_witness import drawn
from finer_curve import HIGH, LOW, family

import fe_lapjoint
from lapjoint import branch
from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import FREQUENCY
from lapjoint.campaigns.branch_dataset import KINDS
from lapjoint.campaigns.branch_parts import family_of, motion_from
from lapjoint.campaigns.confirm_plan import confirm_plan
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.by_another_solver import _Search, by_another
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_beside import Beside
from lapjoint.orbits.branches.grazing import seen_from_beyond
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Graze

TOUCHED = json.loads((Path(__file__).parent / "touched_at_grazes.json").read_text(encoding="utf-8"))
BEYOND_TWO = json.loads((Path(__file__).parent / "two_contacts_beyond.json").read_text(encoding="utf-8"))
BESIDE = json.loads((Path(__file__).parent / "beside_a_touched_graze.json").read_text(encoding="utf-8"))
FINER = 3  # selves of the finite elements, up to 137 elements
SEED, FEW, MANY = 77, range(8), range(60)
MODES, ELEMENTS, SELVES = 8, 16, 2


@pytest.mark.thorough
@pytest.mark.parametrize("which", range(len(TOUCHED)))
@in_one_thread
def test_finite_elements_find_a_graze_whose_motion_touches_already(which: int) -> None:
    said: dict[str, Any] = TOUCHED[which]
    value, error, own = said["value"], said["error"], family()
    one = listed(said, own)
    other = Family(fe_lapjoint.Solver(), own.problem_at, FREQUENCY, LOW, HIGH)
    found = by_another(one, other, FINER, FINER)
    assert found is not None
    assert abs(found.value - value) <= found.error + error
    assert found.error <= 1e-5 * value


def listed(said: dict[str, Any], own: Family) -> Listed:
    """A graze of a file, with the motion there."""
    bifurcation = Bifurcation(
        "grazing", said["value"], said["error"], 0, said["stop"], said["after"], motion=motion_from(said["motion"])
    )
    one = restored(own, bifurcation)
    assert one is not None
    return one


def test_a_motion_beyond_that_lacks_two_contacts_is_not_one_beyond_this_graze() -> None:
    """At 111.99574 rad/s; from there elements came to another graze, at 111.99549, and said so to 2e-6."""
    one = listed(BEYOND_TWO, family())
    assert isinstance(one.found, Graze)
    assert seen_from_beyond(one.family, one.found) is None


@pytest.mark.thorough
@in_one_thread
def test_finite_elements_find_a_graze_beyond_which_two_contacts_are_lacking() -> None:
    own = family()
    one = listed(BEYOND_TWO, own)
    found = by_another(one, Family(fe_lapjoint.Solver(), own.problem_at, FREQUENCY, LOW, HIGH))
    assert found is not None
    assert abs(found.value - BEYOND_TWO["value"]) <= 1e-4
    assert found.error <= 1e-5 * found.value


@in_one_thread
def test_a_flip_beside_a_graze_that_is_touched_is_found_from_beyond_that() -> None:
    """4e-7 of its arc length from the graze, of which elements have the motion only if they come across it."""
    own = family()
    flip = Bifurcation("flip", BESIDE["value"], BESIDE["error"], 0, motion=motion_from(BESIDE["motion"]))
    one = restored(own, flip)
    assert one is not None
    assert one.found is not None
    assert one.way is not None
    (graze,) = one.way.grazes
    elements = Family(fe_lapjoint.Solver(elements=100), own.problem_at, FREQUENCY, LOW, HIGH)
    found = Beside(one.family, one.found, graze).found_by(elements)
    assert found is not None
    assert abs(found.value - BESIDE["value"]) <= 1e-6 * found.value


def grazes(index: int) -> Iterator[tuple[Listed, Family]]:
    """Those of a random joint whose motion touches, and that go on beyond; with the finite elements' maps."""
    one = drawn(SEED, index)
    found = branch(one.problem, one.path, one.low, one.high, options={"n_modes": MODES}, max_points=200, effort=200)
    if not (found.bifurcation_kind.values == KINDS.index("grazing")).any():
        return
    plan = confirm_plan(found, "fe", {"elements": ELEMENTS})
    own, other = family_of(plan.branches.at(0)), family_of(plan.other.at(0))
    for row in plan.rows:
        if row.kind == "grazing" and found.bifurcation_after.values[row.number] in ("persists", "folds"):
            there = restored(own, row.bifurcation)
            assert there is not None
            assert isinstance(there.found, Graze)
            if there.found.before.touched:
                yield there, other


def judge(indices: range) -> int:
    """How many grazes finite elements find from beyond, each within both errors, and as from the motion before it."""
    count = 0
    for index in indices:
        for one, other in grazes(index):
            search = _Search(one, other, SELVES, SELVES)
            beyond, direct, said = search._from_beyond(), search._direct(), one.bifurcation
            if beyond is None:  # several contacts go there at once, and so it is looked for from before it alone
                assert isinstance(one.found, Graze)
                assert seen_from_beyond(one.family, one.found) is None, (index, said.value)
                assert direct is not None, (index, said.value)
                assert abs(direct.value - said.value) <= direct.error + said.error, (index, said.value)
                continue
            assert abs(beyond.value - said.value) <= beyond.error + said.error, (index, said.value)
            if direct is not None:
                assert abs(beyond.value - direct.value) <= beyond.error + direct.error, (index, said.value)
            count += 1
    return count


@in_one_thread
def test_grazes_of_a_few_random_joints_are_found_from_either_side() -> None:
    assert judge(FEW)


@pytest.mark.thorough
@in_one_thread
def test_grazes_of_random_joints_are_found_from_either_side() -> None:
    assert judge(MANY)


def nearer(family: Family, graze: Graze, share: float) -> bool:
    """Whether the curve comes nearer to a graze by a share of the way to it, along its tangent."""
    before = graze.before
    step = share * abs(before.extremum.value / graze.rate)
    place = corrected(family, *before.place.moved(family, step * before.place.tangent), before.place.count)
    assert place is not None
    there = place.matching(before.extremum, before.place.extrema.duration)
    assert there is not None
    return abs(there.value) < abs(before.extremum.value)


@in_one_thread
def test_from_beyond_a_graze_is_where_it_is() -> None:
    """Seen from beyond, and from there again, it has the number that it has, and the motion the other contacts."""
    for index in FEW:
        for one, _ in grazes(index):
            assert isinstance(one.found, Graze)
            seen = seen_from_beyond(one.family, one.found)
            assert seen is not None
            assert not seen.before.touched
            assert seen.before.bent == 0.0  # it has been come to across the graze, which tells nothing of how it bends
            assert nearer(one.family, seen, 0.1)
            assert not nearer(one.family, seen, -0.1)
            assert seen.value == pytest.approx(one.found.value, abs=2 * one.found.left + 1e-8 * abs(one.found.value))
            assert set(seen.before.closings_of_sides) == set(one.found.before.closings_of_sides)
            again = seen_from_beyond(one.family, seen)
            assert again is not None
            assert again.before.touched
            assert again.before.place.closings == one.found.before.place.closings
