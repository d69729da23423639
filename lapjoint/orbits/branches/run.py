"""A curve that was followed: its places, its grazes, and what could not be resolved; and how far one is followed."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from itertools import pairwise

from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.extremum_search import OnExtremum


@dataclass(frozen=True)
class Limits:
    """How far a branch is followed."""

    most: int = 5000
    """Largest number of its points."""
    length: float = math.inf
    """Arc length from its start after which it ends, as if its points were spent."""
    first: float = math.inf
    """Arc length of its first step at most."""
    marches: float = math.inf
    """Number of marches with their derivatives after which it ends likewise."""
    until: Place | None = None
    """A motion at which it ends."""
    enough: Callable[[Run], bool] | None = None
    """Called with the curve so far, whether it has led to what is looked for, and may end; it is then not asked whether
    it goes round in a ring."""
    known: Callable[[Place], frozenset[str]] | None = None
    """Called now and then with a place, on which branches it lies that are known; where the curve goes on as one of
    them, it ends."""
    progress: Callable[[float], None] | None = None
    """Called with the share of the range, or of the effort, that is behind."""


@dataclass(frozen=True)
class Graze:
    """A graze that a branch goes across, or at which it ends."""

    stop: int
    """The stop."""
    value: float
    """The number, in its SI unit."""
    kind: str
    """``persists``, ``folds``, ``ends``, or ``lost`` where no motion beyond it is found."""
    before: OnExtremum = field(repr=False)
    """The motion just before."""
    rate: float
    """Change of the extremum's value with the arc length before it, m."""
    index: int
    """Number of places of the run before it."""
    left: float = 0.0
    """What the distance of the nearest motion may leave of `value`, in the same unit."""
    seen: bool = True
    """Whether the curve beyond is known from just beyond on; else what lies there is not."""


@dataclass(frozen=True)
class Jump:
    """A part of a branch that is not resolved: several grazes at once, or a jump of the map by truncation."""

    first: float
    """The number before it, in its SI unit."""
    last: float
    """The number after it."""
    index: int
    """Number of places of the run before it."""
    width: int = 0
    """Which of the widths was left out that are tried in turn."""


@dataclass(frozen=True)
class Run:
    """A curve followed in one direction."""

    places: list[Place]
    """Its places in sequence, from the start."""
    grazes: list[Graze]
    """Its grazes."""
    jumps: list[Jump]
    """Where it could not be resolved."""
    end: str
    """Why it ends."""
    begin: str = ""
    """Why it does not go on before its start, where that is known."""
    elsewhere: frozenset[int] = frozenset()
    """Numbers of places up to which, from the one before, the curve is another branch's."""

    @property
    def smooth_parts(self) -> Iterator[tuple[int, Place, Place]]:
        """Neighbouring places between which the curve is smooth, with the index of the second."""
        apart = {jump.index for jump in self.jumps}
        for i, (a, b) in enumerate(pairwise(self.places), start=1):
            if i not in apart and a.closings == b.closings:
                yield i, a, b


def joined(back: Run, ahead: Run) -> Run:
    """Two runs from one start as one, in the direction of the second.

    Parameters
    ----------
    back, ahead : Run
        The two; the first in the opposite direction.

    Returns
    -------
    Run
        From the end of the first to that of the second.
    """
    turned = [place.turned() for place in reversed(back.places)]
    first = len(back.places)
    # A graze is at the place of its index, and a jump before it; what was before lies behind when it is turned.
    grazes = [replace(one, index=first - 1 - one.index) for one in back.grazes]
    jumps = [replace(one, index=first - one.index) for one in back.jumps]
    grazes += [replace(one, index=one.index + first - 1) for one in ahead.grazes]
    jumps += [replace(one, index=one.index + first - 1) for one in ahead.jumps]
    return Run([*turned, *ahead.places[1:]], grazes, jumps, ahead.end, back.end)
