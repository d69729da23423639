"""Integrals of a fading exponential, by which rigid bodies move under ramps, against 60 digits."""

from __future__ import annotations

import math
from collections.abc import Callable

import mpmath as mp
import pytest

from analytic.march.gap_function import fading_powers
from fe_lapjoint.march.ramp_interval import fading_integrals


@pytest.mark.parametrize(
    ("integrals", "most"), [(fading_powers, math.inf), (fading_integrals, 2.0)]
)  # faster ones are exponentials of their own
@pytest.mark.parametrize("drag", [0.0, 1e-12, 1e-3, 0.4, 0.5000001, 3.0, 1e3, 1e6])
@pytest.mark.parametrize("s", [1e-7, 1e-3, 1.0, 50.0])
def test_fading_integrals_have_all_digits_whatever_the_drag(
    integrals: Callable, most: float, drag: float, s: float
) -> None:
    s = min(s, most / drag if drag else s)
    found = integrals(drag, s)
    with mp.workdps(60):
        # the n-th integral is s^n / n! times a confluent hypergeometric function
        exact = [
            float(mp.mpf(s) ** n / mp.factorial(n) * mp.hyp1f1(1, n + 1, -mp.mpf(drag) * s))
            for n in range(1, len(found))
        ]
        exact.insert(0, float(mp.exp(-mp.mpf(drag) * s)))
    # the division by drag times s, of 2 at least, keeps the rounding of the term before
    assert list(found) == pytest.approx(exact, rel=5e-15, abs=0.0)
