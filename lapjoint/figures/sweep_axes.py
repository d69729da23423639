"""The swept fields of a sweep's dataset: their names, units and values.

A field is a varied parameter of the problem.  A figure shows at most two swept fields, and further fields at their
first value.
"""

from __future__ import annotations

import math
from collections.abc import Hashable, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import written
from lapjoint.errors import InputError
from lapjoint.figures.text import cut_to, literal
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr

_LONGEST = 20
"""Largest number of characters of a stop's name within the name of its field, to keep labels short."""
_MEMBERS = {"stops": "stop", "supports": "support", "masses": "mass"}
"""Lists of a problem, and the word for one member."""


def in_hertz(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with its frequencies in Hz, for figures and tables.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep, of branches, of a confirmation or of basins.

    Returns
    -------
    xarray.Dataset
        The dataset with variables in Hz in place of rad/s.
    """
    turned = {name: value for name, value in dataset.variables.items() if value.attrs.get("units") == "rad s-1"}
    swept = {value.attrs["path"] for value in turned.values() if "path" in value.attrs}
    range_turned = dataset.attrs.get("path") in swept and "range" in dataset.attrs
    found = dataset.assign_coords({name: _hertz(one) for name, one in turned.items() if name in dataset.coords})
    found = found.assign({name: _hertz(one) for name, one in turned.items() if name in dataset.data_vars})
    return found.assign_attrs(range=np.asarray(dataset.attrs["range"]) / (2 * math.pi)) if range_turned else found


def _hertz(variable: xr.Variable) -> tuple[tuple[Hashable, ...], FloatArray, dict[str, Any]]:
    """A variable of angular frequencies, rad/s, as its dimensions, its values in Hz, and its attributes."""
    text = str(variable.attrs.get("long_name", "")).replace("angular frequency", "frequency")
    attrs = {**variable.attrs, "units": "Hz", "long_name": text.replace("angular_frequency", "frequency")}
    return variable.dims, variable.values / (2 * math.pi), attrs


def refuse_samples(dataset: xr.Dataset, file: str = "FILE") -> None:
    """InputError if a dataset has samples, which are no curves; `file` is its file."""
    if "sample" in dataset.dims:
        raise InputError(f"{file}: has samples of uncertain numbers; `lapjoint uncertainty {file} --figure` draws them")


def in_order(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with ascending values of the first two swept fields, and only the first value of further fields;
    InputError if it has samples."""
    refuse_samples(dataset)
    names = [name for name in dataset.outcome.dims if name != "start"]
    return dataset.sortby(names).isel(dict.fromkeys(names[2:], 0))


def fields(dataset: xr.Dataset) -> tuple[str, str | None]:
    """The names of the first swept field and of the second, which is None if there is only one."""
    names = [str(name) for name in dataset.outcome.dims if name != "start"]
    return names[0], names[1] if len(names) > 1 else None


def check_one_axis(sweeps: Mapping[str, xr.Dataset]) -> None:
    """InputError, which names two sweeps, if the first swept fields of sweeps are not the same, in the same unit."""
    said = {name: axis_label(one, fields(one)[0]) for name, one in sweeps.items()}
    first = next(iter(said))
    for name, here in said.items():
        if here != said[first]:
            raise InputError(f"{name}: is over {here}, and {first} over {said[first]}; one figure has one axis")


def constant_fields(dataset: xr.Dataset) -> list[str]:
    """The fields that have one value in the whole dataset of `in_order`, each as ``gap (all stops) = 0.001 m``."""
    return [
        f"{short_name(dataset, str(name))} = {with_unit(dataset, str(name), value.item())}"
        for name, value in dataset.coords.items()
        if value.ndim == 0
    ]


def each_line(values: xr.DataArray, second: str | None) -> list[FloatArray]:
    """Values over the first swept field, (n,) or (n, starts), for each value of the second field, if there is one."""
    if second is None:
        return [values.values]
    return [values.isel({second: i}).values for i in range(values.sizes[second])]


def cell_edges(values: FloatArray) -> FloatArray:
    """The edges of the cells around ascending values, (n,), half-way between them: shape (n + 1,)."""
    if values.size == 1:
        return np.array([values[0] - 0.5, values[0] + 0.5])
    middles = (values[1:] + values[:-1]) / 2
    return np.concatenate([[1.5 * values[0] - 0.5 * values[1]], middles, [1.5 * values[-1] - 0.5 * values[-2]]])


def axis_label(dataset: xr.Dataset, name: str) -> str:
    """A swept field and its unit, as the label of an axis."""
    unit = units(dataset, name)
    text = "angular frequency ω" if name == "angular_frequency" and unit == "rad/s" else short_name(dataset, name)
    return literal(f"{text} [{unit}]")


def units(dataset: xr.Dataset, name: str) -> str:
    """The unit of a swept field, as figures write it: ``rad/s``, or ``-`` for a field without a dimension."""
    unit = str(dataset[name].units)
    return "-" if unit == "1" else written(unit)


def with_unit(dataset: xr.Dataset, name: str, value: float, digits: int = 4) -> str:
    """A value of a swept field with its unit: ``515 rad/s``."""
    return f"{value:.{digits}g} {units(dataset, name)}".removesuffix(" -")


def short_name(dataset: xr.Dataset, name: str) -> str:
    """The name of a swept field for a label: ``gap (all stops)`` instead of ``stops_all_gap``."""
    group, _, rest = str(dataset[name].attrs.get("path", name)).partition(".")
    which, _, field = rest.rpartition(".")
    if not field or group not in _MEMBERS:
        text = name.replace("_", " ")
        return text.replace("angular frequency", "frequency") if units(dataset, name) == "Hz" else text
    which = f"all {group}" if which == "*" else f"{cut_to(which, _LONGEST)} {_MEMBERS[group]}"
    return f"{field.replace('_', ' ')} ({which})"
