"""Intervals hold the true value about 95 times in a hundred, of scatter whose law is known."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.stats import chi2, t

from lapjoint.problem import FloatArray
from lapjoint.summaries.intervals import is_rare, of_mean, of_positive_mean, of_rate, of_rms

UNITS, REPLICATES = 32, 4000


def share_of(intervals: FloatArray, truth: float) -> float:
    return float(np.mean((intervals[:, 0] <= truth) & (truth <= intervals[:, 1])))


def test_a_mean_has_the_interval_of_student() -> None:
    units = np.array([1.0, 2.0, 4.0])
    half = t.ppf(0.975, 2) * np.std(units, ddof=1) / np.sqrt(3)
    assert of_mean(units) == pytest.approx([7 / 3 - half, 7 / 3 + half])


def test_intervals_of_means_and_squares_hold_the_truth() -> None:
    rng = np.random.default_rng(11)
    assert 0.94 < share_of(of_mean(rng.normal(3.0, 2.0, (UNITS, REPLICATES))), 3.0) < 0.96
    for freedom in (4, 40):  # mean squares of that many independent samples in a unit
        squares = rng.chisquare(freedom, (UNITS, REPLICATES)) / freedom
        assert 0.93 < share_of(of_rms(squares), 1.0) < 0.97


@pytest.mark.parametrize("units", [8, 12, 20])
def test_intervals_of_sums_of_a_few_strong_events_hold_the_truth(units: int) -> None:
    """A unit is the sum of one event on average, of a size that is the cube of Rayleigh's; logarithms hold 90.5 %."""
    rng = np.random.default_rng((13, units))
    counts = rng.poisson(1.0, units * REPLICATES)
    ends = np.cumsum(counts)
    total = np.append(0.0, np.cumsum(rng.rayleigh(size=ends[-1]) ** 3))
    sums = (total[ends] - total[ends - counts]).reshape(units, REPLICATES)
    assert 0.925 < share_of(of_positive_mean(sums), 3 * np.sqrt(np.pi / 2)) < 0.96


def test_a_positive_mean_whose_reciprocal_root_may_be_zero_has_no_upper_end() -> None:
    low, high = of_positive_mean(np.array([0.0, 0.0, 0.0, 1.0]))
    assert 0 < low < 0.25
    assert high == np.inf


@pytest.mark.parametrize("each", [0.1, 1.0, 4.0, 30.0])
@pytest.mark.parametrize("together", [False, True])
def test_intervals_of_rates_hold_the_truth(each: float, together: bool) -> None:
    """Of events alone, and in clusters of one to five."""
    rng = np.random.default_rng(12)
    counts = rng.poisson(each, (UNITS, REPLICATES))
    if together:
        counts = sum(k * rng.poisson(each / 15, (UNITS, REPLICATES)) for k in range(1, 6))
    assert 0.9 < share_of(of_rate(counts, 0.5), 2 * each) <= 0.99


def test_rare_events_have_the_exact_interval_of_poisson() -> None:
    counts = np.zeros((10, 2), dtype=np.int64)
    counts[:3, 1] = 1
    none, three = of_rate(counts, 2.0)
    assert none == pytest.approx([0.0, chi2.ppf(0.975, 2) / 2 / 20])
    assert three == pytest.approx([chi2.ppf(0.025, 6) / 2 / 20, chi2.ppf(0.975, 8) / 2 / 20])
    assert is_rare(counts).all()
    assert not is_rare(counts + 5).any()


def test_one_unit_tells_nothing() -> None:
    assert np.isinf(of_mean(np.array([[1.0]]))).all()
    assert of_positive_mean(np.array([[1.0, 0.0]])).tolist() == [[0.0, np.inf], [0.0, 0.0]]
