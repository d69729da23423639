"""A bifurcation that is found along the curve of a finer self of the solver is that one, and not another of its kind.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping, where the
branch turns twice, and has a flip before either turn and after it; at one of these, and at the graze beside it.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import analytic
from lapjoint import paper_joint
from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.listing import Listed, listed
from lapjoint.orbits.branches.resolving import asked_again
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Limits

MOTIONS = json.loads((Path(__file__).parent / "two_flips.json").read_text(encoding="utf-8"))
LOW, HIGH = 100.0, 5000.0  # rad/s
WITNESS = 3  # as many steps finer than the coarsest self
LENGTH = 3e-2  # arc length from the graze that has both flips
AIM = 1e-5  # error over the frequency


def family() -> Family:
    grid = Grid(paper_joint(damping_ratio=0.02), (Axis(FREQUENCY, (LOW, HIGH)),))
    return Family(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, LOW, HIGH)


def flips_of_the_curve() -> list[float]:
    """Where a finer self has flips on its own curve, followed from its own motion at the graze, in their sequence."""
    own, graze = family(), motion_from(MOTIONS["beside_a_graze"])
    for _ in range(WITNESS):
        finer = own.finer(graze.value)
        assert finer is not None
        own = finer[1]
    start = corrected(own, graze.value, own.adopted(graze.value, graze.point), graze.half_periods)
    assert start is not None
    runs = [follow(own, place, Limits(most=60, length=LENGTH)) for place in (start, start.turned())]
    found = [[one.bifurcation for one in listed(own, run, errors=False)] for run in runs]
    lower = next(some for some in found if any(one.kind == "flip" and one.value < graze.value for one in some))
    return [one.value for one in lower if one.kind == "flip"]


def at_the_flip(own: Family) -> Listed:
    motion = motion_from(MOTIONS["at_the_flip"])
    one = restored(own, Bifurcation("flip", motion.value, float("inf"), 0, motion=motion))
    assert one is not None
    return one


def test_of_two_flips_on_either_side_of_two_turns_the_nearer_one_is_found() -> None:
    own = family()
    found, (nearer, farther, *_) = by_another(at_the_flip(own), own, WITNESS - 1), flips_of_the_curve()
    assert found is not None
    assert abs(found.value - nearer) <= found.error <= AIM * found.value
    assert abs(found.value - farther) > 100 * found.error


def test_where_no_motion_of_the_branch_leads_to_it_one_of_a_closer_look_does() -> None:
    one = replace(at_the_flip(family()), way=None)
    assert by_another(one, one.family, WITNESS - 1) is None
    known = asked_again(one).bifurcation
    assert abs(known.value - flips_of_the_curve()[0]) <= known.error <= AIM * known.value
