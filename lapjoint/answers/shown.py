"""The display of an answer: as text, in a notebook, and as a pandas frame.

Answers do not import figures, because figures import answers: the names below, of modules that are loaded when they are
first needed, are the only references.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import pandas as pd


class Shown:
    """An answer that shows itself as a short table, in a notebook with a small figure."""

    def __repr__(self) -> str:
        return str(self._table.text(type(self).__name__))

    def _repr_html_(self) -> str:
        return str(import_module("lapjoint.figures.notebook").html_of(self))

    def to_pandas(self) -> pd.DataFrame:
        """The table of the answer as a pandas frame: all rows, errors in columns of their own, and units in
        ``attrs["units"]``."""
        return self._table.frame()

    @property
    def _table(self) -> Any:
        return import_module("lapjoint.figures.tables").table_of(self)
