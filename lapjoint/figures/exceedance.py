"""The figure of exceedance: the rate of contacts or cycles of stress that reach or exceed a value, with intervals."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.limits import DASHES, limit_text
from lapjoint.figures.style import COLOURS, STYLES, entitle, new_axes, style
from lapjoint.figures.sweep_axes import refuse_samples
from lapjoint.figures.text import legend_label

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_LABELS = {
    "impulse": "impulse of a contact [N s]",
    "peak_force": "largest force of a contact [N]",
    "contact_duration": "duration of a contact [s]",
    "impact_speed": "impact speed [m/s]",
    "stress_range": "range of a cycle of stress [Pa]",
}
RANGES = "stress_range"
"""The quantity that has places, and cycles; all others have stops, and contacts."""
_SMALL = 1e-3
"""Smallest range that is drawn, divided by the largest: smaller ones do no damage that counts."""


@style()
def plot_exceedance(
    dataset: xr.Dataset, axes: Axes | None = None, *, quantity: str = "impulse", limits: Sequence[float] = ()
) -> Axes:
    """Draw the number of contacts a second that reach or exceed a value, of each stop, with 95 % intervals as bands.

    In place of contacts, cycles of stress can be drawn by their range: where the damage is largest along the beam, and
    at the places that were asked for.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of `lapjoint.statistics`.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    quantity : str
        "impulse", "peak_force", "contact_duration", "impact_speed" or "stress_range".
    limits : sequence of float
        Values at which vertical lines are drawn, in the SI unit of the quantity.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, both logarithmic: the value in its SI unit, the rate in 1/s.

    Raises
    ------
    InputError
        If there is no such quantity, no stop was touched, or no place has an S-N line and stress.
    """
    refuse_samples(dataset)
    names = names_in(dataset, quantity)
    axes = new_axes() if axes is None else axes
    low = dataset[f"{quantity}_low"].values
    for number, (i, name) in enumerate(names.items()):
        rate, ends = dataset[f"{quantity}_exceedance"].values[i], dataset[f"{quantity}_exceedance_interval"].values[i]
        seen = (rate > 0) & ((quantity != RANGES) | (low >= _SMALL * low[-1]))
        if seen.any():
            colour, pattern = COLOURS[number % len(COLOURS)], STYLES[number % len(STYLES)]
            axes.plot(low[seen], rate[seen], color=colour, linestyle=pattern, label=legend_label(name))
            floor = np.maximum(ends[seen, 0], 1e-3 * rate[seen])
            axes.fill_between(low[seen], floor, ends[seen, 1], color=colour, alpha=0.15, linewidth=0)
    for number, limit in enumerate(limits):
        look: dict[str, Any] = {"color": "black", "linestyle": DASHES, "linewidth": 0.7 + 0.5 * number}
        axes.axvline(limit, label=limit_text(dataset, f"{quantity}_low", limit, 0), **look)
    axes.set_xscale("log")
    axes.set_yscale("log")
    axes.set_xlabel(_LABELS[quantity])
    axes.set_ylabel(f"{counted(quantity)} a second that exceed it")
    entitle(axes)
    return axes


def counted(quantity: str) -> str:
    """What is counted by a quantity."""
    return "cycles" if quantity == RANGES else "contacts"


def names_in(dataset: xr.Dataset, quantity: str) -> dict[int, str]:
    """The names of the stops or places whose rates of exceedance a dataset of statistics has, by their index."""
    if quantity not in _LABELS:
        raise InputError(f"quantity = {quantity!r}: allowed are {', '.join(_LABELS)}")
    if quantity != RANGES:
        if not int(dataset[f"{quantity}_count"].sum()):
            raise InputError(f"quantity = {quantity!r}: nothing was touched, so there is nothing to draw")
        return dict(enumerate(dataset.stop_name.values.astype(str).tolist()))
    if f"{quantity}_exceedance" not in dataset:
        raise InputError(f"quantity = {quantity!r}: cycles are counted of a material with [beam.material.fatigue]")
    if not dataset[f"{quantity}_count"].values.any():
        raise InputError(f"quantity = {quantity!r}: there is no stress, so there is nothing to draw")
    worst, found = int(dataset.damage_rate.values.argmax()), {}
    for i in sorted({worst, *np.flatnonzero(dataset.asked.values).tolist()}):
        place = str(dataset["place"].values[i]) if "place" in dataset.coords else f"x = {dataset.x.values[i]:.4g} m"
        found[i] = f"{place}, largest damage" if i == worst else place
    return found
