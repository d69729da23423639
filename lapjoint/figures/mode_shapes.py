"""Figures of mode shapes, of one contact state or of all states, grouped by equal modes."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from lapjoint.answers import Modes
from lapjoint.answers.contact_state import is_paper_joint, paper_state_number, state_order
from lapjoint.errors import InputError
from lapjoint.figures.style import (
    COLOURS,
    GREY,
    PAGE_WIDTH,
    STYLES,
    THIN,
    each_axes,
    entitle,
    new_axes,
    new_panels,
    style,
)
from lapjoint.figures.text import cut_to
from lapjoint.problem import FloatArray, Problem

if TYPE_CHECKING:
    from matplotlib.axes import Axes

SAME = 1e-6
"""Largest relative difference of the frequencies of two states with equal modes: far more than rounding, far less than
the effect of a closed stop."""
MOST_PANELS = 24
"""Largest number of groups of states in one figure, so that the panels are legible."""
_NAMED = 4
"""Number of states of a group whose closed stops are written out; the others are counted."""
_UNBROKEN, _LONGEST = 16, 60
"""Largest number of characters of a state's name that is kept on one line, and that is written in full."""
_POINTS_AT_BEAM = {"bottom": 6, "top": 7, "between": "d"}
"""Matplotlib's carets with their tip on the beam, by the stop's side."""


@style()
def plot_mode_shapes(
    problem: Problem, modes: Modes, axes: Axes | None = None, *, samples: int = 401, hz: bool = False
) -> Axes:
    """Draw the mass-normalised mode shapes (16)-(17) of one contact state over the beam, and mark the closed stops.

    The sign of a mode is arbitrary; each mode is drawn with its largest deflection upwards.

    Parameters
    ----------
    problem : Problem
        The beam and its stops.
    modes : Modes
        The modes of one contact state.
    axes : matplotlib.axes.Axes, optional
        Where to draw; by default on a new figure.
    samples : int
        Number of equidistant positions.
    hz : bool
        Whether natural frequencies are written in Hz, not in rad/s.

    Returns
    -------
    matplotlib.axes.Axes
        The axes drawn on, positions in m and shapes in kg^(-1/2).
    """
    axes = new_axes() if axes is None else axes
    _draw_shapes(axes, problem, [modes], len(modes.angular_frequencies), samples, hz)
    entitle(axes, f"{problem.title}\n{group_title(problem, [modes], hz)}".strip())
    return axes


@style()
def plot_state_shapes(
    problem: Problem,
    states_modes: Sequence[Modes],
    axes: Sequence[Axes] | None = None,
    *,
    count: int = 3,
    hz: bool = False,
) -> tuple[Axes, ...]:
    """Draw the first mode shapes of every contact state, with a panel for each group of states with equal modes.

    For the paper's joint the groups, in this order, are as in the paper's Table 4: state 1; 2 and 4; 3 and 5; 6 to 9.
    Each mode is drawn with its largest deflection upwards.  Carets mark the closed stops of the group.

    Parameters
    ----------
    problem : Problem
        The beam and its stops.
    states_modes : sequence of Modes
        The modes of each contact state, from any solver, in any order.
    axes : sequence of matplotlib.axes.Axes, optional
        Where to draw, a panel for each group; by default on a new figure.
    count : int
        Number of modes drawn in a panel.
    hz : bool
        Whether natural frequencies are written in Hz, not in rad/s.

    Returns
    -------
    tuple of matplotlib.axes.Axes
        The panel of each of `state_groups`.

    Raises
    ------
    InputError
        If there are no states, more than `MOST_PANELS` groups of them or more than `axes`, or `count` is less than 1.
    """
    if count < 1:
        raise InputError(f"count = {count}: must be 1 or more")
    groups = state_groups(problem, states_modes)
    if not 0 < len(groups) <= MOST_PANELS:
        raise InputError(f"states_modes: has {len(groups)} groups of states; 1 to {MOST_PANELS} can be drawn")
    given = () if axes is None else each_axes(axes)
    if axes is not None and len(given) < len(groups):
        raise InputError(f"axes: has {len(given)} panels; these states need {len(groups)}")
    columns = min(2, len(groups))
    rows = -(-len(groups) // columns)
    panels = new_panels(rows, columns, PAGE_WIDTH, 0.3 + 2.1 * rows) if axes is None else given
    for panel, group in zip(panels, groups, strict=False):
        _draw_shapes(panel, problem, group, count, 401, hz)
        entitle(panel, group_title(problem, group, hz))
    if axes is None:
        _tidy(panels, len(groups), columns)
    return panels[: len(groups)]


def _tidy(panels: tuple[Axes, ...], used: int, columns: int) -> None:
    """Keep the labels of positions only on panels with no panel below, and hide unused panels."""
    for panel in panels[: used - columns]:
        panel.set_xlabel("")
        panel.tick_params(labelbottom=False)
    for panel in panels[used:]:
        panel.set_axis_off()


def state_groups(problem: Problem, states_modes: Sequence[Modes]) -> list[list[Modes]]:
    """The contact states in groups with springs at equal positions, and therefore equal natural frequencies.

    Groups, and the states in each group, are sorted by `lapjoint.answers.contact_state.state_order`.
    """
    groups: list[list[Modes]] = []
    for modes in sorted(states_modes, key=lambda each: state_order(problem, each.state)):
        for group in groups:
            if _alike(problem, group[0], modes):
                group.append(modes)
                break
        else:
            groups.append([modes])
    return groups


def _alike(problem: Problem, a: Modes, b: Modes) -> bool:
    places = [sorted(problem.structure.stops[stop].reading for stop in modes.state.closed) for modes in (a, b)]
    n = min(len(a.angular_frequencies), len(b.angular_frequencies))
    one, other = a.angular_frequencies[:n], b.angular_frequencies[:n]
    return places[0] == places[1] and np.allclose(one, other, rtol=SAME, atol=SAME * float(np.max(one, initial=0.0)))


def upright(shape: FloatArray) -> FloatArray:
    """A mode shape, (n,), with the sign that makes its largest deflection positive."""
    return shape * (-1.0 if shape[np.argmax(np.abs(shape))] < 0 else 1.0)


def group_title(problem: Problem, group: Sequence[Modes], hz: bool = False) -> str:
    """The title of a group's panel: the paper's numbers and the closed stops of its states, and the legend's unit."""
    names = [_unbroken(modes.state.name(problem)) for modes in group]
    text = " or ".join(names[:_NAMED]) + (f" or {len(names) - _NAMED} more" if len(names) > _NAMED else "")
    word = "States" if len(group) > 1 else "State"
    if is_paper_joint(problem):
        word += " " + ", ".join(str(paper_state_number(problem, modes.state)) for modes in group)
    return f"{word}: {text}\nmode: natural frequency [{'Hz' if hz else 'rad/s'}]"


def _unbroken(name: str) -> str:
    """A short name with non-breaking spaces, so that ``P2 + P3`` stays on one line; a long name is cut."""
    return name.replace(" ", "\u00a0") if len(name) <= _UNBROKEN else cut_to(name, _LONGEST)


def _draw_shapes(axes: Axes, problem: Problem, group: Sequence[Modes], count: int, samples: int, hz: bool) -> None:
    line, modes = problem.line, group[0]
    x = line.grid(samples)
    starts = np.arange(samples, x.size, samples)  # of the second beam and so on: a gap in the curve before each
    axes.axhline(0.0, color=GREY, linewidth=THIN, zorder=1)
    for i, (omega, shape) in enumerate(zip(modes.angular_frequencies[:count], modes.shapes(x), strict=False)):
        axes.plot(
            np.insert(x, starts, np.nan),
            np.insert(upright(shape), starts, np.nan),
            color=COLOURS[i % len(COLOURS)],
            linestyle=STYLES[i % len(STYLES)],
            label=f"{i + 1}: {omega / (2 * math.pi) if hz else omega:.4g}",
        )
    closed = {s for each in group for s in each.state.closed}
    for place, side in sorted(
        {(x, stop.side) for stop in (problem.structure.stops[s] for s in closed) for x, _ in stop.reading}
    ):
        axes.plot([place], [0.0], marker=_POINTS_AT_BEAM[side], color="0.25", markersize=6, linestyle="", clip_on=False)
    axes.set_xlabel(f"beams {', '.join(line.names)}, one after the other [m]" if line.several else "position x [m]")
    axes.set_ylabel("mode shape [kg$^{-1/2}$]")
    axes.set_xlim(0.0, problem.line.length)
