r"""The largest Lyapunov exponent from the growth of a deviation in each period.

Growths in neighbouring periods are correlated, in weak chaos over many periods, so the standard error is computed by
blocking.  Weighted means over the quarters of a measurement tell quasi-periodic motion from chaos.
`lapjoint.summaries.correlated_series` has both.
"""

from __future__ import annotations

import numpy as np

from lapjoint.answers.steady_state import Exponent
from lapjoint.problem import FloatArray
from lapjoint.summaries.correlated_series import standard_error, weighted_mean


def exponent_of(growth: FloatArray, period: float) -> Exponent:
    """The largest Lyapunov exponent from the logarithms of a deviation's growth in each period, (n,), n at least 64."""
    rates = growth / period
    first, second = np.array_split(rates, 2)
    return Exponent(
        value=float(rates.mean()),
        standard_error=standard_error(rates),
        periods=rates.size,
        time=rates.size * period,
        halves=(float(first.mean()), float(second.mean())),
        quarters=tuple(weighted_mean(part) for part in np.array_split(rates, 4)),
    )


def largest_growth(growth: FloatArray) -> float:
    """Largest factor, 1 to 1e304, by which a deviation grows from a section point to a later one; see `exponent_of`."""
    size = np.concatenate([[0.0], np.cumsum(growth)])
    rise = float(np.max(size - np.minimum.accumulate(size)))
    return float(np.exp(min(rise, 700.0)))
