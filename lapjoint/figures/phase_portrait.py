"""Figures of velocity over displacement: the phase portrait and the Poincare section of a motion."""

from __future__ import annotations

import math
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import History
from lapjoint.errors import InputError
from lapjoint.figures.sampling import heading, in_contact, line_width, smooth_times, times_drawn
from lapjoint.figures.style import COLUMN_WIDTH, GREY, THIN, entitle, new_axes, style
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    from matplotlib.axes import Axes

IN_CONTACT = "in contact"
_ROUNDING = 1e-9
"""Time by which a section point may lie outside the history because of rounding, in excitation periods."""
_LEAST_SHARE = 0.1
"""Least extent of the axes, divided by the orbit's size, so that rounding errors do not fill the figure."""


@style()
def plot_phase_portrait(
    history: History,
    axes: Axes | None = None,
    *,
    x: float | None = None,
    samples: int = 4000,
    label: str | None = None,
) -> Axes:
    """Draw velocity over displacement at one position, with the gaps as thin lines; the orbit is broad while in
    contact.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.  Each further portrait on the same axes has another colour.
    x : float, optional
        Position, m; by default of the stop farthest from the root, or the tip if there are no stops.  "In contact"
        means with a stop at this position, or, if there is none, with any stop.
    samples : int
        Least number of equidistant times; there are more if a period of the fastest excitation would have fewer than
        100.  The times of the switches are added, and further times where the drawn orbit would have visible corners.
    label : str, optional
        Name of the orbit in the legend; by default the position.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, displacement in mm and velocity in m/s.

    Raises
    ------
    InputError
        If the position is outside the beam, or `samples` less than 2.
    """
    place = history.problem.one_position(x)
    t = smooth_times(history, place, times_drawn(history, samples))
    axes = _portrait_axes(axes)
    z, v = _state(history, place, t)
    width = line_width(history)
    marker = "o" if np.ptp(z) == np.ptp(v) == 0 else ""
    (orbit,) = axes.plot(
        z, v, linewidth=width, marker=marker, label=label or f"x = {history.problem.line.place(place)} m"
    )
    here = [i for i, stop in enumerate(history.problem.structure.stops) if stop.met == place]
    contacts = [c for c in history.contacts if c.stop in here or not here]
    if contacts:
        closed = np.where(in_contact(contacts, t), v, np.nan)
        known = {str(line.get_label()) for line in axes.lines}
        axes.plot(
            z,
            closed,
            color=orbit.get_color(),
            linestyle="-",
            linewidth=4 * width,
            alpha=0.3,
            solid_capstyle="butt",
            label=f"_{IN_CONTACT}" if IN_CONTACT in known else IN_CONTACT,
        )
    still = [stop for stop in (history.problem.structure.stops[i] for i in here) if stop.still]
    for gap in {stop.sign * stop.gap for stop in still}:
        axes.axvline(1e3 * gap, color=GREY, linewidth=THIN, zorder=1)
    entitle(axes, heading(history) if label is None else "")
    return axes


@style()
def plot_poincare_section(
    history: History,
    axes: Axes | None = None,
    *,
    x: float | None = None,
    phase: float = 0.0,
    label: str | None = None,
) -> Axes:
    """Draw the Poincare section at one position: velocity over displacement, at one phase of every excitation period.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.  Each further section on the same axes has another colour.
    x : float, optional
        Position, m; by default of the stop farthest from the root, or the tip if there are no stops.
    phase : float
        Phase of the excitation, rad: a section point is drawn at each time t with omega t = phase + 2 pi k.
    label : str, optional
        Name of the section in the legend; by default the position and the phase.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, displacement in mm and velocity in m/s.

    Raises
    ------
    InputError
        If the excitation has no period, the history holds no section point, or the position is outside the
        beam.
    """
    place = history.problem.one_position(x)
    t = section_times(history, phase)
    axes = _portrait_axes(axes)
    z, v = _state(history, place, t)
    size = 4.0 if t.size < 100 else 1.8
    where = f"x = {history.problem.line.place(place)} m"
    name = label or f"{where}, ωt = {f'{phase:g} + ' if phase else ''}2πk: {t.size} section{'s' * (t.size > 1)}"
    axes.plot(z, v, linestyle="", marker="o", markersize=size, markeredgewidth=0, label=name)
    _widen(axes, *_state(history, place, times_drawn(history, 500)))
    entitle(axes, heading(history) if label is None else "")
    return axes


def section_times(history: History, phase: float = 0.0) -> FloatArray:
    """Times t of the section points of a history, omega t = phase + 2 pi k, s, ascending, (m,).

    If a history both starts and ends at a section point, its end is left out, because it is the start of the next
    period: a motion of three periods has three section points.
    """
    omega = history.problem.require_excitation_frequency("a Poincare section")
    if not math.isfinite(phase):
        raise InputError(f"phase = {phase}: must be finite, in rad")
    periods = (np.array([history.start, history.end]) * omega - phase) / (2 * math.pi)
    k = np.arange(math.ceil(periods[0] - _ROUNDING), math.floor(periods[1] + _ROUNDING) + 1)
    if k.size > 1 and k[0] - periods[0] < _ROUNDING and periods[1] - k[-1] < _ROUNDING:
        k = k[:-1]
    if not k.size:
        raise InputError(
            f"phase = {phase:g}: the history, {history.start:g} to {history.end:g} s, holds no section; allowed are "
            f"histories of an excitation period, {2 * math.pi / omega:g} s, or more"
        )
    return np.clip((phase + 2 * math.pi * k) / omega, history.start, history.end)


def _portrait_axes(axes: Axes | None) -> Axes:
    axes = new_axes(COLUMN_WIDTH, 3.0) if axes is None else axes
    axes.set_xlabel("displacement z [mm]")
    axes.set_ylabel("velocity z$_t$ [m/s]")
    return axes


def _state(history: History, x: float, t: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Displacement, mm, and velocity, m/s, at one position, each ``(m,)``."""
    return 1e3 * history.displacement(x, t)[0], history.velocity(x, t)[0]


def _widen(axes: Axes, z: FloatArray, v: FloatArray) -> None:
    """Widen the axes to at least `_LEAST_SHARE` of the size of the orbit, `z`, mm, and `v`, m/s."""
    for limits, set_limits, of in ((axes.get_xlim(), axes.set_xlim, z), (axes.get_ylim(), axes.set_ylim, v)):
        lack = max(0.0, _LEAST_SHARE * float(np.ptp(of)) - (limits[1] - limits[0])) / 2
        if lack:
            set_limits(limits[0] - lack, limits[1] + lack)
