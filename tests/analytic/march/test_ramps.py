"""Motion of rigid-body modes under forces that are linear in time, against 150 digits."""

from __future__ import annotations

import mpmath
import numpy as np
import pytest

from analytic.march.gap_function import fading_powers


def _exact(drag: float, s: float) -> list[float]:
    with mpmath.workdps(150):
        x, t = mpmath.mpf(drag), mpmath.mpf(s)
        if x == 0:
            return [float(t**n / mpmath.factorial(n)) for n in range(5)]
        found = [mpmath.exp(-x * t), (1 - mpmath.exp(-x * t)) / x]
        for n in (1, 2, 3):
            found.append((t**n / mpmath.factorial(n) - found[-1]) / x)
        return [float(value) for value in found]


@pytest.mark.parametrize("drag", [0.0, 1e-12, 1e-3, 0.4, 0.5000001, 3.0, 1e3, 1e6])
@pytest.mark.parametrize("s", [1e-7, 1e-3, 1.0, 50.0])
def test_fading_powers_have_all_digits_whatever_the_drag(drag: float, s: float) -> None:
    # the division by drag times s, of 2 at least, keeps the rounding of the term before
    assert np.allclose(fading_powers(drag, s), _exact(drag, s), rtol=5e-15, atol=0.0)
