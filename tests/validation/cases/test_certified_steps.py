"""The steps of the march are right, and the case tells when they are too long or too short."""

from __future__ import annotations

import pytest

from analytic.march.step_bound import first_root_of_bound
from validation.cases import certified_steps
from validation.verdict import Verdict


def test_steps_end_just_below_the_roots() -> None:
    assert certified_steps.run("quick", lambda _: None).verdict is Verdict.AGREE


@pytest.mark.parametrize("factor", [1.00001, 0.99])
def test_steps_of_another_length_are_noticed(factor: float, monkeypatch: pytest.MonkeyPatch) -> None:
    def longer(h: float, h1: float, h2: float, b3: float, most: float) -> float:
        return min(factor * first_root_of_bound(h, h1, h2, b3, most), most)

    monkeypatch.setattr(certified_steps, "first_root_of_bound", longer)
    found = certified_steps.steps(certified_steps.cubics()[:400])
    assert any(item.verdict is Verdict.DISAGREE for item in found)
