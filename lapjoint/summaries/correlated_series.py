r"""Means of correlated series: their standard errors by blocking, and a weighted mean that converges fast.

The plain standard error treats neighbours as independent, and is too small if they are correlated.  Blocking (H.
Flyvbjerg and H. G. Petersen, J. Chem. Phys. 91 (1989) 461) averages blocks of growing length L. The standard error s(L)
from the scatter of the means rises until L exceeds the time of correlation, then levels off.  There are `_BLOCKS` of
the longest blocks.  If s has risen from blocks a quarter as long to these, s is taken to rise by the same factor again,

    s = s(L) max(1, s(L) / s(L / 4)),

by at most a factor of 2, which holds for blocks whose neighbours are equal.  The error of an AR(1) series is then right
even if L is only its time of correlation.

The plain mean over a quasi-periodic motion converges as 1/n.  With the weights w(t) = exp(-1 / (t (1 - t))), 0 < t < 1,
the mean over a smooth quasi-periodic motion converges faster than any power (S. Das, Y. Saiki, E. Sander and J. Yorke,
Nonlinearity 30 (2017) 4111), and the mean over chaos little slower than without weights.
"""

from __future__ import annotations

import numpy as np

from lapjoint.problem import FloatArray

_BLOCKS = 16
"""Number of the longest blocks: their mean follows Student's t with 15 degrees of freedom, and has an error of more
than two standard errors in 6 % of cases."""


def standard_error(series: FloatArray) -> float:
    """Standard error of the mean of a correlated series, (n,), n at least 64, in the order of time, by blocking."""
    scale = 2.0 ** int(np.frexp(np.max(np.abs(series)))[1])  # so that squares neither overflow nor vanish
    short, long = (scale * _blocked(series / scale, count) for count in (4 * _BLOCKS, _BLOCKS))
    return long * float(np.clip(long / short, 1.0, 2.0)) if short > 0 else long


def weighted_mean(series: FloatArray) -> float:
    """Weighted Birkhoff average of a series, (n,), in the order of time."""
    t = (np.arange(series.size) + 0.5) / series.size
    return float(np.average(series, weights=np.exp(-1 / (t * (1 - t)))))


def _blocked(series: FloatArray, count: int) -> float:
    """Standard error of the mean if the means of `count` blocks were independent."""
    means = [block.mean() for block in np.array_split(series, count)]
    return float(np.std(means, ddof=1) / np.sqrt(count))
