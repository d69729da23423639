"""Integrals of a fading exponential, against 50 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from fe_lapjoint.march.ramp_interval import fading_integrals

TIMES = np.array([0.0, 1e-7, 1e-3, 1.0, 50.0])


@pytest.mark.parametrize("drag", [0.0, 1e-12, 1e-3, 0.4, 3.0, 1e3, 1e6])
def test_fading_integrals_have_all_digits_whatever_the_drag(drag: float) -> None:
    found = np.array([fading_integrals(drag, s) for s in TIMES.tolist()]).T
    with mpmath.workdps(50):
        for n, values in enumerate(found):
            # the n-th integral is s^n / n! times a confluent hypergeometric function
            exact = [
                float(mpmath.mpf(s) ** n / mpmath.factorial(n) * mpmath.hyp1f1(1, n + 1, -mpmath.mpf(drag) * s))
                if n
                else float(mpmath.exp(-mpmath.mpf(drag) * s))
                for s in TIMES
            ]
            # the division by drag times s, of 2 at least, keeps the rounding of the term before
            assert np.allclose(values, exact, rtol=5e-15, atol=0.0)
