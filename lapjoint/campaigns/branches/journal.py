"""The journal of a search for branches: one line for each part of the work that is done."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from lapjoint.campaigns.branches.spec import BranchSpec
from lapjoint.campaigns.journal import Journal


class BranchJournal(Journal):
    """The locked journal beside the file of branches; `Journal` describes the format.

    A part of the work has a name, ``start 3`` or ``branch 0``, and a result of plain values.
    """

    def __init__(self, spec: BranchSpec, out: str | Path, *, force: bool = False) -> None:
        self.parts: dict[str, dict[str, Any]] = {}
        super().__init__(spec, out, force=force)

    def keep(self, name: str, result: dict[str, Any]) -> None:
        """Write the result of a part to the journal: it is on the disk when this returns.

        Parameters
        ----------
        name : str
            Name of the part.
        result : dict
            Result of the part, as values that JSON can hold.

        Raises
        ------
        OutputError
            If the result cannot be written; the results written before are still good.
        """
        self._keep({"part": name, "result": result})

    def _holds_nothing(self) -> bool:
        return not self.parts

    def _done(self) -> str:
        return f"{len(self.parts)} {'part of the work is' if len(self.parts) == 1 else 'parts of the work are'}"

    def _nothing_done(self) -> str:
        return "nothing was done"

    def _take(self, line: dict[str, Any]) -> None:
        self.parts[line["part"]] = line["result"]
