"""The figure of a sweep, as wide as a page: the impulse of each stop, and the outcome at each point.

A second swept field is drawn as one line for each value, or as a map if it has many values.  A sweep with several
starts is drawn as points.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from lapjoint.figures.impulse_curve import draw_line, limit, motion_kinds
from lapjoint.figures.limits import draw_limits, limit_text
from lapjoint.figures.style import COLOURS, GREY, PAGE_WIDTH, STYLE, STYLES, THIN, figure_of, new_panels, style
from lapjoint.figures.sweep_axes import (
    axis_label,
    cell_edges,
    constant_fields,
    each_line,
    fields,
    in_order,
    short_name,
    units,
)
from lapjoint.figures.sweep_variables import IMPULSE, curves, exponent_of, ordinate_of_panel, where
from lapjoint.figures.text import apart, literal, shortened, wrapped
from lapjoint.files.flags import flag_names
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

IntArray = NDArray[np.int64]
_NAME_ROOM = 4.5
"""Largest width of a stop's name above its panel, inches: room for sixty characters."""
MOST_LINES = 7
"""Largest number of values of a second field that are drawn as lines, each in its colour; more values are drawn as a
map."""
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
"""Colour of each outcome; ``periodic_n`` is a periodic motion that repeats after several excitation periods."""
_LABELS = {"no_contact": "no contact", "periodic": "periodic, 1", "periodic_n": "periodic, n"}


@style()
def plot_curve_wide(dataset: xr.Dataset, *, variable: str = IMPULSE, limits: Sequence[float] = ()) -> tuple[Axes, ...]:
    """Draw a panel for each stop, and below them a strip with the outcome at each point, as wide as a page.

    A second swept field is drawn as one line for each of its values, or as a map if it has more than `MOST_LINES`.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep, as `lapjoint.campaigns.sweep` returns it.
    variable : str
        The variable drawn: one of `lapjoint.figures.sweep_variables.drawable`, as ``stress_peak``.
    limits : sequence of float
        Magnitudes of the variable at which dashed lines are drawn, in its SI unit; a map has none.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The panels of the stops, in their order, or one panel of the beam; then the strip.

    Raises
    ------
    InputError
        If the dataset has no such variable.
    """
    dataset = in_order(dataset)
    first, second = fields(dataset)
    lines = curves(dataset, variable)
    stops = len(lines)
    as_map = second is not None and dataset.sizes[second] > MOST_LINES
    strip = max(0.18, 1.5 if as_map else 0.14 * _rows(dataset, first))  # inches high
    heights = [1.15] * stops + [strip]
    height = sum(heights) + 0.32 * stops + 0.9
    panels = new_panels(stops + 1, 1, PAGE_WIDTH, height, sharex=True, height_ratios=heights)
    figure = figure_of(panels)
    names = apart(
        [name or where(dataset, variable) for name, _ in lines],
        lambda name: shortened(name, _NAME_ROOM, STYLE["font.size"]),
    )
    label = ordinate_of_panel(dataset, variable)
    exponent = exponent_of(variable, dataset)
    drawn_limits = [] if as_map else [limit_text(dataset, variable, limit, exponent) for limit in limits]
    for stop, axes in enumerate(panels[:-1]):
        values = lines[stop][1]
        if as_map:
            _map(figure, axes, dataset, values, label, first, second or "")
        else:
            _panel(axes, dataset, values, label, first, second, legend=stop == 0)
            draw_limits(axes, dataset, variable, limits, exponent)
        axes.set_title(literal("; ".join([names[stop], *drawn_limits])), pad=2)
    _certificate_strip(figure, panels[-1], dataset, first, second)
    panels[-1].set_xlabel(axis_label(dataset, first))
    limit(panels[-1], dataset[first].values)
    if constant_fields(dataset):
        text = wrapped(", ".join(constant_fields(dataset)), PAGE_WIDTH - 0.5, STYLE["font.size"])
        figure.suptitle("\n".join(literal(line) for line in text), fontsize=STYLE["font.size"])
    return panels


def certificates(dataset: xr.Dataset) -> IntArray:
    """Indices into `OUTCOME_COLOURS` of the outcomes at the points of a sweep, (first field, second field, starts)."""
    keys = list(OUTCOME_COLOURS)
    codes = np.full(dataset.outcome.shape, keys.index("failed"))
    for value, meaning in flag_names(dataset.outcome.attrs).items():
        codes[dataset.outcome.values == value] = keys.index(meaning)
    many = (codes == keys.index("periodic")) & (dataset.period_multiple.values > 1)
    return np.where(many, keys.index("periodic_n"), codes)


def _panel(
    axes: Axes, dataset: xr.Dataset, values: xr.DataArray, name: str, first: str, second: str | None, legend: bool
) -> None:
    kinds = each_line(motion_kinds(dataset), second)
    for i, line in enumerate(each_line(values, second)):
        label = None if second is None else f"{dataset[second].values[i]:.4g}"
        colour, pattern = COLOURS[i % len(COLOURS)], STYLES[i % len(STYLES)]
        draw_line(axes, dataset[first].values, line, colour, pattern, label, kinds[i])
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    axes.set_ylabel(name)
    if second is not None and legend:
        title = literal(f"{short_name(dataset, second)} [{units(dataset, second)}]")
        axes.legend(title=title, title_fontsize=7, loc="upper left", bbox_to_anchor=(1.0, 1.05))


def _map(
    figure: Figure, axes: Axes, dataset: xr.Dataset, values: xr.DataArray, name: str, first: str, second: str
) -> None:
    values = values.mean("start") if "start" in values.dims else values
    mesh = axes.pcolormesh(
        cell_edges(dataset[first].values),
        cell_edges(dataset[second].values),
        values.values.T,
        cmap="cividis",
        rasterized=True,
    )
    bar = figure.colorbar(mesh, ax=axes, pad=0.01)
    bar.set_label(name)
    axes.set_ylabel(axis_label(dataset, second))
    axes.grid(False)


def _rows(dataset: xr.Dataset, first: str) -> int:
    return max(1, int(dataset.outcome.size) // dataset.sizes[first])


def _certificate_strip(figure: Figure, axes: Axes, dataset: xr.Dataset, first: str, second: str | None) -> None:
    """Draw a row for each value of the second field and each start, coloured by the outcome."""
    codes = draw_outcomes(axes, dataset, dataset[first].values)
    axes.set_title("what was established" if dataset.sizes["stop"] else "what was established, without stops", pad=2)
    axes.grid(False)
    _strip_ticks(axes, dataset, second, len(codes))
    name_outcomes(figure, codes)


def draw_outcomes(axes: Axes, dataset: xr.Dataset, x: FloatArray, row: int = 0) -> IntArray:
    """Draw rows of cells around the swept values `x`, (n,), upwards from `row`, coloured by outcome: a row for each
    value of the second field and each start.  The codes of `certificates`, (rows, n), are returned."""
    from matplotlib.colors import ListedColormap

    codes = certificates(dataset).reshape(x.size, -1).T
    axes.pcolormesh(
        cell_edges(x),
        np.arange(len(codes) + 1) - 0.5 + row,
        codes,
        cmap=ListedColormap(list(OUTCOME_COLOURS.values())),
        vmin=-0.5,
        vmax=len(OUTCOME_COLOURS) - 0.5,
        rasterized=True,
    )
    return codes


def name_outcomes(figure: Figure, codes: IntArray) -> None:
    """Put a legend of the colours of outcomes, by their `codes`, below the figure."""
    from matplotlib.patches import Patch

    keys = list(OUTCOME_COLOURS)
    patches = [
        Patch(facecolor=OUTCOME_COLOURS[keys[i]], label=_LABELS.get(keys[i], keys[i]), edgecolor="0.5", linewidth=0.4)
        for i in np.unique(codes)
    ]
    figure.legend(
        handles=patches,
        loc="outside lower center",
        ncols=len(patches),
        handlelength=1.4,
    )


def _strip_ticks(axes: Axes, dataset: xr.Dataset, second: str | None, rows: int) -> None:
    """Label the rows of the strip: values of the second field, or starts."""
    if second is None:
        axes.set_yticks([])
        if rows > 1:
            axes.set_ylabel("start")
        return
    number = dataset.sizes[second]
    each = rows // number  # starts
    shown = np.arange(number) if number <= MOST_LINES else np.linspace(0, number - 1, 5).round().astype(int)
    axes.set_yticks(
        shown * each + (each - 1) / 2, [f"{value:.3g}" for value in dataset[second].values[shown]], fontsize=6
    )
    if number > MOST_LINES:
        axes.set_ylabel(axis_label(dataset, second))
