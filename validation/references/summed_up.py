"""Statistics of a motion summed up in the plainest way: densely and evenly, by numpy and scipy alone.

The motion is given as samples and as a list of its contacts, all at once; the project keeps it in stretches and adds up
streams.  Intervals are those of the textbooks: Student's t over batches, of the reciprocal root where a number is never
negative, and Garwood's for counts (Biometrika 28, 1936).
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
from scipy import stats

Array = npt.NDArray[np.float64]
LEVEL = 0.95
"""Probability of an interval."""
RARE = 5
"""Events in a batch; counts are rare where most batches have fewer."""


@dataclass(frozen=True)
class Touch:
    """A contact."""

    stop: int
    """Index of the stop."""
    start: float
    """Start, s."""
    end: float
    """End, s."""
    impulse: float
    """Impulse, N s."""
    peak: float
    """Largest force, N."""
    speed: float
    """Speed towards the stop at the start of the contact, m/s."""


def scatter(values: Array, step: float, spacing: float) -> tuple[float, float]:
    """Mean of dense, even samples `step` s apart, shape (m,), and how far the mean of fewer samples may be from it, in
    the unit of the values.

    One sample is taken in each of n intervals of length `spacing`, s, at a place that is as good as random: then the
    error of the mean has a standard deviation of (mean square of the rate of change)^(1/2) spacing / sqrt(12 n) or
    less.
    """
    number = values.size * step / spacing
    rate = math.sqrt(float(np.mean(np.diff(values) ** 2))) / step
    return float(values.mean()), rate * spacing / math.sqrt(12 * number)


def student(batches: Array) -> Array:
    """Interval of a mean, shape (2,), by Student's t from independent batch means, shape (n,)."""
    low, high = stats.t.interval(LEVEL, batches.size - 1, loc=batches.mean(), scale=stats.sem(batches))
    return np.array([low, high])


def of_reciprocal_root(batches: Array) -> Array:
    """Interval of the mean of a number that is never negative, shape (2,), from batch means, shape (n,): Student's t of
    y = mean^(-1/2), with dy = -mean^(-3/2) / 2 d(mean)."""
    mean = batches.mean()
    y = mean**-0.5 - mean**-1.5 / 2 * (student(batches) - mean)
    return np.asarray([end**-2.0 if end > 0 else math.inf for end in y])


def of_counts(counts: Array) -> Array:
    """Interval of the mean of counts, events a batch, shape (2,), from the events in each batch, shape (n,): Garwood's
    where they are rare, with as many events as are independent."""
    if np.mean(counts >= RARE) >= 0.5:
        return of_reciprocal_root(counts)
    clusters = max(1.0, float(np.var(counts, ddof=1)) / counts.mean()) if counts.sum() else 1.0
    number = counts.sum() / clusters
    low = stats.chi2.ppf((1 - LEVEL) / 2, 2 * number) / 2 if number else 0.0
    high = stats.chi2.ppf((1 + LEVEL) / 2, 2 * (number + 1)) / 2
    return clusters / counts.size * np.array([low, high])


def shared(touches: list[Touch], edges: Array, stop: int) -> Array:
    """The time that a stop is touched in each batch, s, shape (n,), whose ends are `edges`, s, shape (n + 1,)."""
    found = np.zeros(edges.size - 1)
    for it in touches:
        if it.stop == stop:
            found += np.clip(np.minimum(it.end, edges[1:]) - np.maximum(it.start, edges[:-1]), 0.0, None)
    return found
