r"""One point of a curve of periodic motions, and the way from a guess to it.

The curve is F(x, p) = P(x, p) - x = 0 with the section point x and the number p.  Deviations are scaled: u by the size
that the solver gives each of its coordinates, over the size of the motion, and w = dp over the scale of p.  With the
derivative J = [P_x - 1, P_p], n x (n + 1), the curve's tangent is what J takes to zero, and the shortest (u, w) with
J (u, w) = -F leads back to the curve: Newton's method, bordered by the tangent where it stands.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cached_property, partial

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extrema, Extremum, closings_of, extrema_of, same_turning_point
from lapjoint.orbits.branches.newton_steps import jacobian, newton_step, shortest, tangent_and_step
from lapjoint.orbits.half_periods import HalfPeriods, Return
from lapjoint.orbits.newton import RESIDUAL, Orbit
from lapjoint.problem import FloatArray

_STEPS = 8
"""Most steps of Newton's method: from a guess near the curve, three are enough."""
_FAR = 0.5
"""Largest residual of a guess over the size of the motion."""
STEEP = 0.1
"""Share of the number in the tangent from which on the number is held while Newton's method leads back to the curve."""
_CHORD = 4.0
"""What a step with an earlier derivative leaves, at most: this times the residual from which it is made, squared, over
that at which the derivative was taken.  Newton's method leaves half of that where it is told by its last step."""
_SETTLED, _HARDLY = 1e-9, 100.0
"""Step of Newton's method, as an arc length, up to which a motion that closes is settled, and how many times as long as
what is left it must be to matter: beside a motion from which it springs a deviation comes back but for its cube, and
all motions within a thousandth of its size close."""
_REPEATS = 1e-6
"""Distance over its size by which a motion misses to repeat in half the time if it does not: it is 1e-9 for one that
does."""
_SLOWEST = 0.7
"""Least share of the residual that a step of Newton's method must take off."""


@dataclass(frozen=True)
class Place:
    """A point of a curve of periodic motions."""

    value: float
    """The number, in its SI unit."""
    orbit: Orbit
    """The motion."""
    weights: FloatArray
    """By which a deviation is multiplied to be scaled, shape ``(n,)``."""
    tangent: FloatArray
    """Unit tangent (u, w) of the curve, in either direction, shape ``(n + 1,)``."""
    half_periods: HalfPeriods
    """The map at `value`."""

    @property
    def count(self) -> int:
        """Number of half periods after which the motion repeats."""
        return self.orbit.half_periods

    @property
    def point(self) -> SectionPoint:
        """Its section point."""
        return self.orbit.point

    @cached_property
    def extrema(self) -> Extrema:
        """How near it comes to every stop, and how far beyond."""
        return extrema_of(self.orbit.last)

    @cached_property
    def closings(self) -> tuple[int, ...]:
        """How often each stop closes, as `Extrema.closings` has it."""
        return self.extrema.closings if "extrema" in self.__dict__ else closings_of(self.orbit.last)

    def matching(self, extremum: Extremum, duration: float) -> Extremum | None:
        """The extremum, or the turning point, that is nearest in phase to one of its kind by another solver.

        Parameters
        ----------
        extremum : Extremum
            As the other solver has it.
        duration : float
            Length of the motion there, s.

        Returns
        -------
        Extremum, or None
            None if there is none.
        """
        turns = extremum.segment is not None
        matching = partial(same_turning_point, self.orbit.last) if turns else self.extrema.matching
        return matching(extremum, duration)

    @cached_property
    def missed(self) -> FloatArray | None:
        """By how much it misses to repeat in half the time, scaled, shape ``(n,)``; None if there is no such motion."""
        half, count = self.half_periods, self.count // 2
        if self.count % 2 or count % half.least:
            return None
        return half.map.difference(half.marched(self.point, count), self.point) * self.weights

    @property
    def repeats_in_half(self) -> bool:
        """Whether it repeats in half the time, and so is one of the branch from which its own would spring."""
        if sum(self.closings) % 2:  # as many contacts begin in either half: this saves a march
            return False
        return self.missed is not None and float(np.linalg.norm(self.missed)) <= _REPEATS

    def repeats_sooner_than(self, other: Place) -> bool:
        """Whether it repeats in half the time, and another one does not.

        Parameters
        ----------
        other : Place
            The other place, of as many half periods.

        Returns
        -------
        bool
            Then it is of the branch from which that of the other springs, or would.
        """
        return self.repeats_in_half and not other.repeats_in_half

    def chord(self, family: Family, origin: Place) -> FloatArray:
        """Where this place lies, seen from another, in this place's coordinates, scaled.

        Parameters
        ----------
        family : Family
            The family of both.
        origin : Place
            The other place.

        Returns
        -------
        FloatArray, shape (n + 1,)
            (u, w).
        """
        map_, there = self.half_periods.map, origin.point
        if not _has_same_coordinates(there, self.point):
            there = map_.adopted(there)
        chord = np.empty(self.weights.size + 1)
        np.multiply(map_.difference(there, self.point), -self.weights, out=chord[:-1])
        chord[-1] = (self.value - origin.value) / family.scale(self.value)
        return chord

    def along(self, direction: FloatArray) -> Place:
        """The same with its tangent turned so that it goes along a direction.

        Parameters
        ----------
        direction : FloatArray, shape (n + 1,)
            (u, w), in the coordinates of this place.

        Returns
        -------
        Place
            The place.
        """
        return self.turned() if float(direction @ self.tangent) < 0 else self

    def turned(self) -> Place:
        """The same with the opposite tangent.

        Returns
        -------
        Place
            The place.
        """
        same = replace(self, tangent=-self.tangent)
        for name in ("extrema", "closings", "missed"):  # they do not depend on the tangent
            if name in self.__dict__:
                same.__dict__[name] = self.__dict__[name]
        return same

    def beginning_at(self, point: SectionPoint) -> Place:
        """The same with another section point: to measure distances from, or to sample the motion there.

        Parameters
        ----------
        point : SectionPoint
            The section point.

        Returns
        -------
        Place
            With the multipliers and the tangent of this one.
        """
        return replace(self, orbit=replace(self.orbit, point=point))

    def light(self) -> Place:
        """The same without the march from switch to switch, of which the extrema have been found.

        Returns
        -------
        Place
            It takes far less memory.
        """
        orbit = replace(self.orbit, last=self.orbit.last.without_segments())
        same = Place(self.value, orbit, self.weights, self.tangent, self.half_periods)
        same.__dict__["extrema"], same.__dict__["missed"] = self.extrema, self.missed
        if "values" in self.orbit.__dict__:
            orbit.__dict__["values"] = self.orbit.values
        return same

    @cached_property
    def orientation(self) -> int:
        """The sign of the number's part in the tangent times that of det(1 - P_x): the same all along a curve.

        It is the same across a graze, too: where an odd number of multipliers passes 1 there, the curve folds back.
        """
        matrix = self.orbit.last.matrix
        sign, _ = np.linalg.slogdet(np.eye(matrix.shape[0]) - matrix)
        return int(np.sign(self.tangent[-1]) * sign)

    def going_on_from(self, other: Place) -> Place:
        """The same with its tangent turned so that it goes on where a curve came to another of its places.

        Parameters
        ----------
        other : Place
            The other place, with its tangent.

        Returns
        -------
        Place
            The place.
        """
        return self.along(self.tangent if self.orientation == other.orientation else -self.tangent)

    def moved(self, family: Family, step: FloatArray) -> tuple[float, SectionPoint]:
        """A guess beside this place.

        Parameters
        ----------
        family : Family
            Its family.
        step : FloatArray, shape (n + 1,)
            (u, w).

        Returns
        -------
        tuple of float and SectionPoint
            The number, and the section point on its map.
        """
        value = self.value + float(step[-1]) * family.scale(self.value)
        return value, family.adopted(value, self.half_periods.map.moved(self.point, step[:-1] / self.weights))


def _has_same_coordinates(point: SectionPoint, other: SectionPoint) -> bool:
    """Whether the coordinates of two section points can be compared number by number."""
    if point.state != other.state or point.coordinates.shape != other.coordinates.shape:
        return False
    if point.nodes is None or other.nodes is None:
        return point.nodes is other.nodes
    return bool(np.array_equal(point.nodes, other.nodes))


def corrected(
    family: Family,
    value: float,
    guess: SectionPoint,
    count: int,
    *,
    fixed: bool = False,
    enough: Callable[[Place, float], bool] | None = None,
) -> Place | None:
    """The place of the curve that is nearest to a guess; None if Newton's method finds none.

    Parameters
    ----------
    family : Family
        The period maps.
    value : float
        The number at the guess, in its SI unit.
    guess : SectionPoint
        On the map there.
    count : int
        Number of half periods; an odd number for a symmetric motion.
    fixed : bool
        Whether the number is to stay as it is.
    enough : callable, optional
        Takes a motion that does not close, with its distance from the curve, scaled; whether it will do.

    Returns
    -------
    Place, or None
        It closes within `lapjoint.orbits.newton.RESIDUAL`, or is `enough`.
    """
    try:
        return _corrected(family, value, guess, count, fixed, enough)
    except (SolverError, InputError, np.linalg.LinAlgError):  # a step led out of what can be marched
        return None


def _corrected(
    family: Family,
    value: float,
    point: SectionPoint,
    count: int,
    fixed: bool,
    enough: Callable[[Place, float], bool] | None,
) -> Place | None:
    allowed, column, weights, J, state, first = _FAR, np.zeros(0), np.zeros(0), np.zeros((0, 1)), None, math.inf
    closed: Place | None = None
    for _ in range(_STEPS):
        half = family.at(value)
        found = family.linearised(value, point, count)
        r = half.map.difference(found.end, point)
        residual = half.relative(r, point)
        if not residual <= allowed:
            return closed
        own = residual <= RESIDUAL or point.state != state or _CHORD * residual**2 > RESIDUAL * first
        if own:
            if found.by_number is not None:
                column, weights = found.by_number, scaling(half, point, r.size)
            elif column.size != r.size or (residual <= RESIDUAL and fixed):
                column, weights = family.derivative(value, point, count), scaling(half, point, r.size)
            J, state, first = jacobian(found.matrix, column * family.scale(value), weights), point.state, residual
        closes = residual <= RESIDUAL
        if closes or (own and enough is not None):
            tangent, step = tangent_and_step(J, -weights * r)
            here = Place(value, Orbit(count, point, residual, found), weights, tangent, found.half_periods)
            way = shortest(step, tangent)
            if not closes and enough is not None and enough(here, float(np.linalg.norm(way))):
                return here
            step = np.append(step[:-1], 0.0) if fixed else way
            closed = here if closes else closed
            if closes and settled(step, weights * r):
                return here
        else:
            step = newton_step(J, weights * r, fixed)
        point = half.map.moved(point, step[:-1] / weights)
        if step[-1]:
            value += float(step[-1]) * family.scale(value)
            point = family.adopted(value, point)
        allowed = _SLOWEST * residual if closed is not None else max(_SLOWEST * residual, 10 * RESIDUAL)
    return closed


def settled(step: FloatArray, left: FloatArray) -> bool:
    """Whether a motion that closes is found: not so beside a motion from which it springs, where all motions close.

    Parameters
    ----------
    step : FloatArray, shape (n + 1,)
        Newton's next step (u, w), scaled.
    left : FloatArray, shape (n,)
        By how much the motion does not close, scaled.

    Returns
    -------
    bool
        Whether the step is short, or not much longer than what is left.
    """
    return float(np.linalg.norm(step)) <= max(_SETTLED, _HARDLY * float(np.linalg.norm(left)))


def place_from(
    value: float, point: SectionPoint, residual: float, found: Return, J: FloatArray, weights: FloatArray
) -> Place:
    """The place of a motion that closes.

    Parameters
    ----------
    value : float
        The number, in its SI unit.
    point : SectionPoint
        Where the motion begins.
    residual : float
        Distance between its start and end, over its size.
    found : Return
        The march over it.
    J : FloatArray, shape (n, n + 1)
        `jacobian` there.
    weights : FloatArray, shape (n,)
        `scaling` there.

    Returns
    -------
    Place
        Its tangent has any direction.
    """
    tangent, _ = tangent_and_step(J, np.zeros(J.shape[0]))
    return Place(value, Orbit(found.count, point, residual, found), weights, tangent, found.half_periods)


def scaling(half: HalfPeriods, point: SectionPoint, n: int) -> FloatArray:
    """Size of a unit of each coordinate over that of the motion.

    Parameters
    ----------
    half : HalfPeriods
        The map.
    point : SectionPoint
        A point of it.
    n : int
        Number of coordinates of a deviation from it.

    Returns
    -------
    FloatArray, shape (n,)
        Over the unit of each coordinate.
    """
    return half.unit_norms(n) / half.size(point)
