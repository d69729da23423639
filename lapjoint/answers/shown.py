"""How an answer is shown in a notebook: `lapjoint.figures.notebook` says how, and is loaded when the first is shown.

Answers import no figures: the name below is the one place where the ground looks upwards, and only a notebook asks.
"""

from __future__ import annotations

from importlib import import_module

_DRAWN_BY = "lapjoint.figures.notebook"


class Shown:
    """An answer that a notebook shows as a table and a small figure."""

    def _repr_html_(self) -> str:
        return str(import_module(_DRAWN_BY).html_of(self))
