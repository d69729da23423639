r"""A motion of one solver taken to another from several of its section points: multiple shooting.

Newton's method from one section point misses a motion with a multiplier of 1e4 as soon as both solvers differ by 1e-4
of its size.  Between two of m section points of the motion a deviation grows by the m-th root of that.  With the map
over the way from point k to the next, F_k = P_k(x_k, p) - x_{k+1}, its derivatives A_k and b_k, and x_m = x_0, a step
is

    d_{k+1} = A_k d_k + b_k w + F_k,   (A - 1) d_0 + b w = -F,

with the products A of all A_k, and b and F carried to the end alike: the system of Newton's method from one point.

[1] U. M. Ascher, R. M. M. Mattheij, R. D. Russell, Numerical Solution of Boundary Value Problems for Ordinary
Differential Equations, SIAM, 1995, section 4.3.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.corrector import Place, corrected, scaling
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.newton_steps import jacobian, newton_step
from lapjoint.orbits.half_periods import HalfPeriods, Return
from lapjoint.problem import FloatArray

_STEPS = 10
"""Most steps: seven motions that Newton's method missed from one point, each taken to three solvers, took six."""
_FAR = 0.1
"""Largest residual over the size of the motion from which a step is made."""
_WORSE = 10.0
"""Most by which a step may make the least residual so far worse: at first, motions on either side of a graze do."""
_STALLED = 0.7
"""Share of the residual that two steps leave, at most, but for once: where a graze lies between two solvers' motions,
steps lead to and fro across it.  Of 23 that led to a motion, the slowest left half."""
_CLOSED, _ROUNDED = 1e-11, 1e-8
"""Residual over the size of the motion at which it is found, and below which it is where steps leave half of it."""


@dataclass(frozen=True)
class Stretch:
    """A part of a motion."""

    point: SectionPoint
    """Where it begins."""
    half_periods: int
    """Its length."""


def stretches_of(place: Place) -> list[Stretch]:
    """The parts of a motion between its section points that have the contact state of the first.

    Parameters
    ----------
    place : Place
        The motion.

    Returns
    -------
    list of Stretch
        Together as long as the motion: what deviations are in other states' modes, these modes cannot carry.
    """
    half, points = place.half_periods, [place.point]
    for _ in range(1, place.count // half.least):
        points.append(half.marched(points[-1], half.least))
    at = [k for k, point in enumerate(points) if point.state == place.point.state]
    ends = [*at[1:], len(points)]
    return [Stretch(points[k], (end - k) * half.least) for k, end in zip(at, ends, strict=True)]


def taken_over(
    family: Family, place: Place, guess: Callable[[SectionPoint], SectionPoint] | None = None, *, fixed: bool = False
) -> Place | None:
    """The motion of a solver that is nearest to one of another.

    Parameters
    ----------
    family : Family
        The period maps of the solver.
    place : Place
        The motion of the other.
    guess : callable, optional
        Takes a section point of the other one to the map of this one, at the same number; `Family.adopted` by default.
    fixed : bool
        Whether the number is to stay as it is.

    Returns
    -------
    Place, or None
        None if Newton's method finds none, neither from the first section point nor from several, or one of the branch
        from which that of the motion springs.
    """
    to_map = guess or (lambda point: family.adopted(place.value, point))

    def from_one() -> Place | None:
        return corrected(family, place.value, to_map(place.point), place.count, fixed=fixed)

    def from_several() -> Place | None:
        try:
            stretches = stretches_of(place)
            if len(stretches) == 1:
                return None
            there = [Stretch(to_map(one.point), one.half_periods) for one in stretches]
            return _shot(family, place.value, there, place.count, fixed)
        except (SolverError, InputError, np.linalg.LinAlgError):  # a step led out of what can be marched
            return None

    found = (way() for way in (from_one, from_several))
    return next((one for one in found if one is not None and not one.repeats_sooner_than(place)), None)


@dataclass(frozen=True)
class Round:
    """Marches from some section points of a motion, each to the next one."""

    family: Family
    """The period maps."""
    value: float
    """The number, in its SI unit."""
    points: Sequence[SectionPoint]
    """Where they begin, ``m`` points of one contact state."""
    lengths: Sequence[int]
    """Half periods of each."""

    @classmethod
    def along(cls, family: Family, value: float, stretches: Sequence[Stretch]) -> Round:
        """The marches over some stretches of a motion.

        Parameters
        ----------
        family : Family
            The period maps.
        value : float
            The number, in its SI unit.
        stretches : sequence of Stretch
            On the map there.

        Returns
        -------
        Round
            The round.
        """
        return cls(family, value, [one.point for one in stretches], [one.half_periods for one in stretches])

    @property
    def in_one_state(self) -> bool:
        """Whether all points still have the contact state of the first: else they cannot be compared."""
        return len({point.state for point in self.points}) == 1

    @cached_property
    def found(self) -> list[Return]:
        """The marches."""
        both = zip(self.points, self.lengths, strict=True)
        return [self.family.linearised(self.value, point, length) for point, length in both]

    @property
    def half(self) -> HalfPeriods:
        """The map."""
        return self.found[0].half_periods

    @property
    def _after(self) -> list[SectionPoint]:
        return [*self.points[1:], self.points[0]]

    @cached_property
    def misses(self) -> list[FloatArray]:
        """By how much each misses the next point, each of shape ``(n,)``."""
        return [self.half.map.difference(one.end, point) for one, point in zip(self.found, self._after, strict=True)]

    @property
    def residual(self) -> float:
        """The largest of these over the size of the motion."""
        return max(self.half.relative(miss, point) for miss, point in zip(self.misses, self._after, strict=True))

    @cached_property
    def _columns(self) -> list[FloatArray]:
        """Derivative of the end of each by the number."""
        return [self.family.column(self.value, one) for one in self.found]

    @cached_property
    def weights(self) -> FloatArray:
        """`scaling` at the first point, shape ``(n,)``."""
        return scaling(self.half, self.points[0], self.misses[0].size)

    def carried(self, stretches: int) -> tuple[FloatArray, FloatArray, FloatArray]:
        """What becomes of a deviation from the first point, of the number's change, and of the misses.

        Parameters
        ----------
        stretches : int
            Over how many of the marches.

        Returns
        -------
        whole : FloatArray, shape (n, n)
            By the deviation.
        by_number : FloatArray, shape (n,)
            By the number.
        missed : FloatArray, shape (n,)
            What the misses come to.
        """
        n = self.misses[0].size
        whole, by_number, missed = np.eye(n), np.zeros(n), np.zeros(n)
        for one, column, miss in zip(self.found[:stretches], self._columns, self.misses, strict=False):
            whole, by_number, missed = one.carried(whole), one.carried(by_number) + column, one.carried(missed) + miss
        return whole, by_number, missed

    def system(self) -> tuple[FloatArray, FloatArray]:
        """The system of Newton's method from the first point.

        Returns
        -------
        J : FloatArray, shape (n, n + 1)
            `jacobian` over all marches.
        missed : FloatArray, shape (n,)
            What they miss, scaled.
        """
        whole, by_number, missed = self.carried(len(self.points))
        return jacobian(whole, by_number * self.family.scale(self.value), self.weights), self.weights * missed

    def stepped(self, step: FloatArray) -> Round:
        """The round after a step.

        Parameters
        ----------
        step : FloatArray, shape (n + 1,)
            (u, w) at the first point; the others follow it.

        Returns
        -------
        Round
            The round.
        """
        deviation, change = step[:-1] / self.weights, float(step[-1]) * self.family.scale(self.value)
        value, moved = self.value + change, list[SectionPoint]()
        for one, point, column, miss in zip(self.found, self.points, self._columns, self.misses, strict=True):
            moved.append(self.family.adopted(value, self.half.map.moved(point, deviation)))
            deviation = one.carried(deviation) + column * change + miss
        return Round(self.family, value, moved, self.lengths)


def _shot(family: Family, value: float, stretches: Sequence[Stretch], count: int, fixed: bool) -> Place | None:
    """The motion near some stretches; None if steps do not lead to one."""
    now = Round.along(family, value, stretches)
    residuals = list[float]()
    for _ in range(_STEPS):
        if not now.in_one_state:
            return None
        residual = now.residual
        least, last = min(residuals, default=np.inf), residuals[-1] if residuals else np.inf
        if residual <= _CLOSED or (residual <= _ROUNDED and residual > 0.5 * last):
            return corrected(family, now.value, now.points[0], count, fixed=fixed)
        residuals.append(residual)
        if not residual <= min(_FAR, _WORSE * least) or _stalls(residuals):
            return None
        now = now.stepped(newton_step(*now.system(), fixed))
    return None


def _stalls(residuals: Sequence[float]) -> bool:
    """Whether steps lead to and fro."""
    return len(residuals) > 3 and all(residuals[-i] > _STALLED * residuals[-i - 2] for i in (1, 2))
