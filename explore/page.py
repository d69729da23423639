"""One open page: the form on the left, on the right the curve and the cycle, and what a change of the question does."""

from __future__ import annotations

import io
import time
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import partial
from html import escape
from itertools import accumulate
from typing import Any
from urllib.parse import parse_qs

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document

from explore import curve_picture, cycle_pictures, results
from explore.answers import Answer, Compared, CurvePart, Cycle, CycleFound, Failed, Part
from explore.computing import Computing
from explore.curve_picture import CurvePicture
from explore.cycle_pictures import CyclePictures
from explore.editing import Tables
from explore.faults import checked
from explore.form_view import FormView
from explore.question import Question, coarse_to_fine, opened, read_back, unpacked
from explore.slider import Turned
from explore.starts import starts, tables_of
from lapjoint.campaigns.point import Point
from lapjoint.errors import InputError
from lapjoint.figures.text import frequency_text
from lapjoint.problem.files import tables_from_toml
from validation.case import CaseResult

STATE = "state"
"""Name of the state in the address."""
FILE = "problem.toml"
"""Name of the file that a page saves."""
GESTURE = 1.0
"""Time within which changes of one field are undone together, s: a slider that is turned changes it often."""
PAINT = 0.08
"""Least time between two drawings of a curve that grows, s: a browser draws it in about half of that."""
MOST_UNDONE = 200
"""Number of changes that can be undone."""
_WIDE = "stretch_width"
_HEADING = "h1 { font-size: 1.3rem; margin: 0.4rem 0 }"


class Page:
    """One open page.

    Parameters
    ----------
    first : Question
        What it asks when it is opened.
    """

    def __init__(self, first: Question) -> None:
        self._document: Document = here()
        self._computing: Computing | None = None
        self._question, self._checked = first, checked(first)
        self._undo: list[Question] = []
        self._redo: list[Question] = []
        self._changed = "", 0.0
        """The path that was changed last, and when, s of the monotonic clock."""
        self._curve: dict[int, Point] = {}
        self._frequencies: tuple[float, ...] = ()
        self._curve_of: Any = None
        self._stops: tuple[str, ...] = ()
        self._cycles: dict[str, Cycle] = {}
        self._compared: CaseResult | None = None
        self._failed: dict[Part, str] = {"curve": "", "cycle": ""}
        self._stale: set[Part] = set()
        self._numbers: dict[Part, int] = {}
        self._drawn, self._later = 0.0, False
        self._sizes: list[int] = []
        """Numbers of points of the curves that follow each other."""
        self._form, self._slider = FormView(self._edit), Turned(self._edit)
        self._curve_picture, self._cycle_pictures = CurvePicture(self._choose), CyclePictures()
        self._make_widgets()
        self._show_question()

    def _make_widgets(self) -> None:
        text = {"size": "small", "sizing_mode": _WIDE}
        self._status = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE])
        self._messages = pmui.Alert("", severity="error", visible=False, sizing_mode=_WIDE)
        self._first = pmui.TextInput(label="from [rad/s]", **text)
        self._last = pmui.TextInput(label="to [rad/s]", **text)
        for one in (self._first, self._last):
            one.param.watch(self._ranged, "value")
        self._back = pmui.IconButton(icon="undo", label="Undo", description="Undo", on_click=lambda _: self._undone())
        self._again = pmui.IconButton(icon="redo", label="Redo", description="Redo", on_click=lambda _: self._redone())
        self._start = pmui.Select(label="Start from", options={"...": "", **starts()}, value="", **text)
        self._start.param.watch(self._started, "value")
        self._file = pmui.FileInput(label="Open a file", accept=".toml,.json", size="small", variant="outlined")
        self._file.param.watch(self._loaded, "value")
        self._commands = pmui.TextAreaInput(
            label="The commands that do this", disabled=False, rows=3, sizing_mode=_WIDE
        )
        self._link = pmui.TextInput(label="A link to this state, while this program runs", **text)
        self._verdict = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE])
        self._tables = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE])
        self._summary = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[results.STYLE])
        self._headline = pmui.Typography("", variant="h6")

    def view(self) -> Any:
        """The page as Panel shows it."""
        save = self._download("Save as problem.toml", FILE, lambda: self._question.problem)
        state = self._download("Save the state", "explore.json", lambda: self._question.written())
        curve = self._download("Curve as CSV", "curve.csv", self._curve_csv)
        cycle = self._download("Cycle as CSV", "cycle.csv", lambda: cycle_pictures.as_csv(self._cycles))
        left = pmui.Column(
            pmui.FlexBox(self._back, self._again, save, state),
            pmui.Row(self._start, self._file, sizing_mode=_WIDE),
            self._messages,
            self._form.view,
            sizing_mode=_WIDE,
        )
        pictures = self._cycle_pictures
        right = pmui.Column(
            self._slider.view,
            pn.pane.Bokeh(self._curve_picture.figure, sizing_mode=_WIDE),
            self._summary,
            pmui.Row(self._first, self._last, sizing_mode=_WIDE),
            self._headline,
            self._verdict,
            pmui.Grid(
                pmui.Grid(
                    pn.pane.Bokeh(pictures.history, sizing_mode=_WIDE),
                    pn.pane.Bokeh(pictures.contacts, sizing_mode=_WIDE),
                    size={"xs": 12, "lg": 7},
                ),
                pmui.Grid(
                    pn.pane.Bokeh(pictures.portrait, sizing_mode=_WIDE),
                    pn.pane.Bokeh(pictures.multipliers, sizing_mode=_WIDE),
                    size={"xs": 12, "lg": 5},
                ),
                container=True,
                spacing=1,
                sizing_mode=_WIDE,
            ),
            self._tables,
            pmui.FlexBox(curve, cycle),
            self._commands,
            self._link,
            sizing_mode=_WIDE,
        )
        grid = pmui.Grid(
            pmui.Grid(left, size={"xs": 12, "md": 4}),
            pmui.Grid(right, size={"xs": 12, "md": 8}),
            container=True,
            spacing=2,
            sizing_mode=_WIDE,
        )
        toggle = pmui.ThemeToggle()  # type: ignore[attr-defined]  # the package finds it when it is asked for
        title = pn.pane.HTML("<h1>lapjoint explore</h1>", sizing_mode=_WIDE, stylesheets=[_HEADING])
        return pmui.Column(pmui.Row(title, toggle, sizing_mode=_WIDE), grid, sizing_mode=_WIDE, margin=(5, 15))

    def _download(self, text: str, name: str, content: Callable[[], str]) -> Any:
        """A button that saves what a function gives."""
        return pmui.FileDownload(
            callback=lambda: io.StringIO(content()), filename=name, label=text, variant="outlined", size="small"
        )

    def begin(self, computing: Computing) -> None:
        """Ask what the page shows, of processes for this page alone."""
        self._computing = computing
        computing.deliver = self._heard
        self._ask()

    def refuse(self, message: str) -> None:
        """Say why the page has no answers."""
        self._messages.param.update(object=message, visible=True, severity="error")

    # What a person does.

    def _edit(self, edit: Callable[[Mapping[str, Any]], Tables], path: str) -> None:
        """Change the problem."""
        self._take(self._question.with_tables(edit(self._question.tables)), path)

    def _choose(self, number: int) -> None:
        """Choose a frequency of the curve for the cycle."""
        if self._checked.problem is None or not number < len(self._frequencies):
            return
        try:
            self._take(self._question.at_frequency(self._frequencies[number]), "frequency")
        except InputError as error:
            self._failed["cycle"] = str(error)
            self._show_answers()

    def _ranged(self, _: Any) -> None:
        """Take another range of frequencies; what is no number is refused at its field."""
        values = []
        for one in (self._first, self._last):
            try:
                values.append(float(one.value))
                one.param.update(error_state=False, helper_text="")
            except ValueError:
                one.param.update(error_state=True, helper_text=f"{one.value!r}: must be a number, in rad/s")
        if len(values) == 2 and values != [self._question.first, self._question.last]:
            self._take(replace(self._question, first=values[0], last=values[1]), "range")

    def _started(self, event: Any) -> None:
        """Start from a preset, or a problem of the gallery."""
        if event.new:
            self._take(opened(tables_of(event.new), self._question.folder), event.new)
            self._start.value = ""

    def _loaded(self, event: Any) -> None:
        """Open a file: a problem, or a state that a page saved."""
        if not event.new:
            return
        name = str(self._file.filename)
        try:
            text = event.new.decode("utf-8-sig")
            if name.endswith(".json"):
                self._take(read_back(text, self._question.folder), name)
            else:
                self._take(opened(tables_from_toml(text, name), self._question.folder), name)
        except (InputError, UnicodeDecodeError) as error:
            self._messages.param.update(object=f"{name}: {error}", visible=True, severity="error")

    def _undone(self) -> None:
        if self._undo:
            self._redo.append(self._question)
            self._turn_to(self._undo.pop())

    def _redone(self) -> None:
        if self._redo:
            self._undo.append(self._question)
            self._turn_to(self._redo.pop())

    def _take(self, question: Question, path: str) -> None:
        """Take a changed question; changes of one path in one gesture are undone together."""
        if question == self._question:
            return
        now = time.monotonic()
        if not (path == self._changed[0] and now < self._changed[1] + GESTURE):
            self._undo = [*self._undo[-MOST_UNDONE:], self._question]
        self._changed = path, now
        self._redo = []
        self._turn_to(question)

    def _turn_to(self, question: Question) -> None:
        """Ask another question."""
        self._question, self._checked = question, checked(question)
        self._ask()
        self._show_question()

    # What is asked, and what comes back.

    def _ask(self) -> None:
        """Ask for the parts of the question that are not those that were asked before."""
        if self._computing is None:
            return
        if self._checked.problem is None:
            self._stale = {"curve", "cycle"}
            self._show_answers()
            return
        self._failed = {"curve": "", "cycle": ""}
        self._ask_curve(self._computing)
        self._compared, self._cycles = None, {}
        self._numbers["cycle"] = self._computing.ask("cycle", self._question)
        self._stale = set()
        self._show_answers()

    def _ask_curve(self, computing: Computing) -> None:
        try:
            plan = self._question.plan()
            key = plan.grid.problem_at(0), plan.grid.axes
        except InputError as error:
            self._failed["curve"], self._curve_of, self._curve, self._frequencies = str(error), None, {}, ()
            self._numbers["curve"] = computing.ask("curve", None)
            return
        if key == self._curve_of:
            return
        self._curve_of, self._curve = key, {}
        self._sizes = list(accumulate(map(len, coarse_to_fine(plan.size))))
        self._frequencies, self._stops = plan.grid.axes[0].values, plan.grid.problem.stop_names
        self._numbers["curve"] = computing.ask("curve", self._question)

    def _heard(self, part: Part, number: int, answer: Answer) -> None:
        """Called in another thread."""
        self._document.add_next_tick_callback(partial(self._take_answer, part, number, answer))

    def _take_answer(self, part: Part, number: int, answer: Answer) -> None:
        if number != self._numbers.get(part):
            return
        if isinstance(answer, CurvePart):
            self._curve |= answer.points
            whole = len(self._curve) in self._sizes
            if whole or time.monotonic() > self._drawn + PAINT:
                self._draw_curve()
            elif not self._later:
                self._later = True
                self._document.add_timeout_callback(self._draw_late, round(1000 * PAINT))
            return
        if isinstance(answer, CycleFound):
            self._cycles[answer.solver] = answer.cycle
        elif isinstance(answer, Compared):
            self._compared = answer.result
        elif isinstance(answer, Failed):
            self._failed[part] = answer.message
        self._show_answers()

    # What is shown.

    def _show_question(self) -> None:
        """Show the form and all that follows from the question alone."""
        question, found = self._question, self._checked
        tables = question.tables
        self._form.show(tables, found.faults, found.hints)
        self._slider.show(tables)
        self._first.value, self._last.value = f"{question.first!r}", f"{question.last!r}"
        general = "\n".join(self._form.general)
        severity = "error" if found.faults else "warning"
        self._messages.param.update(object=general, visible=bool(general), severity=severity)
        self._back.disabled, self._again.disabled = not self._undo, not self._redo
        self._commands.value = "\n".join(question.commands(FILE))
        location = pn.state.location
        if location is not None:
            location.search = f"?{STATE}={question.packed()}"
            self._link.value = (
                f"{location.protocol}//{location.hostname}:{location.port}{location.pathname}{location.search}"
            )

    def _draw_curve(self) -> None:
        self._drawn = time.monotonic()
        self._curve_picture.show(self._frequencies, self._curve, self._stops)
        self._curve_picture.fade("curve" in self._stale)
        self._summary.object = f'<p role="status">{self._curve_summary()}</p>'

    def _draw_late(self) -> None:
        """Draw the points that came too soon after others."""
        self._later = False
        self._draw_curve()

    def _curve_summary(self) -> str:
        """The curve in a sentence or two, also for who cannot see it."""
        if self._failed["curve"]:
            return escape(self._failed["curve"])
        if "curve" in self._stale:
            return "The problem is not valid; this is the curve of the last one that was."
        known, size = len(self._curve), len(self._frequencies)
        doubts = sum(point.outcome not in curve_picture.CERTAIN for point in self._curve.values())
        peaks = [
            (abs(value), self._frequencies[i], name)
            for i, point in self._curve.items()
            for name, value in zip(self._stops, point.impulses, strict=False)
        ]
        if not peaks:
            return f"{known} of {size} frequencies."
        value, omega, name = max(peaks)
        largest = f"largest impulse {value:.5g} N s, of {escape(name)} at {frequency_text(omega)}"
        return f"{known} of {size} frequencies, {doubts} not certified to repeat; {largest}."

    def _show_answers(self) -> None:
        """Show the cycle, and how the curve stands."""
        problem = self._checked.problem
        omega = None if problem is None else problem.excitation_frequency
        self._draw_curve()
        self._curve_picture.choose(omega)
        if "cycle" in self._stale:
            return
        stops = () if problem is None else problem.stop_names
        self._cycle_pictures.show(self._cycles, stops)
        self._headline.object = "Cycle" if omega is None else f"Cycle at {frequency_text(omega)}"
        first = next(iter(self._cycles.values()), None)
        verdict = results.verdict_line(self._compared, self._cycles, self._failed["cycle"])
        self._verdict.object = f'<div role="status">{verdict}</div>' + (f"<p>{first.outcome}</p>" if first else "")
        self._tables.object = results.tables(self._compared, self._cycles)

    def _curve_csv(self) -> str:
        return curve_picture.as_csv(self._frequencies, self._curve, self._stops)


def here() -> Document:
    """The document of the page that is being made or changed."""
    document = pn.state.curdoc
    assert document is not None
    return document


def question_in(address: str, otherwise: Question) -> Question:
    """The question in the query of an address; another one where there is none, or none that is whole."""
    found = parse_qs(address.removeprefix("?")).get(STATE)
    if not found:
        return otherwise
    try:
        return unpacked(found[0], otherwise.folder)
    except InputError:
        return otherwise
