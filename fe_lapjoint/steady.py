"""The search for a steady state: march, try Newton's method ever less often, and measure how nearby motions part.

Newton's method starts long before the march has come near an orbit, but what it finds counts only if it is stable
and the march is bound for it (`fe_lapjoint.newton.bound_for`): of several steady states the one is reported that
the march from the given start leads to.  If the march sits on an unstable orbit it is pushed off
(`fe_lapjoint.held`), and an exponent says nothing of a march that repeats.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field

from fe_lapjoint.exponent import Growth
from fe_lapjoint.held import pushed_off, repeats
from fe_lapjoint.newton import Orbit, bound_for, least, newton
from fe_lapjoint.turns import Point, Turns
from lapjoint.answers.steady_state import Exponent, Outcome
from lapjoint.solver import Progress

TOLERANCE = 1e-9  # relative residual of an orbit
_FIRST = 8  # periods marched before Newton is first tried; then after twice as many
_TRANSIENT = 160  # periods before deviations are followed
_RETURN = 0.1  # relative distance after some turns at which a longer period is suspected
_SUSPECTS = 2  # longer periods tried at a time


@dataclass(frozen=True)
class Found:
    """What a search ended with."""

    orbit: Orbit | None
    last: Point
    exponent: Exponent | None
    outcome: Outcome = Outcome.UNDECIDED
    """What the exponent shows of a motion that does not repeat."""


@dataclass
class Search:
    """A march under way, one point a turn."""

    turns: Turns
    max_order: int
    max_periods: int
    points: list[Point] = field(default_factory=list)
    candidates: dict[int, tuple[Orbit, int]] = field(default_factory=dict)
    """The stable orbits found, by their number of turns, and how many points had been passed then."""
    circled: bool = False
    """Whether an unstable orbit that nearby motions leave in spirals has been found."""
    sat_on: Orbit | None = None
    """The unstable orbit that Newton's method last found, from the present point."""
    pushes: int = 0
    """How often the march has been pushed off an unstable orbit."""

    def run(self, start: Point, first: int, progress: Progress | None) -> Found:
        """Until an orbit is certain, or chaos is, or `max_periods` and an exponent's worth of periods are over."""
        self.points = [start]
        growth, per, trial = Growth(self.turns), self.turns.per_period, first
        while True:
            turned = self.turns.after(self.points[-1])
            self.points.append(turned.end)
            marched, part = divmod(len(self.points) - 1, per)
            if marched >= min(_TRANSIENT, self.max_periods):
                growth.add(turned)
            orbit = self._arrived()
            if orbit is None and part == 0:
                if progress is not None and marched % 8 == 0:
                    progress(min(marched, self.max_periods), self.max_periods)
                if marched >= trial or growth.due:
                    trial = 2 * marched if marched >= trial else trial
                    orbit = self._try_newton()
                    if orbit is None and self._pushed_off():
                        growth = Growth(self.turns)
                        continue
                if orbit is None and self._over(growth, marched):
                    return Found(None, self.points[-1], growth.exponent, growth.outcome)
            if orbit is not None:
                return Found(orbit, self.points[-1], None)

    def _over(self, growth: Growth, marched: int) -> bool:
        """Whether the exponent is certain to show what the motion is, or the effort allowed is spent.

        It shows nothing of a march that repeats: on an unstable orbit it is the growth of what the march does not do.
        """
        certain = False
        if growth.due:
            growth.judge(circled=self.circled)
            if growth.certain and repeats(self.turns, self.points, self.max_order):
                growth.withdraw()
            certain = growth.certain and not self.candidates
        over = certain or (growth.enough and marched >= self.max_periods)
        if growth.due and not over:
            growth.go_on()
        return over

    def _pushed_off(self) -> bool:
        """Push the march off the unstable orbit that it sits on, if it does."""
        if self.sat_on is None:
            return False
        point = pushed_off(self.turns, self.sat_on, self.points[-1], self.pushes)
        if point is None:
            return False
        self.points[-1] = point
        self.pushes += 1
        return True

    def _arrived(self) -> Orbit | None:
        """The candidate that the march is bound for; each is looked at when the march comes by its phase."""
        here = len(self.points) - 1
        for n, (orbit, found_at) in self.candidates.items():
            due = (here - found_at) % n == 0 and here >= 2 * n
            if due and bound_for(self.turns, orbit, self.points[-1 - 2 * n :: n]):
                return orbit
        return None

    def _try_newton(self) -> Orbit | None:
        """From the present point; returns the orbit found if the march is bound for it."""
        self.sat_on = None
        for count in self._counts():
            orbit = newton(self.turns, self.points[-1], count, TOLERANCE)
            self.circled |= orbit is not None and orbit.spirals_out
            if orbit is not None and orbit.unstable:
                self.sat_on = self.sat_on or orbit
            if orbit is not None and orbit.stable:
                orbit = least(self.turns, orbit, TOLERANCE)
                self.candidates[orbit.turns] = orbit, len(self.points) - 1
                if self._arrived() is orbit:
                    return orbit
        return None

    def _counts(self) -> Iterator[int]:
        """Numbers of turns to try: the symmetric motion, the excitation's period, and what nearly repeated."""
        per = self.turns.per_period
        yield from range(1, per + 1)
        here, suspects = self.points[-1], []
        size = self.turns.size(here.y)
        for n in range(per + 1, min(per * self.max_order, len(self.points) - 1) + 1):
            if n % per and n > self.max_order:
                continue  # symmetric, and of more periods than allowed
            away = self.turns.size(self.turns.seen_from(here.state, self.points[-1 - n]) - here.y)
            if away <= _RETURN * size:
                suspects.append((away, n))
        yield from (n for _, n in sorted(suspects)[:_SUSPECTS])


def find(
    turns: Turns, start: Point, *, near: bool, max_order: int, max_periods: int, progress: Progress | None
) -> Found:
    """The steady state that the march from `start` leads to; `near` says that it is likely to be near."""
    first = _FIRST // 2 if near else _FIRST
    return Search(turns, max_order, max_periods).run(start, min(first, max_periods), progress)
