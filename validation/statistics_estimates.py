"""Values of `lapjoint.statistics` as estimates, and intervals that are to hold together."""

from __future__ import annotations

from statistics import NormalDist

import numpy as np
import xarray as xr

from validation.verdict import Estimate


def joint_factor(count: int, level: float) -> float:
    """By how much an interval is wider if `count` of them are to hold together, as often as each alone (Bonferroni)."""
    each = NormalDist()
    return each.inv_cdf(1 - (1 - level) / (2 * count)) / each.inv_cdf((1 + level) / 2)


def estimate_of(found: xr.Dataset, variable: str, factor: float, smeared: float, **where: object) -> Estimate:
    """A value of a dataset of statistics, with its interval as uncertainty."""
    value = found[variable].sel(where, method="nearest") if "x" in where else found[variable].isel(where)
    both = found[f"{variable}_interval"]
    both = both.sel(where, method="nearest") if "x" in where else both.isel(where)
    half = float(np.abs(both.values - float(value)).max())
    units = f"{found.attrs['units']} units of {found.attrs['unit_duration']:.3g} s"
    how = f"{found.attrs['solver']}, {units}, interval widened by {factor:.2f}"
    return Estimate(float(value), factor * half + smeared * abs(float(value)), how)
