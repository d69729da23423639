"""Displacement over time, with gaps and contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.figures.place import checked_position, heading, times_drawn
from lapjoint.figures.style import COLOURS, GREY, STYLES, THIN, entitle, new_axes, style
from lapjoint.problem import Problem
from lapjoint.solution import History

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STRIP = 0.045
"""Height of the strip of one stop, of the axes."""


@style()
def plot_motion(
    history: History, axes: Axes | None = None, *, x: float | Sequence[float] | None = None, samples: int = 2000
) -> Axes:
    """Displacement over time, the gaps dotted, the contacts shaded, and a strip of contacts for each stop.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    x : float or sequence of float, optional
        Positions, m; by default those of the stops, or the tip where there are none.
    samples : int
        Number of times drawn, equidistant; the switches are added to them, and more where an excitation period would
        have fewer than 16 of them.

    Raises
    ------
    InputError
        If a position is outside the beam, or `samples` less than 2.
    """
    positions = _positions(history.problem, x)
    t = times_drawn(history, samples)
    axes = new_axes() if axes is None else axes
    z = 1e3 * history.displacement(np.array(positions), t)
    for i, place in enumerate(positions):
        axes.plot(t, z[i], color=_colour(i), linestyle=STYLES[i % len(STYLES)], label=f"x = {place:g} m")
        for gap in {stop.sign * stop.gap for stop in history.problem.stops if stop.x == place}:
            axes.axhline(1e3 * gap, color=_colour(i), linewidth=THIN, linestyle=(0, (2, 3)))
    _draw_contacts(axes, history, positions)
    axes.set_xlabel("time t [s]")
    axes.set_ylabel("displacement z [mm]")
    axes.set_xlim(history.start, history.end)
    entitle(axes, heading(history))
    return axes


def _positions(problem: Problem, x: float | Sequence[float] | None) -> list[float]:
    if x is None:
        return sorted({stop.x for stop in problem.stops}) or [problem.beam.length]
    return [checked_position(problem, float(place)) for place in np.atleast_1d(np.asarray(x, dtype=float))]


def _colour(i: int) -> str:
    return COLOURS[i % len(COLOURS)]


def _draw_contacts(axes: Axes, history: History, positions: list[float]) -> None:
    """A strip for each stop below the curves, filled while it is closed, its name on the right; shades above."""
    stops = history.problem.stops
    low, high = axes.get_ylim()
    share = min(0.5, STRIP * len(stops))
    axes.set_ylim(low - (high - low) * share / (1 - share), high)
    upwards = axes.get_xaxis_transform()  # in fractions of the axes
    for row, (name, stop) in enumerate(zip(history.problem.stop_names, stops, strict=True)):
        bottom, height = share * (1 - (row + 1) / len(stops)), 0.7 * share / len(stops)
        # One collection for all contacts: quick with thousands of them.
        spans = [(c.start, c.duration) for c in history.contacts if c.stop == row]
        drawn = stop.x in positions
        colour = _colour(positions.index(stop.x)) if drawn else GREY
        axes.broken_barh(
            spans, (bottom, height), transform=upwards, color=colour, alpha=0.6, lw=0, label=f"_contacts of {name}"
        )
        if drawn:
            axes.broken_barh(
                spans, (share, 1 - share), transform=upwards, color=colour, alpha=0.1, lw=0, label=f"_shade of {name}"
            )
        axes.text(1.01, bottom + height / 2, name, transform=axes.transAxes, fontsize=6.5, va="center", color=colour)
