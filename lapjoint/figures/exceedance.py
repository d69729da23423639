"""The figure of exceedance: the rate of contacts that reach or exceed a value, with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.limits import DASHES, limit_text
from lapjoint.figures.style import COLOURS, STYLES, entitle, new_axes, style
from lapjoint.figures.sweep_axes import refuse_samples
from lapjoint.figures.text import legend_label
from lapjoint.summaries.sums import OF_CONTACTS

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_LABELS = {
    "impulse": "impulse of a contact [N s]",
    "peak_force": "largest force of a contact [N]",
    "contact_duration": "duration of a contact [s]",
    "impact_speed": "impact speed [m/s]",
}


@style()
def plot_exceedance(
    dataset: xr.Dataset, axes: Axes | None = None, *, quantity: str = "impulse", limits: Sequence[float] = ()
) -> Axes:
    """Draw the number of contacts a second that reach or exceed a value, of each stop, with 95 % intervals as bands.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of `lapjoint.statistics`.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    quantity : str
        "impulse", "peak_force", "contact_duration" or "impact_speed".
    limits : sequence of float
        Values at which vertical lines are drawn, in the SI unit of the quantity.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, both logarithmic: the value in its SI unit, the rate in 1/s.

    Raises
    ------
    InputError
        If there is no such quantity, or no stop was touched.
    """
    if quantity not in OF_CONTACTS:
        raise InputError(f"quantity = {quantity!r}: allowed are {', '.join(OF_CONTACTS)}")
    refuse_samples(dataset)
    if not int(dataset[f"{quantity}_count"].sum()):
        raise InputError(f"quantity = {quantity!r}: nothing was touched, so there is nothing to draw")
    axes = new_axes() if axes is None else axes
    low = dataset[f"{quantity}_low"].values
    for i, name in enumerate(dataset.stop_name.values):
        rate, ends = dataset[f"{quantity}_exceedance"].values[i], dataset[f"{quantity}_exceedance_interval"].values[i]
        seen = rate > 0
        if seen.any():
            colour, pattern = COLOURS[i % len(COLOURS)], STYLES[i % len(STYLES)]
            axes.plot(low[seen], rate[seen], color=colour, linestyle=pattern, label=legend_label(str(name)))
            floor = np.maximum(ends[seen, 0], 1e-3 * rate[seen])
            axes.fill_between(low[seen], floor, ends[seen, 1], color=colour, alpha=0.15, linewidth=0)
    for number, limit in enumerate(limits):
        look: dict[str, Any] = {"color": "black", "linestyle": DASHES, "linewidth": 0.7 + 0.5 * number}
        axes.axvline(limit, label=limit_text(dataset, f"{quantity}_low", limit, 0), **look)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(_LABELS[quantity])
    axes.set_ylabel("contacts a second that exceed it")
    entitle(axes)
    return axes
