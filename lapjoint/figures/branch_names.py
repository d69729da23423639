"""Names of the parameters, bifurcations and loci of a dataset of branches."""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import xarray as xr

KIND_NAMES = ("fold", "flip", "Neimark-Sacker", "symmetry breaking", "grazing")
"""Names of bifurcations, in the order of their codes in a dataset."""
_GRAZING = KIND_NAMES.index("grazing")


def parameter_of(dataset: xr.Dataset) -> str:
    """The name of the parameter that changes along the branches."""
    return next(str(name) for name, one in dataset.variables.items() if one.dims == ("point",) and "path" in one.attrs)


def second_parameter_of(dataset: xr.Dataset) -> str | None:
    """The name of the second parameter; None if the branches have one parameter only."""
    return next((str(name) for name, one in dataset.coords.items() if "path" in one.attrs), None)


def bifurcation_name(dataset: xr.Dataset, j: int) -> str:
    """The name of a bifurcation: ``fold``, ``grazing of P4``, or ``first grazing of P4`` if the motion has no other
    contact."""
    kind = int(dataset.bifurcation_kind.values[j])
    if kind != _GRAZING:
        return KIND_NAMES[kind]
    first = "first " if int(dataset.bifurcation_first.values[j]) else ""
    return f"{first}grazing of {dataset.stop_name.values[int(dataset.bifurcation_stop.values[j])]}"


def locus_name(dataset: xr.Dataset, j: int) -> str:
    """The name of the locus on which a bifurcation lies: its kind, and its period multiple if that is not 1."""
    point = min(int(dataset.bifurcation_point.values[j]), dataset.sizes["point"] - 1)
    multiple = int(dataset.period_multiple.values[point])
    return bifurcation_name(dataset, j) + (f", {multiple} periods" if multiple > 1 else "")
