"""The witness of fatigue counts as ASTM E1049 does, and its signals have the spectrum that they are given."""

from __future__ import annotations

import numpy as np
import pytest

from validation.cases.fatigue import NARROW, WIDE
from validation.references.gaussian_rainflow import GaussianStress, ranges_of


def test_the_worked_example_of_astm_e1049_is_counted() -> None:
    """ASTM E1049-85 (2017), figure 6: one cycle of 4 and half cycles of 3, 4, 6, 8, 8, 9."""
    whole, half = ranges_of(np.array([-2.0, 1.0, -3.0, 5.0, -1.0, 3.0, -4.0, 4.0, -2.0]))
    assert whole.tolist() == [4.0]
    assert sorted(half.tolist()) == [3.0, 4.0, 6.0, 8.0, 8.0, 9.0]


def test_the_signals_of_a_very_narrow_band_do_the_damage_of_its_formula() -> None:
    f = np.arange(9.5, 10.5, 0.005)
    narrow = GaussianStress(f, np.full(f.size, 2.0), 3.0, 1.0)
    mean, error = narrow.simulated(32, 3)
    assert narrow.moment(0) == pytest.approx(2.0 * (f[-1] - f[0]))
    assert abs(mean - narrow.narrow()) < 4 * error
    assert error < 0.05 * mean
    assert narrow.wirsching_light() < narrow.narrow()


def test_the_spectra_of_the_case_are_narrow_and_wide_and_the_fits_lie_near_the_signals() -> None:
    assert NARROW.stress(0.0).regularity > 0.98
    for x, most in ((0.0, 0.4), (0.45, 0.8)):
        stress = WIDE.stress(x)
        mean, error = stress.simulated(16, 1)
        assert stress.regularity < most
        assert mean + 4 * error < stress.narrow()
        assert abs(stress.dirlik() - mean) < 0.15 * mean + 4 * error  # a fit, of which no error is stated
        assert mean < stress.wirsching_light() + 4 * error
