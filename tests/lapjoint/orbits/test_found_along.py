"""A bifurcation that is found along the curve of a finer self of the solver is that one, and not another of its kind.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping, where the
branch turns twice, and has a flip before either turn and after it; at one of these, and at the graze beside it.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

from finer_curve import FINER, both_ways, family, unconfirmed

from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.resolving import asked_again
from lapjoint.orbits.branches.run import Limits

MOTIONS = json.loads((Path(__file__).parent / "two_flips.json").read_text(encoding="utf-8"))
AROUND = Limits(most=60, length=3e-2)  # from the graze, it has both flips
AIM = 1e-5  # error over the frequency


def at_the_flip(own: Family) -> Listed:
    return unconfirmed(own, "flip", motion_from(MOTIONS["at_the_flip"]))


def flips_of_the_curve() -> list[float]:
    """Where a finer self has flips on its own curve, followed from its own motion at the graze, in their sequence."""
    graze = motion_from(MOTIONS["beside_a_graze"])
    flips = [[one.value for one in way if one.kind == "flip"] for way in both_ways(graze, AROUND)]
    return next(way for way in flips if way and min(way) < graze.value)


def test_of_two_flips_on_either_side_of_two_turns_the_nearer_one_is_found() -> None:
    own = family()
    found, (nearer, farther, *_) = by_another(at_the_flip(own), own, FINER - 1), flips_of_the_curve()
    assert found is not None
    assert abs(found.value - nearer) <= found.error <= AIM * found.value
    assert abs(found.value - farther) > 100 * found.error


def test_where_no_motion_of_the_branch_leads_to_it_one_of_a_closer_look_does() -> None:
    one = replace(at_the_flip(family()), way=None)
    assert by_another(one, one.family, FINER - 1) is None
    known = asked_again(one).bifurcation
    assert abs(known.value - flips_of_the_curve()[0]) <= known.error <= AIM * known.value
