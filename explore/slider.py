"""One number of the problem under a slider, with a choice of which one."""

from __future__ import annotations

import math
from collections.abc import Mapping
from functools import partial
from typing import Any

import panel_material_ui as pmui

from explore.editing import Change, assigned
from explore.form import Field, all_parts, form_of
from lapjoint.answers.series import written
from lapjoint.campaigns.grid import UNITS
from lapjoint.errors import InputError
from lapjoint.problem.override import targets

AROUND = 5.0
"""The slider goes from a fifth to five times the number that it starts from: a joint is hardly known worse."""
POSITIONS = 200
"""Number of positions of the slider on either side of its middle."""
DIGITS = 4
"""Significant digits of the numbers that the slider gives."""
FIRST = "stops.*.gap"
"""The number that the slider turns in a problem that has it: the gap of all stops together."""


class Turned:
    """The slider.

    Parameters
    ----------
    change : Change
        Called when a person turns the slider.
    """

    def __init__(self, change: Change) -> None:
        self._change = change
        self._middle, self._showing = 1.0, False
        self._tables: Mapping[str, Any] = {}
        self._which = pmui.Select(
            label="Number under the slider", options=[], size="small", sizing_mode="stretch_width"
        )
        self._slider = pmui.FloatSlider(label="", start=-1.0, end=1.0, step=1 / POSITIONS, value=0.0, show_value=False)
        self._slider.sizing_mode = "stretch_width"
        self._which.param.watch(self._choose, "value")
        self._slider.param.watch(self._turn, "value")
        self.view = pmui.Row(self._which, self._slider, sizing_mode="stretch_width")

    def show(self, tables: Mapping[str, Any]) -> None:
        """Show the number of a problem."""
        self._tables = tables
        paths = [path for path in (FIRST, *_numbers(tables)) if self._value(path)]
        self._showing = True
        try:
            if list(self._which.options) != paths:
                chosen = self._which.value if self._which.value in paths else next(iter(paths), None)
                self._which.param.update(options=paths, value=chosen)
            self.view.visible = bool(paths)
            if paths:
                self._follow()
        finally:
            self._showing = False

    def _follow(self) -> None:
        """Put the slider where the number is; a new middle where the number is out of its reach, or another one."""
        value = self._value(self._which.value)
        if value and (value * self._middle <= 0 or not 1 / AROUND <= value / self._middle <= AROUND):
            self._middle = value
        if value and self._at(self._slider.value) != value:
            self._slider.value = math.log(value / self._middle) / math.log(AROUND)
        unit = UNITS.get(str(self._which.value).rpartition(".")[2], "1")
        self._slider.label = f"{self._which.value} = {value:.{DIGITS}g} {'' if unit == '1' else written(unit)}"

    def _at(self, position: float) -> float:
        """The number at a position of the slider, -1 to 1."""
        return float(f"{self._middle * AROUND**position:.{DIGITS}g}")

    def _value(self, path: str | None) -> float:
        """The number at a path; 0 if there is none, or several that differ."""
        try:
            found = {value for _, value in targets(dict(self._tables), path or "", "slider")}
        except InputError:
            return 0.0
        value = found.pop() if len(found) == 1 else None
        if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
            return 0.0
        return float(value)

    def _choose(self, event: Any) -> None:
        if not self._showing:
            self._middle = self._value(event.new) or 1.0
            self.show(self._tables)

    def _turn(self, event: Any) -> None:
        if not self._showing:
            self._change(partial(assigned, path=self._which.value, value=self._at(event.new)), self._which.value)


def _numbers(tables: Mapping[str, Any]) -> list[str]:
    """The paths of all numbers of a problem that are not 0."""
    fields = [part for part in all_parts(form_of(tables)) if isinstance(part, Field) and part.kind == "value"]
    return [field.path for field in fields if field.text and not field.text.startswith("[")]
