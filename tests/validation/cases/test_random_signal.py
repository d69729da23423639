"""The case `random-signal`: it agrees, and tells a signal that is not what its density says."""

from __future__ import annotations

import numpy as np
import pytest

from lapjoint.problem import FloatArray
from lapjoint.problem.realisation import Realisation
from validation.cases import random_signal as case
from validation.verdict import Verdict

T = np.arange(2**16) / case.RATE


def test_a_random_excitation_is_what_its_density_says() -> None:
    result = case.run("quick", lambda _: None)
    assert [item.line for item in result.items if item.verdict is Verdict.DISAGREE] == []


def test_a_signal_that_comes_again_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = Realisation.at

    def again(self: Realisation, t: FloatArray, integral: int = 0) -> FloatArray:
        return sound(self, t % 30.0, integral)

    monkeypatch.setattr(Realisation, "at", again)
    assert next(case.correlations(T)).verdict is Verdict.DISAGREE


def test_a_jump_in_a_minute_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = Realisation.at
    assert case.outside(T).verdict is Verdict.AGREE

    def jumping(self: Realisation, t: FloatArray, integral: int = 0) -> FloatArray:
        return sound(self, t, integral) + (t > 60.0)

    monkeypatch.setattr(Realisation, "at", jumping)
    assert case.outside(T).verdict is Verdict.DISAGREE
