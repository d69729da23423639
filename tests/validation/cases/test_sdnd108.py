"""The case `sdnd108`: a mass under gravity falls on a stop as its closed form says, and other masses do not."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lapjoint import Problem
from validation.cases import sdnd108
from validation.verdict import Verdict


def test_both_solvers_and_both_bars_agree_with_the_closed_form() -> None:
    result = sdnd108.run("quick", lambda _: None)
    assert result.verdict is Verdict.AGREE
    assert len(result.checks) == 2 * 2 * 5


def test_the_stiffest_bars_are_within_a_millionth_of_the_rigid_one() -> None:
    result = sdnd108.run("quick", lambda _: None)
    assert max(check.relative for check in result.checks) < 1e-6
    assert max(check.a.uncertainty / abs(check.b.value) for check in result.checks) < 1e-6


def test_the_closed_form_is_what_small_steps_give() -> None:
    of = sdnd108.Falling(2.0, 7.0, 0.5, 1.2, 90.0)
    contact, release, impulse, peak, end = of.answers

    def rates(t: float, at: np.ndarray) -> list[float]:
        force = 90.0 * max(-at[0] - 1.2, 0.0)
        return [at[1], -7.0 + force / 2.0, -force]

    t = np.linspace(0.0, sdnd108.DURATION, 20001)
    z, _, area = solve_ivp(rates, (0.0, t[-1]), [0.0, -0.5, 0.0], t_eval=t, rtol=1e-10, atol=1e-13, max_step=1e-3).y
    pressed = np.flatnonzero(z < -1.2)
    assert t[pressed[[0, -1]]] == pytest.approx([contact, min(release, t[-1])], abs=2 * t[1])
    if release < t[-1]:
        assert area[-1] == pytest.approx(impulse, rel=1e-6)
        assert z[-1] == pytest.approx(end, rel=1e-6)
    assert 90.0 * (-1.2 - z.min()) == pytest.approx(peak, rel=1e-6)


@pytest.mark.parametrize("factor", [0.9999, 1.0001])
def test_another_gravity_disagrees(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    right = sdnd108.Falling.bars

    def wrong(self: sdnd108.Falling, bending_stiffness: float) -> dict[str, Problem]:
        found = right(self, bending_stiffness)
        return {
            name: bar.replace(
                gravity=bar.gravity.model_copy(update={"acceleration": factor * bar.gravity.acceleration})
            )
            for name, bar in found.items()
            if bar.gravity
        }

    monkeypatch.setattr(sdnd108.Falling, "bars", wrong)
    result = sdnd108.run("quick", lambda _: None)
    assert all(check.verdict is Verdict.DISAGREE for check in result.checks)
