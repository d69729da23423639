"""95 % intervals of shares and quantiles of samples that lie in independently scrambled sets.

**A share** p of samples beyond a limit has the interval of Clopper and Pearson (1934) for the number of independent
samples that tell as much: N divided by the design effect (Korn and Graubard, 1998).  The design effect is the variance
of the mean of the sets' shares, from their scatter, over p (1 - p) / N.  Equal shares of all sets show no scatter, but
say no more than that a set of n points knows the share to about a point: the variance of a set's share is therefore
taken as at least 1 / (4 n^2), that of one point on either side of the limit with equal probability.  The few degrees of
freedom of the scatter widen the interval as Student's t is wider than that of N independent samples.  If fewer samples
than sets lie on one side, the scatter tells nothing, and all samples count as independent.

**A quantile** of probability p has the interval of Woodruff (1952): from the value with so many samples below it as the
interval of the share p begins with, to the value with so many above it as that interval leaves.

A sample without an answer may lie anywhere: at the lower end of an interval it counts as the smallest value, at the
upper end as the largest.
"""

from __future__ import annotations

import numpy as np

from lapjoint.problem import FloatArray
from lapjoint.problem.schema import IntArray
from lapjoint.summaries.intervals import LEVEL

_TAIL = (1 - LEVEL) / 2


def share_interval(beyond: FloatArray, sets: IntArray) -> tuple[float, float]:
    """The interval of a probability.

    Parameters
    ----------
    beyond : FloatArray, shape (N,)
        1 for each sample beyond the limit, 0 for the others, NaN for samples without an answer.
    sets : IntArray, shape (N,)
        The set of each sample.

    Returns
    -------
    tuple of float
        Its ends, from 0 to 1.
    """
    ends = [np.where(np.isnan(beyond), filled, beyond) for filled in (0.0, 1.0)]
    low, high = (_clopper_pearson(float(end.mean()), _independent(end, sets)) for end in ends)
    return low[0], high[1]


def quantile(values: FloatArray, probability: float) -> float:
    """The smallest value that at least a share `probability` of the values, (N,), without NaN, does not exceed; NaN of
    none."""
    known = np.sort(values[~np.isnan(values)])
    return float(known[max(0, int(np.ceil(probability * known.size - 1e-9)) - 1)]) if known.size else np.nan


def quantile_interval(values: FloatArray, sets: IntArray, probability: float) -> tuple[float, float]:
    """The interval of a quantile.

    Parameters
    ----------
    values : FloatArray, shape (N,)
        Values of the samples, NaN for samples without an answer.
    sets : IntArray, shape (N,)
        The set of each sample.
    probability : float
        Probability below the quantile, between 0 and 1.

    Returns
    -------
    tuple of float
        Its ends, infinite where the samples do not bound them.
    """
    ends = []
    for side, filled in enumerate((-np.inf, np.inf)):
        whole = np.where(np.isnan(values), filled, values)
        independent = _independent((whole <= quantile(whole, probability)).astype(float), sets)
        share = _clopper_pearson(probability, independent)[side]
        outside = int((share if side == 0 else 1 - share) * whole.size + 1e-9)
        ranked = np.concatenate([[-np.inf], np.sort(whole), [np.inf]])
        ends.append(float(ranked[outside if side == 0 else -1 - outside]))
    return ends[0], ends[1]


def _independent(beyond: FloatArray, sets: IntArray) -> float:
    """The number of independent samples that tell as much about the share of samples, 0 or 1 each, (N,), which is the
    mean of the shares of the sets."""
    from scipy.special import stdtrit

    share, size, count = float(beyond.mean()), beyond.size, int(sets.max()) + 1
    if min(share, 1 - share) * size < count:
        return float(size)
    shares = np.bincount(sets, weights=beyond) / np.bincount(sets)
    variance = max(float(shares.var(ddof=1)), 0.25 * (count / size) ** 2) / count
    freedom = stdtrit(size - 1, 1 - _TAIL) / stdtrit(count - 1, 1 - _TAIL)
    return float(share * (1 - share) / variance * freedom**2)


def _clopper_pearson(share: float, size: float) -> tuple[float, float]:
    """The interval of a probability of which `size` independent samples, not necessarily a whole number, show a
    `share`."""
    from scipy.special import betaincinv

    count = share * size
    low = 0.0 if share == 0 else float(betaincinv(count, size - count + 1, _TAIL))
    high = 1.0 if share == 1 else float(betaincinv(count + 1, size - count, 1 - _TAIL))
    return low, high
