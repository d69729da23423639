"""Bars that do not ring: both solvers agree, and the case tells when one forgets when a flow began."""

from __future__ import annotations

import numpy as np
import pytest

from fe_lapjoint.march.propagator import Flow
from lapjoint.problem import FloatArray
from validation.cases import slow_modes
from validation.verdict import Verdict


def test_both_solvers_agree_on_bars_that_do_not_ring() -> None:
    assert slow_modes.run("quick", lambda _: None).verdict is Verdict.AGREE


def test_an_overdamped_mode_that_forgets_when_it_began_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    def forgetful(self: Flow, step: float, count: int) -> FloatArray:
        z = self.terms.view(float) @ self.system.grid(step)[: count + 1].T
        return self._with_others(z, step * np.arange(count + 1.0), 0)

    monkeypatch.setattr(Flow, "at_grid", forgetful)
    checks = slow_modes.compared("sluggish", slow_modes.SLUGGISH)
    assert any(check.verdict is Verdict.DISAGREE for check in checks)
