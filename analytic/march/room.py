"""Room in a joint's tables, which is made as states and switches are met, and the memory that it takes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from analytic.march.tables import PER_SLOT, PER_SWITCH, UNKNOWN, Tables
from lapjoint.machine.memory import require

_SPARE = 4
"""Least number of slots, or of rows for switches, added when all are taken.  If half of the present number is more,
half is added: then all copies into new rows are at most three times as much as the final tables."""


def with_spare(taken: int) -> int:
    """A number of rows that leaves room for more beyond the `taken` ones."""
    return taken + max(_SPARE, taken // 2)


def grown(tables: Tables, slots: int, switches: int) -> Tables:
    """The tables with room for `slots` slots and `switches` switches; arrays that are large enough are shared with
    `tables`.

    `SolverError` is raised where the tables would take too much memory; see `lapjoint.machine.memory`.
    """
    before, after = (_bytes(tables, *rows) for rows in (_rows(tables), (slots, switches)))
    modes = tables.kind.shape[1]
    what = f"the tables of {slots} contact states and {switches} switches, of {modes} modes each,"
    require(after, what, "take fewer modes (n_modes), fewer stops, or a shorter motion", before)
    parts: dict[str, Any] = {}
    for names, rows in ((PER_SLOT, slots), (PER_SWITCH, switches)):
        for name in names:
            old = getattr(tables, name)
            if old.shape[0] < rows:
                parts[name] = np.zeros((rows, *old.shape[1:]), dtype=old.dtype)
                parts[name][: old.shape[0]] = old
                if name in UNKNOWN:
                    parts[name][old.shape[0] :] = -1
    return tables._replace(**parts)


def _rows(tables: Tables) -> tuple[int, int]:
    """Number of slots, and of rows for switches."""
    return tables.modes.size, tables.carry.shape[0]


def _bytes(tables: Tables, slots: int, switches: int) -> float:
    """Bytes of these tables with `slots` slots and `switches` rows for switches."""
    sizes = (
        rows * sum(part.itemsize * math.prod(part.shape[1:]) for part in map(tables.__getattribute__, names))
        for names, rows in ((PER_SLOT, slots), (PER_SWITCH, switches))
    )
    return float(sum(sizes))
