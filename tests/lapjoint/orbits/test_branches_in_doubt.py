"""What no finer solver has from motion to motion is known from its own curve: from its end, or from within the branch.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping, at
bifurcations that it stated without an error.  The witness is the curve of a still finer self, from its own motion.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from finer_curve import FINER, both_ways, family

from lapjoint.answers.branches import Bifurcation, Branch, MotionThere
from lapjoint.campaigns.branch_parts import motion_from, seed_of
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.bridging import followed
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_along import motion_at
from lapjoint.orbits.branches.grazing import beyond_graze, just_beyond, located_graze, sharper
from lapjoint.orbits.branches.listing import listed
from lapjoint.orbits.branches.resolving import Resolved, resolved
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Graze, Limits, Run, joined
from lapjoint.orbits.branches.shooting import taken_over
from lapjoint.orbits.branches.tracing import trace

MOTIONS = json.loads((Path(__file__).parent / "in_doubt.json").read_text(encoding="utf-8"))
FOLLOWED = Limits(most=50)
LOST_AT_ONCE = 167.70511886  # rad/s; regression: the self with 54 modes, along its curve from its own flip beside it
AIM = 1e-5  # error over the frequency


def branch_at(own: Family, which: str) -> tuple[Run, Resolved]:
    """The branch about a motion, as it is followed, and with what finer solvers have."""
    said = MOTIONS[which]
    motion = motion_from(said["motion"])
    one = restored(own, Bifurcation(said["kind"], motion.value, float("inf"), 0, said["stop"], motion=motion))
    assert one is not None
    place = motion_at(one.found)
    run = joined(*(followed(own, start, FOLLOWED) for start in (place.turned(), place)))
    return run, resolved(own, run)


def stated(found: Resolved) -> list[Bifurcation]:
    """The bifurcations of a branch; each must have an error."""
    own = [one.bifurcation for one in found.bifurcations if one.bifurcation.kind != "unresolved"]
    assert all(one.error <= AIM * one.value for one in own)
    return own


@in_one_thread
def test_what_lies_beside_where_a_branch_springs_is_looked_for_from_there() -> None:
    """It is lost 1e-8 of its number from there, and a motion that is carried is one of another branch."""
    run, found = branch_at(family(), "lost_at_once")
    assert found.ends == (run.begin, run.end)
    (graze,) = stated(found)
    assert abs(graze.value - run.grazes[-1].value) > graze.error
    assert graze.value == pytest.approx(LOST_AT_ONCE, abs=graze.error)


@in_one_thread
def test_a_short_branch_is_followed_by_a_finer_solver_from_within() -> None:
    run, found = branch_at(family(), "short")
    assert found.ends == (run.begin, run.end)
    (graze,) = [one for one in stated(found) if one.kind == "grazing"]
    assert abs(graze.value - run.grazes[-1].value) > graze.error
    motion = graze.motion
    assert motion is not None
    known = [one.value for way in both_ways(motion, Limits(most=30)) for one in way if one.kind == "grazing"]
    assert min(abs(one - graze.value) for one in known) <= graze.error


@in_one_thread
def test_a_part_that_is_in_the_way_of_another_is_followed_with_it() -> None:
    """The branch has a torus and a fold beside each of two grazes; a finer solver has the grazes alone."""
    run, found = branch_at(family(), "beside_another_part")
    value = MOTIONS["beside_another_part"]["motion"][0]
    there = [one for one in stated(found) if abs(one.value - value) < 1e-5 * value]
    assert [one.kind for one in there] == ["grazing"]
    assert run.begin == found.ends[0]
    known = [one.value for way in both_ways(there[0].motion, FOLLOWED) for one in way if one.kind == "grazing"]
    assert min(abs(one - there[0].value) for one in known) <= there[0].error


@in_one_thread
def test_what_a_coarse_solver_steps_over_just_beyond_a_graze_is_there() -> None:
    """Its map jumps so that it has no motion nearer to the graze; a finer one has a fold and a flip there."""
    own, motion = family(), motion_from(MOTIONS["before_a_graze_that_hides_two"]["motion"])
    start = corrected(own, motion.value, own.adopted(motion.value, motion.point), motion.half_periods)
    assert start is not None
    run = joined(*(followed(own, place, Limits(most=30, length=0.05)) for place in (start.turned(), start)))
    assert [one.bifurcation.kind for one in listed(own, run, errors=False)] == ["grazing"]
    found = stated(resolved(own, run))
    known = [one for way in both_ways(motion, Limits(most=30, length=0.05)) for one in way]
    assert sorted(one.kind for one in found) == ["flip", "fold", "grazing"] == sorted(one.kind for one in known)
    for kind in ("flip", "fold", "grazing"):
        (value,), (true,) = ([one for one in some if one.kind == kind] for some in (found, known))
        assert abs(value.value - true.value) <= value.error


def traced(which: str) -> tuple[Branch, MotionThere]:
    """A branch that springs at both ends, from where it springs, with its errors; and its motion in the middle."""
    seed = seed_of(MOTIONS[which]["seed"])
    found = trace(family(), seed, most_multiple=4)
    assert found is not None
    branch = found.branch
    assert branch.ends == ("bifurcation", "bifurcation")
    middle = branch.points[len(branch.points) // 2]
    return branch, MotionThere(middle.value, middle.motion.section_point, seed.count)


@pytest.mark.thorough
@in_one_thread
def test_what_two_finer_solvers_leave_unconfirmed_a_third_one_follows() -> None:
    """A branch of 4e-5 rad/s between two grazes: with 36 modes it has a fold that is not sure, with 54 one that is."""
    branch, middle = traced("between_two_grazes")
    assert all(one.error <= AIM * one.value for one in branch.bifurcations)
    (fold,) = [one for one in branch.bifurcations if one.kind == "fold"]
    known = [one.value for way in both_ways(middle, FOLLOWED, FINER + 1) for one in way if one.kind == "fold"]
    assert min(abs(one - fold.value) for one in known) <= fold.error


@in_one_thread
def test_beyond_a_graze_of_one_half_lies_no_motion_that_lacks_a_contact_in_both() -> None:
    """Finer solvers went across to the branch from which it springs, and left out a graze and the fold behind it."""
    branch, middle = traced("beside_its_mother")
    ways = both_ways(middle, FOLLOWED)
    for kind, count in (("grazing", 2), ("fold", 1)):
        known = [one.value for way in ways for one in way if one.kind == kind]
        mine = [one for one in branch.bifurcations if one.kind == kind]
        assert len(mine) == count
        for one in mine:
            assert min(abs(value - one.value) for value in known) <= one.error


@in_one_thread
def test_what_two_selves_have_alike_by_chance_finer_ones_state() -> None:
    """They had a flip within 9e-8 rad/s; finer ones, which did not find it from there, have it 7.6e-6 beside that."""
    branch, middle = traced("by_chance")
    known = [one.value for way in both_ways(middle, FOLLOWED) for one in way if one.kind == "flip"]
    (flip,) = [one for one in branch.bifurcations if one.kind == "flip"]
    assert min(abs(value - flip.value) for value in known) <= flip.error <= AIM * flip.value


@in_one_thread
def test_a_curve_that_turns_before_it_touches_leaves_what_it_may() -> None:
    """Coarse selves come to a graze; by finer ones the extremum turns 4e-10 m short of it.

    Their straight lines from there differ by 9e-5 rad/s, nine times the error that two of them would give.
    """
    branch, _ = traced("turns_before_it_touches")
    *_, graze = [one for one in branch.bifurcations if one.kind == "grazing"]
    one = restored(family(), graze)
    assert one is not None
    assert isinstance(one.found, Graze)
    finer, place, rate = family().self_at(2), motion_at(one.found), one.found.rate
    own = taken_over(finer, place)
    assert own is not None
    extremum = own.matching(one.found.before.extremum, place.extrema.duration)
    assert extremum is not None
    before = located_graze(finer, own, extremum, rate)
    assert before is not None
    beyond = beyond_graze(finer, before, rate)
    assert beyond is not None
    nearest = just_beyond(finer, beyond, rate)
    assert nearest is not None
    assert not nearest.touched
    assert np.isinf(nearest.left)
    assert sharper(finer, before, nearest, rate) is before
    assert abs(graze.value - nearest.value) <= 2 * graze.error <= 2 * AIM * graze.value
