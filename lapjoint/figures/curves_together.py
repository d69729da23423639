"""The curves of several sweeps in one figure, such as a sweep upwards and one downwards.

With several curves in a sweep, one for each stop, a colour tells the stops apart and a line pattern the sweeps.  With
one curve in each sweep, or in the figure with panels, colour and pattern tell the sweeps apart.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.errors import InputError
from lapjoint.figures.impulse_curve import draw_line, motion_kinds, name_marks
from lapjoint.figures.impulse_curve_wide import draw_outcomes, name_outcomes
from lapjoint.figures.limits import draw_limits
from lapjoint.figures.style import (
    COLOURS,
    GREY,
    PAGE_WIDTH,
    STYLES,
    THIN,
    entitle,
    figure_of,
    new_axes,
    new_panels,
    style,
)
from lapjoint.figures.sweep_axes import axis_label, check_one_axis, fields, in_order
from lapjoint.figures.sweep_variables import (
    IMPULSE,
    check_variable,
    curves,
    exponent_of,
    ordinate,
    ordinate_of_panel,
    where,
)
from lapjoint.figures.text import SMALL, legend_label, literal, shortened
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes

_STRIP_NAME = 1.1
"""Largest width of the name of a sweep beside the strip of outcomes, inches."""


@style()
def plot_curves(
    datasets: Mapping[str, xr.Dataset],
    axes: Axes | None = None,
    *,
    variable: str = IMPULSE,
    limits: Sequence[float] = (),
) -> Axes:
    """Draw a variable of several sweeps over their one swept field, page-wide.

    Parameters
    ----------
    datasets : mapping of str to xarray.Dataset
        The sweeps by their names in the legend; all over the same field, and over no other.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    variable : str
        The variable drawn, as in `plot_curve`.
    limits : sequence of float
        Magnitudes of the variable at which dashed lines are drawn, in its SI unit.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on.

    Raises
    ------
    InputError
        If the sweeps do not fit together, or one has no such variable.
    """
    sweeps = fitting(datasets, variable)
    axes = new_axes(PAGE_WIDTH, 3.4) if axes is None else axes
    some = next(iter(sweeps.values()))
    exponent, lines, stops = _lines(sweeps, variable)
    of_stops = len(stops) > 1
    if of_stops:
        for i, stop in enumerate(stops):
            axes.plot([], [], "-", color=COLOURS[i % len(COLOURS)], label=legend_label(stop))
    kinds = []
    for number, (name, one) in enumerate(sweeps.items()):
        kinds.append(motion_kinds(one).values)
        pattern = STYLES[number % len(STYLES)]
        for stop, values in lines[name].items():
            colour = COLOURS[(stops.index(stop) if of_stops else number) % len(COLOURS)]
            draw_line(axes, _x(one), values.values, colour, pattern, None, kinds[-1])
        shown = GREY if of_stops else COLOURS[number % len(COLOURS)]
        axes.plot([], [], linestyle=pattern, color=shown, label=legend_label(name))
    name_marks(axes, kinds)
    draw_limits(axes, some, variable, limits, exponent)
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    axes.set_xlabel(axis_label(some, fields(some)[0]))
    axes.set_ylabel(ordinate(some, variable, exponent))
    axes.set_xlim(*_ends(sweeps))
    alone = "" if of_stops or not stops else stops[0]
    entitle(axes, ", ".join(filter(None, [alone, where(some, variable)])))
    return axes


@style()
def plot_curves_wide(
    datasets: Mapping[str, xr.Dataset], *, variable: str = IMPULSE, limits: Sequence[float] = ()
) -> tuple[Axes, ...]:
    """Draw a panel for each stop with the curves of several sweeps, and below a strip of outcomes for each sweep.

    Parameters
    ----------
    datasets : mapping of str to xarray.Dataset
        The sweeps by their names in the legend; all over the same field, and over no other.
    variable : str
        The variable drawn, as in `plot_curve`.
    limits : sequence of float
        Magnitudes of the variable at which dashed lines are drawn, in its SI unit.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The panels, then the strips in one.

    Raises
    ------
    InputError
        If the sweeps do not fit together, or one has no such variable.
    """
    sweeps = fitting(datasets, variable)
    some, (exponent, lines, stops) = next(iter(sweeps.values())), _lines(sweeps, variable)
    heights = [1.15] * len(stops) + [0.16 * len(sweeps)]
    height = sum(heights) + 0.32 * len(stops) + 1.2
    panels = new_panels(len(heights), 1, PAGE_WIDTH, height, sharex=True, height_ratios=heights)
    kinds = [motion_kinds(one).values for one in sweeps.values()]
    for stop, axes in zip(stops, panels[:-1], strict=True):
        for number, (name, one) in enumerate(sweeps.items()):
            if stop in lines[name]:
                look = COLOURS[number % len(COLOURS)], STYLES[number % len(STYLES)], legend_label(name)
                draw_line(axes, _x(one), lines[name][stop].values, *look, kinds[number])
        name_marks(axes, kinds)
        draw_limits(axes, some, variable, limits, exponent)
        axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
        axes.set_ylabel(ordinate_of_panel(some, variable, exponent))
        if axes is panels[0]:
            entitle(axes, stop or where(some, variable))
        else:
            axes.set_title(literal(stop), pad=2)
    codes = [draw_outcomes(panels[-1], one, _x(one), number) for number, one in enumerate(sweeps.values())]
    names = [literal(shortened(name, _STRIP_NAME, SMALL)) for name in sweeps]
    panels[-1].set_yticks(range(len(names)), names)
    panels[-1].set_ylim(len(names) - 0.5, -0.5)
    panels[-1].set_title("what was established", pad=2)
    panels[-1].grid(False)
    panels[-1].set_xlabel(axis_label(some, fields(some)[0]))
    panels[-1].set_xlim(*_ends(sweeps))
    name_outcomes(figure_of(panels), np.concatenate([np.unique(one) for one in codes]))
    return panels


def _lines(
    sweeps: Mapping[str, xr.Dataset], variable: str
) -> tuple[int, dict[str, dict[str, xr.DataArray]], list[str]]:
    """The power of ten of the unit's prefix, the curves of each sweep by stop, and the stops of all sweeps."""
    exponent = exponent_of(variable, *sweeps.values())
    lines = {name: dict(curves(one, variable, exponent)) for name, one in sweeps.items()}
    return exponent, lines, list(dict.fromkeys(stop for each in lines.values() for stop in each))


def fitting(datasets: Mapping[str, xr.Dataset], variable: str) -> dict[str, xr.Dataset]:
    """The sweeps in ascending order; InputError, which names a sweep, if they do not fit into one figure."""
    found: dict[str, xr.Dataset] = {}
    for name, dataset in datasets.items():
        try:
            check_variable(dataset, variable)
        except InputError as error:
            raise InputError(f"{name}: {error}") from None
        first, second = fields(dataset)
        if second is not None:
            reason = "several files are drawn in one figure only if each has one swept parameter"
            raise InputError(f"{name}: is over {first} and {second}; {reason}")
        found[name] = in_order(dataset)
    check_one_axis(found)
    return found


def _x(dataset: xr.Dataset) -> FloatArray:
    values: FloatArray = dataset[fields(dataset)[0]].values
    return values


def _ends(sweeps: Mapping[str, xr.Dataset]) -> tuple[float | None, float | None]:
    """The least and the largest swept value of all sweeps; None where there is one value only."""
    values = np.concatenate([_x(one) for one in sweeps.values()])
    return (float(values.min()), float(values.max())) if np.ptp(values) > 0 else (None, None)
