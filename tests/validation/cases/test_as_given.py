"""The ground on trial: it agrees as it is, and no fault in it passes."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from lapjoint import Problem, paper_joint
from lapjoint.answers import History
from lapjoint.orbits.exponent import exponent_of
from lapjoint.problem import Beam, PolynomialShape, files
from validation.cases import as_given
from validation.verdict import Verdict


def disagree() -> list[str]:
    result = as_given.run("quick", lambda _: None)
    return [item.name for item in result.items if item.verdict is Verdict.DISAGREE]


def test_the_ground_is_as_given() -> None:
    assert disagree() == []


def scaled(of: Callable[..., Any], factor: float = 1.001) -> Callable[..., Any]:
    return lambda *args, **options: factor * of(*args, **options)


def wide(of: Callable[..., Problem]) -> Callable[..., Problem]:
    def changed(*args: Any, **options: Any) -> Problem:
        problem = of(*args, **options)
        return problem.replace(stops=[s.model_copy(update={"gap": 1.01 * s.gap}) for s in problem.stops])

    return changed


FAULTS: dict[str, tuple[str, Any]] = {
    "the preset's gap one percent off": ("validation.cases.as_given.paper_joint", wide(paper_joint)),
    "a gap of a file read one percent wide": ("validation.cases.as_given.from_toml", wide(files.from_toml)),
    "bending stiffness": ("lapjoint.problem.beam.Beam.EI", property(scaled(Beam.EI.fget))),  # type: ignore[attr-defined]
    "mass per length": ("lapjoint.problem.beam.Beam.m", property(scaled(Beam.m.fget))),  # type: ignore[attr-defined]
    "the side of a stop": ("lapjoint.problem.supports_and_stops.Stop.sign", property(lambda self: 1)),
    "the first damping ratio for all": (
        "lapjoint.problem.damping.ModalDamping.ratios",
        lambda self, count: np.full(count, np.atleast_1d(self.ratio)[0]),
    ),
    "an initial velocity": (
        "lapjoint.problem.initial.PolynomialShape.velocity_at",
        scaled(PolynomialShape.velocity_at),
    ),
    "the force law": ("lapjoint.answers.history.History.contact_force", scaled(History.contact_force)),
    "the moment": ("lapjoint.answers.history.History.moment", scaled(History.moment)),
    "impulses per period": (
        "validation.cases.as_given.impulses_per_period",
        scaled(as_given.impulses_per_period),
    ),
    "exponents": ("validation.cases.as_given.exponent_of", lambda growth, period: exponent_of(1.001 * growth, period)),
}


@pytest.mark.parametrize("fault", FAULTS)
def test_a_fault_of_the_ground_is_caught(fault: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(*FAULTS[fault])
    assert disagree(), fault


def test_a_phase_that_is_not_read_is_caught(monkeypatch: pytest.MonkeyPatch) -> None:
    def still(text: str) -> Problem:
        problem = files.from_toml(text)
        base = problem.base_motion
        return problem if base is None else problem.replace(base_motion=base.model_copy(update={"phase": 0.0}))

    monkeypatch.setattr(as_given, "from_toml", still)
    assert any("phase" in name for name in disagree())
