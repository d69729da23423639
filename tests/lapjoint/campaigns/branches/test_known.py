"""Whether a motion lies on a branch that is known: those of the branch do, and those of a part that it lacks do not."""

from __future__ import annotations

from typing import Any

import pytest

from lapjoint.campaigns.branches.known import Curve, Motion
from lapjoint.campaigns.branches.plain import plain_start
from lapjoint.campaigns.branches.solve import solve_branch
from lapjoint.campaigns.branches.spec import BranchSpec, range_of
from lapjoint.orbits.branches.starts import Start, of_motion, start_from


def settled(spec: BranchSpec, value: float) -> dict[str, Any]:
    """The motion in which a march from rest ends."""
    of = range_of(spec)
    start = start_from(of, value, of.resolution(value).map(value).initial(), 1)
    assert start is not None
    return plain_start(start)


@pytest.mark.parametrize("value", [3.1e-4, 3.21e-4, 3.3e-4, 3.36e-4, 3.39e-4])
def test_every_motion_that_a_march_keeps_lies_on_the_branch(
    spec: BranchSpec, plain: dict[str, Any], value: float
) -> None:
    curve, resolution = Curve(spec, plain), range_of(spec).resolution(value)
    assert Motion(spec, settled(spec, value)).lies_on(curve)
    for one in curve.motions_at(value, 2):  # with a contact: one or two of them within the folds
        start = of_motion(resolution, value, one.section(), 2)
        assert Motion(spec, plain_start(start)).lies_on(curve)


def test_each_motion_lies_on_the_branch_that_is_followed_from_any_of_them(
    spec: BranchSpec, plain: dict[str, Any]
) -> None:
    """Also at folds and at the graze, where the parameter of neighbouring knots does not reach the motion's own."""
    of, curve = range_of(spec), Curve(spec, plain)
    starts = [Start.at(point) for point in curve.motions_at(3.25e-4, 2)]
    assert starts
    again = Curve(spec, solve_branch(spec, plain_start(starts[0])))
    for equations, unknowns, _ in plain["knots"]:
        _, closed, stops, phase, tied = plain["equations"][equations]
        motion = {
            **plain_start(starts[0]),
            **{"closed": closed, "stops": stops, "phase": phase, "tied": tied, "unknowns": unknowns},
            **{"direction": None, "away_from": None},
        }
        assert of.low <= unknowns[-1] <= of.high
        assert Motion(spec, motion).lies_on(curve)
        assert Motion(spec, motion).lies_on(again)


def test_a_motion_of_a_part_that_a_branch_lacks_does_not_lie_on_it(spec: BranchSpec, plain: dict[str, Any]) -> None:
    turn = next(i for i, (_, _, may_turn) in enumerate(plain["knots"]) if may_turn and i > len(plain["knots"]) // 2)
    part = Curve(spec, {**plain, "knots": plain["knots"][:turn]})
    motion = Motion(spec, settled(spec, 3.9e-4))
    assert motion.lies_on(Curve(spec, plain))
    assert not motion.lies_on(part)


def test_a_motion_does_not_lie_on_a_branch_of_another_period(spec: BranchSpec, plain: dict[str, Any]) -> None:
    motion = settled(spec, 3.1e-4)
    assert not Motion(spec, motion).lies_on(Curve(spec, {**plain, "half_periods": 2 * plain["half_periods"]}))
