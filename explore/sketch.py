"""The sketch of the joint on the page, in which stops, supports, masses and gaps are dragged."""

from __future__ import annotations

import json
import math
from dataclasses import asdict
from pathlib import Path
from typing import Any, ClassVar

import param
from panel.custom import JSComponent

from explore.answers import Drawn
from explore.form import number_text


class Sketch(JSComponent):
    """The sketch of a joint, with a slider at each number that can be moved.

    Positions move by hundredths of their beam's length, gaps by factors.  A handle keeps the value to which it was
    moved until a picture comes that knows it; a new picture takes neither the focus nor a drag that is under way.
    """

    drawn = param.ClassSelector(class_=Drawn, default=None, allow_None=True, precedence=-1)
    """What is shown."""
    moved = param.Tuple(default=None, length=3, allow_None=True, precedence=-1)
    """The last move: the path of a field, its value as text of TOML, and whether the move is at its end.  A move that
    follows an equal one triggers its watchers, too."""
    shown = param.String(default="{}")
    """What the browser shows, as JSON."""

    _esm = Path(__file__).with_name("sketch.js")
    _rename: ClassVar[dict[str, str | None]] = {"drawn": None, "moved": None}  # they stay in Python

    @param.depends("drawn", watch=True, on_init=True)
    def _show(self) -> None:
        self.shown = json.dumps(asdict(self.drawn)) if self.drawn is not None else "{}"

    def _handle_msg(self, data: Any) -> None:
        """Take a move that the browser sends; one of a handle that is gone meanwhile is left out."""
        path, value, done = data
        handle = next((one for one in self.drawn.handles if one.path == path), None) if self.drawn is not None else None
        if handle is None or not isinstance(value, int | float) or not math.isfinite(value):
            return
        within = number_text(min(max(float(value), handle.least), handle.most))
        move = path, f'"{handle.beam}{within}"' if handle.beam else within, bool(done)
        if move == self.moved:
            self.param.trigger("moved")
        else:
            self.moved = move
