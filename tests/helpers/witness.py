"""A witness of steady states who has not searched: it marches on from where a motion was accepted, and looks.

It knows a period map's `march` and nothing of orbits, derivatives or distances from stops.  After `DECAYS` decay times,
in whole multiples of the period that was certified, it asks after how many periods the march repeats, whether it
touches a stop, and which impulses it gives a period, and compares this with the certificate.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lapjoint.answers.steady_state import Outcome, SectionPoint, SteadyState
from lapjoint.orbits import PeriodMap
from lapjoint.problem import FloatArray

DECAYS = 20.0  # decay times marched on: exp(-20) = 2e-9 of a free vibration is left
LONGER = 10  # times as long is marched on where the motion still approaches the certified one: a multiplier near one
MOST_REPEATS = 64  # periods after which a march may repeat
WATCHED = 64  # of which it is looked at over so many besides
_CLOSED = 1e-6  # of the size of the motion: returns within it repeat
_NOISY = 1e-3  # of the size, and of how far the section points are apart: what jumps of truncated modes may leave
_IMPULSE = 1e-4  # of the largest impulse: certified and marched ones agree within it
_TOUCH = 1e-9  # of stiffness, gap and period: an impulse that is only rounding


@dataclass(frozen=True)
class Seen:
    """What a march does over some periods."""

    repeats: int
    """Least number of periods after which it repeats; 0: it does not."""
    closure: float
    """How closely it does, or comes nearest to, of its size."""
    impulses: FloatArray
    """Mean impulse of each stop over one period, N s, shape ``(stops,)``."""
    end: SectionPoint

    @property
    def touches(self) -> bool:
        """Whether it touches any stop."""
        return bool(np.any(self.impulses != 0))


@dataclass(frozen=True)
class Judgement:
    """The judgement on one certificate."""

    verdict: str
    """"true", "false", "slow" (true, but 20 decay times did not suffice), or "undecided"."""
    why: str
    seen: Seen
    periods: int
    """Periods marched on until then."""


def testify(period_map: PeriodMap, steady: SteadyState, decay_time: float) -> Judgement:
    """March on from the acceptance of a steady state, and compare; `decay_time` is 1 / min(zeta_i omega_i), s."""
    assert steady.acceptance is not None
    ahead = _ahead(period_map, steady, decay_time)
    seen = marched(period_map, steady.acceptance.point, ahead)
    if steady.outcome is Outcome.UNDECIDED:
        return Judgement("undecided", f"the march repeats after {seen.repeats}, to {seen.closure:.1e}", seen, ahead)
    first = contradiction(steady, seen, period_map.period)
    if not first or not steady.period_multiple:
        return Judgement("false" if first else "true", first, seen, ahead)
    why, seen, times = _at_last(period_map, steady, seen, ahead)
    return Judgement("false" if why else "slow", f"{first}; at last {why}" if why else first, seen, times * ahead)


def _ahead(period_map: PeriodMap, steady: SteadyState, decay_time: float) -> int:
    """Periods of `DECAYS` decay times, in whole multiples of the period certified."""
    multiple = max(steady.period_multiple, 1)
    return multiple * math.ceil(DECAYS * decay_time / period_map.period / multiple)


def _at_last(period_map: PeriodMap, steady: SteadyState, seen: Seen, ahead: int) -> tuple[str, Seen, int]:
    """March `ahead` again and again, until the certificate is no longer denied: why it is, what is seen, how often."""
    why, times = "", 0
    while times < LONGER:
        times += 1
        seen = marched(period_map, seen.end, ahead)
        why = contradiction(steady, seen, period_map.period)
        if not why:
            break
    return why, seen, times + 1


def contradiction(steady: SteadyState, seen: Seen, period: float) -> str:
    """What a march has shown that a certificate denies, in words; empty if they agree."""
    if not steady.period_multiple:
        # A torus comes back closely, too: only what closes counts here.
        repeats = seen.repeats and seen.closure <= _CLOSED
        return f"repeats after {seen.repeats} periods, to {seen.closure:.1e}" if repeats else ""
    stops = steady.problem.stops
    if seen.touches != (steady.outcome is not Outcome.NO_CONTACT):
        return f"class: certified {steady.outcome.name}, impulses of the march {seen.impulses}"
    if seen.repeats != steady.period_multiple:
        return f"multiple: certified {steady.period_multiple}, march {seen.repeats} ({seen.closure:.1e})"
    rounding = _TOUCH * period * np.array([stop.stiffness * abs(stop.gap) for stop in stops])
    allowed = _IMPULSE * float(np.max(np.abs(seen.impulses), initial=0.0)) + rounding
    if np.any(np.abs(seen.impulses - steady.impulses) > allowed):
        return f"impulses: certified {steady.impulses}, march {seen.impulses}"
    return ""


def marched(period_map: PeriodMap, start: SectionPoint, periods: int) -> Seen:
    """March over some periods, and look at those that follow."""
    now = period_map.march(start, 2 * periods).end
    points, impulses = [now], []
    for _ in range(MOST_REPEATS + WATCHED):
        passage = period_map.march(now, 2)
        now = passage.end
        points.append(now)
        impulses.append(passage.impulses)
    repeats, closure = least_repeat(period_map, points)
    last = WATCHED // repeats * repeats if repeats else WATCHED
    return Seen(repeats, closure, np.mean(impulses[-last:], axis=0), now)


def least_repeat(period_map: PeriodMap, points: Sequence[SectionPoint]) -> tuple[int, float]:
    """The number of periods after which section points repeat, and the distance; 0 and the least if they do not."""
    size = max(period_map.size(point) for point in points)
    returns = np.array(
        [
            max(
                period_map.norm(period_map.difference(points[i + n], points[i]))
                for i in range(len(points) - 1 - WATCHED, len(points) - n)
            )
            for n in range(1, MOST_REPEATS + 1)
        ]
    )
    returns /= size
    closed = np.flatnonzero(returns <= _CLOSED)
    if not closed.size:
        closed = np.flatnonzero(returns <= _NOISY * min(1.0, float(returns.max())))
    if not closed.size:
        return 0, float(returns.min())
    return int(closed[0]) + 1, float(returns[closed[0]])


def reached_from_rest(period_map: PeriodMap, steady: SteadyState, decay_time: float) -> str:
    """How a march from the initial state ends elsewhere; empty if it does not, or if none was certified.

    The march is that of `simulate`.  Where it comes through the section point of the acceptance, no more is to be said;
    where the search has pushed it, it may not come through.
    """
    assert steady.acceptance is not None
    if steady.outcome is Outcome.UNDECIDED:
        return ""
    begin, accepted = period_map.initial(), steady.acceptance.point
    now = period_map.march(begin, 2 * steady.acceptance.periods).end
    if now.state == accepted.state and np.array_equal(now.coordinates, accepted.coordinates):
        return ""
    ahead = _ahead(period_map, steady, decay_time)
    seen = marched(period_map, now, ahead)
    why = contradiction(steady, seen, period_map.period)
    return _at_last(period_map, steady, seen, ahead)[0] if why and steady.period_multiple else why
