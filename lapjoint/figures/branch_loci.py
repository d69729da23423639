"""The figure of loci of bifurcations in two parameters: one line for each locus, one line style for each name."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.branch_names import locus_name, parameter_of, second_parameter_of
from lapjoint.figures.style import COLOURS, GREY, MARKERS, STYLES, entitle, new_axes, style
from lapjoint.figures.sweep_axes import axis_label

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

NONE = "no bifurcation in this range"
"""Text in a figure without loci."""


@style()
def plot_loci(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Draw the loci of bifurcations in two parameters.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of `lapjoint.branch` with a second parameter, `also_over`.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on.

    Raises
    ------
    InputError
        If the dataset has no second parameter.
    """
    second = second_parameter_of(dataset)
    if second is None:
        raise InputError("the branches are of one problem, not of several values of a second parameter: no loci")
    axes = new_axes(5.0, 3.4) if axes is None else axes
    names = np.array([locus_name(dataset, j) for j in range(dataset.sizes["bifurcation"])], dtype=object)
    locus, x, y = (dataset[f"bifurcation_{name}"].values for name in ("locus", "also_over", "value"))
    for i, name in enumerate(sorted(set(names.tolist()), key=lambda one: (-int((names == one).sum()), one))):
        look = _look(i)
        axes.plot([], [], label=name, **look)
        for number in dict.fromkeys(locus[names == name].tolist()):
            mine = np.flatnonzero(locus == number)
            mine = mine[np.argsort(x[mine], kind="stable")]
            axes.plot(x[mine], y[mine], **look)
    axes.set_xlabel(axis_label(dataset, second))
    axes.set_ylabel(axis_label(dataset, parameter_of(dataset)))
    axes.set_xlim(*_widened(dataset[second].values))
    axes.set_ylim(*_widened(np.asarray(dataset.attrs["range"], dtype=float)))
    if not names.size:
        axes.text(0.5, 0.5, NONE, transform=axes.transAxes, ha="center", va="center", color=GREY)
    entitle(axes)
    return axes


def _look(i: int) -> dict[str, Any]:
    """The line style of the loci with name number `i`."""
    look: dict[str, Any] = {"markersize": 3.0, "markerfacecolor": "white", "markeredgewidth": 0.7, "linewidth": 0.9}
    which = {"color": COLOURS, "linestyle": STYLES, "marker": MARKERS}
    return {**look, **{key: one[i % len(one)] for key, one in which.items()}}


def _widened(values: np.ndarray) -> tuple[float, float]:
    """The range of values, shape ``(n,)``, widened by room for marks at its ends."""
    room = 0.02 * float(np.ptp(values)) or 1.0
    return float(values.min()) - room, float(values.max()) + room
