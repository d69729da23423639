"""The case `colliding-beams`: the closed form of rigid beams, what is conserved, and mistakes that are noticed."""

from __future__ import annotations

import numpy as np
import pytest

from lapjoint import Problem
from validation.cases import colliding_beams
from validation.cases.colliding_beams import MASSES, MEET, VELOCITY, at_first, rigid
from validation.verdict import Verdict


def test_the_closed_form_is_what_small_steps_give() -> None:
    masses, arms = np.array(MASSES), np.array(MEET) - 0.5
    shift, turn = np.array([0.0, 0.0]), np.array([0.0, 0.0])
    speed, spin = np.array([0.0, VELOCITY[0] + VELOCITY[1] / 2]), np.array([0.0, VELOCITY[1]])
    step, impulse, touched, signs = 1e-5, 0.0, [], np.array([1.0, -1.0])
    for i in range(10_000):
        beyond = float(-signs @ (shift + arms * turn)) - colliding_beams.GAP
        if beyond > 0:
            touched.append(i * step)
        force = colliding_beams.SPRING * max(beyond, 0.0)
        impulse += force * step
        speed, spin = speed + step * signs * force / masses, spin + step * signs * force * arms * 12 / masses
        shift, turn = shift + step * speed, turn + step * spin
    closed = {name: value for name, (_, value) in rigid().items()}
    assert (touched[0], touched[-1], impulse) == pytest.approx(
        (closed["impact"], closed["rebound"], closed["impulse"]), rel=1e-3
    )
    about_ends = masses * (speed / 2 + spin / 12)
    for i in range(2):
        assert masses[i] * speed[i] == pytest.approx(closed[f"momentum {i + 1}"], rel=1e-3)
        assert about_ends[i] == pytest.approx(closed[f"angular momentum {i + 1}"], rel=1e-3)


def test_rigid_beams_keep_what_they_brought() -> None:
    closed = {name: value for name, (_, value) in rigid().items()}
    brought = at_first()
    assert closed["momentum 1"] + closed["momentum 2"] == pytest.approx(brought.momentum, rel=1e-14)
    turning = closed["angular momentum 1"] + closed["angular momentum 2"]
    assert turning + (MEET[0] - MEET[1]) * closed["momentum 2"] == pytest.approx(brought.angular_momentum, rel=1e-14)


@pytest.mark.thorough
@pytest.mark.parametrize("changed", [{"between": ("upper:0.7", "lower:0.4001")}, {"stiffness": 2000.1}])
def test_another_meeting_disagrees(changed: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    right = colliding_beams.pair

    def wrong(*bending_stiffness: float) -> Problem:
        problem = right(*bending_stiffness)
        return problem.replace(stops=(problem.stops[0].model_copy(update=changed),))

    monkeypatch.setattr(colliding_beams, "pair", wrong)
    assert colliding_beams.run("quick", lambda _: None).verdict is Verdict.DISAGREE
