"""The impulses that a sweep found, drawn one column wide, as in Figure 4 of the paper.

Several starts are drawn as points.  A second swept field is drawn as one line for each of its values.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, GREY, STYLES, THIN, entitle, new_axes, style
from lapjoint.figures.sweep_axes import axis_label, constant_fields, each_line, fields, in_order, short_name
from lapjoint.figures.text import legend_label
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


@style()
def plot_curve(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Draw the impulse of every stop over the first swept field, top positive, bottom negative, one column wide.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep, as `lapjoint.campaigns.sweep` returns it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, impulses in N s.
    """
    axes = new_axes(COLUMN_WIDTH, 2.7) if axes is None else axes
    dataset = in_order(dataset)
    first, second = fields(dataset)
    for stop, name in enumerate(dataset.stop_name.values):
        for i, impulse in enumerate(each_line(dataset.impulse.isel(stop=stop), second)):
            label = legend_label(str(name)) if i == 0 else None
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
        entitle(axes, ", ".join(constant_fields(dataset)))
    else:
        values = [] if second is None else [f"{dataset.sizes[second]} values of {short_name(dataset, second)}"]
        entitle(axes, ", ".join([*values, *constant_fields(dataset)]))
    return axes


def draw_line(axes: Axes, x: FloatArray, y: FloatArray, colour: str, pattern: str, label: str | None) -> None:
    """Draw a line, or points where there are several starts or only one swept value.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        Where to draw.
    x : FloatArray, shape (n,)
        Swept values, in the unit of their field.
    y : FloatArray, shape (n,) or (n, starts)
        Impulses, N s.
    colour : str
        Colour of the line or points, as matplotlib names it.
    pattern : str
        Style of the line, one of `lapjoint.figures.style.STYLES`.
    label : str or None
        Name in the legend; None for no entry.
    """
    if y.ndim > 1 or x.size == 1:
        columns = y.reshape(x.size, -1)
        axes.plot(
            np.repeat(x, columns.shape[1]), columns.ravel(), ".", color=colour, markersize=3.5, label=label, mew=0
        )
    else:
        axes.plot(x, y, color=colour, linestyle=pattern, linewidth=0.9, label=label)


def limit(axes: Axes, x: FloatArray) -> None:
    """Let the axis run from the least to the largest of the swept values, if there are several.

    Parameters
    ----------
    axes : matplotlib.axes.Axes
        The axes.
    x : FloatArray, shape (n,)
        Swept values, in the unit of their field.
    """
    if x.size > 1 and np.all(np.isfinite(x)):
        axes.set_xlim(float(x.min()), float(x.max()))
