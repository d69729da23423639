"""The case `together`: its joints have every part, and more of them agree."""

from __future__ import annotations

import pytest

from validation.cases import together
from validation.verdict import Verdict


def test_each_seed_draws_a_joint_of_its_own_with_every_part() -> None:
    joints = [together.joint(seed) for seed in together.SEEDS["full"]]
    assert len({joint.beam for joint in joints}) == len(joints)
    for joint in joints:
        assert joint == together.joint(together.SEEDS["full"][joints.index(joint)])
        assert len(joint.masses) == 2
        assert joint.gravity is not None
        assert any(stop.gap < 0 for stop in joint.stops)
        assert any(stop.in_space for stop in joint.stops)


@pytest.mark.slow
def test_both_solvers_agree_on_more_joints() -> None:
    for seed in range(9, 21):
        found, _ = together.judged(seed, "quick")
        assert [item.line for item in found if item.verdict is Verdict.DISAGREE] == [], seed
