"""The case `limits`: problems with new parts become simpler ones, and others do not."""

from __future__ import annotations

import pytest

from lapjoint.problem import Mass
from validation.cases import limits
from validation.verdict import Check, Verdict


def disagreeing(checks: list[Check]) -> list[str]:
    return [check.line for check in checks if check.verdict is not Verdict.AGREE]


def test_each_limit_is_the_simpler_problem() -> None:
    assert disagreeing(list(limits.run("quick", lambda _: None).checks)) == []


def test_a_mass_that_does_not_vanish_disagrees(monkeypatch: pytest.MonkeyPatch) -> None:
    def heavier(x: float, mass: float) -> Mass:
        return Mass(x=x, mass=1e3 * mass if mass < 1 else mass)

    monkeypatch.setattr(limits, "Mass", heavier)
    found = disagreeing(list(limits.of_masses()))
    assert found
    assert all("vanishes" in line for line in found)


def test_a_stop_that_lets_go_is_no_spring(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(limits, "INTERFERENCE", 2e-5)
    assert disagreeing(list(limits.of_preload()))
