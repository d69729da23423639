"""What is measured of a march that was not found to repeat, and what that shows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from lapjoint.answers.steady_state import Exponent, Outcome, SectionPoint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.unstable import NARROW, PUSHES, REPEATS
from lapjoint.problem import FloatArray

_WATCHED = 64  # periods over which it is looked how far a march wanders


@dataclass(frozen=True)
class Wandering:
    """A stretch of a march over which an exponent was measured."""

    outcome: Outcome
    """What it shows: aperiodic, quasi-periodic, or undecided."""
    exponent: Exponent
    point: SectionPoint
    """Where the stretch ends."""
    breadth: float
    """How far it wanders from repeating, relative to its size: the farthest of all returns, at the best multiple."""
    residual: float
    """How closely its last points repeat, at the best multiple, relative to their size."""
    impulses: FloatArray
    """Mean impulse of each stop over one excitation period, N s, shape ``(stops,)``."""

    def confirms(self, before: Wandering) -> bool:
        """Whether this shows what the stretch before it showed, so that more would tell nothing new.

        If deviations died out in both, the motion repeats, after more periods than were looked for.
        """
        if self.outcome is Outcome.UNDECIDED:
            return before.exponent.negative and self.exponent.negative
        return self.outcome is before.outcome


def shown(exponent: Exponent, slowest_decay: float, breadth: float, *, spirals: bool, pushes: int) -> Outcome:
    """What one measurement establishes of a march.

    The exponent says nothing of a march that repeats, nor of one that is so narrow that it may be held and has not
    been pushed off for certain: at an unstable motion it is the growth of deviations that the march does not make.

    Parameters
    ----------
    exponent : Exponent
        As measured.
    slowest_decay : float
        Least rate at which free vibration dies away by damping, 1/s; 0 without damping.
    breadth : float
        How far the march wanders from repeating, relative to its size.
    spirals : bool
        Whether an unstable periodic motion that nearby motions leave in spirals is known.
    pushes : int
        How often the march has been pushed off an unstable motion.
    """
    if breadth <= REPEATS:
        return Outcome.UNDECIDED
    if exponent.positive:
        return Outcome.UNDECIDED if breadth <= NARROW and pushes < PUSHES else Outcome.APERIODIC
    return Outcome.QUASIPERIODIC if spirals and exponent.vanishes(slowest_decay) else Outcome.UNDECIDED


def breadth_and_residual(half_periods: HalfPeriods, points: Sequence[SectionPoint], most: int) -> tuple[float, float]:
    """How far the last points of a march, a period apart, are from repeating after 1 ... `most` periods.

    The farthest of all returns, and the last one, each at the multiple that is best for it and over the motion's size.
    """
    last = points[-_WATCHED - 1 :]
    map_ = half_periods.map
    size = max(map(map_.size, last)) + 1e-300
    farthest, latest = [], []
    for multiple in range(1, min(most, len(last) - 1) + 1):
        returns = [map_.norm(map_.difference(b, a)) for a, b in zip(last, last[multiple:], strict=False)]
        farthest.append(max(returns) / size)
        latest.append(returns[-1] / size)
    return min(farthest), min(latest)


def nearest_return(half_periods: HalfPeriods, points: Sequence[SectionPoint]) -> float:
    """How closely the last point comes back to one of the later half of the points, over its size."""
    later = points[len(points) // 2 : -1]
    return min((half_periods.apart(point, points[-1]) for point in later), default=float("inf"))
