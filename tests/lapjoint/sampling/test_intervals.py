"""Intervals of probabilities and quantiles hold the true values of beams whose answers are known in closed form."""

from __future__ import annotations

import numpy as np
import pytest
from scipy import stats
from scipy.optimize import brentq

from lapjoint import paper_joint
from lapjoint.problem import FloatArray
from lapjoint.problem.uncertain import Lognormal, UncertainNumber, Uniform
from lapjoint.sampling.design import samples_of
from lapjoint.sampling.intervals import quantile, quantile_interval, share_interval

REPLICATES, N = 500, 256
NODES = np.polynomial.legendre.leggauss(500)
EXCEEDED, QUANTILES = (0.004, 0.02, 0.1, 0.5), (0.05, 0.5, 0.95)
PATHS = ("stops.0.stiffness", "stops.1.stiffness", "stops.2.stiffness", "stops.3.stiffness")


def lognormal(name: str, path: str, deviation: float) -> Lognormal:
    return Lognormal(name=name, paths=(path,), apply="factor", kind="lognormal", mean=1.0, deviation=deviation)


class Cantilever:
    """Deflection P L^3 / (3 E I) of a tip under P, with I = b h^3 / 12: of lognormal variables, itself lognormal."""

    deviations = (0.2, 0.02, 0.08, 0.03)
    powers = np.array([1.0, 3.0, -1.0, -3.0])
    variables: tuple[UncertainNumber, ...] = tuple(
        lognormal(name, path, deviation)
        for name, path, deviation in zip(("P", "L", "E", "h"), PATHS, deviations, strict=True)
    )
    squares = np.log1p(np.array(deviations) ** 2)
    answer = stats.norm(-(powers * squares / 2).sum(), np.sqrt((powers**2 * squares).sum()))

    def values(self, drawn: FloatArray) -> FloatArray:
        return np.log(drawn) @ self.powers

    def limit(self, probability: float) -> float:
        return float(self.answer.isf(probability))


class BarOnAClosedStop:
    """Amplitude of a pinned rigid bar whose tip rests on a stop that never opens, on a shaken base: stiffness K is
    lognormal and the damping ratio uniform, both about a resonance.  The amplitude exceeds a limit for K between two
    roots of a quadratic equation."""

    mass, force, omega = 1.0 / 3.0, 1.0, 30.0
    stiffness = mass * omega**2
    variables: tuple[UncertainNumber, ...] = (
        lognormal("K", PATHS[0], 0.15),
        Uniform(name="zeta", paths=("damping.ratio",), kind="uniform", low=0.02, high=0.08),
    )
    square = np.log1p(0.15**2)
    factor = stats.lognorm(np.sqrt(square), 0, np.exp(-square / 2))

    def values(self, drawn: FloatArray) -> FloatArray:
        K, zeta = drawn[:, 0] * self.stiffness, drawn[:, 1]
        off = K - self.mass * self.omega**2
        return np.asarray(self.force / np.sqrt(off**2 + 4 * zeta**2 * self.omega**2 * self.mass * K))

    def exceeded(self, limit: float) -> float:
        nodes, weights = NODES
        zeta, inertia = 0.05 + 0.03 * nodes, self.mass * self.omega**2
        half = inertia * (1 - 2 * zeta**2)  # K^2 - 2 half K + inertia^2 = (force / limit)^2
        root = np.sqrt(np.maximum(half**2 - inertia**2 + (self.force / limit) ** 2, 0.0))
        ends = [self.factor.cdf((half + sign * root) / self.stiffness) for sign in (1, -1)]
        return float(weights @ (ends[0] - ends[1]) / 2)

    def limit(self, probability: float) -> float:
        return float(brentq(lambda limit: self.exceeded(limit) - probability, 1e-4, 0.2, xtol=1e-12))


BEAMS = [Cantilever(), BarOnAClosedStop()]


def replicates(beam: Cantilever | BarOnAClosedStop) -> list[tuple[FloatArray, np.ndarray]]:
    """The answers at the samples of each seed, and the sets of the samples."""
    problem = paper_joint().replace(uncertain=beam.variables)
    drawn = (samples_of(problem, N, seed=seed) for seed in range(REPLICATES))
    return [(beam.values(np.array(one.values)), np.array(one.sets)) for one in drawn]


def judged(intervals: FloatArray, truth: float, plain: FloatArray) -> None:
    """At least 92 % of the intervals hold the truth, and they are at most 1.2 times as wide as those of plain Monte
    Carlo."""
    held = float(np.mean((intervals[:, 0] <= truth) & (truth <= intervals[:, 1])))
    wide = float(np.diff(intervals).mean() / np.diff(plain).mean())
    assert held >= 0.92, f"{held:.1%} hold {truth:.6g}"
    assert wide <= 1.2, f"{wide:.3f} times as wide"


@pytest.mark.thorough
@pytest.mark.parametrize("beam", BEAMS, ids=lambda beam: type(beam).__name__)
def test_intervals_hold_the_truth_and_are_as_narrow_as_those_of_plain_sampling(
    beam: Cantilever | BarOnAClosedStop,
) -> None:
    found, random = replicates(beam), np.random.default_rng(5)
    problem = paper_joint().replace(uncertain=beam.variables)
    plain = []
    for _ in range(REPLICATES):
        u = random.random((N, len(problem.uncertain)))
        plain.append(beam.values(np.stack([v.quantiles(u[:, i]) for i, v in enumerate(problem.uncertain)], axis=-1)))
    for p in EXCEEDED:
        limit = beam.limit(p)
        ours = np.array([share_interval((values > limit).astype(float), sets) for values, sets in found])
        counts = [int((values > limit).sum()) for values in plain]
        theirs = np.array([stats.binomtest(count, N).proportion_ci(method="exact") for count in counts])
        judged(ours, p, theirs)
    for p in QUANTILES:
        ours = np.array([quantile_interval(values, sets, p) for values, sets in found])
        low = int(stats.binom.ppf(0.025, N, p)) - 1
        high = N - 1 - (int(stats.binom.ppf(0.025, N, 1 - p)) - 1)
        theirs = np.array([np.sort(values)[[low, high]] for values in plain])
        judged(ours, beam.limit(1 - p), theirs)


def test_without_any_exceedance_the_interval_is_that_of_independent_samples() -> None:
    sets = np.repeat(np.arange(8), 32)
    expected = stats.binomtest(0, 256).proportion_ci(method="exact")
    np.testing.assert_allclose(share_interval(np.zeros(256), sets), expected)
    np.testing.assert_allclose(share_interval(np.ones(256), sets), 1 - np.array(expected)[::-1])


def test_equal_shares_of_all_sets_are_not_taken_for_certainty() -> None:
    sets = np.repeat(np.arange(8), 32)
    low, high = share_interval(np.tile([1.0] * 16 + [0.0] * 16, 8), sets)
    assert low < 0.5 - 0.31 / 32  # a share of 0.31 / 32 off is as likely as 5 % to leave 8 equal counts
    assert high > 0.5 + 0.31 / 32


def test_samples_without_an_answer_may_lie_anywhere() -> None:
    sets, values = np.repeat(np.arange(8), 32), np.random.default_rng(2).standard_normal(256)
    lost = values.copy()
    lost[:10] = np.nan
    ends = [np.where(np.isnan(lost), filled, lost) for filled in (-np.inf, np.inf)]
    for p in QUANTILES:
        found = quantile_interval(lost, sets, p)
        assert found == (quantile_interval(ends[0], sets, p)[0], quantile_interval(ends[1], sets, p)[1])
    beyond = np.where(np.isnan(lost), np.nan, (lost > 1.0).astype(float))
    low, high = share_interval(beyond, sets)
    assert low == share_interval((ends[0] > 1.0).astype(float), sets)[0]
    assert high == share_interval((ends[1] > 1.0).astype(float), sets)[1]
    assert quantile_interval(np.full(256, np.nan), sets, 0.5) == (-np.inf, np.inf)
    assert np.isnan(quantile(np.full(4, np.nan), 0.5))


def test_a_quantile_is_the_smallest_value_that_reaches_its_share() -> None:
    assert [quantile(np.arange(1.0, 21.0), p) for p in (0.05, 0.051, 0.5, 0.95, 1.0)] == [1.0, 2.0, 10.0, 19.0, 20.0]


def test_few_samples_do_not_bound_the_edges_of_a_band() -> None:
    sets, values = np.repeat(np.arange(8), 2), np.arange(16.0)
    assert quantile_interval(values, sets, 0.05)[0] == -np.inf
    assert quantile_interval(values, sets, 0.95)[1] == np.inf
