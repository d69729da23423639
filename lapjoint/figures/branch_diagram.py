"""The diagram of branches: stable motions solid, unstable motions dashed, bifurcations marked and named."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.branch_curve import Curve, curve_of, heights_of
from lapjoint.figures.branch_names import KIND_NAMES, parameter_of
from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, GREY, MARKERS, THIN, entitle, new_axes, style
from lapjoint.figures.sweep_axes import axis_label
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

ORDINATES = {"impulse": "impulse in a period [N s]", "peak_force": "largest force [N]"}
"""Variables that a diagram can show, and the labels of their axes."""
_SOLID, _DASHED = "-", (0, (2.5, 1.5))
"""Line patterns of stable and unstable motions; colour alone tells the stops apart."""
_ALIKE = 1e-6
"""Largest relative difference of the values of two stops that counts as equal: rounding, or the choice of curve points,
explains it."""


@style()
def plot_branches(dataset: xr.Dataset, axes: Axes | None = None, *, ordinate: str = "impulse") -> Axes:
    """Draw branches over the parameter that changes, a colour for each stop.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of branches, as `lapjoint.branch` returns it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    ordinate : {"impulse", "peak_force"}
        The value drawn of each stop, in N s or N.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on.

    Raises
    ------
    InputError
        If there is no such ordinate.
    """
    if ordinate not in ORDINATES:
        raise InputError(f"ordinate = {ordinate!r}: allowed: {', '.join(ORDINATES)}")
    axes = new_axes(COLUMN_WIDTH, 2.7) if axes is None else axes
    name = parameter_of(dataset)
    values = dataset[ordinate].values
    heights = heights_of(dataset, values, impulses=ordinate == "impulse")
    for branch in range(dataset.branch_first_end.size):
        curve = curve_of(dataset, branch, values, heights)
        for stop in range(values.shape[1]):
            _draw(axes, curve, stop)
    for stop, label in enumerate(dataset.stop_name.values):
        axes.plot([], [], _SOLID, color=COLOURS[stop % len(COLOURS)], label=str(label))
    if dataset.stop_name.size and not dataset.stable.values.all():
        axes.plot([], [], color=GREY, linestyle=_DASHED, label="unstable")
    if dataset.stop_name.size:
        _mark(axes, dataset, values, heights)
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    axes.set_xlabel(axis_label(dataset, name))
    axes.set_ylabel(ORDINATES[ordinate])
    low, high = sorted(np.asarray(dataset.attrs["range"], dtype=float).tolist())
    axes.set_xlim(low, high)
    entitle(axes)
    return axes


def _draw(axes: Axes, curve: Curve, stop: int) -> None:
    """Draw one branch of one stop: stable parts solid, unstable parts dashed."""
    colour, stable = COLOURS[stop % len(COLOURS)], curve.stable
    edges = [0, *(np.flatnonzero(stable[1:] != stable[:-1]) + 1).tolist(), stable.size]
    for first, last in pairwise(edges):
        part, dashes = slice(first, last + 1), _SOLID if stable[first : first + 1].all() else _DASHED
        axes.plot(curve.x[part], curve.y[part, stop], color=colour, linestyle=dashes, linewidth=0.9)


def _mark(axes: Axes, dataset: xr.Dataset, values: FloatArray, heights: FloatArray) -> None:
    """Mark bifurcations on the curve of the stop with the largest value, the first if several have equal values."""
    most = np.abs(values).max(axis=0, initial=0.0)
    stop = int(np.argmax(most >= (1 - _ALIKE) * most.max()))
    kinds = dataset.bifurcation_kind.values
    for kind, label in enumerate(KIND_NAMES):
        mine = kinds == kind
        if mine.any():
            axes.plot(
                dataset.bifurcation_value.values[mine],
                heights[mine, stop],
                linestyle="",
                marker=MARKERS[kind],
                markersize=3.5,
                markerfacecolor="white",
                markeredgecolor="black",
                markeredgewidth=0.7,
                label=label,
                zorder=4,
            )
