"""Outside witnesses in closed form: the textbooks' beams, and the impact oscillator with one degree of freedom."""

from __future__ import annotations

import itertools
import math
from collections.abc import Callable

import numpy as np
import pytest
from scipy.integrate import quad, solve_ivp

from validation.cases import one_mode, textbook
from validation.cases.bilinear import Bilinear, classical_frequency
from validation.cases.textbook_equations import BEAMS, ROOTS, roots
from validation.verdict import Kind, Verdict


def silent(_: str) -> None:
    """Progress that nobody wants."""


@pytest.mark.parametrize("name", BEAMS)
def test_roots_are_five_and_near_where_they_must_be(name: str) -> None:
    found = roots(BEAMS[name].equation)
    assert len(found) == ROOTS
    gaps = [b - a for a, b in itertools.pairwise(found)]
    assert all(0.2 < gap / math.pi < 1.5 for gap in gaps)  # none missed, none twice; springs bunch the lowest
    assert gaps[-1] == pytest.approx(math.pi, rel=0.06)


def test_every_printed_row_is_of_a_beam_that_is_solved() -> None:
    assert sum(len(textbook.rows_of(beam)) for beam in BEAMS) == 11


def test_both_solvers_meet_the_textbooks() -> None:
    result = textbook.run("quick", silent)
    assert result.verdict is Verdict.AGREE
    assert {check.b.kind for check in result.checks} == {Kind.ANALYTICAL, Kind.PUBLISHED}
    assert max(c.relative for c in result.checks if c.name.endswith("analytic against the equation")) < 1e-14


@pytest.mark.parametrize("gap", one_mode.GAPS)
def test_the_closed_form_obeys_the_differential_equation(gap: float) -> None:
    limit = one_mode.oscillator(gap)
    first, second = limit.contacts(2)
    k = limit.omega_2**2 - limit.omega_1**2

    def rates(t: float, y: np.ndarray) -> list[float]:
        return [y[1], -(limit.omega_1**2) * y[0] - k * max(y[0] - gap, 0.0), max(y[0] - gap, 0.0)]

    def solved(end: float) -> np.ndarray:
        steps = {"rtol": 1e-10, "atol": 1e-13, "max_step": 1e-3}
        return np.asarray(solve_ivp(rates, (0.0, end), [0.0, limit.speed, 0.0], **steps).y[:, -1])

    assert solved(first.start + 1e-12)[0] == pytest.approx(gap, abs=1e-9)
    assert solved(first.end)[0] == pytest.approx(gap, abs=1e-9)
    assert solved(first.end)[2] == pytest.approx(first.area, rel=1e-6)
    assert solved(second.start)[:2] == pytest.approx([gap, limit.impact_speed], abs=1e-8)


def test_without_a_gap_the_frequency_is_the_classical_one_and_harmonics_are_those_of_the_half_sines() -> None:
    limit = Bilinear(10.0, 25.0, 0.0, 0.1)
    assert 2 * math.pi / limit.period == pytest.approx(classical_frequency(10.0, 25.0), rel=1e-13)
    contact = math.pi / 25.0

    def x(t: float) -> float:
        return 0.1 / 25 * math.sin(25 * t) if t < contact else -0.1 / 10 * math.sin(10 * (t - contact))

    def part(f: Callable[[float], float], angle: float) -> float:
        return float(quad(lambda t: x(t) * f(angle * t), 0, limit.period, points=[contact])[0])

    for n in range(4):
        angle = 2 * math.pi * n / limit.period
        size = math.hypot(part(math.cos, angle), part(math.sin, angle)) / limit.period
        assert limit.harmonic(n) == pytest.approx(size, rel=1e-9)
