"""The pictures of the cycle: displacement over time, contacts, velocity over displacement, and Floquet multipliers."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from bokeh.models import ColumnDataSource, FactorRange, HoverTool, Range1d
from bokeh.models.annotations.geometry import Span
from bokeh.plotting import figure

from explore.answers import Cycle
from explore.curve_picture import fit
from lapjoint.figures.style import COLOURS

HEIGHT, ROW = 260, 26
"""Height of a picture, and of the row of a stop, pixels."""
NAMES = {"analytic": "analytic", "fe": "finite elements"}
MARKERS = {"analytic": "circle", "fe": "square"}
DASHES = {"analytic": "solid", "fe": "dashed"}


class CyclePictures:
    """Time history, contacts, phase portrait and multipliers of the cycle, by both solvers."""

    def __init__(self) -> None:
        self._time = {name: ColumnDataSource({"t": [], "z": [], "v": []}) for name in NAMES}
        self._bars = ColumnDataSource({key: [] for key in ("stop", "start", "end", "impulse", "solver", "colour")})
        self._stops = FactorRange()
        self.history = figure(
            height=HEIGHT,
            sizing_mode="stretch_width",
            tools="pan,box_zoom,reset,save",
            active_drag=None,
            toolbar_location="above",
            x_range=Range1d(start=0.0, end=1.0),
            y_range=Range1d(start=-1.0, end=1.0),
            x_axis_label="time [s]",
            y_axis_label="displacement [m]",
            name="time history",
        )
        self.contacts = figure(
            height=ROW * 3,
            sizing_mode="stretch_width",
            tools="save",
            toolbar_location=None,
            x_range=self.history.x_range,
            y_range=self._stops,
            x_axis_label="contacts over time [s]",
            name="contacts",
        )
        self.portrait = figure(
            height=HEIGHT + 40,
            sizing_mode="stretch_width",
            tools="pan,box_zoom,reset,save",
            active_drag=None,
            toolbar_location="above",
            x_range=Range1d(start=-1.0, end=1.0),
            y_range=Range1d(start=-1.0, end=1.0),
            x_axis_label="displacement [m]",
            y_axis_label="velocity [m/s]",
            name="phase portrait",
        )
        for i, (name, text) in enumerate(NAMES.items()):
            look: dict[str, Any] = {
                "source": self._time[name],
                "color": COLOURS[i],
                "line_dash": DASHES[name],
                "line_width": 2,
            }
            line = self.history.line("t", "z", legend_label=text, **look)
            self.portrait.line("z", "v", legend_label=text, **look)
            if name == "analytic":
                self.history.add_tools(
                    HoverTool(
                        tooltips=[("t", "@t{0.00000} s"), ("z", "@z{0.000e+0} m")], renderers=[line], mode="vline"
                    )
                )
        bars = self.contacts.hbar(
            y="stop", left="start", right="end", height=0.7, source=self._bars, color="colour", alpha=0.6
        )
        tips = [
            ("", "@stop, @solver"),
            ("from", "@start{0.00000} s"),
            ("to", "@end{0.00000} s"),
            ("impulse", "@impulse{0.0000} N s"),
        ]
        self.contacts.add_tools(HoverTool(tooltips=tips, renderers=[bars]))
        self._multipliers = {name: ColumnDataSource({"re": [], "im": []}) for name in NAMES}
        self.multipliers = figure(
            height=HEIGHT,
            sizing_mode="stretch_width",
            tools="save",
            toolbar_location="above",
            match_aspect=True,
            x_axis_label="multiplier, real part",
            y_axis_label="imaginary part",
            name="multipliers",
        )
        self.multipliers.circle(x=0.0, y=0.0, radius=1.0, fill_alpha=0.0, line_color="gray")
        for i, name in enumerate(NAMES):
            self.multipliers.scatter(
                "re",
                "im",
                source=self._multipliers[name],
                marker=MARKERS[name],
                size=9,
                fill_alpha=0.0,
                line_width=2,
                line_color=COLOURS[i],
            )
        self._now = Span(dimension="height", line_color="gray", line_dash="dotted", visible=False)
        self.history.add_layout(self._now)
        for one in (self.history, self.contacts, self.portrait, self.multipliers):
            one.toolbar.logo = None
        for one in (self.history, self.portrait):
            one.legend.visible = False
            one.add_layout(one.legend[0], "below")
            one.legend[0].orientation = "horizontal"

    def show(self, cycles: Mapping[str, Cycle], stops: Sequence[str]) -> None:
        """Draw the cycles that are known, by the names of their solvers."""
        for name, source in self._time.items():
            cycle = cycles.get(name)
            none = np.zeros(0)
            source.data = {
                "t": none if cycle is None else cycle.t,
                "z": none if cycle is None else cycle.z,
                "v": none if cycle is None else cycle.v,
            }
            values = np.array(() if cycle is None else cycle.multipliers, dtype=complex)
            self._multipliers[name].data = {"re": values.real, "im": values.imag}
        rows = [
            (stops[bar.stop], bar.start, bar.end, bar.impulse, NAMES[name], COLOURS[list(NAMES).index(name)])
            for name, cycle in cycles.items()
            for bar in cycle.bars
        ]
        columns = list(zip(*rows, strict=True)) or [()] * 6
        self._bars.data = {
            key: list(column)
            for key, column in zip(("stop", "start", "end", "impulse", "solver", "colour"), columns, strict=True)
        }
        touched = list(dict.fromkeys(reversed(stops)))
        if self._stops.factors != touched:
            self._stops.factors = touched
            self.contacts.height = ROW * max(len(touched), 1) + 60
        for one in (self.history, self.portrait):
            one.legend.visible = bool(cycles)
        t, z, v = (np.concatenate([np.zeros(0), *(getattr(cycle, key) for cycle in cycles.values())]) for key in "tzv")
        for axis, values in (
            (self.history.x_range, t),
            (self.history.y_range, z),
            (self.portrait.x_range, z),
            (self.portrait.y_range, v),
        ):
            fit(axis, values)
        place = next((cycle.place for cycle in cycles.values()), "")
        self.history.yaxis.axis_label = f"displacement at {place} [m]" if place else "displacement [m]"

    def mark(self, time: float | None) -> None:
        """Mark a time of the film, s since the start of the motion."""
        self._now.update(location=time or 0.0, visible=time is not None)


def as_csv(cycles: Mapping[str, Cycle]) -> str:
    """The time histories as a table with commas; floats have the digits that give them back."""
    heads = [
        f"{text} of {name} [{unit}]" for name in cycles for text, unit in (("displacement", "m"), ("velocity", "m/s"))
    ]
    first = next(iter(cycles.values()), None)
    if first is None:
        return ""
    columns = [column for cycle in cycles.values() for column in (cycle.z, cycle.v)]
    rows = [",".join(map(repr, map(float, row))) for row in zip(first.t, *columns, strict=True)]
    return "\n".join([",".join(["time [s]", *heads]), *rows]) + "\n"
