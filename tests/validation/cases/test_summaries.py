"""The case `summaries`: it agrees, and tells numbers that are a little off."""

from __future__ import annotations

from dataclasses import replace

import pytest

from lapjoint.summaries import of_orbit
from validation.cases import summaries as case
from validation.verdict import Verdict


@pytest.mark.thorough
def test_what_is_read_off_a_motion_is_what_plain_sums_give() -> None:
    result = case.run("quick", lambda _: None)
    assert [item.line for item in result.items if item.verdict is Verdict.DISAGREE] == []


def test_a_force_a_thousandth_too_large_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    sound = of_orbit.summarise

    def larger(*args: object, **kwargs: object) -> of_orbit.OrbitSummary:
        found = sound(*args, **kwargs)  # type: ignore[arg-type]
        return replace(found, values={name: 1.001 * value for name, value in found.values.items()})

    monkeypatch.setattr(case, "summarise", larger)
    wrong = {check.name for check in case.steady_with_contacts() if check.verdict is Verdict.DISAGREE}
    assert "steady with contacts, force rms of stop 1" in wrong
