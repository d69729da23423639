"""The order of convergence observed in answers."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.problem.schema import FloatArray

ROUNDING = 1e-12
"""Largest relative error that counts as rounding, and is left out of the fit: some 5000 units in the last place, more
than the sums in an answer lose."""


def fitted_order(resolutions: FloatArray, error: FloatArray, floor: float = ROUNDING) -> float:
    """The order p of error ~ N^-p over resolutions N, both (n,): the slope of the least-squares line of the logarithms.

    Relative errors up to `floor` are left out; with fewer than two others, the order is NaN.
    """
    above = error > floor
    if above.sum() < 2:
        return math.nan
    return -float(np.polyfit(np.log(resolutions[above]), np.log(error[above]), 1)[0])
