"""The curve of impulses that a sweep found, a column wide: Figure 4 of the paper.

Several starts are drawn as points; a second swept field as one line for each value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, GREY, STYLES, THIN, entitle, new_axes, style
from lapjoint.figures.sweep_axes import axis_label, each_line, fields, held, in_order, short
from lapjoint.figures.text import key

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@style()
def plot_curve(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Impulse of every stop over the first swept field, top positive, bottom negative; a column wide.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of a sweep.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    """
    axes = new_axes(COLUMN_WIDTH, 2.7) if axes is None else axes
    dataset = in_order(dataset)
    first, second = fields(dataset)
    for stop, name in enumerate(dataset.stop_name.values):
        for i, impulse in enumerate(each_line(dataset.impulse.isel(stop=stop), second)):
            label = key(str(name)) if i == 0 else None
            draw_line(
                axes, dataset[first].values, impulse, COLOURS[stop % len(COLOURS)], STYLES[stop % len(STYLES)], label
            )
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    axes.set_xlabel(axis_label(dataset, first))
    axes.set_ylabel("impulse in a period [N s]")
    limit(axes, dataset[first].values)
    if not dataset.sizes["stop"]:
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(0.5, 0.6, "no stops, no impulses", transform=axes.transAxes, ha="center", color=GREY)
        entitle(axes, ", ".join(held(dataset)))
    else:
        values = [] if second is None else [f"{dataset.sizes[second]} values of {short(dataset, second)}"]
        entitle(axes, ", ".join([*values, *held(dataset)]))
    return axes


def draw_line(axes: Axes, x: Any, y: Any, colour: Any, pattern: str, label: str | None) -> None:
    """A line, or points where there are several starts, or one value only."""
    if y.ndim > 1 or x.size == 1:
        columns = y.reshape(x.size, -1)
        axes.plot(
            np.repeat(x, columns.shape[1]), columns.ravel(), ".", color=colour, markersize=3.5, label=label, mew=0
        )
    else:
        axes.plot(x, y, color=colour, linestyle=pattern, linewidth=0.9, label=label)


def limit(axes: Axes, x: Any) -> None:
    """The axis from the least to the largest value swept."""
    if x.size > 1 and np.all(np.isfinite(x)):
        axes.set_xlim(float(x.min()), float(x.max()))
