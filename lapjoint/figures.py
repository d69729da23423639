"""Figures of answers, drawn with matplotlib and without a display.

Each function takes an answer object, and axes to draw on if the caller has them; it returns the axes, whose
``figure`` can be saved.  The colours are those of Okabe and Ito (2008), which colour-blind readers tell apart;
line styles repeat the distinction.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solution import History, Modes

if TYPE_CHECKING:
    from matplotlib.axes import Axes

COLOURS = ("#0072B2", "#D55E00", "#009E73", "#CC79A7", "#E69F00", "#56B4E9", "#000000")
STYLES = ("-", "--", "-.", ":")
FORMATS = (".png", ".svg", ".pdf")


def new_axes(width: float = 7.0, height: float = 3.6) -> Axes:
    """Axes on a figure of their own, `width` by `height` inches, that belongs to no window."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained").subplots()


def save(axes: Axes, path: str | Path) -> None:
    """Write the figure that `axes` belong to, as PNG, SVG or PDF by the ending of `path`.

    Raises
    ------
    InputError
        If the ending is another one, or the file cannot be written.
    """
    ending = Path(path).suffix.lower()
    if ending not in FORMATS:
        raise InputError(f"{path}: figures are written as {', '.join(FORMATS)}, not {ending or 'without an ending'}")
    from matplotlib.figure import Figure

    figure = axes.figure
    assert isinstance(figure, Figure)
    try:
        figure.savefig(path, dpi=150)
    except OSError as error:
        raise InputError(f"{path}: cannot be written: {error.strerror or error}") from None


def plot_motion(history: History, axes: Axes | None = None, *, samples: int = 2000) -> Axes:
    """Displacement at each stop's position over time, the gaps dotted, and a strip of contacts for each stop.

    Where there is no stop, the displacement of the tip is drawn.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    samples : int
        Number of times drawn, equidistant; the switches are added to them.
    """
    ax = new_axes() if axes is None else axes
    stops = history.problem.stops
    positions = sorted({stop.x for stop in stops}) or [history.problem.beam.length]
    t = np.union1d(np.linspace(history.start, history.end, samples), history.switch_times)
    z = 1e3 * history.displacement(np.array(positions), t)
    for i, x in enumerate(positions):
        colour = COLOURS[i % len(COLOURS)]
        ax.plot(t, z[i], color=colour, linestyle=STYLES[i % len(STYLES)], linewidth=1.2, label=f"x = {x:g} m")
        for gap in {stop.sign * stop.gap for stop in stops if stop.x == x}:
            ax.axhline(1e3 * gap, color=colour, linewidth=0.6, linestyle=(0, (2, 3)))
    _draw_contacts(ax, history, positions)
    ax.set_xlabel("time t [s]")
    ax.set_ylabel("displacement z [mm]")
    ax.set_xlim(history.start, history.end)
    ax.set_title(f"{history.problem.title or 'Motion'}\n{history.solver}", fontsize=9, loc="left")
    ax.legend(frameon=False, ncols=4, fontsize=8, loc="upper right", bbox_to_anchor=(1.0, 1.12))
    return restrained(ax)


def _draw_contacts(ax: Axes, history: History, positions: list[float]) -> None:
    """A strip for each stop below the curves, filled while the stop is closed, its name on the right."""
    stops, strip = history.problem.stops, 0.045
    low, high = ax.get_ylim()
    share = min(0.5, strip * len(stops))
    ax.set_ylim(low - (high - low) * share / (1 - share), high)
    for row, (name, stop) in enumerate(zip(history.problem.stop_names, stops, strict=True)):
        bottom = share * (1 - (row + 1) / len(stops))
        height = 0.7 * share / len(stops)
        spans = [(c.start, c.duration) for c in history.contacts if c.stop == row]
        colour = COLOURS[positions.index(stop.x) % len(COLOURS)]
        # Upwards in fractions of the axes, and one collection for all contacts: quick with thousands of them.
        ax.broken_barh(spans, (bottom, height), transform=ax.get_xaxis_transform(), color=colour, alpha=0.6, lw=0)
        ax.text(1.01, bottom + height / 2, name, transform=ax.transAxes, fontsize=7, va="center", color=colour)


def plot_mode_shapes(problem: Problem, modes: Modes, axes: Axes | None = None, *, samples: int = 401) -> Axes:
    """Mass-normalised mode shapes of one contact state over the beam, the closed stops marked.

    The sign of a mode is arbitrary; each is drawn with its largest deflection upwards.
    """
    ax = new_axes() if axes is None else axes
    x = np.linspace(0.0, problem.beam.length, samples)
    for i, (omega, shape) in enumerate(zip(modes.angular_frequencies, modes.shapes(x), strict=True)):
        largest = shape[np.argmax(np.abs(shape))]
        ax.plot(
            x,
            shape * np.sign(largest),
            color=COLOURS[i % len(COLOURS)],
            linestyle=STYLES[(i // len(COLOURS)) % len(STYLES)],
            linewidth=1.2,
            label=f"{i + 1}: {omega:.4g} rad/s",
        )
    ax.axhline(0.0, color="0.6", linewidth=0.6)
    for stop in modes.state.closed:
        ax.plot([problem.stops[stop].x], [0.0], marker="^", color="0.3", markersize=7, clip_on=False)
    ax.set_xlabel("position x [m]")
    ax.set_ylabel("mode shape [kg$^{-1/2}$]")
    ax.set_xlim(0.0, problem.beam.length)
    ax.set_title(f"Modes of the state: {modes.state.name(problem)}", fontsize=9)
    ax.legend(frameon=False, fontsize=8, loc="upper left", bbox_to_anchor=(1.0, 1.0))
    return restrained(ax)


def restrained(ax: Axes) -> Axes:
    """The axes without the frame's top and right, and with small tick labels."""
    for side in ("top", "right"):
        ax.spines[side].set_visible(False)
    ax.tick_params(labelsize=8)
    return ax
