"""Figures of samples: bands over a swept field, the share of samples beyond a value where nothing is swept, and the
uncertain numbers in the order in which they matter."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.limits import DASHES, draw_limits, limit_text
from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, PAGE_WIDTH, STYLES, entitle, new_panels, style
from lapjoint.figures.sweep_axes import axis_label
from lapjoint.figures.sweep_variables import curves, exponent_of, ordinate, unit_of
from lapjoint.figures.text import legend_label, literal
from lapjoint.sampling.bands import PROBABILITIES, Sampled, bands
from lapjoint.sampling.intervals import share_interval

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_DRAWN = 100
"""Largest number of values at which the share of samples that exceed them is drawn: a point on each per cent."""


@style()
def plot_bands(dataset: xr.Dataset, variable: str, *, limits: Mapping[str, float] | None = None) -> tuple[Axes, ...]:
    """Draw the band of a variable over the first swept field, a panel for each stop, with limits as lines.

    If nothing is swept, as in statistics, the share of samples that exceed a value is drawn over the value.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep, or of statistics, with samples; axes after the first are shown at their first value.
    variable : str
        The variable, as ``stress_peak``.
    limits : mapping, optional
        Limits by the names of their variables, in SI units.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The panels.  Each shows the median and the band from 5 to 95 %; thin lines bound the 95 % intervals of the
        edges of the band.  If nothing is swept, one panel has a line for each stop or place, within the 95 % interval
        of the share.

    Raises
    ------
    InputError
        If the file has no samples, or no such variable.
    """
    of = Sampled(dataset)
    if not of.swept:
        return (_shares_beyond(of, of.variable(variable), limits or {}),)
    first, *others = of.swept
    found = bands(dataset, None, [variable]).isel(dict.fromkeys(others, 0)).sortby(first)
    name = of.variable(variable)
    lines, exponent = curves(dataset, name), exponent_of(name, dataset)
    unit, bounds = 10.0**exponent, [limit for one, limit in (limits or {}).items() if of.variable(one) == name]
    panels = new_panels(len(lines), 1, PAGE_WIDTH, max(2.4, 1.5 * len(lines) + 0.6), sharex=True)
    x = found[first].values
    for i, (axes, (label, _)) in enumerate(zip(panels, lines, strict=True)):
        at = {"stop": i} if label else {}
        low, middle, high = found[f"{name}_quantile"].isel(at).transpose("probability", first).values / unit
        ends = found[f"{name}_quantile_interval"].isel(at).transpose("bound", "probability", first).values / unit
        colour, marker = COLOURS[i % len(COLOURS)], "o" if x.size == 1 else ""
        share = f"{100 * PROBABILITIES[0]:g} to {100 * PROBABILITIES[-1]:g} %"
        axes.fill_between(x, low, high, color=colour, alpha=0.25, linewidth=0, label=f"{share} of samples")
        axes.plot(x, middle, color=colour, linestyle="-", marker=marker, label="median")
        for edge in (ends[0, 0], ends[1, -1]):
            axes.plot(x, edge, color=colour, linestyle=":", linewidth=0.7)
        axes.plot([], [], color=colour, linestyle=":", linewidth=0.7, label="95 % interval of the band")
        draw_limits(axes, dataset, name, bounds, exponent)
        axes.set_xlim(float(x.min()), float(x.max())) if x.size > 1 else None
        axes.set_ylim(bottom=0.0)
        axes.set_ylabel(legend_label(label) if label else ordinate(dataset, name))
        if i == 0:
            entitle(axes, ordinate(dataset, name) if label else "")
    panels[-1].set_xlabel(axis_label(dataset, first))
    return panels


def _shares_beyond(of: Sampled, name: str, limits: Mapping[str, float]) -> Axes:
    """Draw the share of samples that exceed a value, a line for each stop or place, and the limits of the variable."""
    dataset, sets = of.dataset, of.dataset.sample_set.values[of.independent]
    exponent = exponent_of(name, dataset)
    values = of.magnitudes(name)[of.independent] / 10.0**exponent
    lines = [("", values)]
    if values.ndim > 1:
        dim = str(values.dims[1])
        names = dataset.stop_name.values if dim == "stop" else [f"x = {x:.4g} m" for x in dataset[dim].values]
        lines = [(str(label), values.isel({dim: i})) for i, label in enumerate(names)]
    (axes,) = new_panels(1, 1, COLUMN_WIDTH, 2.7)
    for i, (label, own) in enumerate(lines):
        at = np.unique(own.values[~np.isnan(own.values)])
        if not at.size:
            continue
        at = np.append(0.0, at[np.unique(np.linspace(0, at.size - 1, _DRAWN).astype(int))])
        beyond = np.where(np.isnan(own.values), np.nan, own.values > at[:, None])
        ends = np.array([share_interval(row, sets) for row in beyond])
        colour, pattern = COLOURS[i % len(COLOURS)], STYLES[i % len(STYLES)]
        look: dict[str, Any] = {"color": colour, "linestyle": pattern, "drawstyle": "steps-post"}
        axes.plot(at, np.nanmean(beyond, axis=1), label=legend_label(label), **look)
        axes.fill_between(at, ends[:, 0], ends[:, 1], step="post", color=colour, alpha=0.2, linewidth=0)
    for one, bound in limits.items():
        if of.variable(one) == name:
            text = limit_text(dataset, name, bound, exponent)
            axes.axvline(bound / 10.0**exponent, color="black", linestyle=DASHES, linewidth=0.7, label=text)
    axes.set_xlim(left=0.0)
    axes.set_ylim(0.0, 1.0)
    axes.set_xlabel(literal(f"{name.replace('_', ' ')} [{unit_of(dataset, name, exponent)}]".removesuffix(" [1]")))
    axes.set_ylabel("share of samples that exceed it")
    entitle(axes)
    return axes


@style()
def plot_ranking(indices: xr.Dataset, variable: str, *, stop: int | None = None) -> Axes:
    """Draw the sensitivity indices of a variable as bars, the number that matters most at the top.

    Parameters
    ----------
    indices : xarray.Dataset
        Dataset of `lapjoint.sensitivities`.
    variable : str
        The variable, as ``stress_peak``.
    stop : int, optional
        The stop, from 0, of a variable of stops; by default the indices of all stops are averaged.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on: first-order indices, and total ones if there are any, with 95 % intervals.
    """
    kinds = [kind for kind in ("first_order", "total") if f"{variable}_{kind}" in indices]
    if not kinds:
        raise InputError(f"variable {variable!r}: has no sensitivity indices here")

    def of(name: str) -> xr.DataArray:
        values = indices[name]
        if values.ndim == 1:
            return values
        other = str(values.dims[1])
        return values.mean(other) if stop is None else values.isel({other: stop})

    order = np.argsort(np.nan_to_num(of(f"{variable}_{kinds[-1]}").values))
    names = [legend_label(str(name)) for name in indices.uncertain.values[order]]
    (axes,) = new_panels(1, 1, COLUMN_WIDTH, 0.9 + 0.35 * len(names))
    height = 0.8 / len(kinds)
    for i, kind in enumerate(kinds):
        value, error = of(f"{variable}_{kind}").values[order], of(f"{variable}_{kind}_error").values[order]
        y = np.arange(len(names)) + (0.5 * (len(kinds) - 1) - i) * height
        axes.barh(y, np.nan_to_num(value), height, color=COLOURS[i], label=kind.replace("_", "-").replace("-o", " o"))
        axes.errorbar(value, y, xerr=error, fmt="none", ecolor="black", elinewidth=0.7, capsize=2)
    axes.set_yticks(np.arange(len(names)), names)
    axes.set_xlabel("share of the variance")
    axes.set_xlim(left=min(0.0, axes.get_xlim()[0]))
    entitle(axes, literal(variable.replace("_", " ")))
    return axes
