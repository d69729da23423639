"""Figures of contacts: the impulse of each contact, and the contact state over time."""

from __future__ import annotations

from itertools import pairwise
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import Contact, History
from lapjoint.answers.contact_state import ContactState, state_label, state_order
from lapjoint.figures.sampling import heading
from lapjoint.figures.style import (
    COLOURS,
    GREY,
    MARKERS,
    THIN,
    draw_time,
    entitle,
    faint_if_thin,
    new_axes,
    room_of,
    style,
)
from lapjoint.figures.text import apart, legend_label, literal, shortened, width_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes

MOST_STEMS = 200
"""Number of contacts above which markers are small, and have no stems to the axis."""
_NAMES_SHARE = 0.3
"""Largest fraction of the figure's width that the names of states take."""


@style()
def plot_contact_impulses(history: History, axes: Axes | None = None) -> Axes:
    """Draw the impulse of each contact over the time at which it starts, top positive, bottom negative.

    Each contact has a marker in the colour and shape of its stop.  The marker is hollow if an end of the history cuts
    the contact, so that the impulse is incomplete.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, time in s and impulses in N s.
    """
    axes = new_axes() if axes is None else axes
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    for stop, name in enumerate(history.problem.stop_names):
        mine = [contact for contact in history.contacts if contact.stop == stop]
        cut = [contact for contact in mine if contact.open_start or contact.open_end]
        size = 3.5 if len(history.contacts) <= MOST_STEMS else 1.8
        _draw_impulses(
            axes, [contact for contact in mine if contact not in cut], stop, legend_label(name), size, hollow=False
        )
        _draw_impulses(axes, cut, stop, f"_{name}, cut", size, hollow=True)
        if len(history.contacts) <= MOST_STEMS:
            t, impulse = _impulses(mine)
            axes.vlines(t, 0.0, impulse, color=COLOURS[stop % len(COLOURS)], linewidth=THIN, alpha=0.6, zorder=1)
    if not history.contacts:
        axes.set_ylim(-1.0, 1.0)
        axes.set_yticks([0.0])
        axes.text(0.5, 0.6, "no contact", transform=axes.transAxes, ha="center", color=GREY)
    margin = 0.015 * (history.end - history.start)  # for markers on the ends
    draw_time(axes, history.start - margin, history.end + margin, "time t of impact [s]")
    axes.set_ylabel("impulse [N s]")
    hollow = any(contact.open_start or contact.open_end for contact in history.contacts)
    entitle(axes, heading(history) + ("\nhollow: cut by an end of the history" if hollow else ""))
    return axes


def _draw_impulses(axes: Axes, contacts: list[Contact], stop: int, name: str, size: float, *, hollow: bool) -> None:
    colour = COLOURS[stop % len(COLOURS)]
    axes.plot(
        *_impulses(contacts),
        linestyle="",
        color=colour,
        marker=MARKERS[stop % len(MARKERS)],
        markerfacecolor="white" if hollow else colour,
        markersize=size,
        markeredgewidth=0.25 * size,
        label=name,
    )


def _impulses(contacts: list[Contact]) -> tuple[list[float], list[float]]:
    return [contact.start for contact in contacts], [contact.impulse for contact in contacts]


@style()
def plot_contact_states(history: History, axes: Axes | None = None) -> Axes:
    """Draw the contact state over time: a row for each state that occurs, with a bar for each of its intervals.

    The fraction of time spent in a state is written at the end of its row.  The rows of the paper's joint are named by
    the paper's numbers (Table 1), rows of other joints by their closed stops.

    Parameters
    ----------
    history : History
        The motion.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, time in s.
    """
    intervals = state_intervals(history)
    states = sorted(intervals, key=lambda state: state_order(history.problem, state))
    axes = new_axes(height=1.1 + 0.22 * len(states)) if axes is None else axes
    duration = history.end - history.start
    for row, state in enumerate(states):
        colour = COLOURS[(len(state.closed) - 1) % len(COLOURS)] if state.closed else GREY
        # One collection for all bars, which is fast with thousands of switches.
        axes.broken_barh(intervals[state], (row - 0.36, 0.72), **faint_if_thin(colour))
        share = sum(length for _, length in intervals[state]) / duration if duration else 1.0
        axes.text(1.01, row, f"{share:.1%}", transform=axes.get_yaxis_transform(), va="center", fontsize=7)
    names = [state_label(history.problem, state) for state in states]
    short = apart(names, lambda name: shortened(name, _NAMES_SHARE * room_of(axes)))
    axes.set_yticks(range(len(states)), [literal(name) for name in short])
    axes.set_ylim(len(states) - 0.4, -0.6)
    axes.grid(False, axis="y")
    draw_time(axes, history.start, history.end)
    axes.set_ylabel("contact state")
    entitle(axes, heading(history), beside=0.8 + max(width_of(name) for name in short))
    return axes


def state_intervals(history: History) -> dict[ContactState, list[tuple[float, float]]]:
    """Start and duration, s, of each interval that a motion spends in each contact state; durations are above zero."""
    edges = np.concatenate([[history.start], history.switch_times, [history.end]]).tolist()
    intervals: dict[ContactState, list[tuple[float, float]]] = {}
    for state, (start, end) in zip(history.states, pairwise(edges), strict=True):
        if end > start:
            intervals.setdefault(state, []).append((start, end - start))
    return intervals
