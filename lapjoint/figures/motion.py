"""The figure of a motion: displacement over time, with gaps and contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.figures.sampling import heading, in_contact, line_width, times_drawn
from lapjoint.figures.style import (
    COLOURS,
    GREY,
    STYLES,
    THIN,
    draw_time,
    entitle,
    faint_if_thin,
    new_axes,
    room_of,
    style,
)
from lapjoint.figures.text import apart, literal, shortened
from lapjoint.problem import FloatArray, Problem

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STRIP = 0.11
"""Height of the strip of one stop, inches: the height of its name."""
_NAME_SIZE = 6.5
"""Size of the stops' names, points; it is reduced if there are too many stops."""
_NAMES_SHARE = 0.2
"""Largest fraction of the figure's width that the names of stops take."""


@style()
def plot_motion(
    history: History,
    axes: Axes | None = None,
    *,
    x: float | Sequence[float] | None = None,
    samples: int = 2000,
    label: str | None = None,
) -> Axes:
    """Draw the displacement over time, with the gaps dotted and the contacts shaded.

    Below the curves each stop has a strip that is filled while the stop is closed.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    x : float or sequence of float, optional
        Positions, m; by default the positions of the stops, or the tip if there are no stops.
    samples : int
        Least number of equidistant times; there are more if a period of the fastest excitation would have fewer than
        100.  The times of the switches are added.
    label : str, optional
        Name of the motion in the legend, before its positions; by default title and solver are written above the axes.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, time in s and displacement in mm.

    Raises
    ------
    InputError
        If `x` names no position, or one outside the beam, or `samples` is less than 2.
    """
    positions = _positions(history.problem, x)
    t = times_drawn(history, samples)
    axes = new_axes() if axes is None else axes
    z, faces = 1e3 * history.displacement(np.array(positions), t), 1e3 * history.faces(t)
    for i, place in enumerate(positions):
        pattern = STYLES[i % len(STYLES)]
        where = f"x = {history.problem.line.place(place)} m"
        name = f"{label}, {where}" if label else where
        axes.plot(t, z[i], color=_colour(i), linestyle=pattern, linewidth=line_width(history), label=name)
        here = [(k, stop) for k, stop in enumerate(history.problem.structure.stops) if stop.met == place]
        for gap in {stop.sign * stop.gap for _, stop in here if stop.still}:
            axes.axhline(1e3 * gap, color=_colour(i), linewidth=THIN, linestyle=(0, (2, 3)))
        for face in (faces[k] for k, stop in here if not stop.still):
            axes.plot(t, face, color=_colour(i), linewidth=THIN, linestyle=(0, (2, 3)), label="_face")
    _shade_contacts(axes, history, positions, t, z)
    _draw_strips(axes, history, positions)
    draw_time(axes, history.start, history.end)
    axes.set_ylabel("displacement z [mm]")
    entitle(axes, heading(history) if label is None else "")
    return axes


def _positions(problem: Problem, x: float | Sequence[float] | None) -> list[float]:
    if x is None:
        return sorted({stop.met for stop in problem.structure.stops}) or [problem.line.length]
    places = np.atleast_1d(np.asarray(x, dtype=float))
    if not places.size:
        raise InputError("x = []: names no position; one or more are needed, or None for those of the stops")
    return [problem.position(place) for place in places]


def _colour(i: int) -> str:
    return COLOURS[i % len(COLOURS)]


def _shade_contacts(axes: Axes, history: History, positions: list[float], t: FloatArray, z: FloatArray) -> None:
    """Shade the area between gap and curve while the stop is closed; `z` is in mm, shape ``(positions, m)``."""
    faces = 1e3 * history.faces(t)
    for i, (name, stop) in enumerate(zip(history.problem.stop_names, history.problem.structure.stops, strict=True)):
        closed = in_contact([contact for contact in history.contacts if contact.stop == i], t)
        if stop.met in positions and closed.any():
            row = positions.index(stop.met)
            shade = axes.fill_between(
                t, z[row], faces[i], where=closed.tolist(), color=_colour(row), alpha=0.13, linewidth=0
            )
            shade.set_label(f"_shade of {name}")


def _draw_strips(axes: Axes, history: History, positions: list[float]) -> None:
    """Draw a strip for each stop below the curves, filled while the stop is closed, with its name on the right."""
    stops = history.problem.structure.stops
    low, high = axes.get_ylim()
    axes.set_yticks([tick for tick in axes.get_yticks() if low <= tick <= high])
    share = min(0.5, STRIP * len(stops) / _height(axes))
    size = min(_NAME_SIZE, 72 * 0.9 * share * _height(axes) / max(1, len(stops)))
    names = apart(history.problem.stop_names, lambda name: shortened(name, _NAMES_SHARE * room_of(axes), size))
    axes.set_ylim(low - (high - low) * share / (1 - share), high)
    for row, (name, stop) in enumerate(zip(names, stops, strict=True)):
        bottom, height = share * (1 - (row + 1) / len(stops)), 0.7 * share / len(stops)
        colour = _colour(positions.index(stop.met)) if stop.met in positions else GREY
        # Heights are fractions of the axes.  One collection holds all contacts, which is fast with thousands of
        # contacts.
        axes.broken_barh(
            [(c.start, c.duration) for c in history.contacts if c.stop == row],
            (bottom, height),
            transform=axes.get_xaxis_transform(),
            **faint_if_thin(colour, 0.6),
            label=f"_contacts of {name}",
        )
        axes.text(
            1.01, bottom + height / 2, literal(name), transform=axes.transAxes, fontsize=size, va="center", color=colour
        )


def _height(axes: Axes) -> float:
    """Height of the axes, inches, without the title: an estimate, because matplotlib computes the layout when it
    draws."""
    assert axes.figure is not None
    return 0.75 * float(axes.bbox.height) / axes.figure.dpi
