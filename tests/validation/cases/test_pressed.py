"""The case `pressed`: an interference is felt from the start on, and by its own size."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from lapjoint import Problem
from validation.cases import pressed
from validation.verdict import Verdict


def test_both_solvers_agree_with_the_closed_form() -> None:
    assert pressed.run("quick", lambda _: None).verdict is Verdict.AGREE


def test_the_closed_form_is_what_small_steps_give() -> None:
    of = pressed.Pressed(3.0, 50.0, 700.0, 0.02)
    release, impulse, force, impact, pull = of.answers

    def rates(t: float, at: np.ndarray) -> list[float]:
        pressed_by = 700.0 * max(at[0] + 0.02, 0.0)
        return [at[1], -(50.0 * at[0] + pressed_by) / 3.0, pressed_by]

    t = np.linspace(0.0, 1.2 * impact, 20001)
    z, _, area = solve_ivp(rates, (0.0, t[-1]), [0.0, 0.0, 0.0], t_eval=t, rtol=1e-10, atol=1e-13, max_step=1e-3).y
    opened = np.flatnonzero(z < -0.02)
    assert t[opened[[0, -1]]] == pytest.approx([release, impact], abs=2 * t[1])
    assert area[opened[0]] == pytest.approx(impulse, rel=1e-6)
    assert force == 14.0
    assert -50.0 * z.min() == pytest.approx(pull, rel=1e-6)


@pytest.mark.parametrize("gap", [-2.002e-3, -1.998e-3])
def test_another_interference_disagrees(gap: float, monkeypatch: pytest.MonkeyPatch) -> None:
    right = pressed.Pressed.beam

    def wrong(self: pressed.Pressed, bending_stiffness: float) -> Problem:
        problem = right(self, bending_stiffness)
        return problem.replace(stops=(problem.stops[0].model_copy(update={"gap": gap}),))

    monkeypatch.setattr(pressed.Pressed, "beam", wrong)
    assert pressed.run("quick", lambda _: None).verdict is Verdict.DISAGREE
