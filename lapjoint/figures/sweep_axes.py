"""How a sweep is read and named in its figures.

A third swept field, where there is one, is drawn at its first value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from lapjoint.figures.text import cut_to, literal

if TYPE_CHECKING:
    import xarray as xr

_LONGEST = 20
"""Characters of a stop's name within the name of its field."""


def in_order(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with its axes ascending, and but two of them."""
    names = [name for name in dataset.outcome.dims if name != "start"]
    return dataset.sortby(names).isel(dict.fromkeys(names[2:], 0))


def fields(dataset: xr.Dataset) -> tuple[str, str | None]:
    """The names of the first and, where there is one, of the second swept field."""
    names = [str(name) for name in dataset.outcome.dims if name != "start"]
    return names[0], names[1] if len(names) > 1 else None


def held(dataset: xr.Dataset) -> list[str]:
    """The fields that are drawn at one value, with it."""
    return [
        f"{short(dataset, str(name))} = {value.item():.4g} {units(dataset, str(name))}".removesuffix(" -")
        for name, value in dataset.coords.items()
        if value.ndim == 0
    ]


def each_line(values: xr.DataArray, second: str | None) -> list[Any]:
    """Values over the first field, ``(n,)`` or ``(n, starts)``, for each value of the second."""
    if second is None:
        return [values.values]
    return [values.isel({second: i}).values for i in range(values.sizes[second])]


def axis_label(dataset: xr.Dataset, name: str) -> str:
    """A field and its unit, for an axis."""
    text = "angular frequency ω" if name == "angular_frequency" else short(dataset, name)
    return literal(f"{text} [{units(dataset, name)}]")


def units(dataset: xr.Dataset, name: str) -> str:
    """The unit of a field, as figures write it."""
    return {"rad s-1": "rad/s", "N m-1": "N/m", "1": "-"}.get(dataset[name].units, str(dataset[name].units))


def short(dataset: xr.Dataset, name: str) -> str:
    """A field for a label: ``gap (all stops)`` rather than ``stops_all_gap``."""
    group, _, rest = str(dataset[name].attrs.get("path", name)).partition(".")
    which, _, field = rest.rpartition(".")
    if not field or group not in ("stops", "supports"):
        return name.replace("_", " ")
    which = f"all {group}" if which == "*" else f"{cut_to(which, _LONGEST)} {group[:-1]}"
    return f"{field.replace('_', ' ')} ({which})"
