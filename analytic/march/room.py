"""Room in a joint's tables, which is made as states and switches are met, and the memory that it takes."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from analytic.march.tables import PER_SLOT, PER_SWITCH, UNKNOWN, Tables
from lapjoint.machine.memory import require

_SPARE = 4
"""Slots, or rows for switches, that are added when all are taken; or half as many as there are, if these are more, so
that what is copied for new ones is at most three times as much as there is in the end."""


def with_spare(taken: int) -> int:
    """So many rows, and some to spare.

    Parameters
    ----------
    taken : int
        How many are taken.

    Returns
    -------
    int
        More than that.
    """
    return taken + max(_SPARE, taken // 2)


def grown(tables: Tables, slots: int, switches: int) -> Tables:
    """The same tables with room for more.

    Parameters
    ----------
    tables : Tables
        The states of a joint.
    slots : int
        Number of slots, at least as many as there are.
    switches : int
        Number of rows for switches, at least as many as there are.

    Returns
    -------
    Tables
        Its other arrays are those of `tables`.

    Raises
    ------
    SolverError
        If they would take too much memory; see `lapjoint.machine.memory`.
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
    """What tables like these take with so many slots and rows for switches, bytes."""
    sizes = (
        rows * sum(part.itemsize * math.prod(part.shape[1:]) for part in map(tables.__getattribute__, names))
        for names, rows in ((PER_SLOT, slots), (PER_SWITCH, switches))
    )
    return float(sum(sizes))
