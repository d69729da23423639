"""The cycle on the page: pictures, the verdict on both solvers, and tables."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import panel as pn
import panel_material_ui as pmui

from explore import results
from explore.answers import Answer, Compared, Cycle, CycleFound, Drawn, Failed, Natural
from explore.computing import Computing
from explore.curve_picture import PALE
from explore.cycle_pictures import CyclePictures, as_csv
from explore.film import Film, scene_of
from explore.question import Question
from explore.sketch import Sketch
from lapjoint.figures.text import frequency_text
from lapjoint.problem import Problem
from validation.case import CaseResult

_WIDE = "stretch_width"


class CycleView:
    """The cycle by both solvers; that of the question before stays until the first solver has answered.

    Parameters
    ----------
    move : callable
        Called with the path of a number that was dragged in the sketch, and its value as text.
    later : callable
        Calls a function after a time, ms, when the models of pictures may be changed.
    """

    def __init__(self, move: Callable[[str, str], None], later: Callable[[Callable[[], None], int], Any]) -> None:
        self.sketch, self._film = Sketch(sizing_mode=_WIDE), Film(sizing_mode=_WIDE)
        self.sketch.param.watch(lambda event: move(*event.new[:2]), "moved", onlychanged=False)
        self.natural = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE])
        self.first_frequency = 0.0
        """The lowest natural frequency with all stops open, rad/s; 0 if it is not known."""
        self._number, self._stale = 0, False
        self._problem: Problem | None = None
        self._cycles: dict[str, Cycle] = {}
        self._compared: CaseResult | None = None
        self._failed = ""
        self._pictures = CyclePictures()
        self._headline = pmui.Typography("Cycle", variant="h2", sx={"fontSize": "1.15rem"})
        self._verdict, self._tables = (
            pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE]) for _ in range(2)
        )

        def column(*figures: Any, width: int) -> Any:
            return pmui.Grid(*(pn.pane.Bokeh(one, sizing_mode=_WIDE) for one in figures), size={"xs": 12, "lg": width})

        pictures = pmui.Grid(
            column(self._pictures.history, self._pictures.contacts, width=7),
            column(self._pictures.portrait, self._pictures.multipliers, width=5),
            container=True,
            spacing=1,
            sizing_mode=_WIDE,
        )
        self._film.param.watch(lambda _: later(lambda: self._pictures.mark(self._film.time), 0), "time")
        self._below = pmui.Column(self._film, pictures, self._tables, sizing_mode=_WIDE)
        self.view = pmui.Column(self._headline, self._verdict, self._below, sizing_mode=_WIDE)

    def ask(self, question: Question, problem: Problem, computing: Computing) -> None:
        """Ask for the cycle of a question, whose problem is valid."""
        self._problem, self._cycles, self._compared, self._failed = problem, {}, None, ""
        self._stale, self._film.rests = False, True
        omega = problem.excitation_frequency
        self._headline.object = "Cycle" if omega is None else f"Cycle at {frequency_text(omega)}"
        self._number = computing.ask("cycle", question)
        self._tell()

    def take(self, number: int, answer: Answer) -> None:
        """Take an answer, if it is one to the question that was asked last."""
        if number != self._number or self._problem is None:
            return
        if isinstance(answer, Drawn):
            self.sketch.drawn = answer
            return
        if isinstance(answer, Natural):
            self.natural.object = results.natural_line(answer)
            self.first_frequency = float(answer.angular_frequencies[0])
            return
        if isinstance(answer, Failed):
            self._failed = answer.message
        elif isinstance(answer, CycleFound):
            if not self._cycles:
                self._film.scene = scene_of(self._problem, answer.cycle)
                self._film.rests = False
            self._cycles[answer.solver] = answer.cycle
        elif isinstance(answer, Compared):
            self._compared = answer.result
        self._film.visible = bool(self._cycles)
        if not isinstance(answer, Compared):
            self._pictures.show(self._cycles, self._problem.stop_names)
        self._tables.object = results.tables(self._compared, self._cycles)
        self._tell()

    def outdate(self) -> None:
        """Say that the cycle is not that of the problem in the form, which is not valid."""
        self._stale = True
        self._tell()

    def csv(self) -> str:
        """The time histories as a table with commas."""
        return as_csv(self._cycles)

    def _tell(self) -> None:
        outcome = next((f"<p>{cycle.outcome}</p>" for cycle in self._cycles.values()), "")
        line = results.verdict_line(self._compared, self._cycles, self._failed)
        older = bool(self._tables.object) and not self._cycles
        self._below.styles = {"opacity": str(PALE if older else 1)}
        if self._stale:
            line = results.STALE
        elif older:
            outcome = results.BEFORE
        self._verdict.object = f'<div role="status">{line}</div>{outcome}'
