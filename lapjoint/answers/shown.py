"""How a notebook shows an answer: by `lapjoint.figures.notebook`, which is loaded when the first answer is shown.

Answers import no figures: the name below is the one place where answers refer to what is built on them.
"""

from __future__ import annotations

from importlib import import_module

_DRAWN_BY = "lapjoint.figures.notebook"


class Shown:
    """An answer that a notebook shows as a table and a small figure."""

    def _repr_html_(self) -> str:
        return str(import_module(_DRAWN_BY).html_of(self))
