"""One open page: the form on the left, on the right the curve and the cycle, and what a change of the question does."""

from __future__ import annotations

import io
import time
from collections.abc import Callable
from dataclasses import replace
from functools import partial
from html import escape
from typing import Any
from urllib.parse import parse_qs

import panel as pn
import panel_material_ui as pmui
from bokeh.document import Document

from explore.answers import Answer, Part
from explore.computing import Computing
from explore.curve_view import CurveView
from explore.cycle_view import CycleView
from explore.editing import Edit, typed
from explore.faults import checked
from explore.form_view import FormView, message_pane, show_messages
from explore.question import Question, opened, read_back, unpacked, with_range
from explore.slider import Turned
from explore.starts import starts, tables_of
from lapjoint.errors import InputError
from lapjoint.problem.files import tables_from_toml

STATE = "state"
"""Name of the state in the address."""
FILE = "problem.toml"
"""Name of the file that a page saves."""
GESTURE = 1.0
"""Time within which changes of one field are undone together, s: a slider that is turned changes it often."""
LARGEST = 10_000_000
"""Largest file that is opened, bytes: no problem of a person's hand is a hundredth of that."""
MOST_UNDONE = 200
"""Number of changes that can be undone."""
_WIDE = "stretch_width"
_SMALL: dict[str, Any] = {"variant": "outlined", "size": "small"}
_HEADING = "h1 { font-size: 1.3rem; margin: 0.4rem 0 }"
_ELSEWHERE = ":host { font-size: 0.9rem } pre { overflow-x: auto; padding: 0.5rem 0 }"


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
        self._due = False
        self._undo: list[Question] = []
        self._redo: list[Question] = []
        self._changed = "", 0.0
        """The path that was changed last, and when, s of the monotonic clock."""
        self._form, self._slider = FormView(self._edit), Turned(self._edit)
        self._curve = CurveView(self._choose, self._range, self._in_unit, self._document.add_timeout_callback)
        self._cycle = CycleView(self._moved, self._document.add_timeout_callback)
        self._make_widgets()
        self._show_question()

    def _make_widgets(self) -> None:
        text = {"size": "small", "sizing_mode": _WIDE}
        self._messages = message_pane()
        self._back = pmui.IconButton(icon="undo", label="Undo", description="Undo", on_click=lambda _: self._undone())
        self._again = pmui.IconButton(icon="redo", label="Redo", description="Redo", on_click=lambda _: self._redone())
        self._start = pmui.Select(label="Start from", options={"...": "", **starts()}, value="", **text)
        self._start.param.watch(self._started, "value")
        self._file = pmui.FileInput(label="Open a file", accept=".toml,.json", **_SMALL)
        self._file.param.watch(self._loaded, "value")
        self._around = pmui.Button(label="Curve around the first of them", on_click=lambda _: self._ranged(), **_SMALL)
        self._elsewhere = pn.pane.HTML("", sizing_mode=_WIDE, stylesheets=[_ELSEWHERE])

    def view(self) -> Any:
        """The page as Panel shows it."""
        save = self._download("Save as problem.toml", FILE, lambda: self._question.problem)
        state = self._download("Save the state", "explore.json", lambda: self._question.written())
        left = pmui.Column(
            pmui.FlexBox(self._back, self._again, save, state),
            pmui.Row(self._start, self._file, sizing_mode=_WIDE),
            self._messages,
            self._cycle.sketch,
            self._cycle.natural,
            self._around,
            self._form.view,
            sizing_mode=_WIDE,
        )
        curve = self._download("Curve as CSV", "curve.csv", self._curve.csv)
        cycle = self._download("Cycle as CSV", "cycle.csv", self._cycle.csv)
        right = pmui.Column(
            self._slider.view,
            self._curve.view,
            self._cycle.view,
            pmui.FlexBox(curve, cycle),
            self._elsewhere,
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
        return pmui.FileDownload(callback=lambda: io.StringIO(content()), filename=name, label=text, **_SMALL)

    def begin(self, computing: Computing) -> None:
        """Ask what the page shows, of processes for this page alone."""
        self._computing = computing
        computing.deliver = self._heard
        self._follow_soon()

    def refuse(self, message: str) -> None:
        """Say why the page has no answers."""
        show_messages(self._messages, message.split("\n"), True)

    def _edit(self, edit: Edit, path: str) -> None:
        """Change the problem, unless the change is one of a form or a sketch of before, whose place is gone."""
        try:
            tables = edit(self._question.tables)
        except InputError:
            return
        self._take(self._question.with_tables(tables), path)

    def _moved(self, path: str, value: str) -> None:
        """Take a number that was dragged in the sketch."""
        self._edit(partial(typed, path=path, text=value), path)

    def _choose(self, omega: float) -> None:
        """Choose a frequency of the curve for the cycle, rad/s."""
        if self._checked.problem is not None:
            self._take(self._question.at_frequency(omega), "frequency")

    def _range(self, first: float, last: float) -> None:
        """Take another range of frequencies, in the unit of the page."""
        self._take(replace(self._question, first=first, last=last), "range")

    def _in_unit(self, hz: bool) -> None:
        """Take frequencies in Hz, or in rad/s."""
        self._take(self._question.in_unit(hz), "unit")

    def _ranged(self) -> None:
        """Take the range of frequencies around the lowest natural one."""
        if self._cycle.first_frequency > 0:
            self._take(self._question.around(self._cycle.first_frequency), "range")

    def _started(self, event: Any) -> None:
        """Start from a preset, or a problem of the gallery."""
        if event.new:
            self._take(opened(tables_of(event.new), self._question.folder, self._question.hz), event.new)
            self._start.value = ""

    def _loaded(self, event: Any) -> None:
        """Open a file: a problem, or a state that a page saved."""
        if not event.new:
            return
        name, folder, hz = str(self._file.filename), self._question.folder, self._question.hz
        if len(event.new) > LARGEST:
            self.refuse(f"{name}: has {len(event.new) / 1e6:.3g} MB; at most {LARGEST / 1e6:g} MB are opened")
            return
        try:
            text = event.new.decode("utf-8-sig")
            question = (
                read_back(text, folder) if name.endswith(".json") else opened(tables_from_toml(text, name), folder, hz)
            )
        except UnicodeDecodeError:
            self.refuse(f"{name}: is not a text file in UTF-8")
        except InputError as error:
            self.refuse(str(error))
        else:
            self._take(question, name)

    def _undone(self) -> None:
        if self._undo:
            self._redo.append(self._question)
            self._changed = "", 0.0
            self._turn_to(self._undo.pop())

    def _redone(self) -> None:
        if self._redo:
            self._undo.append(self._question)
            self._changed = "", 0.0
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
        """Turn to another question."""
        self._checked = checked(question)
        self._question = with_range(question, self._checked.problem)
        self._follow_soon()

    def _follow_soon(self) -> None:
        """Ask and show the question in a tick of its own: only there the models of pictures may be changed."""
        if not self._due:
            self._due = True
            self._document.add_next_tick_callback(self._follow)

    def _follow(self) -> None:
        self._due = False
        self._ask()
        self._show_question()

    def _ask(self) -> None:
        problem, computing = self._checked.problem, self._computing
        if computing is None:
            return
        if problem is None:
            self._curve.outdate()
            self._cycle.outdate()
            return
        self._curve.ask(self._question, problem, computing)
        self._cycle.ask(self._question, problem, computing)
        self._curve.mark(problem.excitation_frequency)

    def _heard(self, part: Part, number: int, answer: Answer) -> None:
        """Called in another thread."""
        view = self._curve if part == "curve" else self._cycle
        self._document.add_next_tick_callback(partial(view.take, number, answer))

    def _show_question(self) -> None:
        """Show all that follows from the question alone."""
        question, found = self._question, self._checked
        tables = question.tables
        self._form.show(tables, found.faults, found.hints)
        self._slider.show(tables)
        self._curve.show(question)
        show_messages(self._messages, self._form.general, bool(found.faults))
        self._back.disabled, self._again.disabled = not self._undo, not self._redo
        location, search = pn.state.location, f"?{STATE}={question.packed()}"
        if location is not None:
            location.search = search
        self._elsewhere.object = _elsewhere(question, search)


def here() -> Document:
    """The document of the page that is being made or changed."""
    document = pn.state.curdoc
    assert document is not None
    return document


def _elsewhere(question: Question, search: str) -> str:
    """What brings the answers to a question elsewhere, as HTML: the commands, and a link."""
    title, commands = "The commands that do this", escape("\n".join(question.commands(FILE)))
    return (
        f'<p>{title}:</p><pre tabindex="0" role="group" aria-label="{title}">{commands}</pre>'
        f'<p><a href="{search}" target="_blank">A link to this state</a>, while this program runs</p>'
    )


def question_in(address: str, otherwise: Question) -> Question:
    """The question in the query of an address; another one where there is none, or none that is whole."""
    found = parse_qs(address.removeprefix("?")).get(STATE)
    if not found:
        return otherwise
    try:
        return unpacked(found[0], otherwise.folder)
    except InputError:
        return otherwise
