"""The form of a problem on the page: a widget for each field, with unit and description, and messages at the fields."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from html import escape
from typing import Any

import panel as pn
import panel_material_ui as pmui

from explore import editing
from explore.editing import Change, Edit
from explore.faults import at_fields
from explore.form import Field, Group, Listing, Part, all_parts, form_of
from lapjoint.answers.series import written
from lapjoint.problem.override import toml_value

OPEN = ("stops", "base_motion")
"""Parts that are open when a page is opened: where a joint is loose, and what shakes it."""
Messages = Sequence[tuple[str, str]]
"""Paths of fields, and messages."""
_WIDE = "stretch_width"
_WRONG = "#c62828"
_STYLE = """
ul { list-style: none; margin: 0.2rem 0; padding: 0.4rem 0.7rem; border-left: 6px solid; overflow-wrap: anywhere }
.wrong { border-color: #d55e00 }
.odd { border-color: #e69f00 }
"""


class FormView:
    """The form.  What is in a group is made when the group is opened, and kept while its fields stay the same.

    Parameters
    ----------
    change : Change
        Called when a person changes something.
    """

    def __init__(self, change: Change) -> None:
        self.view = pmui.Column(sizing_mode=_WIDE)
        self.general: list[str] = []
        """Messages that belong to no field of the form."""
        self._change = change
        self._cards: dict[str, Any] = {}
        self._shapes: dict[str, tuple[str, ...]] = {}
        """What decides which widgets are in a card, by the paths of cards that were opened."""
        self._parts: dict[str, Part] = {}
        self._widgets: dict[str, Any] = {}
        self._notes: dict[str, Any] = {}
        self._said: dict[str, list[str]] = {}
        self._faults: Messages = ()
        self._slips: Messages = ()
        self._showing = False

    def show(self, tables: Mapping[str, Any], faults: Messages, slips: Messages) -> None:
        """Show a problem, with what is wrong and what looks like a slip at the fields."""
        parts = form_of(tables)
        self._parts = {part.path: part for part in all_parts(parts)}
        new = {path for path, _ in faults} - {path for path, _ in self._faults}
        self._faults, self._slips = faults, slips
        self._showing = True
        try:
            for kept in (self._cards, self._shapes, self._widgets, self._notes, self._said):
                for path in [path for path in kept if path not in self._parts]:
                    del kept[path]
            if not self.view.objects:
                self.view.objects = [self._shown(part) for part in parts]
            self._refresh(parts)
            for above in sorted({one for path in new for one in _above(path)}):  # the outer ones first
                if above in self._cards:
                    self._cards[above].active = [0]
            self._tell()
        finally:
            self._showing = False

    def _shown(self, part: Part) -> Any:
        """The widget of a field, or the card of a group or a list."""
        return self._field(part) if isinstance(part, Field) else self._card(part)

    def _card(self, part: Group | Listing) -> Any:
        card = self._cards.get(part.path)
        if card is None:
            active = [0] if part.path in OPEN else []
            card = self._cards[part.path] = pmui.Accordion(
                (_heading(part), pmui.Column(sizing_mode=_WIDE)), active=active, disable_gutters=True, sizing_mode=_WIDE
            )
            card.param.watch(lambda _: self._opened(part.path), "active")
        return card

    def _opened(self, path: str) -> None:
        """Fill a card that was opened."""
        showing, self._showing = self._showing, True
        try:
            self._refresh([self._parts[path]])
            self._tell()
        finally:
            self._showing = showing

    def _refresh(self, parts: Sequence[Part]) -> None:
        """Show the values of fields, and make anew what is in open cards that have other fields than before."""
        for part in parts:
            if isinstance(part, Field):
                if part.path in self._widgets:
                    self._set(part)
                continue
            card = self._cards.get(part.path)
            if card is None:
                continue
            if card._names != [_heading(part)]:
                card[0] = (_heading(part), card[0])
            below = part.items if isinstance(part, Listing) else part.parts
            if card.active and self._shapes.get(part.path) != _shape(part):
                self._shapes[part.path] = _shape(part)
                card[0].objects = self._inside(part)
            self._refresh(below)

    def _inside(self, part: Group | Listing) -> list[Any]:
        """What a group or a list shows below its heading."""
        note = self._notes[part.path] = message_pane()
        self._said.pop(part.path, None)
        about = pmui.Typography(part.hint, variant="body2")
        if isinstance(part, Listing):
            add = self._button(f"Add to {part.label}", editing.added, part.path)
            return [note, about, *map(self._card, part.items), add]
        if part.absent:
            return [note, about, self._button(f"Add {part.label}", editing.added, part.path)]
        rows: list[Any] = [note, about]
        if part.tag:
            rows.append(self._kind(part))
        rows += [self._field(one) for one in part.parts if isinstance(one, Field)]
        rows += [self._card(one) for one in part.parts if not isinstance(one, Field)]
        if part.removable:
            rows.append(self._button(f"Remove {part.label}", editing.removed, part.path, variant="text"))
        return rows

    def _kind(self, part: Group) -> Any:
        """The choice of the kind of a group."""
        label = f"{part.label}: {part.tag}"
        choice = pmui.Select(label=label, options=list(part.words), value=part.word, size="small", sizing_mode=_WIDE)

        def chosen(event: Any) -> None:
            self._changed(partial(editing.changed_kind, path=part.path, word=event.new), part.path)

        choice.param.watch(chosen, "value")
        return choice

    def _button(self, text: str, edit: Callable[..., editing.Tables], path: str, variant: str = "outlined") -> Any:
        button = pmui.Button(label=text, variant=variant, size="small")
        button.on_click(lambda event: self._changed(partial(edit, path=path), path))
        return button

    def _field(self, part: Field) -> Any:
        unit = "" if part.unit in ("", "1") else f" [{written(part.unit)}]"
        common = {"label": f"{part.label}{unit}{' *' if part.required else ''}", "sizing_mode": _WIDE, "size": "small"}
        self._said.pop(part.path, None)
        widget: Any
        if part.kind == "flag":
            widget = self._widgets[part.path] = pmui.Checkbox(**common, value=_on(part))
            widget.param.watch(partial(self._ticked, part.path), "value")
            note = self._notes[part.path] = message_pane()
            return pmui.Column(widget, pmui.Typography(part.hint, variant="caption"), note, sizing_mode=_WIDE)
        if part.kind == "choice":
            none = f"({part.default})" if part.default else "(none)"
            options = {none: "", **{word: word for word in part.choices}}
            widget = pmui.Select(**common, options=options, value=part.text, helper_text=part.hint)
        else:
            widget = pmui.TextInput(**common, value=part.text, placeholder=part.default, helper_text=part.hint)
        widget.param.watch(partial(self._typed, part.path), "value")
        self._widgets[part.path] = widget
        return widget

    def _set(self, part: Field) -> None:
        """Show the value of a field."""
        widget = self._widgets[part.path]
        value = _on(part) if part.kind == "flag" else part.text
        same = widget.value == value or (part.kind == "value" and toml_value(widget.value) == toml_value(part.text))
        if not same:
            widget.value = value

    def _tell(self) -> None:
        """Show messages at their fields, and take those back that hold no more."""
        paths = dict.fromkeys([*self._widgets, *self._notes])
        wrong, odd = at_fields(self._faults, paths), at_fields(self._slips, paths)
        self.general = [*wrong.get("", []), *odd.get("", [])]
        faulty = {above for path, _ in self._faults for above in _above(path)}
        for path, card in self._cards.items():
            card.header_color = _WRONG if path in faulty else None
        for path in paths:
            lines = [*wrong.get(path, []), *(f"Is this a slip? {line}" for line in odd.get(path, []))]
            if lines == self._said.get(path):
                continue
            self._said[path] = lines
            if path in self._notes:
                show_messages(self._notes[path], lines, path in wrong)
            else:
                hint = self._parts[path].hint
                self._widgets[path].param.update(error_state=path in wrong, helper_text=" ".join(lines) or hint)

    def _typed(self, path: str, event: Any) -> None:
        self._changed(partial(editing.typed, path=path, text=str(event.new)), path)

    def _ticked(self, path: str, event: Any) -> None:
        self._changed(partial(editing.typed, path=path, text=str(bool(event.new)).lower()), path)

    def _changed(self, edit: Edit, path: str) -> None:
        if not self._showing:
            self._change(edit, path)


def _heading(part: Group | Listing) -> str:
    """The name of a group or a list, and how much there is of it, as HTML."""
    if isinstance(part, Listing):
        return f"{part.label} ({len(part.items) or 'none'})"
    return f"{part.label} (none)" if part.absent else escape(part.label)


def _on(part: Field) -> bool:
    return (part.text or part.default) == "true"


def _shape(part: Part) -> tuple[str, ...]:
    """What of a part decides which widgets are in it."""
    if isinstance(part, Field):
        return part.path, part.kind, *part.choices
    if isinstance(part, Listing):
        return tuple(item.path for item in part.items)
    own = (one for each in part.parts for one in (_shape(each) if isinstance(each, Field) else (each.path,)))
    return part.word, str(part.absent), *own


def _above(path: str) -> list[str]:
    """A path, and all paths above it."""
    keys = path.split(".")
    return [".".join(keys[: i + 1]) for i in range(len(keys))]


def message_pane() -> Any:
    """A place for messages, which is empty at first; it is never hidden, for that fails before it is drawn."""
    return pn.pane.HTML("", margin=(0, 10), sizing_mode=_WIDE, stylesheets=[_STYLE])


def show_messages(pane: Any, lines: Sequence[str], wrong: bool) -> None:
    """Show messages in their place, each in a line: what is `wrong`, or what looks like a slip."""
    items = "".join(f"<li>{escape(line)}</li>" for line in lines)
    pane.object = f'<ul role="alert" class="{"wrong" if wrong else "odd"}">{items}</ul>' if lines else ""
