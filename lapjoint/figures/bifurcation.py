"""The bifurcation diagram of a sweep: stroboscopic samples of each motion over the swept field.

A motion that repeats after p excitation periods has p dots above its value of the field.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.series import written
from lapjoint.campaigns.point import OUTCOME_CODES
from lapjoint.errors import InputError
from lapjoint.figures.impulse_curve import limit
from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, GREY, PAGE_WIDTH, entitle, new_axes, style
from lapjoint.figures.sweep_axes import (
    axis_label,
    check_one_axis,
    constant_fields,
    fields,
    in_order,
    short_name,
    with_unit,
)
from lapjoint.figures.sweep_variables import STROBES, exponent_of, unit_of
from lapjoint.figures.text import legend_label, literal
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_AS_VECTORS = 20_000
"""Most dots that a file of vectors holds one by one; more are one image in it, which viewers draw at once."""
_LOOKS: dict[str, dict[str, Any]] = {
    "repeats": {"ms": 1.8, "mew": 0},
    "does not repeat": {"ms": 1.2, "mew": 0, "alpha": 0.3},
    "undecided": {"ms": 2.0, "mew": 0.4, "mfc": "none"},
}
"""How the dots of each kind of motion are drawn, by the kind's name in the legend."""


def plot_bifurcation(
    datasets: xr.Dataset | Mapping[str, xr.Dataset],
    axes: Axes | None = None,
    *,
    variable: str = STROBES[0],
    wide: bool = False,
) -> Axes:
    """Draw the stroboscopic samples of sweeps over their first swept field: a bifurcation diagram.

    Filled dots are of motions that repeat, pale ones of motions that do not, and hollow ones of motions of which this
    is undecided.  Each sweep, and each value of a second swept field, has a colour.

    Parameters
    ----------
    datasets : xarray.Dataset or mapping of str to xarray.Dataset
        A sweep with samples, or several over the same field by their names in the legend.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    variable : str
        The samples drawn: ``strobe_displacement`` or ``strobe_velocity``.
    wide : bool
        Whether a new figure is as wide as a page; by default it is as wide as a column.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on.

    Raises
    ------
    InputError
        If a sweep has no such samples, or the sweeps are over different fields.
    """
    sweeps = dict(datasets) if isinstance(datasets, Mapping) and not hasattr(datasets, "attrs") else {"": datasets}
    return _drawn({name: _checked(one, name, variable) for name, one in sweeps.items()}, axes, variable, wide)


def _checked(dataset: Any, name: str, variable: str) -> xr.Dataset:
    """The dataset in order; InputError if it has no such samples."""
    if variable not in STROBES or variable not in dataset:
        raise InputError(f"{name or 'variable'}: has no {variable}; --strobe 64 of a sweep stores samples")
    found: xr.Dataset = in_order(dataset)
    return found


@style()
def _drawn(sweeps: Mapping[str, xr.Dataset], axes: Axes | None, variable: str, wide: bool) -> Axes:
    some = next(iter(sweeps.values()))
    first = fields(some)[0]
    check_one_axis(sweeps)
    axes = new_axes(PAGE_WIDTH if wide else COLUMN_WIDTH, 3.4 if wide else 2.7) if axes is None else axes
    exponent = exponent_of(variable, *sweeps.values())
    clouds = {label: one for name, sweep in sweeps.items() for label, one in _clouds(name, sweep).items()}
    many = sum(one[variable].size for one in clouds.values()) > _AS_VECTORS
    drawn = set()
    for i, (label, one) in enumerate(clouds.items()):
        colour = COLOURS[i % len(COLOURS)]
        if label:
            axes.plot([], [], "o", ms=3.5, mew=0, color=colour, label=legend_label(label))
        for kind, (x, y) in _dots(one, first, variable).items():
            if x.size:
                drawn.add(kind)
                look: dict[str, Any] = {"color": colour, "rasterized": many} | _LOOKS[kind]
                axes.plot(x, y / 10.0**exponent, linestyle="", marker="o", **look)
    for kind in _LOOKS:
        if kind in drawn:
            axes.plot([], [], linestyle="", marker="o", label=kind, **({"color": GREY} | _LOOKS[kind] | {"ms": 3.5}))
    axes.set_xlabel(axis_label(some, first))
    unit, what = unit_of(some, variable, exponent), variable.removeprefix("strobe_")
    axes.set_ylabel(literal(f"{what} once a period [{unit}]"))
    limit(axes, np.concatenate([one[first].values for one in sweeps.values()]))
    places = list(dict.fromkeys(f"{written(str(one[variable].attrs['place']))} m" for one in sweeps.values()))
    entitle(axes, ", ".join([" and ".join(places), *(constant_fields(some) if len(sweeps) == 1 else [])]))
    return axes


def _clouds(name: str, sweep: xr.Dataset) -> dict[str, xr.Dataset]:
    """The parts of a sweep that have colours of their own, by their names in the legend."""
    second = fields(sweep)[1]
    if second is None:
        return {name: sweep}
    found = {}
    for i, value in enumerate(sweep[second].values):
        of = f"{short_name(sweep, second)} = {with_unit(sweep, second, value)}"
        found[f"{name}: {of}" if name else of] = sweep.isel({second: i})
    return found


def _dots(sweep: xr.Dataset, first: str, variable: str) -> dict[str, tuple[FloatArray, FloatArray]]:
    """The swept values and the different samples of each kind of motion, in the unit of the file."""
    samples = sweep[variable].transpose(first, ..., "strobe")
    number = samples.sizes["strobe"]
    multiple = sweep.period_multiple.transpose(first, ...).values.reshape(-1, 1)
    undecided = sweep.outcome.transpose(first, ...).values.reshape(-1, 1) == OUTCOME_CODES["UNDECIDED"]
    y = samples.values.reshape(-1, number)
    x = np.broadcast_to(np.repeat(sweep[first].values, y.shape[0] // sweep.sizes[first])[:, None], y.shape)
    known = np.isfinite(y)
    of_kind = {
        "does not repeat": known & (multiple == 0) & ~undecided,
        "undecided": known & undecided,
        "repeats": known & (np.arange(number) < multiple),
    }
    return {kind: (x[which], y[which]) for kind, which in of_kind.items()}
