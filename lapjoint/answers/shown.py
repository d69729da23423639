"""The display of an answer in a notebook, by `lapjoint.figures.notebook`, which is loaded when it is first needed.

Answers do not import figures, because figures import answers: the name below is the only reference.
"""

from __future__ import annotations

from importlib import import_module

_DRAWN_BY = "lapjoint.figures.notebook"


class Shown:
    """An answer that a notebook shows as a table and a small figure."""

    def _repr_html_(self) -> str:
        return str(import_module(_DRAWN_BY).html_of(self))
