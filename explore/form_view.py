"""The form of a problem on the page: a widget for each field, with unit and description, and messages at the fields."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any

import panel_material_ui as pmui

from explore import editing
from explore.faults import at_fields
from explore.form import Field, Group, Listing, Part, all_parts, form_of
from lapjoint.answers.series import written
from lapjoint.problem.override import toml_value

Change = Callable[[Callable[[Mapping[str, Any]], editing.Tables], str], None]
"""Takes a change of the tables of a problem, and the path that it changes."""
OPEN = ("stops", "base_motion")
"""Parts that are open when a page is opened: where a joint is loose, and what shakes it."""
_WIDE = "stretch_width"


class FormView:
    """The form.

    Parameters
    ----------
    change : Change
        Called when a person changes something.
    """

    def __init__(self, change: Change) -> None:
        self.view = pmui.Column(sizing_mode=_WIDE)
        self._change = change
        self._shape: tuple[tuple[str, ...], ...] = ()
        self._widgets: dict[str, Any] = {}
        self._notes: dict[str, Any] = {}
        self._hints: dict[str, str] = {}
        self._said: dict[str, str] = {}
        self._showing = False
        self._parts: dict[str, Group | Listing] = {}
        self._open = set(OPEN)
        """Paths of the groups and lists that are open."""
        self._messages: tuple[Sequence[tuple[str, str]], Sequence[tuple[str, str]]] = (), ()

    def show(
        self, tables: Mapping[str, Any], faults: Sequence[tuple[str, str]], hints: Sequence[tuple[str, str]]
    ) -> None:
        """Show a problem, with what is wrong and what looks like a slip at the fields."""
        parts = form_of(tables)
        everything = list(all_parts(parts))
        shape = tuple(map(_shape, everything))
        self._parts = {part.path: part for part in everything if not isinstance(part, Field)}
        self._showing = True
        try:
            if shape != self._shape:
                self._build(parts)
                self._shape = shape
            for part in everything:
                if isinstance(part, Field) and part.path in self._widgets:
                    self._set(part)
            self._messages = faults, hints
            self._tell(faults, hints)
        finally:
            self._showing = False

    def _build(self, parts: Sequence[Part]) -> None:
        self._widgets, self._notes, self._hints, self._said = {}, {}, {}, {}
        fields = [self._field(part) for part in parts if isinstance(part, Field)]
        self.view.objects = [*fields, self._folded([part for part in parts if not isinstance(part, Field)])]

    def _folded(self, parts: Sequence[Group | Listing]) -> Any:
        """Groups and lists, each below its heading; what is in them is made when it is opened."""
        insides = [pmui.Column(sizing_mode=_WIDE) for _ in parts]
        active = [i for i, part in enumerate(parts) if part.path in self._open]
        headings = [(_heading(part), inside) for part, inside in zip(parts, insides, strict=True)]
        folded = pmui.Accordion(*headings, active=active, sizing_mode=_WIDE, disable_gutters=True)

        def fill(*_: Any) -> None:
            for i, (part, inside) in enumerate(zip(parts, insides, strict=True)):
                if i not in folded.active:
                    self._open.discard(part.path)
                    continue
                self._open.add(part.path)
                if not inside.objects:
                    inside.objects = self._inside(self._parts[part.path])
                    self._tell(*self._messages)

        fill()
        folded.param.watch(fill, "active")
        return folded

    def _inside(self, part: Group | Listing) -> list[Any]:
        """What a group or a list shows below its heading."""
        note = self._notes[part.path] = pmui.Alert("", severity="error", visible=False, sizing_mode=_WIDE)
        about = pmui.Typography(part.hint, variant="body2")
        if isinstance(part, Listing):
            items = [self._folded(part.items)] if part.items else []
            return [note, about, *items, self._button(f"Add to {part.label}", editing.added, part.path)]
        if part.absent:
            return [note, about, self._button(f"Add {part.label}", editing.added, part.path)]
        rows: list[Any] = [note, about]
        if part.tag:
            kind = pmui.Select(
                label=f"{part.label}: {part.tag}", options=list(part.words), value=part.word, sizing_mode=_WIDE
            )
            kind.param.watch(
                lambda event: self._changed(partial(editing.changed_kind, path=part.path, word=event.new), part.path),
                "value",
            )
            rows.append(kind)
        rows += [self._field(one) for one in part.parts if isinstance(one, Field)]
        below = [one for one in part.parts if not isinstance(one, Field)]
        rows += [self._folded(below)] if below else []
        if part.removable:
            rows.append(self._button(f"Remove {part.label}", editing.removed, part.path))
        return rows

    def _button(self, text: str, edit: Callable[..., editing.Tables], path: str) -> Any:
        button = pmui.Button(label=text, variant="outlined", size="small")
        button.on_click(lambda event: self._changed(partial(edit, path=path), path))
        return button

    def _field(self, part: Field) -> Any:
        unit = "" if part.unit in ("", "1") else f" [{written(part.unit)}]"
        label = f"{part.label}{unit}{' *' if part.required else ''}"
        common = {"label": label, "sizing_mode": _WIDE, "size": "small"}
        self._hints[part.path] = part.hint
        widget: Any
        if part.kind == "flag":
            widget = pmui.Checkbox(**{**common, "description": part.hint}, value=_on(part))
            note = self._notes[part.path] = pmui.Alert("", severity="error", visible=False, sizing_mode=_WIDE)
            widget.param.watch(partial(self._ticked, part.path), "value")
            self._widgets[part.path] = widget
            return pmui.Column(widget, note, sizing_mode=_WIDE)
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

    def _tell(self, faults: Sequence[tuple[str, str]], hints: Sequence[tuple[str, str]]) -> None:
        """Show messages at their fields, and take those back that hold no more."""
        paths = dict.fromkeys([*self._widgets, *self._notes])
        wrong, odd = at_fields(faults, paths), at_fields(hints, paths)
        self.general = [*wrong.get("", []), *odd.get("", [])]
        for path in paths:
            lines = "\n".join([*wrong.get(path, []), *odd.get(path, [])])
            if lines == self._said.get(path, ""):
                continue
            self._said[path] = lines
            if path in self._notes:
                self._notes[path].param.update(
                    object=lines, visible=bool(lines), severity="error" if path in wrong else "warning"
                )
            else:
                self._widgets[path].param.update(error_state=path in wrong, helper_text=lines or self._hints[path])

    def _typed(self, path: str, event: Any) -> None:
        self._changed(partial(editing.typed, path=path, text=str(event.new)), path)

    def _ticked(self, path: str, event: Any) -> None:
        self._changed(partial(editing.typed, path=path, text=str(bool(event.new)).lower()), path)

    def _changed(self, edit: Callable[[Mapping[str, Any]], editing.Tables], path: str) -> None:
        if not self._showing:
            self._change(edit, path)


def _heading(part: Group | Listing) -> str:
    """The name of a group or a list, and how much there is of it."""
    if isinstance(part, Listing):
        return f"{part.label} ({len(part.items) or 'none'})"
    return f"{part.label} (none)" if part.absent else part.label


def _on(part: Field) -> bool:
    return (part.text or part.default) == "true"


def _shape(part: Part) -> tuple[str, ...]:
    """What of a part decides which widgets there are."""
    if isinstance(part, Field):
        return part.path, part.kind, *part.choices
    if isinstance(part, Listing):
        return part.path, part.label, str(len(part.items))
    return part.path, part.label, part.word, str(part.absent)
