"""The published scheme by itself is right, and the case tells when its rule or its losses are others."""

from __future__ import annotations

from dataclasses import replace

import pytest

from analytic.published import steady
from analytic.published.loss import FrozenPart, frozen_part
from lapjoint import History
from validation.cases import as_published
from validation.verdict import Verdict


def test_the_scheme_agrees_with_its_witnesses() -> None:
    assert as_published.run("quick", lambda _: None).verdict is Verdict.AGREE


def test_another_number_of_repeats_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(steady, "_REPEATS", 21)
    found = as_published.settled("515 rad/s", as_published.paper(515.0))
    assert any(check.verdict is Verdict.DISAGREE for check in found)


def test_losses_that_are_a_thousandth_off_are_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def off(history: History) -> FrozenPart:
        found = frozen_part(history)
        return replace(found, kinetic=1 - 1.001 * (1 - found.kinetic))

    monkeypatch.setattr(as_published, "frozen_part", off)
    assert any(check.verdict is Verdict.DISAGREE for check in as_published.left_behind())
