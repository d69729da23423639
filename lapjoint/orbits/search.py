"""The search for the steady state: march, and find by Newton's method an orbit for which the march is bound.

The march continues period by period, as in `simulate`.  From time to time Newton's method begins at its section point:
for one period, symmetric motions first, and for several periods after which the march has nearly come back.  A stable
orbit is the steady state only if the march is bound for it: certain to converge to it (`lapjoint.orbits.approach`).  If
the march is not yet bound for the orbit, the forecast says how long to march before the next test.  The orbit is
dropped if the march meanwhile departs from the prediction of the linearised map.

A march that cannot leave an unstable motion is pushed off it (`lapjoint.orbits.unstable`).  A march that has not
settled after many periods is followed together with a deviation, and its Lyapunov exponent is measured over ever longer
stretches of periods.  An outcome counts if two successive stretches show it, the second longer than the first: a long
transient, or chaos that pauses, deceives one stretch more easily than two.  The second stretch must last for twenty
decay times of the slowest free vibration.  For an aperiodic outcome it must last for a hundred if a stable orbit is
known, or is found where the march nearly comes back.  Both lengths are limited by the allowed effort.  The motion
counts as accepted at the start of the second stretch, from which anyone can repeat it.  A march that nearly comes back
is not called quasi-periodic.

If a deviation grows by more than `BEYOND_ROUNDING` in each of the last periods, rounding alone decides where each
period ends.  Newton's method is then not tried again, and the stretches begin at once, with the least length for a
standard error.

All effort is counted in periods and switches: no outcome depends on the speed of the machine.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np

from lapjoint.answers.steady_state import Acceptance, Outcome, SectionPoint
from lapjoint.orbits.exponent import exponent_of, largest_growth
from lapjoint.orbits.finite_differences import FiniteDifferences
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.least_period import over_least_period
from lapjoint.orbits.newton import BEYOND_ROUNDING, FAR, RESIDUAL, Orbit, find_orbit
from lapjoint.orbits.period_map import Followed, Follows, PeriodMap, decay_periods
from lapjoint.orbits.unstable import NARROW, PUSHES, REPEATS, disturbed, pushed_off
from lapjoint.orbits.wandering import Wandering, breadth_and_residual, nearest_return, outcome_of
from lapjoint.problem import FloatArray
from lapjoint.solver import Progress
from lapjoint.summaries.correlated_series import standard_error

FIRST_LOOK = 8
"""Periods after which Newton's method is first tried from rest: most motions are then near enough to their orbit."""
FIRST_LOOK_NEAR = 4
"""Periods after which Newton's method is first tried from a known section point, which is likely to be near an
orbit."""
TRANSIENT = 256
"""Periods marched before an exponent is measured, so that the transient does not count."""
STRETCH = 512
"""Least number of periods over which an exponent is measured."""
SHORT_STRETCH = 64
"""Least number of periods of a stretch if rounding decides where each period ends: enough for a standard error of the
mean."""
_NEARLY_BACK = 0.05
"""Largest distance from an earlier section point, divided by the size of the motion, with which Newton's method is
tried for an orbit over the periods between the two points."""
_RETURNS = 3
"""Number of the nearest earlier section points for which Newton's method is tried."""
_NEAR = 0.2
"""Largest residual over several periods, as a fraction of the size of the motion, from which Newton's method is
tried."""
_COURSE = 0.25
"""Largest error of the linearised map's prediction of the march, as a fraction of the step that it predicts."""
_SLOWER = 0.5
"""Largest error of the linearised map's prediction, divided by the decrease of the distance by the slowest multiplier:
a march with a larger error may circle the orbit for ever."""
_THERE = 1e-8
"""Distance from an orbit, as a fraction of the size of the motion, within which rounding decides the direction of a
step."""
_AT = 1e-11
"""Distance from an orbit, divided by the size of the motion, within which a march is at the orbit: rounding and the
tolerance of switches leave some 1e-13."""
MULTIPLES_AT_A_LOOK = 8
"""Number of periods marched each time Newton's method is tried, to find the number of periods after which the march
comes back."""
DECAY_TIMES = 20.0
"""Least length of the second stretch, in decay times of the slowest free vibration: exp(-20) = 2e-9."""
SUSPECT = 5
"""Factor on `DECAY_TIMES` if a stable orbit is known: chaos may then be a long transient."""
_WATCHED = 192
"""Number of the last points of a stretch among which nearly closed orbits are searched for."""
_FEW = 3
"""Longest period of the nearly closed orbits searched for, in excitation periods."""
_TRIED = 4
"""Number of the nearly closed orbits for which Newton's method is tried, the most nearly closed first."""
_LOCKED = 1e-3
"""Distance from an earlier section point, divided by the breadth of the march, below which a motion may be locked to a
multiple of the period, and is not called quasi-periodic."""


@dataclass(frozen=True)
class Effort:
    """Limits of the search for a steady state."""

    max_period_multiple: int = 64
    """Longest period of the periodic motions searched for, in excitation periods."""
    max_periods: int = 16_000
    """Limit of the excitation periods marched; if an exponent has to be measured, at least one stretch is added."""
    max_switches: int = 20_000_000
    """Limit of the switches during the march."""
    growth: bool = True
    """Whether to measure the growth of deviations during the march, which about doubles the time."""


@dataclass(frozen=True)
class SearchResult:
    """The end of a search: an orbit, or a stretch of a march that was not found to repeat."""

    motion: Orbit | Wandering
    """The orbit or the stretch."""
    acceptance: Acceptance
    """The section point at which, and the number of periods after which, the motion was accepted."""


def near(half_periods: HalfPeriods, share: float, orbit: Orbit, deviation: FloatArray) -> bool:
    """Whether a deviation, (n,), is at most `share` times the orbit's size, or at most ten times the orbit's
    residual."""
    return half_periods.relative(deviation, orbit.point) <= max(share, 10 * orbit.residual)


def as_linearised(
    half_periods: HalfPeriods, orbit: Orbit, deviation: FloatArray, after: Callable[[], FloatArray]
) -> bool:
    """Whether the step of a march towards a stable orbit agrees with the linearised map.

    `deviation`, (n,), is e at the orbit's section point; `after` returns e one period of the orbit later, and is called
    only if it is needed.  The answer is True without a comparison if the orbit has no switches, because the map is then
    linear, and within rounding of the orbit.  Otherwise let M be the derivative of the map.  The error of the
    linearised step must be small compared with (I - M) e, the error near another fixed point.  It must also be small
    compared with the decrease of the distance by the slowest multiplier, because a motion of many periods around the
    orbit would have a larger error.
    """
    if not orbit.watch.switches.time.size or near(half_periods, _THERE, orbit, deviation):
        return True
    norm, mapped = half_periods.map.norm, orbit.last.matrix @ deviation
    slower = _SLOWER * (1 - abs(orbit.leading)) * norm(deviation)
    return norm(after() - mapped) <= min(_COURSE * norm(deviation - mapped), slower)


class SteadyStateSearch:
    """A march under way; `progress` is called with the periods marched and their limit."""

    def __init__(self, period_map: PeriodMap, effort: Effort, progress: Progress | None = None) -> None:
        self._map, self._effort, self._progress = period_map, effort, progress
        self._half_periods = HalfPeriods(period_map)
        self._follows: Follows = period_map if isinstance(period_map, Follows) else FiniteDifferences(period_map)
        self.point: SectionPoint
        """The section point that the march has reached; set by `run`."""
        self.marched = 0
        """Periods marched."""
        self._switches = self._pushes = 0
        self._growth: list[FloatArray] = []  # logarithms of the growth in each period that was followed
        self._deviation: FloatArray | None = None
        self._spirals = False  # whether an unstable orbit is known that nearby motions leave in spirals
        self._stable_known = False  # whether a stable orbit is known for which the march is not bound
        self._closest = (np.inf, 2)  # distance of the last nearest return, and its half periods

    def run(self, start: SectionPoint, first_look: int = FIRST_LOOK) -> SearchResult:
        """March until a motion is certified, or the effort is spent; Newton's method begins after `first_look`
        periods."""
        self.point, look = start, first_look
        while self.marched < TRANSIENT and not self._spent:
            self._advance(min(look, TRANSIENT, self._effort.max_periods) - self.marched)
            orbit = self._look()
            if orbit is not None:
                return self._found(orbit)
            if self._rounding_decides:
                break
            self._push_off()
            look = max(2 * look, self.marched)
        return self._wander()

    def _wander(self) -> SearchResult:
        """Continue a march that has not settled, and measure its exponent over ever longer stretches."""
        before: Wandering | None = None
        stretch = self._shortest
        while True:
            begun = Acceptance(self.point, self.marched)
            now, points = self._measured(stretch)
            orbit = self._look() or self._come_back(points)
            if orbit is not None:
                return self._found(orbit)
            if before is not None and now.confirms(before) and (self._spent or self._long_enough(now, points)):
                return self._found(now, begun)
            if self._spent:
                return self._found(replace(now, outcome=Outcome.UNDECIDED), begun)
            before = now
            if self._push_off() or self._disturbed(now):
                before = None
            else:
                wanted = max(2 * stretch, 0 if now.outcome is Outcome.UNDECIDED else self._enough)
                stretch = max(min(wanted, self._effort.max_periods - self.marched), self._shortest)

    @property
    def _rounding_decides(self) -> bool:
        """Whether a deviation grew beyond rounding in each of the last periods in which it was followed."""
        growth = np.concatenate([np.zeros(0), *self._growth[-MULTIPLES_AT_A_LOOK:]])
        return growth.size > 0 and float(growth.min()) > math.log(BEYOND_ROUNDING)

    @property
    def _shortest(self) -> int:
        """Least number of periods of the next stretch."""
        return SHORT_STRETCH if self._rounding_decides else STRETCH

    @property
    def _enough(self) -> int:
        """Periods after which free vibration has decayed: the least length of the second stretch."""
        return decay_periods(self._map, DECAY_TIMES, self._effort.max_periods)

    def _long_enough(self, now: Wandering, points: Sequence[SectionPoint]) -> bool:
        """Whether a stretch that confirms the previous stretch was long enough to count."""
        if now.outcome is Outcome.UNDECIDED:
            return True
        least = self._enough * (SUSPECT if self._may_settle(now, points) else 1)
        return now.exponent.periods >= least

    @property
    def _spent(self) -> bool:
        """Whether the allowed effort is spent."""
        return self.marched >= self._effort.max_periods or self._switches >= self._effort.max_switches

    def _found(self, motion: Orbit | Wandering, at: Acceptance | None = None) -> SearchResult:
        """The result of the search, accepted at the present point or, with `at`, where the last stretch began."""
        growth = largest_growth(np.concatenate(self._growth)) if self._effort.growth and self._growth else None
        at = at or Acceptance(self.point, self.marched)
        return SearchResult(motion, replace(at, pushes=self._pushes, growth=growth))

    def _advance(self, periods: int) -> None:
        """March over some periods."""
        if self._effort.growth:
            self._follow(periods)
        elif periods > 0:
            passage = self._map.march(self.point, 2 * periods)
            self.point, self._deviation = passage.end, None
            self._count(periods, passage.switches)

    def _follow(self, periods: int) -> Followed | None:
        """March over some periods, together with a deviation."""
        if periods <= 0:
            return None
        found = self._follows.followed(self.point, self._unit_deviation(), periods)
        self.point, self._deviation = found.points[-1], found.deviation
        self._growth.append(found.growth)
        self._count(periods, found.switches)
        return found

    def _unit_deviation(self) -> FloatArray:
        """The deviation that was followed to the present point, or else a random one, of unit size, shape ``(n,)``."""
        random = self._random_deviation()
        known = self._deviation is not None and self._deviation.size == random.size
        return self._deviation if known and self._deviation is not None else random

    def _random_deviation(self) -> FloatArray:
        """A random deviation of unit size, shape ``(n,)``; its numbers are the same each time."""
        deviation = np.random.default_rng(0).standard_normal(self._map.difference(self.point, self.point).size)
        return deviation / self._map.norm(deviation)

    def _count(self, periods: int, switches: int) -> None:
        self.marched += periods
        self._switches += switches
        if self._progress is not None:
            self._progress(min(self.marched, self._effort.max_periods), self._effort.max_periods)

    def _look(self) -> Orbit | None:
        """The orbit for which the march is bound, if one is found; the march advances meanwhile."""
        for count in range(self._half_periods.least, 3, self._half_periods.least):
            orbit = self._orbit(count, FAR)
            if orbit is not None:
                return orbit
        points = [self.point]
        for _ in range(min(self._effort.max_period_multiple, MULTIPLES_AT_A_LOOK)):
            self._follow(1)
            points.append(self.point)
        returns = np.array([self._half_periods.apart(point, points[-1]) for point in points[-2::-1]])
        self._closest = float(returns.min()), 2 * (int(np.argmin(returns)) + 1)
        for i in np.argsort(returns, kind="stable")[:_RETURNS]:
            if returns[i] <= _NEARLY_BACK and i > 0:
                orbit = self._orbit(2 * (int(i) + 1), _NEAR)
                if orbit is not None:
                    return orbit
        return None

    def _orbit(self, count: int, farthest: float) -> Orbit | None:
        """The orbit over `count` half periods that Newton's method finds from the present point, if the march is bound
        for it."""
        if self._rounding_decides:
            return None
        orbit = find_orbit(self._half_periods, self.point, count, farthest)
        if orbit is None:
            return None
        self._spirals |= orbit.spirals_out
        if not orbit.stable:
            return None
        orbit = over_least_period(self._half_periods, orbit)
        if orbit.period_multiple > self._effort.max_period_multiple:
            return None
        if self._bound_for(orbit):
            return orbit
        self._stable_known = True
        return None

    def _bound_for(self, orbit: Orbit) -> bool:
        """Whether the march is bound for a stable orbit; the march continues until this is known."""
        multiple, left = orbit.period_multiple, 2 * self._effort.max_periods // orbit.half_periods
        while True:
            deviation = self._map.difference(self.point, orbit.point)
            forecast = orbit.forecast(deviation, left)
            if forecast.bound and self._as_linearised(orbit, deviation):
                return True
            wait = math.ceil(forecast.fails * orbit.half_periods / 2)
            if wait > self._enough and near(self._half_periods, _AT, orbit, deviation):
                return self._stays(orbit)
            wait = multiple * math.ceil(max(wait, self.marched // 8, 1) / multiple)
            if self.marched + wait > self._effort.max_periods or not self.on_course(orbit, deviation, wait):
                return False

    def _stays(self, orbit: Orbit) -> bool:
        """March until free vibration has decayed; return whether the march is still at the orbit.

        If a stop chatters, or is touched by less than rounding, there is no room for any deviation, and no forecast can
        show that a march is bound for the orbit.
        """
        multiple = orbit.period_multiple
        wait = multiple * math.ceil(max(self._enough, TRANSIENT) / multiple)
        if self.marched + wait > self._effort.max_periods:
            return False
        self._advance(wait)
        return near(self._half_periods, _AT, orbit, self._map.difference(self.point, orbit.point))

    def _as_linearised(self, orbit: Orbit, deviation: FloatArray) -> bool:
        """Whether the next step of the march agrees with the linearised map of the orbit; see `as_linearised`."""

        def after() -> FloatArray:
            return self._map.difference(self._half_periods.marched(self.point, orbit.half_periods), orbit.point)

        return as_linearised(self._half_periods, orbit, deviation, after)

    def on_course(self, orbit: Orbit, deviation: FloatArray, periods: int) -> bool:
        """March over some periods; return whether the march follows the prediction of the linearised map.

        March and prediction are compared after 1, 3, 7, 15 ... periods of the orbit, and at the end.
        """
        multiple = orbit.period_multiple
        matrix = np.linalg.matrix_power(orbit.last.matrix, 2 * multiple // orbit.half_periods)
        steps, done = periods // multiple, 0
        predicted, power, stride = deviation, matrix, 1
        while done < steps and not self._spent:
            if done + stride > steps:
                stride = steps - done
                power = np.linalg.matrix_power(matrix, stride)
            self._advance(stride * multiple)
            done += stride
            predicted = power @ predicted
            actual = self._map.difference(self.point, orbit.point)
            if self._map.norm(actual - predicted) > _COURSE * self._map.norm(deviation - predicted):
                return False
            if done < steps:
                power, stride = power @ power, 2 * stride
        return done >= steps

    def _push_off(self) -> bool:
        """Push the march off an unstable motion that it cannot leave; return whether there is one."""
        closest, count = self._closest
        if closest > REPEATS:
            return False
        point = pushed_off(self._half_periods, self.point, count, self._pushes)
        if point is None:
            return False
        self.point = point
        self._pushes += 1
        return True

    def _disturbed(self, now: Wandering) -> bool:
        """Disturb an aperiodic march; return whether it was so narrow that the disturbance counts as a push."""
        if not now.exponent.positive:
            return False
        # The deviation that has grown may keep a symmetry of the march; a random one breaks it.
        both = self._unit_deviation() + self._random_deviation()
        both /= self._map.norm(both)
        self.point = disturbed(self._half_periods, self.point, now.breadth, both, self._pushes)
        pushed = now.breadth <= NARROW and self._pushes < PUSHES
        self._pushes += pushed
        return pushed

    def _come_back(self, points: Sequence[SectionPoint]) -> Orbit | None:
        """The orbit of many periods for which the march is bound, found from the nearest returns of its last points."""
        most = min(self._effort.max_period_multiple, len(points) - 1)
        returns = np.array([self._half_periods.apart(points[-1 - n], points[-1]) for n in range(1, most + 1)])
        if not returns.size or returns.min() > _NEARLY_BACK:
            return None
        first = int(np.flatnonzero(returns <= 10 * returns.min() + RESIDUAL)[0])
        self.point, before = points[-1], self.point
        for multiple in dict.fromkeys((first + 1, int(np.argmin(returns)) + 1)):
            orbit = self._orbit(2 * multiple, _NEAR)
            if orbit is not None:
                return orbit
        if self.point is points[-1]:
            self.point = before
        return None

    def _may_settle(self, now: Wandering, points: Sequence[SectionPoint]) -> bool:
        """Whether an aperiodic march may be a long transient, because there is a stable orbit.

        Orbits are searched where the march nearly comes back after a few periods.
        """
        if now.outcome is not Outcome.APERIODIC or self._stable_known or self._rounding_decides:
            return self._stable_known and now.outcome is Outcome.APERIODIC
        last, apart = points[-_WATCHED:], self._half_periods.apart
        nearly = [
            (apart(last[i + multiple], last[i]), i, multiple)
            for multiple in range(1, _FEW + 1)
            for i in range(0, len(last) - multiple, multiple)
        ]
        for _, i, multiple in sorted(nearly)[:_TRIED]:
            orbit = find_orbit(self._half_periods, last[i], 2 * multiple, FAR)
            self._stable_known |= orbit is not None and orbit.stable
        return self._stable_known

    def _measured(self, periods: int) -> tuple[Wandering, Sequence[SectionPoint]]:
        """March over a stretch of periods, and measure the largest Lyapunov exponent; return also its section
        points."""
        found = self._follow(periods)
        assert found is not None
        exponent = exponent_of(found.growth, self._map.period)
        most = min(self._effort.max_period_multiple, MULTIPLES_AT_A_LOOK)
        breadth, residual = breadth_and_residual(self._half_periods, found.points, most)
        outcome = outcome_of(
            exponent, self._map.lowest_damping_rate, breadth, spirals=self._spirals, pushes=self._pushes
        )
        if outcome is Outcome.QUASIPERIODIC and nearest_return(self._half_periods, found.points) <= _LOCKED * breadth:
            outcome = Outcome.UNDECIDED
        wandering = Wandering(
            outcome=outcome,
            exponent=exponent,
            point=found.points[-1],
            breadth=breadth,
            residual=residual,
            impulses=found.impulses.mean(axis=0),
            standard_errors=np.array([standard_error(impulses) for impulses in found.impulses.T]),
        )
        return wandering, found.points
