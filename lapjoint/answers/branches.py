"""What a bifurcation of a branch of periodic motions is."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

BifurcationKind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking", "grazing"]
"""What a bifurcation is called."""


@dataclass(frozen=True)
class Bifurcation:
    """A bifurcation of a branch."""

    kind: BifurcationKind
    """What it is."""
    value: float
    """The number of the problem at which it is, in its SI unit."""
    error: float
    """Estimate of the numerical error of `value`, in the same unit; infinite where none can be stated."""
    index: int
    """It lies between the points `index` - 1 and `index` of its branch, or at the latter."""
    stop: int = -1
    """The stop that is grazed; of a stop and its twin on the other side the first; -1 where none is."""
    after: str = ""
    """What the branch does at a graze: it ``persists``, ``folds``, ``ends`` or is ``lost``; empty for another kind."""
    impulses: tuple[float, ...] = ()
    """Impulse of each stop there, N s a period of the excitation."""
