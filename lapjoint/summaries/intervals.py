"""Intervals that contain the true value 95 times in a hundred, from nearly independent units.

A unit is a part of a motion that is long compared with the time of correlation, or a whole realisation.

**Means** of values of either sign have the interval of Student's t over the n units.

**Root mean squares**, means of values that are never negative (the largest in a unit, time in contact) and rates of
many events have Student's interval of the reciprocal root of the mean m, to first order.  With the scatter s of the
units and h = t s / (2 m sqrt(n)), it runs from m / (1 + h)^2 to m / (1 - h)^2, and has no upper end if h is 1 or more.
If few hard contacts make up the sum, a mean that is too low comes with a scatter that is too low by a larger factor.
The reciprocal root allows for this; an interval of the logarithm would lie below the truth in one case in ten.

**Rare events**, if fewer than half of the units have `FEW` events or more, have the exact interval of a Poisson count
(Garwood, Biometrika 28, 1936).  Events in clusters count as fewer independent events, by the index of dispersion D of
the units' counts, the variance divided by the mean, but at least 1: N events have the interval of N / D, times D.
Without any event, D is 1.
"""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray

LEVEL = 0.95
"""Probability that an interval holds the true value."""
FEW = 5
"""Number of events in a unit below which events count as rare."""
_TAIL = (1 - LEVEL) / 2


def of_mean(units: FloatArray) -> FloatArray:
    """The interval, (..., 2), of a mean, from the means over units, (U, ...); infinite with fewer than two units."""
    middle = units.mean(axis=0)
    half = _half_width(units)
    return np.stack([middle - half, middle + half], axis=-1)


def of_positive_mean(units: FloatArray) -> FloatArray:
    """The interval, (..., 2), of a mean that is never negative, from the means over units, (U, ...)."""
    middle = units.mean(axis=0)
    size = np.where(middle > 0, middle, 1.0)
    h = _half_width(units) / size / 2
    upper = np.where(h < 1, size / np.where(h < 1, 1 - h, 1.0) ** 2, math.inf)
    ends = np.stack([size / (1 + h) ** 2, upper], axis=-1)
    return np.where(middle[..., None] > 0, ends, 0.0)


def of_rms(units: FloatArray) -> FloatArray:
    """The interval, (..., 2), of a root mean square, from the mean squares over units, (U, ...)."""
    return np.sqrt(of_positive_mean(units))


def of_rate(counts: npt.NDArray[Any], duration: float) -> FloatArray:
    """The interval, (..., 2), of events a second, from counts in units, (U, ...), of a duration, s."""
    rare = is_rare(counts)
    often = of_positive_mean(counts / duration)
    return np.where(rare[..., None], _of_rare(counts) / (counts.shape[0] * duration), often)


def is_rare(counts: npt.NDArray[Any]) -> npt.NDArray[np.bool_]:
    """Whether events are so rare that their counts in units, (U, ...), are far from normally distributed."""
    return np.asarray(np.mean(counts >= FEW, axis=0) < 0.5)


def _of_rare(counts: npt.NDArray[Any]) -> FloatArray:
    """The interval of the number of events in all units, shape ``(..., 2)``."""
    from scipy.special import gammaincinv

    total, mean = counts.sum(axis=0), counts.mean(axis=0)
    spread = counts.var(axis=0, ddof=1) if counts.shape[0] > 1 else np.ones_like(mean)
    dispersion = np.maximum(1.0, spread / np.where(mean > 0, mean, 1.0))
    independent = total / dispersion
    low = np.where(total > 0, gammaincinv(np.where(total > 0, independent, 1.0), _TAIL), 0.0)
    return np.stack([dispersion * low, dispersion * gammaincinv(independent + 1.0, 1 - _TAIL)], axis=-1)


def _half_width(units: FloatArray) -> FloatArray:
    """Half the width of Student's interval of the mean, shape ``(...)``."""
    from scipy.special import stdtrit

    number = units.shape[0]
    if number < 2:
        return np.full(units.shape[1:], math.inf)
    return np.asarray(stdtrit(number - 1, 1 - _TAIL) * units.std(axis=0, ddof=1) / math.sqrt(number))
