"""What a branch of periodic motions is: motions along a curve, and its bifurcations."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Literal, NamedTuple

from lapjoint.answers.steady_state import SectionPoint, SteadyState

BifurcationKind = Literal["fold", "flip", "neimark-sacker", "symmetry breaking", "grazing", "unresolved"]
"""What a bifurcation is called.  ``unresolved`` is a part of the curve, narrow as its error says, that is not known."""


class MotionThere(NamedTuple):
    """The motion at a bifurcation."""

    value: float
    """The number of the problem, in its SI unit."""
    point: SectionPoint
    """Where it begins."""
    half_periods: int
    """Number of half periods after which it repeats; mirrored, if it is odd."""


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
    motion: MotionThere | None = field(default=None, repr=False, compare=False)
    """The motion there, or just before a graze; None if it is not known."""


@dataclass(frozen=True)
class BranchPoint:
    """A motion of a branch."""

    value: float
    """The number of the problem, in its SI unit."""
    motion: SteadyState = field(repr=False)
    """The motion and its certificate, stable or not."""


@dataclass(frozen=True)
class Branch:
    """Periodic motions along a curve."""

    path: str
    """Path of the number of the problem that changes."""
    points: tuple[BranchPoint, ...] = field(repr=False)
    """The motions, in their sequence along the curve."""
    bifurcations: tuple[Bifurcation, ...]
    """Its bifurcations, in the same sequence."""
    ends: tuple[str, str]
    """Why it ends at its first and at its last point: ``boundary`` of the range, ``closed`` to a ring, ``graze`` where
    the map jumps, ``bifurcation`` from which it springs, ``lost``, or the ``effort`` that was allowed; in a diagram,
    too, where it ``joins`` a branch that was followed before it."""

    @property
    def period_multiple(self) -> int:
        """Excitation periods after which its motions repeat."""
        return self.points[0].motion.period_multiple
