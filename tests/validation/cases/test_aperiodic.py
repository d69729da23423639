"""Exponents of chaos: what several motions say of one measurement goes into both intervals."""

from __future__ import annotations

import pytest

from lapjoint.answers import Exponent
from validation.cases.aperiodic import exponents


def measured(value: float, time: float = 100.0, standard_error: float = 0.01) -> Exponent:
    halves, quarters = (value, value), (value,) * 4
    return Exponent(value, standard_error, int(time), time, halves, quarters)


def test_the_scatter_of_several_motions_counts_and_not_what_one_says_of_itself() -> None:
    mean, single = exponents([measured(value) for value in (1.0, 2.0, 3.0)], measured(5.0, time=25.0))
    t = 9.925  # Student's, 99 %, two degrees of freedom
    assert (mean.value, single.value) == (2.0, 5.0)
    assert mean.uncertainty == pytest.approx(t / 3**0.5, rel=1e-3)
    assert single.uncertainty == pytest.approx(2 * t, rel=1e-3)  # of a quarter of the time


def test_a_larger_error_of_its_own_stands() -> None:
    _, single = exponents([measured(1.0), measured(1.1), measured(1.2)], measured(1.0, standard_error=3.0))
    assert single.uncertainty == pytest.approx(9.925 * 3.0, rel=1e-3)
