"""The figure of a sweep, one column wide: impulses, as in the paper's Figure 4, or another variable of its motions.

A sweep with several starts is drawn as points.  A second swept field is drawn as one line for each of its values, the
last value darkest.  A line is interrupted where the kind of motion changes, or the impulse jumps.  Motions that do not
repeat have hollow marks.
"""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.figures.limits import draw_limits
from lapjoint.figures.style import COLOURS, COLUMN_WIDTH, GREY, STYLES, THIN, entitle, new_axes, style
from lapjoint.figures.sweep_axes import axis_label, constant_fields, each_line, fields, in_order, short_name, units
from lapjoint.figures.sweep_variables import IMPULSE, curves, exponent_of, ordinate, where
from lapjoint.figures.text import legend_label
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes


JUMP, STEEP = 4.0, 0.04
"""A line breaks between two points whose impulses differ by more than `JUMP` times the differences on either side, and
by more than the fraction `STEEP` of the range of all impulses."""
_PALEST = 0.35  # opacity of the line of the first value of a second field
_SHOWN = 4  # most values of a second field in the legend; if there are more, only the first and the last


@style()
def plot_curve(
    dataset: xr.Dataset, axes: Axes | None = None, *, variable: str = IMPULSE, limits: Sequence[float] = ()
) -> Axes:
    """Draw the impulse of every stop over the first swept field, top positive, bottom negative, one column wide.

    Another `variable` is drawn in the same way: for each stop, or the largest value along the beam.

    Parameters
    ----------
    dataset : xarray.Dataset
        Dataset of a sweep, as `lapjoint.campaigns.sweep` returns it.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    variable : str
        The variable drawn: one of `lapjoint.figures.sweep_variables.drawable`, as ``stress_peak``.
    limits : sequence of float
        Magnitudes of the variable at which dashed lines are drawn, in its SI unit.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, impulses in N s.

    Raises
    ------
    InputError
        If the dataset has no such variable.
    """
    axes = new_axes(COLUMN_WIDTH, 2.7) if axes is None else axes
    dataset = in_order(dataset)
    lines = curves(dataset, variable)
    first, second = fields(dataset)
    kinds = each_line(motion_kinds(dataset), second)
    for stop, (name, values) in enumerate(lines):
        for i, line in enumerate(each_line(values, second)):
            label = legend_label(name) if name and i == len(kinds) - 1 else None
            colour, pattern = COLOURS[stop % len(COLOURS)], STYLES[stop % len(STYLES)]
            draw_line(axes, dataset[first].values, line, colour, pattern, label, kinds[i], _opacity(i, len(kinds)))
    _name_shades(axes, dataset, second)
    name_marks(axes, kinds)
    draw_limits(axes, dataset, variable, limits, exponent_of(variable, dataset))
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    axes.set_xlabel(axis_label(dataset, first))
    axes.set_ylabel(ordinate(dataset, variable))
    limit(axes, dataset[first].values)
    if not lines:
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(
            0.5,
            0.6,
            "no stops, no impulses" if variable == IMPULSE else "no stops",
            transform=axes.transAxes,
            ha="center",
            color=GREY,
        )
        entitle(axes, ", ".join(constant_fields(dataset)))
    else:
        shades = "" if second is None else f"{short_name(dataset, second)} [{units(dataset, second)}], paler to darker"
        entitle(axes, ", ".join(filter(None, [where(dataset, variable), shades, *constant_fields(dataset)])))
    return axes


def motion_kinds(dataset: xr.Dataset) -> xr.DataArray:
    """A number for the kind of motion at each point of a sweep, without dimension ``stop``; lines join points of one
    kind.

    The number is the period multiple, plus 0.5 for a symmetric motion; `ERRATIC` if the motion was not found to repeat,
    NaN if the solver failed.
    """
    kinds: xr.DataArray = (dataset.period_multiple + 0.5 * dataset.symmetric).where(
        dataset.period_multiple > 0, ERRATIC
    )
    return kinds.where(dataset.impulse.notnull().all("stop"))


ERRATIC = 0.0
"""Kind of a motion that was not found to repeat."""


def in_pieces(y: FloatArray, kinds: FloatArray) -> list[slice]:
    """Slices of points that one line joins, in order, of values `y`, (n,), with `motion_kinds`, (n,)."""
    steps = np.abs(np.diff(y))
    around = np.maximum(np.append(0.0, steps[:-1]), np.append(steps[1:], 0.0))
    range_of = float(np.ptp(y[np.isfinite(y)])) if np.isfinite(y).any() else 0.0
    jumps = (steps > JUMP * around) & (steps > STEEP * range_of) if y.size > 2 else np.zeros(steps.size, dtype=bool)
    apart = np.flatnonzero(jumps | (np.diff(kinds) != 0)) + 1
    edges = [0, *apart.tolist(), y.size]
    return [slice(a, b) for a, b in pairwise(edges)]


def draw_line(
    axes: Axes,
    x: FloatArray,
    y: FloatArray,
    colour: str,
    pattern: str,
    label: str | None,
    kinds: FloatArray | None = None,
    opacity: float = 1.0,
) -> None:
    """Draw lines of `y`, (n,) or (n, starts), over `x`, (n,), with marks on motions that do not repeat.

    Points are drawn instead of lines if there are several starts, or only one swept value.  `kinds` are the
    `motion_kinds`, of the shape of `y`; by default one line joins all points.
    """
    kinds = np.ones(y.shape) if kinds is None else kinds
    erratic = kinds == ERRATIC
    look: dict[str, Any] = {"color": colour, "alpha": opacity}
    if y.ndim > 1 or x.size == 1:
        across = np.repeat(x, y.size // x.size)
        axes.plot(across, y.ravel(), ".", markersize=3.5, label=label, mew=0, **look)
        x, y, erratic = across, y.ravel(), erratic.ravel()
    else:
        axes.plot([], [], linestyle=pattern, linewidth=0.9, label=label, **look)
        for piece in in_pieces(y, kinds):
            alone = piece.stop - piece.start == 1 and not erratic[piece.start]
            axes.plot(x[piece], y[piece], linestyle=pattern, linewidth=0.9, marker="." if alone else "", ms=2.5, **look)
    if erratic.any():
        axes.plot(x[erratic], y[erratic], linestyle="", marker="o", ms=_MARK, mfc="white", mew=0.5, mec=colour, **look)


_MARK = 2.2  # size of the mark of a motion that does not repeat, points


def _opacity(i: int, count: int) -> float:
    return 1.0 if count == 1 else _PALEST + (1 - _PALEST) * i / (count - 1)


def _name_shades(axes: Axes, dataset: xr.Dataset, second: str | None) -> None:
    """Add a legend entry for each value of the second field, in the opacity of its line."""
    if second is None:
        return
    values = dataset[second].values
    shown = range(len(values)) if len(values) <= _SHOWN else (0, len(values) - 1)
    for i in shown:
        axes.plot([], [], "-", color=GREY, alpha=_opacity(i, len(values)), linewidth=1.8, label=f"{values[i]:.4g}")


def name_marks(axes: Axes, kinds: list[FloatArray]) -> None:
    """Add a legend entry for the marks of motions that do not repeat, if there are any."""
    if any((kind == ERRATIC).any() for kind in kinds):
        axes.plot([], [], linestyle="", marker="o", ms=_MARK, mfc="white", mew=0.5, mec=GREY, label="does not repeat")


def limit(axes: Axes, x: FloatArray) -> None:
    """Let the axis run from the least to the largest of the swept values `x`, (n,), if there are several."""
    if x.size > 1 and np.all(np.isfinite(x)):
        axes.set_xlim(float(x.min()), float(x.max()))
