"""The case `sdnd101`: what of the published answers is confirmed, and what is not."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from validation.cases import sdnd101
from validation.verdict import Verdict


def test_force_and_time_are_confirmed_and_the_impulse_is_not() -> None:
    result = sdnd101.run("quick", lambda _: None)
    assert result.verdict is Verdict.EXPLAINED
    found = {check.name: check.verdict for check in result.checks}
    assert all(verdict is Verdict.AGREE for name, verdict in found.items() if "closed form" in name)
    for name, verdict in found.items():
        if "printed" in name:
            assert verdict is (Verdict.EXPLAINED if "impulse" in name else Verdict.AGREE), name


def test_closed_form_is_the_integral_of_its_force() -> None:
    mass = sdnd101.Mass(3.0, 50.0, 700.0, 0.4)
    peak, contact, impulse = mass.answers
    omega = math.sqrt(750.0 / 3.0)
    t = np.linspace(0.0, contact, 4001)
    force = 700.0 * 0.4 / omega * np.sin(omega * t)
    assert force[-1] == pytest.approx(0.0, abs=1e-9)
    assert peak == pytest.approx(force.max(), rel=1e-6)
    assert impulse == pytest.approx(quad(lambda s: 700.0 * 0.4 / omega * math.sin(omega * s), 0.0, contact)[0])


@pytest.mark.parametrize("factor", [0.999, 1.001])
def test_a_wrong_stiffness_disagrees(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    right = sdnd101.Mass.beam

    def wrong(self: sdnd101.Mass, bending_stiffness: float) -> object:
        problem = right(self, bending_stiffness)
        (stop,) = problem.stops
        return problem.replace(stops=(stop.model_copy(update={"stiffness": factor * stop.stiffness}),))

    monkeypatch.setattr(sdnd101.Mass, "beam", wrong)
    assert sdnd101.run("quick", lambda _: None).verdict is Verdict.DISAGREE
