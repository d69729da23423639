"""Printing of bands, probabilities and sensitivities by the command line, in 80 columns, and their content as JSON."""

from __future__ import annotations

from itertools import product
from textwrap import fill
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import written
from lapjoint.cli.echo import echo
from lapjoint.cli.printing import COLUMNS, NAME_SHOWN
from lapjoint.figures.sweep_axes import with_unit
from lapjoint.figures.text import cut_to, plain
from lapjoint.sampling.bands import LARGEST, Sampled
from lapjoint.sampling.design import SETS
from lapjoint.summaries.blocks import shown

if TYPE_CHECKING:
    import xarray as xr

_FIRST = 26
"""Width of the first column, characters."""
_DIGITS = 4
"""Significant digits that are printed."""
_PLACES_SHOWN = 8
"""Largest number of stops or places of a variable that are printed; JSON has all."""


def print_uncertainty(of: Sampled, found: xr.Dataset, indices: xr.Dataset, names: tuple[str, ...]) -> None:
    """Print the samples, and of each variable its bands, its probabilities of exceedance and its sensitivities."""
    attrs = found.attrs
    echo(plain(str(attrs["title"])))
    echo(f"{attrs['samples']} samples of {', '.join(of.names)}, in {SETS} independent sets")
    for line in _doubts(attrs):
        echo(fill(line, COLUMNS))
    for name in names:
        whole = LARGEST + name if of.swept else name
        over = ", largest over all swept points" if of.swept else ""
        echo(f"\n{name} [{written(str(found[f'{name}_quantile'].units))}]{over}")
        own = "numerical range" if "outcome" in of.dataset else "range by intervals"
        echo(f"{'':<{_FIRST}}{'':>11}{'95 % by sampling':>22}{own:>21}")
        for place, at in _places(found, whole):
            for i, p in enumerate(found.probability.values):
                label = f"{place} {100 * p:g} %".strip()
                echo(_row(label, found, f"{whole}_quantile", {"probability": i, **at}))
            if f"{whole}_exceedance" in found:
                limit = found[f"{whole}_exceedance"].limit
                echo(_row(f"{place} P(> {limit:.4g})".strip(), found, f"{whole}_exceedance", at))
                if of.swept:
                    worst = {**at, **_worst(found[f"{name}_exceedance"].isel(at))}
                    echo(_row(f"  {_where(found, worst, of.swept)}", found, f"{name}_exceedance", worst))
        _print_indices(indices, name)


def summary(found: xr.Dataset, indices: xr.Dataset) -> dict[str, Any]:
    """The content of a JSON file: coordinates, and units, dimensions and values of each variable."""
    variables = {}
    for name, values in [*found.data_vars.items(), *indices.data_vars.items()]:
        entry = {str(key): value for key, value in values.attrs.items()}
        variables[str(name)] = {**entry, "over": [str(one) for one in values.dims], "values": values.values.tolist()}
    coordinates = {str(name): value.values.tolist() for name, value in [*found.coords.items(), *indices.coords.items()]}
    return {**found.attrs, "coordinates": coordinates, "variables": variables}


def _doubts(attrs: dict[str, Any]) -> list[str]:
    """Sentences that count what has no answer, or no certain one."""
    found, points = [], attrs["points"]
    if attrs["failed"]:
        found.append(
            f"{attrs['failed']} of {points} points have no answer: their values may lie anywhere, and the intervals "
            "allow for that."
        )
    if attrs.get("undecided"):
        found.append(f"{attrs['undecided']} of {points} points are undecided: their values may be of a transient.")
    wandering = attrs.get("aperiodic", 0) + attrs.get("quasiperiodic", 0)
    if wandering:
        found.append(f"{wandering} of {points} points do not repeat: their peaks are those of a finite time.")
    return found or [f"All {points} points have an answer."]


def _places(found: xr.Dataset, name: str) -> list[tuple[str, dict[str, int]]]:
    """The stops or places of a variable: a label, and the indices by dimension."""
    dims = [dim for dim in found[f"{name}_quantile"].dims if dim != "probability"]
    if not dims:
        return [("", {})]
    sizes = [range(found.sizes[dim]) for dim in dims]
    every = [dict(zip(map(str, dims), at, strict=True)) for at in product(*sizes)]
    return [(_place(found, at), at) for at in every[:_PLACES_SHOWN]]


def _place(found: xr.Dataset, at: dict[str, int]) -> str:
    words = []
    for dim, i in at.items():
        if dim == "stop":
            words.append(cut_to(str(found.stop_name.values[i]), NAME_SHOWN // 2))
        else:
            words.append(f"{dim} = {found[dim].values[i]:.4g}" if dim in found.coords else f"{dim} {i}")
    return ", ".join(words)


def _worst(values: xr.DataArray) -> dict[str, int]:
    """The indices of the swept point with the largest value."""
    where = np.unravel_index(int(np.nanargmax(np.nan_to_num(values.values, nan=-1.0))), values.shape)
    return {str(dim): int(i) for dim, i in zip(values.dims, where, strict=True)}


def _where(found: xr.Dataset, at: dict[str, int], swept: tuple[str, ...]) -> str:
    parts = [with_unit(found, dim, found[dim].values[at[dim]]) for dim in swept]
    return "at " + ", ".join(parts)


def _row(label: str, found: xr.Dataset, name: str, at: dict[str, int]) -> str:
    value, ends = float(found[name].isel(at)), found[f"{name}_interval"].isel(at).values
    numerical = found[f"{name}_numerical"].isel(at).values if f"{name}_numerical" in found else [np.nan]
    texts = (f"{shown(number, _DIGITS):>11}" for number in (value, *ends, *numerical))
    return f"{cut_to(label, _FIRST):<{_FIRST}}" + "".join(texts)


def _print_indices(indices: xr.Dataset, name: str) -> None:
    """Print the sensitivity indices of a variable; of several stops or places, their mean."""
    kinds = [kind for kind in ("first_order", "total") if f"{name}_{kind}" in indices]
    if not kinds:
        return
    echo(f"{'share of the variance':<{_FIRST}}" + "".join(f"{kind.replace('_', ' '):>26}" for kind in kinds))
    means = {}
    for kind in kinds:
        for ending in ("", "_error"):
            values = indices[f"{name}_{kind}{ending}"]
            means[kind + ending] = values.mean([dim for dim in values.dims if dim != "uncertain"]).values
    for i in np.argsort(-np.nan_to_num(means[kinds[-1]])):
        row = "".join(f"{_share(means[kind][i]):>14} +- {_share(means[f'{kind}_error'][i]):<8}" for kind in kinds)
        echo(f"{cut_to(str(indices.uncertain.values[i]), _FIRST - 2):<{_FIRST}}{row}".rstrip())


def _share(value: float) -> str:
    return f"{value:.2f}" if np.isfinite(value) else "?"
