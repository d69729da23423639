"""The variables of a sweep that can be drawn: impulses, and the variables that ``--summary`` added."""

from __future__ import annotations

import math
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers.series import written
from lapjoint.errors import InputError
from lapjoint.figures.text import literal
from lapjoint.summaries.of_orbit import OF_ALL, SUMMARIES

if TYPE_CHECKING:
    import xarray as xr

IMPULSE = "impulse"
STROBES = "strobe_displacement", "strobe_velocity"
"""Stroboscopic samples, which `lapjoint.figures.bifurcation` draws."""
_NAMES = {
    IMPULSE: "impulse in a period",
    "contact_time": "share of time in contact",
    "contact_rate": "contacts a second",
    "received_power": "power that the stop takes, to keep or to give back",
    "dissipated_power": "power lost in the stop",
    "dissipated_power_total": "power lost in all stops",
    "input_power": "power of the excitation",
    "damping_power": "power lost in beams and links",
    "damage_rate": "fatigue damage a second",
    "equivalent_range": "equivalent stress range",
    "largest_range": "largest stress range",
}
_KINDS = {"peak": "largest", "rms": "RMS of"}
_BESIDE_PANEL = 18
"""Largest number of characters in a line of a label beside a panel of 1.15 inches."""
_PREFIXES = {9: "G", 6: "M", 3: "k", 0: "", -3: "m", -6: "µ", -9: "n"}
_PLAIN = 0.1, 1e4
"""Bounds of the largest magnitude of a variable between which its unit has no prefix."""


def drawable(dataset: xr.Dataset) -> tuple[str, ...]:
    """The names of the variables of a sweep that can be drawn; the first is `IMPULSE`."""
    return IMPULSE, *(name for name in SUMMARIES if name in dataset)


def check_variable(dataset: xr.Dataset, variable: str) -> None:
    """InputError if a variable is not among those that can be drawn."""
    if variable not in drawable(dataset):
        there, more = ", ".join(drawable(dataset)), "--summary of a sweep adds more"
        raise InputError(f"variable {variable!r}: is not in this file, which has {there}; {more}")


def curves(dataset: xr.Dataset, variable: str, exponent: int | None = None) -> list[tuple[str, xr.DataArray]]:
    """The curves of a drawable variable: name and values of each stop, or an empty name and the values of the beam.

    The values are in the unit of `ordinate`, with the `exponent` of its prefix, by default as the dataset needs.
    """
    check_variable(dataset, variable)
    values = dataset[variable] / 10.0 ** (exponent_of(variable, dataset) if exponent is None else exponent)
    if "stop" not in values.dims:
        return [("", values)]
    return [(str(name), values.isel(stop=i)) for i, name in enumerate(dataset.stop_name.values)]


def ordinate(dataset: xr.Dataset, variable: str, exponent: int | None = None) -> str:
    """Name and unit of a drawable variable, as the label of an axis: ``largest stress [MPa]``."""
    quantity, _, kind = variable.rpartition("_")
    text = _NAMES.get(variable) or f"{_KINDS[kind]} {quantity.replace('_', ' ')}"
    unit = unit_of(dataset, variable, exponent)
    return literal(text if unit == "1" else f"{text} [{unit}]")


def ordinate_of_panel(dataset: xr.Dataset, variable: str, exponent: int | None = None) -> str:
    """The same for a low panel of a stop, beside which a long name takes several lines."""
    return "impulse [N s]" if variable == IMPULSE else fill(ordinate(dataset, variable, exponent), _BESIDE_PANEL)


def unit_of(dataset: xr.Dataset, variable: str, exponent: int | None = None) -> str:
    """The unit of a drawable variable with its prefix."""
    exponent = exponent_of(variable, dataset) if exponent is None else exponent
    return _PREFIXES[exponent] + written(str(dataset[variable].attrs["units"]))


def exponent_of(variable: str, *datasets: xr.Dataset) -> int:
    """Power of ten of the prefix of a unit that suits all datasets; 0 for impulses, fractions and rates."""
    size = max(float(np.nanmax(np.abs(dataset[variable].values), initial=0.0)) for dataset in datasets)
    units = str(datasets[0][variable].attrs["units"])
    if variable == IMPULSE or units in ("1", "s-1") or not 0 < size < np.inf or _PLAIN[0] <= size < _PLAIN[1]:
        return 0
    return int(np.clip(3 * math.floor(math.log10(size) / 3), min(_PREFIXES), max(_PREFIXES)))


def where(dataset: xr.Dataset, variable: str) -> str:
    """A remark on the place along the beam of a drawable variable; empty for a variable of stops."""
    return "" if "stop" in dataset[variable].dims or variable in OF_ALL else "where it is largest along the beam"
