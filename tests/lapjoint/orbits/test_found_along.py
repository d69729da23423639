"""A bifurcation that is found along the curve of a finer self of the solver is that one, and not another of its kind.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping, where the
branch turns twice, and has a flip before either turn and after it; at one of these, and at the graze beside it.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from finer_curve import FINER, both_ways, family, unconfirmed

from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_again import Finder
from lapjoint.orbits.branches.listing import Listed, listed
from lapjoint.orbits.branches.resolving import asked_again
from lapjoint.orbits.branches.run import Limits, Run
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.value_errors import Stated

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


def a_curve(own: Family) -> Run:
    """Upwards from the motion at 600 rad/s."""
    seed = seed_from(own, 600.0, own.at(600.0).map.initial(), 1)
    assert seed is not None
    start = corrected(own, seed.value, seed.point, seed.count)
    assert start is not None
    upwards = start.along(np.append(np.zeros(start.tangent.size - 1), 1.0))
    return follow(own, upwards, Limits(most=40, length=1.0))


def test_each_bifurcation_of_a_curve_is_found_by_a_closer_look() -> None:
    """Grazes too, of which the march from switch to switch is not kept."""
    own = family()
    run = a_curve(own)
    surely, unsure = listed(own, run, errors=True), listed(own, run, errors=False)
    assert {one.bifurcation.kind for one in surely} == {"grazing", "neimark-sacker", "symmetry breaking"}
    stated = 0
    for one, other in zip(surely, unsure, strict=True):
        known = asked_again(replace(other, way=None)).bifurcation
        if np.isfinite(known.error):
            stated += 1
            assert abs(known.value - one.bifurcation.value) <= known.error + one.bifurcation.error
    assert stated == len(unsure)


def test_what_is_known_already_is_taken_over_where_it_is_meant_without_doubt(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """A finer solver that follows a part once more need not estimate errors again: the coarser one has asked it."""
    own = family()
    run = a_curve(own)
    unsure = [one.bifurcation for one in listed(own, run, errors=False)]
    mine = [replace(one, value=one.value * (1 + 1e-7), error=2e-7 * one.value) for one in unsure]
    asked = list[float]()

    def stated_here(_family: Family, _place: Place, value: float, _finder: Finder) -> Stated:
        asked.append(value)
        return Stated(value, np.inf)

    monkeypatch.setattr("lapjoint.orbits.branches.listing.stated", stated_here)
    again = [one.bifurcation for one in listed(own, run, True, mine)]
    assert [(one.value, one.error) for one in again] == [(one.value, one.error) for one in mine]
    assert not asked
    for wrong in (
        replace(mine[0], value=mine[0].value * (1 + 1e-6)),  # too far off
        replace(mine[0], kind="fold", stop=-1),
        replace(mine[0], stop=mine[0].stop + 1),
    ):
        listed(own, run, True, [wrong, *mine[1:]])
        assert asked == [unsure[0].value]
        asked.clear()
    listed(own, run, True, [*mine, replace(mine[0], error=3e-7 * mine[0].value)])  # which of the two is meant?
    assert asked == [unsure[0].value]
