"""The curve on the page: its picture, a sentence about it, and the range of frequencies."""

from __future__ import annotations

import math
import time
from collections import Counter
from collections.abc import Callable
from html import escape
from itertools import accumulate
from typing import Any

import panel as pn
import panel_material_ui as pmui

from explore import results
from explore.answers import Answer, CurvePart, Failed
from explore.computing import Computing
from explore.curve_picture import CurvePicture, as_csv
from explore.question import Question, coarse_to_fine
from lapjoint.campaigns.point import Point
from lapjoint.errors import InputError
from lapjoint.figures.curve_features import motion_words
from lapjoint.figures.text import frequency_text
from lapjoint.problem import Problem

PAINT = 0.08
"""Least time between two drawings of a curve that grows, s: a browser draws it in about half of that."""
WAIT = 0.5
"""Time for which the curve before stays, pale, while the first of a new one is not whole, s."""
PATIENCE = 3
"""Time without any point after which the page says why, s."""
_WIDE = "stretch_width"


class CurveView:
    """The curve.

    Parameters
    ----------
    choose : callable
        Called with a frequency that was clicked, rad/s.
    turn : callable
        Called with another range of frequencies, in the unit of the page.
    turn_unit : callable
        Called with whether frequencies shall be in Hz.
    later : callable
        Calls a function after a time, ms, when the models of pictures may be changed.
    """

    def __init__(
        self,
        choose: Callable[[float], None],
        turn: Callable[[float, float], None],
        turn_unit: Callable[[bool], None],
        later: Callable[[Callable[[], None], int], Any],
    ) -> None:
        self._choose, self._turn, self._later = choose, turn, later
        self._number = 0
        self._key: object = None
        self._frequencies: tuple[float, ...] = ()
        self._points: dict[int, Point] = {}
        self._stops: tuple[str, ...] = ()
        self._sizes: list[int] = []
        """Numbers of points of the curves that follow each other."""
        self._ends, self._unit = (0.0, 0.0), ""
        self._failed, self._stale = "", False
        self._asked, self._drawn, self._waits = 0.0, 0.0, False
        self._picture = CurvePicture(self._clicked)
        self._summary = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE])
        self._first = pmui.TextInput(size="small", sizing_mode=_WIDE)
        self._last = pmui.TextInput(size="small", sizing_mode=_WIDE)
        self._hz = pmui.Switch(label="Hz")
        for one in (self._first, self._last):
            one.param.watch(self._ranged, "value")
        self._hz.param.watch(lambda event: turn_unit(event.new), "value")
        ranges = pmui.Row(self._first, self._last, self._hz, sizing_mode=_WIDE)
        picture = pn.pane.Bokeh(self._picture.figure, sizing_mode=_WIDE)
        self.view = pmui.Column(picture, self._summary, ranges, sizing_mode=_WIDE)

    def show(self, question: Question) -> None:
        """Show the range of frequencies of a question, in its unit."""
        (name, size), self._ends = question.unit, (question.first, question.last)
        self._hz.value = question.hz
        for one, label, value in zip((self._first, self._last), ("from", "to"), self._ends, strict=True):
            one.param.update(label=f"{label} [{name}]", value=repr(value), error_state=False, helper_text="")
        if name != self._unit:
            self._unit = name
            self._picture.in_unit(name, size)
            self._picture.show(self._frequencies, self._points, self._stops)

    def ask(self, question: Question, problem: Problem, computing: Computing) -> None:
        """Ask for the curve of a question, whose problem is valid, unless it is the one that was asked last."""
        self._stale = False
        try:
            plan = question.plan(problem)
            key = plan.grid.problem_at(0), plan.grid.axes
        except InputError as error:
            self._failed, self._key, self._points, self._frequencies, self._stops = str(error), None, {}, (), ()
            self._number = computing.ask("curve", None)
            self._draw()
            return
        if key == self._key:
            self._picture.fade(False)
            self._tell()
            return
        self._failed, self._key, self._points = "", key, {}
        self._sizes = list(accumulate(map(len, coarse_to_fine(plan.size))))
        self._frequencies, self._stops = plan.grid.axes[0].values, plan.grid.problem.stop_names
        self._asked = time.monotonic()
        self._picture.fade(True)
        self._number = computing.ask("curve", question)
        self._later(self._comfort, 1000 * PATIENCE)

    def take(self, number: int, answer: Answer) -> None:
        """Take an answer, if it is one to the question that was asked last."""
        if number != self._number:
            return
        if isinstance(answer, Failed):
            self._failed = answer.message
            self._tell()
        elif isinstance(answer, CurvePart):
            self._points |= answer.points
            self._draw_soon()

    def outdate(self) -> None:
        """Say that the curve is not that of the problem in the form, which is not valid."""
        self._stale = True
        self._picture.fade(True)
        self._tell()

    def mark(self, omega: float | None) -> None:
        """Mark the frequency of the cycle, rad/s."""
        self._picture.choose(omega)

    def csv(self) -> str:
        """The curve as a table with commas."""
        return as_csv(self._frequencies, self._points, self._stops)

    def _comfort(self) -> None:
        """Say what takes so long."""
        if not self._points and not self._failed:
            self._summary.object = (
                '<p role="status">Computing. The first start after an installation compiles the solvers, which takes '
                "up to a minute.</p>"
            )

    def _draw_soon(self) -> None:
        """Draw the curve when a curve is whole, and else now and then."""
        now = time.monotonic()
        if len(self._points) in self._sizes:
            self._draw()
        elif (len(self._points) < self._sizes[0] and now < self._asked + WAIT) or now < self._drawn + PAINT:
            if not self._waits:
                self._waits = True
                self._later(self._draw_late, round(1000 * PAINT))
        else:
            self._draw()

    def _draw_late(self) -> None:
        """Draw what came too soon after the drawing before."""
        self._waits = False
        if self._sizes and len(self._points) not in (0, *self._sizes):
            self._draw_soon()

    def _draw(self) -> None:
        self._drawn = time.monotonic()
        self._picture.show(self._frequencies, self._points, self._stops)
        self._picture.fade(self._stale)
        self._tell()

    def _tell(self) -> None:
        self._summary.object = f'<p role="status">{self._sentence()}</p>'

    def _sentence(self) -> str:
        """The curve in a sentence or two, also for who cannot see it."""
        if self._stale:
            return "The problem is not valid; this is the curve of the last one that was."
        if self._failed:
            return f"There is no curve. {escape(self._failed)}"
        known, size = len(self._points), len(self._frequencies)
        outcomes = Counter(motion_words(point.outcome.lower(), 0, False) for point in self._points.values())
        motions = ", ".join(f"{count} {outcome}" for outcome, count in outcomes.most_common())
        peaks = [
            (abs(value), self._frequencies[i], name)
            for i, point in self._points.items()
            for name, value in zip(self._stops, point.impulses, strict=False)
            if math.isfinite(value)
        ]
        if not peaks:
            return f"{known} of {size} frequencies."
        value, omega, name = max(peaks)
        largest = f"largest impulse {value:.5g} N s, of {escape(name)} at {frequency_text(omega)}"
        return f"{known} of {size} frequencies: {motions}; {largest if value else 'no stop is touched'}."

    def _clicked(self, number: int) -> None:
        self._choose(self._frequencies[number])

    def _ranged(self, event: Any) -> None:
        """Take another end of the range; what is no number is refused at its field."""
        try:
            value = float(event.new)
        except ValueError:
            event.obj.param.update(error_state=True, helper_text=f"{event.new!r}: must be a number, in {self._unit}")
            return
        i = (self._first, self._last).index(event.obj)
        if value != self._ends[i]:
            first, last = (value if k == i else end for k, end in enumerate(self._ends))
            self._turn(first, last)
