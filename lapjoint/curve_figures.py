"""Figures of sweeps: impulse against what was swept, and what was established at each point.

Several starts are drawn as points; a second swept field as one line for each value, or as a map where there are many.
A third field, where there is one, is drawn at its first value.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.figures import COLOURS, STYLES, new_axes, restrained

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLUMN_WIDTH, PAGE_WIDTH = 3.4, 7.0
MOST_LINES = 7
"""A second field with more values than this is drawn as a map."""
OUTCOME_COLOURS = {
    "no_contact": "#DDDDDD",
    "periodic": "#56B4E9",
    "periodic_n": "#0072B2",
    "chattering": "#009E73",
    "quasiperiodic": "#CC79A7",
    "aperiodic": "#D55E00",
    "undecided": "#F0E442",
    "failed": "#000000",
}
"""Colours of what was established; ``periodic_n`` repeats after several excitation periods."""
_LABELS = {"no_contact": "no contact", "periodic": "periodic, 1", "periodic_n": "periodic, n"}


def plot_curve(dataset: xr.Dataset, ax: Axes | None = None) -> Axes:
    """Impulse of every stop over the first swept field, top positive, bottom negative; a column wide.

    Parameters
    ----------
    dataset : xarray.Dataset
        Of a sweep.
    ax : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    """
    ax = new_axes(COLUMN_WIDTH, 2.7) if ax is None else ax
    dataset = _in_order(dataset)
    first, second = _fields(dataset)
    for stop, name in enumerate(dataset.stop_name.values):
        for i, impulse in enumerate(_lines(dataset.impulse.isel(stop=stop), second)):
            label = str(name) if i == 0 else None
            _draw(ax, dataset[first].values, impulse, COLOURS[stop % len(COLOURS)], STYLES[stop % len(STYLES)], label)
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set_xlabel(_axis_label(dataset, first), fontsize=8)
    ax.set_ylabel("impulse in a period [N s]", fontsize=8)
    _limit(ax, dataset[first].values)
    if dataset.sizes["stop"]:
        anchor: dict[str, Any] = {"loc": "lower center", "bbox_to_anchor": (0.5, 1.0)}
        values = [] if second is None else [f"{dataset.sizes[second]} values of {_short(second)}"]
        note = ", ".join([*values, *_held(dataset)]) or None
        ax.legend(
            **anchor,
            ncols=4,
            frameon=False,
            fontsize=7,
            handlelength=1.6,
            columnspacing=1.0,
            title=note,
            title_fontsize=7,
        )
    ax.tick_params(labelsize=7)
    return restrained(ax)


def plot_curve_wide(dataset: xr.Dataset) -> tuple[Axes, ...]:
    """A panel for each stop, and a strip that says what was established at each point; as wide as a page.

    A second field is drawn as a line for each of its values, or as a map.
    """
    dataset = _in_order(dataset)
    first, second = _fields(dataset)
    stops = dataset.sizes["stop"]
    as_map = second is not None and dataset.sizes[second] > MOST_LINES
    figure, axes = _panels(stops, max(0.18, 1.5 if as_map else 0.14 * _rows(dataset, first)))
    for stop, ax in enumerate(axes[:-1]):
        impulse = dataset.impulse.isel(stop=stop)
        if as_map:
            _map(figure, ax, dataset, impulse, first, second or "")
        else:
            _panel(ax, dataset, impulse, first, second, legend=stop == 0)
        ax.set_title(str(dataset.stop_name.values[stop]), fontsize=8, loc="left", pad=2)
    _certificate_strip(figure, axes[-1], dataset, first, second)
    axes[-1].set_xlabel(_axis_label(dataset, first), fontsize=8)
    _limit(axes[-1], dataset[first].values)
    if _held(dataset):
        figure.suptitle(", ".join(_held(dataset)), fontsize=8)
    return axes


def certificates(dataset: xr.Dataset) -> Any:
    """What was established at each point, as an index into `OUTCOME_COLOURS`."""
    keys = list(OUTCOME_COLOURS)
    meanings = dataset.outcome.attrs["flag_meanings"].split()
    codes = np.full(dataset.outcome.shape, keys.index("failed"))
    for value, meaning in zip(np.atleast_1d(dataset.outcome.attrs["flag_values"]), meanings, strict=True):
        codes[dataset.outcome.values == value] = keys.index(meaning)
    many = (codes == keys.index("periodic")) & (dataset.order.values > 1)
    return np.where(many, keys.index("periodic_n"), codes)


def _in_order(dataset: xr.Dataset) -> xr.Dataset:
    """The dataset with its axes ascending, and but two of them."""
    names = [name for name in dataset.outcome.dims if name != "start"]
    return dataset.sortby(names).isel(dict.fromkeys(names[2:], 0))


def _held(dataset: xr.Dataset) -> list[str]:
    """The fields that are drawn at one value, with it."""
    return [
        f"{_short(str(name))} = {value.item():.4g} {_units(dataset, str(name))}".removesuffix(" -")
        for name, value in dataset.coords.items()
        if value.ndim == 0
    ]


def _fields(dataset: xr.Dataset) -> tuple[str, str | None]:
    """The names of the first and, where there is one, of the second swept field."""
    names = [str(name) for name in dataset.outcome.dims if name != "start"]
    return names[0], names[1] if len(names) > 1 else None


def _lines(values: xr.DataArray, second: str | None) -> list[Any]:
    """Values over the first field, ``(n,)`` or ``(n, starts)``, for each value of the second."""
    if second is None:
        return [values.values]
    return [values.isel({second: i}).values for i in range(values.sizes[second])]


def _draw(ax: Axes, x: Any, y: Any, colour: Any, style: str, label: str | None) -> None:
    """A line, or points where there are several starts, or one value only."""
    if y.ndim > 1 or x.size == 1:
        columns = y.reshape(x.size, -1)
        ax.plot(np.repeat(x, columns.shape[1]), columns.ravel(), ".", color=colour, markersize=3.5, label=label, mew=0)
    else:
        ax.plot(x, y, color=colour, linestyle=style, linewidth=0.9, label=label)


def _panels(stops: int, strip: float) -> tuple[Figure, tuple[Axes, ...]]:
    """A figure with a panel for each stop, and the strip below, `strip` inches high, that shares their axis."""
    from matplotlib.figure import Figure

    heights = [1.15] * stops + [strip]
    figure = Figure(figsize=(PAGE_WIDTH, sum(heights) + 0.32 * stops + 0.9), layout="constrained")
    axes = figure.subplots(stops + 1, 1, sharex=True, squeeze=False, height_ratios=heights)[:, 0]
    return figure, tuple(axes)


def _panel(ax: Axes, dataset: xr.Dataset, impulse: xr.DataArray, first: str, second: str | None, legend: bool) -> None:
    lines = _lines(impulse, second)
    for i, line in enumerate(lines):
        label = None if second is None else f"{dataset[second].values[i]:.4g}"
        _draw(ax, dataset[first].values, line, COLOURS[i % len(COLOURS)], STYLES[i % len(STYLES)], label)
    ax.axhline(0.0, color="0.6", linewidth=0.5, zorder=0)
    ax.set_ylabel("impulse [N s]", fontsize=8)
    if second is not None and legend:
        title = f"{_short(second)} [{_units(dataset, second)}]"
        ax.legend(
            title=title, title_fontsize=7, fontsize=7, frameon=False, loc="upper left", bbox_to_anchor=(1.0, 1.05)
        )
    restrained(ax)


def _map(figure: Figure, ax: Axes, dataset: xr.Dataset, impulse: xr.DataArray, first: str, second: str) -> None:
    values = impulse.mean("start") if "start" in impulse.dims else impulse
    mesh = ax.pcolormesh(
        _edges(dataset[first].values), _edges(dataset[second].values), values.values.T, cmap="cividis", rasterized=True
    )
    bar = figure.colorbar(mesh, ax=ax, pad=0.01)
    bar.set_label("impulse [N s]", fontsize=7)
    bar.ax.tick_params(labelsize=7)
    ax.set_ylabel(_axis_label(dataset, second), fontsize=7)
    ax.tick_params(labelsize=8)


def _rows(dataset: xr.Dataset, first: str) -> int:
    return max(1, int(dataset.outcome.size) // dataset.sizes[first])


def _certificate_strip(figure: Figure, ax: Axes, dataset: xr.Dataset, first: str, second: str | None) -> None:
    """A row for each value of the second field and each start, coloured by what was established."""
    from matplotlib.colors import ListedColormap
    from matplotlib.patches import Patch

    codes = certificates(dataset).reshape(dataset.sizes[first], -1).T
    ax.pcolormesh(
        _edges(dataset[first].values),
        np.arange(len(codes) + 1) - 0.5,
        codes,
        cmap=ListedColormap(list(OUTCOME_COLOURS.values())),
        vmin=-0.5,
        vmax=len(OUTCOME_COLOURS) - 0.5,
        rasterized=True,
    )
    ax.set_title("what was established", fontsize=8, loc="left", pad=2)
    ax.tick_params(labelsize=8)
    _strip_ticks(ax, dataset, second, len(codes))
    keys = list(OUTCOME_COLOURS)
    patches = [
        Patch(facecolor=OUTCOME_COLOURS[keys[i]], label=_LABELS.get(keys[i], keys[i]), edgecolor="0.5", linewidth=0.4)
        for i in np.unique(codes)
    ]
    figure.legend(
        handles=patches,
        loc="outside lower center",
        ncols=len(patches),
        frameon=False,
        fontsize=8,
        handlelength=1.4,
        columnspacing=1.2,
    )


def _strip_ticks(ax: Axes, dataset: xr.Dataset, second: str | None, rows: int) -> None:
    """Say at the strip's side what its rows are: some values of the second field, or starts."""
    if second is None:
        ax.set_yticks([])
        if rows > 1:
            ax.set_ylabel("start", fontsize=7)
        return
    number = dataset.sizes[second]
    each = rows // number  # starts
    shown = np.arange(number) if number <= MOST_LINES else np.linspace(0, number - 1, 5).round().astype(int)
    ax.set_yticks(
        shown * each + (each - 1) / 2, [f"{value:.3g}" for value in dataset[second].values[shown]], fontsize=6
    )
    if number > MOST_LINES:
        ax.set_ylabel(_axis_label(dataset, second), fontsize=7)


def _axis_label(dataset: xr.Dataset, name: str) -> str:
    text = "angular frequency ω" if name == "angular_frequency" else _short(name)
    return f"{text} [{_units(dataset, name)}]"


def _units(dataset: xr.Dataset, name: str) -> str:
    return {"rad s-1": "rad/s", "N m-1": "N/m", "1": "-"}.get(dataset[name].units, str(dataset[name].units))


def _short(name: str) -> str:
    """A field for a label: ``gap (all stops)`` rather than ``stops_all_gap``."""
    group, _, rest = name.partition("_")
    which, _, field = rest.partition("_")
    if not field or group not in ("stops", "supports"):
        return name.replace("_", " ")
    return f"{field.replace('_', ' ')} ({which} {group if which == 'all' else group[:-1]})"


def _edges(values: Any) -> Any:
    """The ends of the cells around ascending values, one more than these."""
    if values.size == 1:
        return values[0] + np.array([-0.5, 0.5])
    middles = (values[1:] + values[:-1]) / 2
    return np.concatenate([[1.5 * values[0] - 0.5 * values[1]], middles, [1.5 * values[-1] - 0.5 * values[-2]]])


def _limit(ax: Axes, x: Any) -> None:
    if x.size > 1 and np.all(np.isfinite(x)):
        ax.set_xlim(float(x.min()), float(x.max()))
