"""The picture of the curve: the impulse of each stop over the excitation frequency, with what is in doubt marked."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from bokeh.events import Event, Tap
from bokeh.models import ColumnDataSource, HoverTool, Range1d
from bokeh.models.annotations.geometry import Span
from bokeh.models.annotations.legends import Legend, LegendItem
from bokeh.plotting import figure

from lapjoint.campaigns.point import FAILED, Point
from lapjoint.figures.curve_features import motion_words
from lapjoint.figures.style import COLOURS
from lapjoint.figures.text import frequency_text

HEIGHT = 340
"""Height of the picture, pixels."""
DASHES = ("solid", "dashed", "dotdash", "dotted")
PALE = 0.3
"""Opacity of a curve that is not that of the problem in the form."""
ROOM = 0.02
"""Room on either side of the frequencies, as a share of their range."""


class CurvePicture:
    """The picture, and the frequencies that it has.

    Parameters
    ----------
    choose : callable
        Called with the number of the frequency that was clicked.
    """

    def __init__(self, choose: Callable[[int], None]) -> None:
        self._choose = choose
        self._frequencies: tuple[float, ...] = ()
        """As they are drawn."""
        self._size = 1.0
        """Size of the unit of frequencies, rad/s."""
        self._omega: float | None = None
        self._lines = ColumnDataSource({"xs": [], "ys": [], "colour": [], "dash": [], "stop": []})
        self._marks = ColumnDataSource({key: [] for key in ("x", "y", "stop", "what", "at", "colour", "size")})
        self._doubts = ColumnDataSource({key: [] for key in ("x", "y", "stop", "what", "at")})
        self.figure = figure(
            height=HEIGHT,
            sizing_mode="stretch_width",
            tools="pan,box_zoom,wheel_zoom,reset,save",
            active_drag=None,
            active_scroll=None,
            x_axis_label="excitation frequency [rad/s]",
            y_axis_label="impulse per period [N s]",
            toolbar_location="above",
            x_range=Range1d(start=0.0, end=1.0),
            y_range=Range1d(start=-1.0, end=1.0),
            name="curve",
        )
        self.figure.toolbar.logo = None
        lines = self.figure.multi_line(
            "xs", "ys", source=self._lines, line_color="colour", line_dash="dash", line_width=2, name="curve lines"
        )
        marks = self.figure.scatter("x", "y", source=self._marks, color="colour", size="size")
        doubts = self.figure.scatter(
            "x", "y", source=self._doubts, marker="x", size=9, line_width=2, color="gray", name="in doubt"
        )
        self._drawn: tuple[Any, Any, Any] = lines, marks, doubts
        self._named: list[str] = []
        self._here = Span(dimension="height", line_dash="dotted", line_width=2, line_color="gray", visible=False)
        self.figure.add_layout(self._here)
        tips = [("", "@stop"), ("", "@at"), ("impulse", "@y{0.00000} N s"), ("", "@what")]
        self.figure.add_tools(HoverTool(tooltips=tips, renderers=[marks, doubts], attachment="vertical"))
        self.figure.add_layout(Legend(items=[], orientation="horizontal", spacing=12), "below")
        self.figure.on_event(Tap, self._tapped)

    def show(self, frequencies: Sequence[float], points: Mapping[int, Point], stops: Sequence[str]) -> None:
        """Draw the points that are known, by the numbers of their frequencies, rad/s."""
        self._frequencies = tuple(value / self._size for value in frequencies)
        known = sorted(points)
        places = np.array([self._frequencies[i] for i in known])
        impulses = np.array([points[i].impulses or (math.nan,) * len(stops) for i in known]).reshape(
            len(known), len(stops)
        )
        kinds = np.array([_kind(points[i]) for i in known])
        breaks = np.flatnonzero(np.diff(kinds) != 0) + 1
        colours = [COLOURS[k % (len(COLOURS) - 1)] for k in range(len(stops))]
        ys = [np.insert(impulses[:, k], breaks, np.nan) for k in range(len(stops))]
        xs = np.insert(places, breaks, places[breaks] if breaks.size else 0.0)
        dashes = [DASHES[k % len(DASHES)] for k in range(len(stops))]
        self._lines.data = {
            "xs": [xs] * len(stops),
            "ys": ys,
            "colour": colours,
            "dash": dashes,
            "stop": list(stops),
        }
        sure = np.array([points[i].period_multiple > 0 for i in known], dtype=bool)
        at, what = [frequency_text(frequencies[i]) for i in known], [said(points[i]) for i in known]
        self._marks.data = self._rows(places, impulses, stops, at, what, sure) | {
            "colour": [colour for colour in colours for _ in range(int(sure.sum()))],
            "size": [2.0 if len(known) > len(self._frequencies) / 2 else 4.0] * (len(stops) * int(sure.sum())),
        }
        self._doubts.data = self._rows(places, np.nan_to_num(impulses), stops, at, what, ~sure)
        self._name(stops)
        if self._frequencies:
            fit(self.figure.x_range, self._frequencies)
        fit(self.figure.y_range, impulses[np.isfinite(impulses)])

    @staticmethod
    def _rows(
        places: Any, impulses: Any, stops: Sequence[str], at: Sequence[str], what: Sequence[str], which: Any
    ) -> dict[str, Any]:
        """The columns of the points of all stops that `which` chooses."""
        chosen = [i for i in range(len(at)) if which[i]]
        return {
            "x": np.tile(places[chosen], len(stops)),
            "y": impulses[chosen].T.ravel(),
            "stop": [stop for stop in stops for _ in chosen],
            "at": [at[i] for _ in stops for i in chosen],
            "what": [what[i] for _ in stops for i in chosen],
        }

    def _name(self, stops: Sequence[str]) -> None:
        """The legend: the stops, and the mark of what is in doubt."""
        lines, _, doubts = self._drawn
        doubted = len(self._doubts.data["stop"]) > 0
        items = [LegendItem(label=name, renderers=[lines], index=k) for k, name in enumerate(stops)]
        items.append(LegendItem(label="not certified to repeat", renderers=[doubts], visible=doubted))
        legend = self.figure.legend[0]
        names = [*stops, str(doubted)]
        if self._named != names:
            self._named, legend.items = names, items

    def choose(self, omega: float | None) -> None:
        """Mark the frequency of the cycle, rad/s."""
        self._omega = omega
        self._here.update(location=(omega or 0.0) / self._size, visible=omega is not None)

    def in_unit(self, name: str, size: float) -> None:
        """Draw frequencies in a unit from now on, whose size in rad/s is given."""
        self._size = size
        self.figure.xaxis.axis_label = f"excitation frequency [{name}]"
        self.choose(self._omega)

    def fade(self, stale: bool) -> None:
        """Draw the curve pale, because it is not that of the problem in the form; or as usual."""
        lines, marks, doubts = self._drawn
        opacity = PALE if stale else 1.0
        lines.glyph.line_alpha = opacity
        for one in (marks, doubts):
            one.glyph.update(fill_alpha=opacity, line_alpha=opacity)

    def _tapped(self, event: Event) -> None:
        if self._frequencies and isinstance(event, Tap) and event.x is not None:
            self._choose(int(np.argmin(np.abs(np.array(self._frequencies) - event.x))))


def fit(axis: Any, values: Any) -> None:
    """Let an axis reach from the least to the largest of some values, with `ROOM` on either side."""
    if len(values):
        low, high = float(np.min(values)), float(np.max(values))
        room = ROOM * (high - low) or 1e-9 + ROOM * abs(high)
        axis.update(start=low - room, end=high + room)


def said(point: Point) -> str:
    """What was established of a point, in a few words."""
    return point.message or motion_words(point.outcome.lower(), point.period_multiple, point.symmetric)


def _kind(point: Point) -> float:
    """A number for the kind of motion; lines join points of one kind."""
    return -1.0 if point.outcome == FAILED else point.period_multiple + 0.5 * point.symmetric


def as_csv(frequencies: Sequence[float], points: Mapping[int, Point], stops: Sequence[str]) -> str:
    """The curve as a table with commas; floats have the digits that give them back."""
    rows = [",".join(["angular_frequency [rad/s]", "outcome", *(f"impulse of {name} [N s]" for name in stops)])]
    for i in sorted(points):
        values = points[i].impulses or (math.nan,) * len(stops)
        rows.append(",".join([repr(frequencies[i]), points[i].outcome, *map(repr, values)]))
    return "\n".join(rows) + "\n"
