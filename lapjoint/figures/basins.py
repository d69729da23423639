"""Figures of basins: the motion in which each start of a plane ends, or the fraction of starts that end in each motion.

Starts that end in no known motion are grey and hatched.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.figures.basin_names import motion_names
from lapjoint.figures.style import (
    COLOURS,
    GREY,
    MARKERS,
    STYLES,
    entitle,
    faint_if_thin,
    new_axes,
    style,
)
from lapjoint.figures.sweep_axes import axis_label, cell_edges
from lapjoint.figures.text import literal

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_PALER = 0.45
"""Fraction of white that is mixed into the colours each time they are used again, from the seventh motion on."""
_HATCH = "//////"
_UNBOUND = (0.85, 0.85, 0.85)
"""Colour of starts that end in no known motion."""


@style()
def plot_basins(dataset: xr.Dataset, axes: Axes | None = None) -> Axes:
    """Draw basins: a plane of starts, or the fractions of starts that end in each motion, along a varied parameter if
    there is one.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of `lapjoint.basins`.
    axes : matplotlib.axes.Axes, optional
        Axes to draw on; by default those of a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes.
    """
    over = [str(name) for name in dataset.motion.dims if name not in ("first", "second", "start")]
    if over:
        axes = axes or new_axes(height=3.4)
        _draw_along(axes, dataset, over[0])
    elif "first" in dataset.motion.dims:
        axes = axes or new_axes(5.0, 4.6)
        _draw_plane(axes, dataset)
    else:
        axes = axes or new_axes(height=1.2 + 0.24 * dataset.sizes["motion"])
        _draw_shares(axes, dataset)
    return axes


def _colour(number: int) -> Any:
    """The colour of motion `number`, from 0: one of `COLOURS`, or a paler one if all are used."""
    from matplotlib.colors import to_rgb

    rounds, which = divmod(number, len(COLOURS) - 1)  # black is kept for lines
    own = np.array(to_rgb(COLOURS[which]))
    return tuple(1 - (1 - own) * (1 - _PALER) ** rounds)


def _colours(one: xr.Dataset) -> list[Any]:
    """A colour for each motion of a dataset."""
    return [_colour(i) for i in range(int((one.period_multiple.values > 0).sum()))]


def _samples(axes: Axes, one: xr.Dataset) -> None:
    """Add to the legend a colour sample of each motion in which some start ends, and of starts that end in none."""
    from matplotlib.patches import Rectangle

    def sample(label: str, **look: Any) -> None:
        axes.add_patch(Rectangle((0.5, 0.5), 0.0, 0.0, transform=axes.transAxes, label=label, **look))

    for name, colour, count in zip(motion_names(one), _colours(one), one["count"].values, strict=False):
        if count:
            sample(name, facecolor=colour)
    for name, count in zip(one.unbound.values, one.unbound_count.values, strict=True):
        if count:
            sample(str(name), facecolor=_UNBOUND, edgecolor=GREY, hatch=_HATCH, linewidth=0.0)


def _draw_plane(axes: Axes, dataset: xr.Dataset) -> None:
    """The plane of starts, each in the colour of its motion."""
    from matplotlib.colors import ListedColormap

    x, y = dataset["first"].values, dataset["second"].values
    motion = dataset.motion.values.T
    colours = [_UNBOUND, *_colours(dataset)]
    axes.pcolormesh(
        cell_edges(x),
        cell_edges(y),
        motion + 1,
        cmap=ListedColormap(colours),
        vmin=-0.5,
        vmax=len(colours) - 0.5,
        rasterized=True,
    )
    unbound = np.where(motion < 0, 1.0, 0.0)
    if unbound.any() and min(unbound.shape) > 1:
        axes.contourf(x, y, unbound, levels=[0.5, 1.5], colors="none", hatches=[_HATCH])
    axes.grid(False)
    axes.set_xlabel(_moved(dataset, "first"))
    axes.set_ylabel(_moved(dataset, "second"))
    _samples(axes, dataset)
    axes.set(xlim=cell_edges(x)[[0, -1]], ylim=cell_edges(y)[[0, -1]])
    entitle(axes, str(dataset.attrs["title"]))


def _moved(dataset: xr.Dataset, name: str) -> str:
    """The label of a coordinate of the plane."""
    one = dataset[name]
    symbol, _, place = str(one.attrs["coordinate"]).partition("(")
    unit = str(one.attrs["units"]).replace("m s-1", "m/s")
    return literal(f"start moved by {symbol} at x = {place.rstrip(')')} m [{unit}]")


def _draw_shares(axes: Axes, dataset: xr.Dataset) -> None:
    """A bar for each motion: the fraction of starts that end in it, with its interval."""
    names, colours = motion_names(dataset), _colours(dataset)
    rows = [(names[i], colours[i], "", i) for i in range(len(names))]
    bars = [(name, colour, *_share(dataset, "", i)) for name, colour, _, i in rows]
    bars += [
        (str(name), _UNBOUND, *_share(dataset, "unbound_", i))
        for i, name in enumerate(dataset.unbound.values)
        if dataset.unbound_count.values[i]
    ]
    for at, (name, colour, share, low, high) in enumerate(bars):
        axes.barh(at, share, color=colour, hatch="" if name in names else _HATCH, height=0.7)
        axes.plot([low, high], [at, at], color="black", linestyle="-", linewidth=1.0)
    axes.set_yticks(range(len(bars)), [literal(bar[0]) for bar in bars])
    axes.set(ylim=(len(bars) - 0.5, -0.5), xlim=(0.0, 1.0), xlabel="share of the starts, and its 95 % interval")
    axes.grid(False, axis="y")
    entitle(axes, str(dataset.attrs["title"]))


def _share(one: xr.Dataset, prefix: str, i: int) -> tuple[float, float, float]:
    """The fraction of starts that end in motion or outcome `i`, and the ends of its interval."""
    share, low, high = (float(one[f"{prefix}fraction{end}"].values[i]) for end in ("", "_low", "_high"))
    return share, low, high


def _draw_along(axes: Axes, dataset: xr.Dataset, name: str) -> None:
    """The fraction of starts that end on each branch, or in no known motion, along the varied parameter, with
    intervals."""
    dataset = dataset.sortby(name)
    x, branch = dataset[name].values, dataset.branch.values
    for number in range(int(branch.max(initial=-1)) + 1):
        where, which = np.nonzero(branch == number)
        values = dataset.isel({name: int(where[0])})
        label = f"{motion_names(values, numbered=False)[which[0]]} at {x[where[0]]:.4g}"
        rows = [_share(dataset.isel({name: int(i)}), "", int(j)) for i, j in zip(where, which, strict=True)]
        _curve(axes, x[where], np.array(rows), literal(label), _colour(number), number)
    for i, kind in enumerate(dataset.unbound.values):
        if dataset.unbound_count.values[:, i].any():
            rows = [_share(dataset.isel({name: j}), "unbound_", i) for j in range(x.size)]
            _curve(axes, x, np.array(rows), str(kind), GREY, -1)
    axes.set(ylim=(-0.03, 1.03), ylabel="share of the starts")
    axes.set_xlabel(axis_label(dataset, name))
    entitle(axes, str(dataset.attrs["title"]))


def _curve(axes: Axes, x: np.ndarray, rows: np.ndarray, label: str, colour: Any, number: int) -> None:
    """A fraction of starts along the varied parameter; `rows`, shape (n, 3), are the fraction and the ends of its
    interval."""
    line = ":" if number < 0 else STYLES[number % len(STYLES)]
    marker = MARKERS[number % len(MARKERS)]
    axes.plot(x, rows[:, 0], color=colour, linestyle=line, marker=marker, label=label)
    axes.vlines(x, rows[:, 1], rows[:, 2], colors=[colour], linewidth=1.0)
    axes.fill_between(x, rows[:, 1], rows[:, 2], **faint_if_thin(colour, 0.25))
