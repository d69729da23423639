"""The case `sdnd102`: a wall fixed in space is met as closed forms say, and a wall that moves with the base is not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lapjoint import Problem
from validation.cases import sdnd102
from validation.references.mass_beside_wall import MassBesideWall
from validation.verdict import Verdict


def test_both_solvers_give_every_contact_as_the_closed_form_does() -> None:
    result = sdnd102.run("quick", lambda _: None)
    assert result.verdict is Verdict.AGREE
    assert len(result.checks) == 2 * 2 * 5 * 10


def test_the_closed_form_is_what_small_steps_give() -> None:
    mass = MassBesideWall(2.0, 300.0, 0.05, 9.0, 9000.0, 4e-3)

    def rates(t: float, at: np.ndarray) -> list[float]:
        y = -np.sin(mass.omega * t) / mass.omega**2
        force = mass.wall * max(at[0] + y - mass.gap, 0.0)
        return [
            at[1],
            -np.sin(mass.omega * t) - (mass.drag * at[1] + mass.stiffness * at[0] + force) / mass.mass,
            force,
        ]

    hits = mass.hits(6.0)
    assert len(hits) > 3
    marched = solve_ivp(rates, (0.0, 6.0), [0.0, 0.0, 0.0], rtol=1e-9, atol=1e-12, max_step=1e-3, dense_output=True)
    for hit in hits:
        before, after = (marched.sol(t)[2] for t in (hit.start - 1e-3, hit.end + 1e-3))
        assert after - before == pytest.approx(hit.impulse, rel=1e-5)


@pytest.mark.parametrize("changed", [{"fixed_to": "base"}, {"stiffness": 1.001 * 5.76e7}])
def test_another_wall_disagrees(changed: dict[str, object], monkeypatch: pytest.MonkeyPatch) -> None:
    right = sdnd102.beam

    def wrong(mass: MassBesideWall, bending_stiffness: float) -> Problem:
        problem = right(mass, bending_stiffness)
        return problem.replace(stops=(problem.stops[0].model_copy(update=changed),))

    monkeypatch.setattr(sdnd102, "beam", wrong)
    monkeypatch.setattr(sdnd102, "DURATION", 0.6)
    assert sdnd102.run("quick", lambda _: None).verdict is Verdict.DISAGREE


def test_an_image_that_moves_otherwise_disagrees(monkeypatch: pytest.MonkeyPatch) -> None:
    right = sdnd102.mirrored

    def wrong(mass: MassBesideWall, bending_stiffness: float) -> Problem:
        problem = right(mass, bending_stiffness)
        image, own = problem.beams
        return problem.replace(beams=(image.model_copy(update={"base_share": -0.999}), own))

    monkeypatch.setattr(sdnd102, "mirrored", wrong)
    monkeypatch.setattr(sdnd102, "DURATION", 0.6)
    different = [item.name for item in sdnd102.run("quick", lambda _: None).checks if item.verdict is Verdict.DISAGREE]
    assert different
    assert all("mirror" in name for name in different)
