"""Measurements of a march that was not found to repeat, and the outcome that they show."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from lapjoint.answers.steady_state import Exponent, Outcome, SectionPoint
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.unstable import NARROW, PUSHES, REPEATS
from lapjoint.problem import FloatArray

_WATCHED = 64
"""Number of the last periods of a march over which its breadth is measured."""


@dataclass(frozen=True)
class Wandering:
    """A stretch of a march over which an exponent was measured."""

    outcome: Outcome
    """The outcome that the stretch shows: aperiodic, quasi-periodic, or undecided."""
    exponent: Exponent
    """The largest Lyapunov exponent over the stretch."""
    point: SectionPoint
    """Section point at which the stretch ends."""
    breadth: float
    """Largest distance between last points one period multiple apart, divided by their size, for the multiple with the
    least."""
    residual: float
    """Distance between the last point and the point one period multiple before, divided by their size, for the multiple
    with the least distance."""
    impulses: FloatArray
    """Mean impulse of each stop over one excitation period, N s, shape ``(stops,)``."""
    standard_errors: FloatArray
    """Standard errors of these means, with the correlation from period to period, N s, shape ``(stops,)``."""

    def confirms(self, before: Wandering) -> bool:
        """Whether this stretch shows the outcome of the previous stretch, so that a longer stretch would show nothing
        new.

        Two undecided stretches agree if deviations died out in both: the motion repeats, after more periods than were
        searched.
        """
        if self.outcome is Outcome.UNDECIDED:
            return before.exponent.negative and self.exponent.negative
        return self.outcome is before.outcome


def outcome_of(
    exponent: Exponent, lowest_damping_rate: float, breadth: float, *, spirals: bool, pushes: int
) -> Outcome:
    """The outcome that one measurement of a march establishes: `APERIODIC`, `QUASIPERIODIC` or `UNDECIDED`.

    The exponent proves nothing about a march that repeats.  It proves nothing, either, about a march so narrow that it
    may be unable to leave an unstable motion, unless it was pushed often enough: the exponent is then the growth of
    deviations that the march does not have.  `breadth` is the distance of the march from repeating, divided by its
    size.  `spirals` says whether an unstable periodic motion is known that nearby motions leave in spirals.  `pushes`
    counts the pushes off an unstable motion.
    """
    if breadth <= REPEATS:
        return Outcome.UNDECIDED
    if exponent.positive:
        return Outcome.UNDECIDED if breadth <= NARROW and pushes < PUSHES else Outcome.APERIODIC
    return Outcome.QUASIPERIODIC if spirals and exponent.vanishes(lowest_damping_rate) else Outcome.UNDECIDED


def breadth_and_residual(half_periods: HalfPeriods, points: Sequence[SectionPoint], most: int) -> tuple[float, float]:
    """`Wandering.breadth` and `Wandering.residual` of section points of a march, over period multiples up to `most`."""
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
    """The least distance of the last of `points` from the others of their later half, divided by the size; inf without
    others."""
    later = points[len(points) // 2 : -1]
    return min((half_periods.apart(point, points[-1]) for point in later), default=float("inf"))
