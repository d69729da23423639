"""Sensitivity indices: which uncertain number matters, by SALib.

A first-order index is the share of the variance that vanishes if one number is known; a total index is the share that
remains if all other numbers are known.  Sobol points give first-order indices, by random balance designs; the design of
Saltelli gives both.  Intervals are SALib's, by resampling of the samples.
"""

from __future__ import annotations

import warnings
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import FloatArray
from lapjoint.sampling.bands import LARGEST, Sampled
from lapjoint.sampling.design import DRAWN
from lapjoint.summaries.intervals import LEVEL

if TYPE_CHECKING:
    import xarray as xr

FEWEST = 64
"""Number of Sobol points below which no index is given: random balance designs see 10 harmonics of each number, and
noise alone puts 20 / N of the variance into them."""
_SEED = 1
"""Seed of the resampling."""
_RESAMPLES = 200
"""Number of resamplings: enough for a standard deviation to 5 %."""


def sensitivities(dataset: xr.Dataset, variables: Sequence[str] | None = None) -> xr.Dataset:
    """Sensitivity indices of the variables of a file with samples: of each one's largest value over all swept points.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep with samples.
    variables : sequence of str, optional
        The variables, as ``stress_peak``; by default all that the file has.

    Returns
    -------
    xarray.Dataset
        For each variable ``*_first_order`` over ``uncertain``, with ``*_first_order_error``, half of the width of the
        95 % interval, and the same of ``*_total`` if the samples have Saltelli's design.  NaN where nothing varies, or
        there are fewer than `FEWEST` samples.

    Raises
    ------
    InputError
        If the file has no samples, or lacks a variable, or SALib is not installed.
    """
    import xarray as xr

    try:
        import SALib  # noqa: F401
    except ImportError:
        raise InputError("sensitivities: SALib is not installed; pip install 'lapjoint[sensitivity]'") from None
    of, found = Sampled(dataset), {}
    kinds = ("first_order", "total") if int(dataset.sample_matrix.max()) else ("first_order",)
    for name in [of.variable(one) for one in variables] if variables is not None else of.variables:
        values = of.largest(of.magnitudes(name))
        columns = values.values.reshape(values.shape[0], -1)
        each = np.stack([_indices(of, column) for column in columns.T], axis=-1)  # (kinds, 2, uncertain, columns)
        here = ("uncertain", *values.dims[1:])
        for kind, of_kind in zip(kinds, each, strict=True):
            for ending, indices in zip(("", "_error"), of_kind, strict=True):
                found[f"{name}_{kind}{ending}"] = here, indices.reshape(-1, *values.shape[1:]), {"units": "1"}
    coordinates: dict[str, Any] = {"uncertain": np.array(of.names, dtype=object)}
    kept = {name: dataset[name] for name in ("stop", "stop_name", "x") if name in dataset.coords}
    return xr.Dataset(found, coords=coordinates | kept, attrs={"of": LARGEST if of.swept else ""})


def _indices(of: Sampled, values: FloatArray) -> FloatArray:
    """Indices and half-widths of one output, (kinds, 2, uncertain); samples without an answer are left out, with the
    other samples of their block."""
    from SALib.analyze import rbd_fast, sobol

    dataset, d = of.dataset, len(of.names)
    width = int(dataset.sample_matrix.max()) + 1
    blocks = values.reshape(-1, width)
    whole = ~np.isnan(blocks).any(axis=1)
    kept = blocks[whole]
    if kept.size < FEWEST or np.ptp(kept) == 0:
        return np.full((1 if width == 1 else 2, 2, d), np.nan)
    problem = {"num_vars": d, "names": of.names, "bounds": [[0.0, 1.0]] * d}
    options: dict[str, Any] = {"num_resamples": _RESAMPLES, "conf_level": LEVEL, "seed": _SEED}
    with warnings.catch_warnings(action="ignore"):  # of numpy, where a resampling has no variance
        if width > 1:
            got = sobol.analyze(problem, kept.ravel(), calc_second_order=False, **options)
            return np.array([[got["S1"], got["S1_conf"]], [got["ST"], got["ST_conf"]]], dtype=float)
        drawn = np.stack([dataset[DRAWN + name].values for name in of.names], axis=-1)
        got = rbd_fast.analyze(problem, drawn[whole], kept.ravel(), **options)
        return np.array([[got["S1"], got["S1_conf"]]], dtype=float)
