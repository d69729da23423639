"""The case `resting`: equilibria against closed forms, and what the closed forms are."""

from __future__ import annotations

from dataclasses import replace

import pytest

from validation.cases import resting
from validation.verdict import Verdict


def test_equilibria_are_those_of_closed_forms_and_of_marches() -> None:
    assert resting.run("quick", lambda _: None).verdict is Verdict.AGREE


@pytest.mark.parametrize("gap", [-3e-3, 0.0, 4e-3])
def test_the_closed_form_is_the_tip_reaction_of_a_uniform_cantilever(gap: float) -> None:
    L, EI, m, g, k = 1.4, 310.0, 2.3, 9.81, 900.0
    push, tip, clamp, couple = resting.Cantilever(((L, EI, m),), k, gap, gravity=g).answers
    q = m * g
    assert push == pytest.approx((q * L**4 / (8 * EI) - gap) / (L**3 / (3 * EI) + 1 / k), rel=1e-12)
    assert -tip == pytest.approx(gap + push / k, rel=1e-12)
    assert clamp == pytest.approx(q * L - push, rel=1e-12)
    assert couple == pytest.approx(q * L**2 / 2 - push * L, rel=1e-12)


@pytest.mark.parametrize("changed", [{"stop": 3.1001e3}, {"gap": -2.0001e-3}, {"contents": 0.5001}, {"points": ()}])
def test_another_cantilever_disagrees(changed: dict[str, float], monkeypatch: pytest.MonkeyPatch) -> None:
    of = resting.CANTILEVERS["two segments and all loads"]
    other = replace(of, **changed)  # type: ignore[arg-type]
    problem = other.problem
    monkeypatch.setattr(resting, "CANTILEVERS", {"other": of})
    monkeypatch.setattr(resting.Cantilever, "problem", property(lambda _: problem))
    checks = [check for check in resting.against_closed_forms() if "tip" in check.name]
    assert len(checks) == 2
    assert all(check.verdict is Verdict.DISAGREE for check in checks)


@pytest.mark.slow
def test_more_joints_rest_where_marches_settle() -> None:
    checks = [check for seed in range(25, 65) for check in resting.settled(seed)]
    assert [check.line for check in checks if check.verdict is not Verdict.AGREE] == []
