"""Lyapunov exponents of series whose answers are known: errors hold; chaos, tori and transients are told apart."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.signal import lfilter

from lapjoint.orbits.exponent import exponent_of, largest_growth
from lapjoint.problem import FloatArray
from lapjoint.summaries.correlated_series import standard_error, weighted_mean


def autoregressive(time: float, size: int, rng: np.random.Generator) -> tuple[FloatArray, float]:
    """An AR(1) series with variance 1 and a correlation that falls in `time`, and the true error of its mean."""
    a = math.exp(-1 / time) if time else 0.0
    noise = rng.standard_normal(size + 2000) * math.sqrt(1 - a * a)
    return np.asarray(lfilter([1.0], [1.0, -a], noise))[2000:], math.sqrt((1 + a) / (1 - a) / size)


@pytest.mark.parametrize("time", [*(pytest.param(it, marks=pytest.mark.thorough) for it in (0.0, 4.0, 64.0)), 16.0])
def test_errors_of_correlated_series_cover_as_they_should(time: float) -> None:
    rng, count = np.random.default_rng(5), 400
    draws = [autoregressive(time, 2048, rng)[0] for _ in range(count)]
    missed = np.mean([abs(x.mean()) > 2 * standard_error(x) for x in draws])
    # 4.6 % if the error were known, 6.4 % of Student's t with 15 degrees of freedom; the scatter of 400 draws is 1.2 %.
    assert 0.01 < missed < 0.11
    estimate, true = np.median([standard_error(x) for x in draws]), autoregressive(time, 2048, rng)[1]
    assert 0.8 * true < estimate < 1.5 * true


def logistic(r: float, size: int) -> FloatArray:
    """ln |f'| along f(x) = r x (1 - x); at r = 4 its mean is ln 2."""
    x, growths = 0.3, np.zeros(size + 1000)
    for i in range(growths.size):
        growths[i] = math.log(abs(r * (1 - 2 * x)))
        x = r * x * (1 - x)
    return growths[1000:]


def circle(omega: float, k: float, size: int) -> FloatArray:
    """ln f' along Arnold's map f(x) = x + omega - k sin(2 pi x) / 2 pi, for k < 1 an invertible map of a circle."""
    x, growths = 0.1, np.zeros(size)
    for i in range(size):
        growths[i] = math.log(1 - k * math.cos(2 * math.pi * x))
        x = (x + omega - k * math.sin(2 * math.pi * x) / (2 * math.pi)) % 1.0
    return growths


def test_the_exponent_of_the_logistic_map_is_ln_2() -> None:
    found = exponent_of(logistic(4.0, 4000), 0.1)
    assert found.positive
    assert abs(found.value - math.log(2) / 0.1) <= 4 * found.standard_error
    assert found.standard_error < 0.05 * found.value


def test_the_exponent_on_a_torus_vanishes_faster_than_a_plain_mean() -> None:
    golden = (math.sqrt(5) - 1) / 2
    for size in (400, 1000, 4000):
        found = exponent_of(circle(golden, 0.8, size), 1.0)
        assert found.vanishes(rate=0.1)
        assert not found.positive
    assert max(map(abs, found.quarters)) < 1e-6


def test_a_locked_motion_is_not_taken_for_a_torus() -> None:
    """Arnold's map within the tongue of winding number 0: every point comes to rest, at a known rate."""
    omega, k = 0.05, 0.8
    rest = math.log(1 - math.sqrt(k * k - (2 * math.pi * omega) ** 2))
    found = exponent_of(circle(omega, k, 1000), 1.0)
    assert found.negative
    assert found.quarters[-1] == pytest.approx(rest, rel=1e-9)
    assert not found.vanishes(rate=5.0)


def test_a_transient_that_dies_away_is_neither_chaos_nor_a_torus() -> None:
    noise = autoregressive(8.0, 1600, np.random.default_rng(2))[0]
    growths = np.where(np.arange(1600) < 800, 0.9, -0.3) + 0.3 * noise
    found = exponent_of(growths, 1.0)
    assert found.value > 4 * found.standard_error or found.standard_error > 0.05  # the mean alone would mislead
    assert not found.positive
    assert not found.negative
    assert not found.vanishes(rate=1.0)


def test_intermittent_chaos_never_gets_two_certificates() -> None:
    """Just below its window of period three the logistic map all but repeats for some 300 steps, then bursts."""
    growths = logistic(1 + math.sqrt(8) - 1e-4, 64_000)
    rate = 10 * growths.mean()
    for size in (500, 1000, 2000, 4000, 8000):
        found = [exponent_of(part, 1.0) for part in growths.reshape(-1, size)]
        assert not any(one.negative or one.vanishes(rate / 5) for one in found)
        far = [abs(one.value - growths.mean()) > 4 * one.standard_error for one in found]
        assert np.mean(far) <= 0.05  # as good as none of Student's t, but 500 steps hold a burst or two
    assert all(one.positive for one in found)


def test_an_exponent_says_over_what_it_was_measured() -> None:
    found = exponent_of(np.concatenate([np.full(64, 0.5), np.full(64, 1.5)]), 0.1)
    assert (found.periods, found.time) == (128, pytest.approx(12.8))
    assert found.value == pytest.approx(10.0)
    assert found.halves == pytest.approx((5.0, 15.0))
    assert found.quarters == pytest.approx((5.0, 5.0, 15.0, 15.0))
    assert not found.positive  # the halves differ


def test_a_series_that_does_not_scatter_has_no_error() -> None:
    assert standard_error(np.full(640, -0.3)) == pytest.approx(0.0, abs=1e-15)
    assert weighted_mean(np.full(100, -0.3)) == pytest.approx(-0.3)


def test_the_largest_growth_is_from_any_period_to_any_later_one() -> None:
    assert largest_growth(np.array([1.0, -3.0, 2.0, -1.0, 2.5, -9.0])) == pytest.approx(math.exp(3.5))
    assert largest_growth(np.array([-1.0, -2.0])) == 1.0  # from a moment to itself
    assert largest_growth(np.array([1.0, 2.0])) == pytest.approx(math.exp(3.0))
    rng = np.random.default_rng(0)
    series = rng.standard_normal(60)
    sums = [series[i:j].sum() for i in range(60) for j in range(i, 61)]
    assert largest_growth(series) == pytest.approx(math.exp(max(sums)))
    assert math.isfinite(largest_growth(np.full(2000, 5.0)))
