"""Realisations are Gaussian, stationary, of the density that is asked for, and the same however they are asked for."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import chi2, kurtosis, norm, skew

from lapjoint.problem.density import Density
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.ramps import KNOTS, RampBlocks, RandomForce, RecordedForce
from lapjoint.problem.realisation import MOST_TAPS, SMEAR, Realisation, edge, integrated, taps_for

DENSITY = Density((20.0, 60.0, 200.0), (1.0, 8.0, 0.5))
RATE = 1600.0
ONE_IN_A_MILLION = 1e-6
"""How often a right program would fail a test of chance with other seeds."""


@pytest.mark.parametrize("power", [0, 2, -2, -4])
def test_moments_are_the_integrals_of_the_density(power: int) -> None:
    for density in (
        DENSITY,
        Density((2.0, 30.0), (3.0, 0.2)),
        Density((1.0, 7.0), (7.0, 1.0)),
        Density((1, 9), (2, 2)),
    ):
        found = quad(
            lambda f, of=density: (2 * np.pi * f) ** power * of.at(np.array([f]))[0],
            density.lowest,
            density.top,
            points=density.frequency[1:-1] or None,
            epsabs=0,
            epsrel=1e-11,
        )[0]
        assert abs(density.moment(power) - found) < 1e-9 * found


def test_a_density_is_a_power_of_the_frequency_between_breakpoints_and_nothing_outside() -> None:
    density = Density((10.0, 1000.0), (4.0, 0.04))
    assert np.allclose(density.at(np.array([10.0, 100.0, 1000.0])), [4.0, 0.4, 0.04], rtol=1e-12)
    assert density.at(np.array([0.0, 9.999, 1000.1])).tolist() == [0.0, 0.0, 0.0]


def _density_of_samples(taps: np.ndarray, f: np.ndarray, rate: float) -> np.ndarray:
    """One-sided, by the definition: the sum over the taps at each frequency."""
    phases = np.exp(-2j * np.pi * np.outer(f / rate, np.arange(taps.size)))
    return np.asarray(np.abs(phases @ taps) ** 2 * 2 / rate)


def test_the_filter_gives_the_density_but_for_its_edges() -> None:
    taps, inner = taps_for(DENSITY, RATE), SMEAR * DENSITY.lowest
    f = np.array([20 + inner, 30.0, 45.0, 60 - inner, 60 + inner, 100.0, 150.0, 200 - inner])
    straight = np.sinc(f / RATE) ** 4
    assert np.allclose(_density_of_samples(taps, f, RATE) * straight, DENSITY.at(f), rtol=2e-3)
    outside = np.array([0.0, 5.0, 20 - inner, 200 + inner, 400.0, 800.0])
    assert np.max(_density_of_samples(taps, outside, RATE)) < 1e-9 * max(DENSITY.density)
    assert edge(DENSITY, RATE) == pytest.approx(inner, rel=1e-3)


def test_a_filter_with_too_few_taps_smears_more_and_says_so() -> None:
    assert edge(Density((0.01, 100.0), (1.0, 1.0)), 800.0) > 0.01 * SMEAR * 5
    assert edge(Density((0.01, 100.0), (1.0, 1.0)), 800.0) * MOST_TAPS == pytest.approx(
        edge(Density((1.0, 100.0), (1.0, 1.0)), 800.0) * taps_for(Density((1.0, 100.0), (1.0, 1.0)), 800.0).size,
        rel=1e-3,
    )


def test_a_realisation_is_gaussian_and_stationary() -> None:
    parts = np.array([Realisation(DENSITY, RATE, 77, k).at(np.arange(2**17) / RATE) for k in range(4)])
    # independent numbers: as many as twice the equivalent bandwidth times the duration
    f = np.linspace(20, 200, 20001)
    S = DENSITY.at(f) / np.sinc(f / RATE) ** 4
    width = np.trapezoid(S, f) ** 2 / np.trapezoid(S**2, f)
    variances, n = parts.reshape(4, 8, -1).var(axis=2), 2 * width * 2**14 / RATE
    statistic = n / 2 * np.sum((variances / variances.mean() - 1) ** 2)  # var(s^2) = 2 sigma^4 / n
    assert chi2.sf(statistic, variances.size - 1) > ONE_IN_A_MILLION
    assert chi2.cdf(statistic, variances.size - 1) > ONE_IN_A_MILLION
    allowed, total = norm.isf(ONE_IN_A_MILLION), 2 * width * parts.size / RATE
    assert abs(variances.mean() / np.trapezoid(S, f) - 1) < allowed * np.sqrt(2 / total)
    assert abs(skew(parts.ravel())) < allowed * np.sqrt(6 / total)
    assert abs(kurtosis(parts.ravel())) < allowed * np.sqrt(24 / total)


def test_what_is_asked_for_first_changes_no_bit() -> None:
    t = np.linspace(0.0, 400.0, 4001)  # over some forty blocks
    whole = Realisation(DENSITY, RATE, 5, 3)
    for integral in (0, 1, 2):
        together = whole.at(t, integral)
        backwards, again = Realisation(DENSITY, RATE, 5, 3), pickle.loads(pickle.dumps(whole))
        one_by_one = [backwards.at(t[i : i + 1], integral)[0] for i in range(t.size - 1, -1, -40)]
        assert one_by_one == together[::-40].tolist()
        assert again.at(t[1234:1235], integral)[0] == together[1234]


def test_integrated_taps_end_where_they_began() -> None:
    for taps in integrated(taps_for(DENSITY, RATE), RATE):
        assert np.max(np.abs(taps[[0, -1]])) < 1e-7 * np.max(np.abs(taps))


def test_blocks_of_ramps_are_one_signal() -> None:
    one, other = (
        Realisation(Density((20.0, top), (1.0, 1.0)), 8 * top, 3, part) for part, top in ((0, 200.0), (1, 130.0))
    )
    end = 10.3
    record = RecordedForce(LoadShape.at(1.0), np.array([0.0, 0.013, 7.7, end]), np.array([0.0, 3.0, -2.0, 1.0]))
    blocks = RampBlocks(
        (RandomForce(LoadShape.along(0.0, 1.0), one, 2.0), RandomForce(LoadShape.at(0.5), other, -1.0), record)
    )
    assert blocks.end == end
    t, edges = np.sort(np.random.default_rng(1).uniform(0, end, 5000)), []
    block = blocks.block_at(0.0)
    while True:
        assert np.all(np.diff(block.time) > 0)
        edges.append(block.end)
        if block.end == blocks.end:
            break
        after = blocks.block_at(block.end)
        assert after.time[0] == block.end
        assert np.array_equal(after.force[0], block.force[-1])
        block = after
    assert np.allclose(edges[:-1], KNOTS / 1600.0 * np.arange(1, len(edges)))
    assert blocks.block_at(end) is block
    force, slope = blocks.at(t)
    expected = np.stack([2 * one.at(t), -other.at(t), record.at(t)], axis=1)
    assert np.max(np.abs(force - expected)) < 1e-9 * np.max(np.abs(expected))
    ahead = blocks.at(t + 1e-8)[0]
    smooth = np.array([blocks.until(it) > it + 1e-8 for it in t.tolist()])
    assert np.allclose(((ahead - force) / 1e-8)[smooth], slope[smooth], atol=1e-4 * np.max(np.abs(slope)))
    assert np.array_equal(pickle.loads(pickle.dumps(blocks)).at(t)[0], force)
