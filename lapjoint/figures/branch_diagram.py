"""Branches of periodic motions: stable ones solid, unstable ones dashed, bifurcations marked with their names."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.branch_names import KIND_NAMES, number_of
from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, GREY, MARKERS, THIN, entitle, new_axes, style
from lapjoint.figures.sweep_axes import axis_label
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

ORDINATES = {"impulse": "impulse in a period [N s]", "peak_force": "largest force [N]"}
"""Variables that a diagram may show, and the labels of their axes."""


@style()
def plot_branches(dataset: xr.Dataset, axes: Axes | None = None, *, ordinate: str = "impulse") -> Axes:
    """Draw branches over the number that changes, a colour for each stop.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of branches, as `lapjoint.branch` returns it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    ordinate : {"impulse", "peak_force"}
        What is drawn of each stop, in N s or N.

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
    name = number_of(dataset)
    x, values = dataset[name].values, dataset[ordinate].values
    for branch in range(dataset.branch_first_end.size):
        mine = np.flatnonzero(dataset.branch.values == branch)
        for stop in range(values.shape[1]):
            colour = COLOURS[stop % len(COLOURS)]
            _draw(axes, x[mine], values[mine, stop], dataset.stable.values[mine] == 1, colour)
    for stop, label in enumerate(dataset.stop_name.values):
        axes.plot([], [], color=COLOURS[stop % len(COLOURS)], label=str(label))
    if dataset.stop_name.size:
        _mark(axes, dataset, values, ordinate)
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    axes.set_xlabel(axis_label(dataset, name))
    axes.set_ylabel(ORDINATES[ordinate])
    low, high = sorted(np.asarray(dataset.attrs["range"], dtype=float).tolist())
    axes.set_xlim(low, high)
    entitle(axes)
    return axes


def _draw(axes: Axes, x: FloatArray, y: FloatArray, stable: FloatArray, colour: str) -> None:
    """One branch of one stop: runs of stable points solid, of unstable ones dashed, each to the next run's first."""
    edges = [0, *(np.flatnonzero(stable[1:] != stable[:-1]) + 1).tolist(), x.size]
    for first, last in pairwise(edges):
        part = slice(first, last + 1)
        axes.plot(x[part], y[part], color=colour, linestyle="-" if stable[first] else (0, (2.5, 1.5)), linewidth=0.9)


def _mark(axes: Axes, dataset: xr.Dataset, values: FloatArray, ordinate: str) -> None:
    """Bifurcations, on the curve of the stop that is pressed hardest: where each is, or at the point that follows."""
    stop = int(np.argmax(np.abs(values).max(axis=0))) if values.size else 0
    kinds = dataset.bifurcation_kind.values
    heights = values[np.minimum(dataset.bifurcation_point.values, len(values) - 1), stop]
    if ordinate == "impulse":
        known = dataset.bifurcation_impulse.values[:, stop]
        heights = np.where(np.isfinite(known), known, heights)
    for kind, label in enumerate(KIND_NAMES):
        mine = kinds == kind
        if mine.any():
            axes.plot(
                dataset.bifurcation_value.values[mine],
                heights[mine],
                linestyle="",
                marker=MARKERS[kind],
                markersize=3.5,
                markerfacecolor="white",
                markeredgecolor="black",
                markeredgewidth=0.7,
                label=label,
                zorder=4,
            )
