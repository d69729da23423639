"""The order of convergence that answers show."""

from __future__ import annotations

import math

import numpy as np

from lapjoint.problem.schema import FloatArray

ROUNDING = 1e-12
"""Relative errors up to this are taken for rounding, and say nothing about convergence: it is some 5000 units in the
last place of a number, more than the sums in an answer lose."""


def fitted_order(resolutions: FloatArray, error: FloatArray, floor: float = ROUNDING) -> float:
    """The order p of error ~ N^-p: the slope of the least-squares line through the logarithms.

    Parameters
    ----------
    resolutions : FloatArray, shape (n,)
        Numbers N of elements or modes.
    error : FloatArray, shape (n,)
        Size of the relative error at each.
    floor : float
        Relative errors up to this are left out.

    Returns
    -------
    float
        The order; NaN if fewer than two errors are above `floor`.
    """
    above = error > floor
    if above.sum() < 2:
        return math.nan
    return -float(np.polyfit(np.log(resolutions[above]), np.log(error[above]), 1)[0])
