"""The cases of random excitation: they agree, and notice what is a tenth off."""

from __future__ import annotations

from dataclasses import replace
from itertools import pairwise
from typing import Any

import pytest

from validation.cases import random_linear, random_stops
from validation.statistics_estimates import joint_factor
from validation.verdict import Verdict


def run(case: Any, patch: pytest.MonkeyPatch) -> Verdict:
    patch.setattr(case, "SOLVERS", {"analytic": case.SOLVERS["analytic"]})
    return Verdict(case.run("quick", lambda _: None).verdict)


@pytest.mark.thorough
@pytest.mark.parametrize("case", [random_linear, random_stops])
def test_they_agree(case: Any, monkeypatch: pytest.MonkeyPatch) -> None:
    assert run(case, monkeypatch) is Verdict.AGREE


def test_a_beam_a_tenth_too_heavy_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(random_linear, "BEAM", replace(random_linear.BEAM, mass=1.1 * random_linear.BEAM.mass))
    assert run(random_linear, monkeypatch) is Verdict.DISAGREE


@pytest.mark.thorough
def test_a_spring_a_tenth_too_soft_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    soft = replace(random_stops.OSCILLATOR, omega=0.9**0.5 * random_stops.OSCILLATOR.omega)
    made = random_stops.bar
    monkeypatch.setattr(random_stops, "bar", lambda band, kept=random_stops.OSCILLATOR: _with(made, kept, band))
    monkeypatch.setattr(random_stops, "OSCILLATOR", soft)
    assert run(random_stops, monkeypatch) is Verdict.DISAGREE


def _with(made: Any, oscillator: Any, band: tuple[float, float]) -> Any:
    """The bar of one oscillator while another is the reference."""
    now, random_stops.OSCILLATOR = random_stops.OSCILLATOR, oscillator
    try:
        return made(band)
    finally:
        random_stops.OSCILLATOR = now


def test_intervals_that_are_to_hold_together_are_wider() -> None:
    assert joint_factor(1, 0.95) == pytest.approx(1.0)
    assert joint_factor(20, 0.95) == pytest.approx(3.0233 / 1.95996, rel=1e-4)


def test_a_wider_band_leaves_out_less() -> None:
    parts = [sum(random_stops.bias(band)) for band in random_stops.BANDS]
    assert all(after < before / 1.8 for before, after in pairwise(parts))
