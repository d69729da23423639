"""The motion that Figure 4 shows, followed through the windows of the paper, between the points of a sweep."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache
from typing import TYPE_CHECKING

import numpy as np

from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, branch
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.problem import FloatArray

if TYPE_CHECKING:
    import xarray as xr

RANGE = (1390.0, 2170.0)  # Frequencies of the branch, rad/s: all windows, with a margin on both sides
HARMLESS = "grazing"
"""A bifurcation that need not change the kind of motion: points and other bifurcations show the change."""


@dataclass(frozen=True)
class Window:
    """Bifurcations and motions of one solver's branches in a window."""

    changes: int
    """Bifurcations in it, grazes left out, and motions in and next to it that are unstable or of another period."""
    broken: int
    """Broken symmetries in it, and motions in and next to it that are not their own mirror images."""

    @property
    def words(self) -> str:
        """The text for the table."""
        if not self.changes and not self.broken:
            return "followed through it: one branch of stable, symmetric motions without a bifurcation"
        return f"followed through it: {self.changes} changes, {self.broken} of symmetry"


def window(solver: str, first: float, last: float) -> Window:
    """Follow the motion of a solver through a window from `first` to `last`, rad/s; a branch that does not lead through
    it counts as a change, and as a broken symmetry."""
    return in_window(_branches(solver), first, last)


def in_window(found: xr.Dataset, first: float, last: float) -> Window:
    """Bifurcations and motions of all branches over the excitation frequency between `first` and `last`, rad/s."""
    omega, number = found.angular_frequency.values, found.branch.values
    changes = broken = 0
    through = False
    for i in range(found.sizes["branch_number"]):
        mine = np.flatnonzero(number == i)
        if omega[mine].min() > last or omega[mine].max() < first:
            continue
        through = through or bool(omega[mine].min() <= first and omega[mine].max() >= last)
        inside = (omega[mine] >= first) & (omega[mine] <= last)
        seen = mine[inside | _beside(omega[mine], first, last)]
        plain = (found.stable.values[seen] == 1) & (found.period_multiple.values[seen] == 1)
        changes += int((~plain).sum())
        broken += int((found.symmetric.values[seen] == 0).sum())
    value = found.bifurcation_value.values
    kinds = np.array([KINDS[kind] for kind in found.bifurcation_kind.values], dtype=object)
    there = kinds[(value >= first) & (value <= last)]
    return Window(
        changes + int((there != HARMLESS).sum()) + (not through),
        broken + int((there == "symmetry breaking").sum()) + (not through),
    )


def _beside(omega: FloatArray, first: float, last: float) -> np.ndarray:
    """Which points of a branch have a neighbour on the other side of an edge of a window."""
    found = np.zeros(omega.size, dtype=bool)
    for edge in (first, last):
        across = (omega[:-1] - edge) * (omega[1:] - edge) <= 0
        found[:-1] |= across
        found[1:] |= across
    return found


@cache
def _branches(solver: str) -> xr.Dataset:
    return branch(paper_joint(), FREQUENCY, *RANGE, solver=solver, errors=False)
