"""What the samples of a file show: bands, and probabilities of exceeding limits, with their sampling errors.

Each value of a sample has an error of its own, if the file has it: a numerical error, or the interval of statistics.
A band or a probability then is computed twice more, with all values at the lower and at the upper ends of their errors;
that shows what these errors change.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.files.flags import flag_names
from lapjoint.problem import FloatArray
from lapjoint.problem.schema import IntArray
from lapjoint.sampling.design import DRAWN, SAMPLE
from lapjoint.sampling.intervals import quantile, quantile_interval, share_interval
from lapjoint.summaries.table import interval_ends

if TYPE_CHECKING:
    import xarray as xr

PROBABILITIES = (0.05, 0.5, 0.95)
"""Probabilities of the quantiles that bound a band, and of its middle."""
LARGEST = "largest_"
"""Beginning of the names of what belongs to the largest value of each sample over all swept points."""


@dataclass(frozen=True)
class Sampled:
    """A file of a campaign with samples."""

    dataset: xr.Dataset

    def __post_init__(self) -> None:
        if SAMPLE not in self.dataset.dims:
            raise InputError("the file has no samples; `--samples` of a sweep, or of statistics, draws some")
        if "start" in self.dataset.dims:
            raise InputError("the file has several starts at each point, and bands are those of one motion at each")

    @property
    def names(self) -> list[str]:
        """Names of the uncertain numbers."""
        return [str(name).removeprefix(DRAWN) for name in self.dataset.coords if str(name).startswith(DRAWN)]

    @cached_property
    def independent(self) -> IntArray:
        """The samples, by number, whose values have the distribution of the uncertain numbers and are independent from
        set to set: all, or the points A and B of Saltelli's design."""
        matrices = self.dataset.sample_matrix.values
        return np.flatnonzero((matrices == 0) | (matrices == matrices.max()))

    @property
    def swept(self) -> tuple[str, ...]:
        """Names of the swept dimensions."""
        return tuple(str(name) for name in self.dataset["outcome"].dims[1:]) if "outcome" in self.dataset else ()

    @property
    def variables(self) -> tuple[str, ...]:
        """Names of the variables that have a value for each sample."""
        found = [str(name) for name, values in self.dataset.data_vars.items() if self._is_value(str(name), values)]
        return tuple(found)

    @property
    def usual(self) -> tuple[str, ...]:
        """Names of the variables that are shown if none is named: all of a sweep; of statistics, which have some forty,
        peaks, contacts a second, and damage."""
        if "outcome" in self.dataset:
            return self.variables
        rates = ("contact_rate", "damage_rate")
        return tuple(name for name in self.variables if name.endswith("_peak") or name in rates)

    def _is_value(self, name: str, values: xr.DataArray) -> bool:
        aside = ("residual", "multiplier_real", "multiplier_imag", "exponent", "standard_error", "duration", "growth")
        ends = ("_error", "_x", "_interval")
        return SAMPLE in values.dims and values.dtype.kind == "f" and name not in aside and not name.endswith(ends)

    def variable(self, name: str) -> str:
        """The variable that a name means: itself, or the peak of a quantity; InputError if the file has neither."""
        for one in (name, f"{name}_peak"):
            if one in self.variables:
                return one
        there = ", ".join(self.variables)
        more = "--summary of a sweep" if "outcome" in self.dataset else "--quantity of statistics"
        raise InputError(f"variable {name!r}: is not in this file, which has {there}; {more} adds more")

    def magnitudes(self, name: str) -> xr.DataArray:
        """The magnitudes of a variable, the samples first."""
        return abs(self.dataset[name]).transpose(SAMPLE, ...)

    def ends(self, name: str) -> tuple[xr.DataArray, xr.DataArray] | None:
        """The least and the largest magnitude that each value can have by its error, or by its interval, that the file
        states; an unknown error is infinite.  None if the file has neither of this variable."""
        values = self.magnitudes(name)
        if f"{name}_error" in self.dataset:
            errors = self.dataset[f"{name}_error"].transpose(*values.dims).fillna(np.inf)
            return (values - errors).clip(0.0), values + errors
        if f"{name}_interval" in self.dataset:
            both = self.dataset[f"{name}_interval"].transpose(*values.dims, "bound")
            low, high = both.isel(bound=0).fillna(-np.inf), both.isel(bound=1).fillna(np.inf)
            least, most = low.clip(0.0) - high.clip(max=0.0), abs(both).max("bound", skipna=False).fillna(np.inf)
            return least.where(values.notnull()), most.where(values.notnull())
        return None

    def largest(self, values: xr.DataArray) -> xr.DataArray:
        """The largest value of each sample over all swept points; NaN if one of them has no answer."""
        return values.max(dim=self.swept, skipna=False)


def bands(
    dataset: xr.Dataset, limits: Mapping[str, float] | None = None, variables: Sequence[str] | None = None
) -> xr.Dataset:
    """Bands of the variables of a file with samples, and probabilities of exceeding limits.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep, or of statistics, with samples.
    limits : mapping, optional
        Limits of the magnitude of variables, in their SI units, by names as ``stress_peak``, or ``stress`` for short.
    variables : sequence of str, optional
        The variables; by default all that the file has, or those with limits if there are any.

    Returns
    -------
    xarray.Dataset
        For each variable ``*_quantile`` over ``probability``, and for each limit ``*_exceedance``: each with
        ``*_interval`` (95 %, sampling error alone) and, if the file has errors, ``*_numerical`` (the range within
        which numerical errors, or of statistics the intervals of the samples, can move it).  The same with
        ``largest_`` in front belongs to the largest value over all swept points.

    Raises
    ------
    InputError
        If the file has no samples, or lacks a variable.
    """
    import xarray as xr

    of = Sampled(dataset)
    chosen = {of.variable(name): _limit(name, value) for name, value in (limits or {}).items()}
    names = [of.variable(name) for name in variables] if variables is not None else list(chosen or of.variables)
    found: dict[str, Any] = {}
    for name in dict.fromkeys([*names, *chosen]):
        values, ends = of.magnitudes(name), of.ends(name)
        units = str(dataset[name].attrs.get("units", "1"))
        found |= _read_off(of, name, units, values, ends, chosen.get(name))
        if of.swept:
            over = None if ends is None else (of.largest(ends[0]), of.largest(ends[1]))
            found |= _read_off(of, LARGEST + name, units, of.largest(values), over, chosen.get(name))
    coordinates = {
        "probability": ("probability", list(PROBABILITIES), {"units": "1", "long_name": "probability below"}),
        "bound": interval_ends(),
    }
    kept = {name: dataset[name] for name in (*of.swept, "stop", "stop_name", "x") if name in dataset.coords}
    attributes = {"title": str(dataset.attrs.get("title", "")), "samples": int(of.independent.size), **_counts(of)}
    return xr.Dataset(found, coords=coordinates | kept, attrs=attributes)


def _limit(name: str, value: float) -> float:
    if not value > 0 or not np.isfinite(value):
        raise InputError(f"limit {name} = {value!r}: must be positive and finite; it bounds the magnitude")
    return float(value)


def _counts(of: Sampled) -> dict[str, int]:
    """Number of points of all samples, and of those with each outcome that makes a number doubtful."""
    if "outcome" not in of.dataset:
        failed = of.dataset["failed"].values[of.independent] if "failed" in of.dataset else np.zeros(0)
        return {"points": int(of.independent.size), "failed": int((failed > 0).sum())}
    outcome = of.dataset.outcome.values[of.independent]
    codes = {name: code for code, name in flag_names(of.dataset.outcome.attrs).items()}
    doubtful = ("failed", "undecided", "aperiodic", "quasiperiodic")
    return {"points": int(outcome.size), **{name: int((outcome == codes[name]).sum()) for name in doubtful}}


def _read_off(
    of: Sampled,
    name: str,
    units: str,
    values: xr.DataArray,
    ends: tuple[xr.DataArray, xr.DataArray] | None,
    limit: float | None,
) -> dict[str, Any]:
    """The variables of the answer that belong to one variable of the file."""
    here, sets = tuple(str(one) for one in values.dims[1:]), of.dataset.sample_set.values[of.independent]
    middle = values.values[of.independent]
    outer = [] if ends is None else [end.values[of.independent] for end in ends]
    dims = ("probability", *here)

    def with_bounds(each: list[FloatArray]) -> FloatArray:
        return np.stack(each, axis=-1)

    found: dict[str, Any] = {
        f"{name}_quantile": (dims, np.stack([_quantiles(middle, p) for p in PROBABILITIES]), {"units": units})
    }
    intervals = [np.apply_along_axis(quantile_interval, 0, middle, sets, p) for p in PROBABILITIES]
    found[f"{name}_quantile_interval"] = (*dims, "bound"), np.moveaxis(np.stack(intervals), 1, -1), {"units": units}
    if outer:
        moved = np.stack([with_bounds([_quantiles(end, p) for end in outer]) for p in PROBABILITIES])
        found[f"{name}_quantile_numerical"] = (*dims, "bound"), moved, {"units": units}
    if limit is None:
        return found
    attributes = {"units": "1", "limit": limit, "limit_units": units}
    found[f"{name}_exceedance"] = here, _shares(middle, limit), attributes
    interval = np.apply_along_axis(share_interval, 0, _beyond(middle, limit), sets)
    found[f"{name}_exceedance_interval"] = (*here, "bound"), np.moveaxis(interval, 0, -1), attributes
    if outer:
        moved = with_bounds([_shares(end, limit) for end in outer])
        found[f"{name}_exceedance_numerical"] = (*here, "bound"), moved, attributes
    return found


def _quantiles(values: FloatArray, probability: float) -> FloatArray:
    """The quantile over samples, (N, ...), of each column: shape (...)."""
    return np.asarray(np.apply_along_axis(quantile, 0, values, probability))


def _beyond(values: FloatArray, limit: float) -> FloatArray:
    """1 where a value exceeds the limit, 0 where it does not, NaN where there is none."""
    return np.where(np.isnan(values), np.nan, (values > limit).astype(float))


def _shares(values: FloatArray, limit: float) -> FloatArray:
    """The share of the samples with an answer, (N, ...), that exceed the limit: shape (...); NaN of none."""
    known = np.sum(~np.isnan(values), axis=0)
    return np.where(known > 0, np.sum(values > limit, axis=0) / np.maximum(known, 1), np.nan)
