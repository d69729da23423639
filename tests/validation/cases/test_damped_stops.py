"""The case `damped_stops`: other stops are noticed."""

from __future__ import annotations

import pytest

from lapjoint import Problem
from validation.cases import damped_stops
from validation.verdict import Verdict


def test_another_damper_is_found(monkeypatch: pytest.MonkeyPatch) -> None:
    right = damped_stops.bar

    def wrong(damping: float, may_pull: bool, force: float) -> Problem:
        return right(1.001 * damping, may_pull, force)

    monkeypatch.setattr(damped_stops, "bar", wrong)
    checks, _ = damped_stops.falling(damped_stops.SOLVERS[0], False)
    assert all(check.verdict is Verdict.DISAGREE for check in checks)
