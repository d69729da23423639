"""The motion of one problem, seen once in each period of its excitation: what a solver gives to be searched.

A *section point* is the state of a motion at a multiple of the period T.  The *period map* takes a section point to
the one a period later; its fixed points are the periodic motions.  A problem that is its own mirror image has a finer
map, over half a period and mirrored afterwards, z -> -z; its fixed points are the symmetric motions.

`PeriodMap` is what a solver must give.  A solver that also gives `Tangent` (how deviations travel), or `Follows` (that,
over many periods at once), is searched faster; without them finite differences of `PeriodMap.march` do the same work.
A deviation is a vector in the solver's own coordinates; the search only adds and scales deviations, and multiplies
them by the matrices that the solver gave.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
import numpy.typing as npt

from lapjoint.answers import History
from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class Passage:
    """What a march over some half periods comes to."""

    end: SectionPoint
    impulses: FloatArray
    """Impulse of each stop over the march, N s, top positive, bottom negative, shape ``(stops,)``."""
    switches: int
    """How often a stop opened or closed."""


class PeriodMap(Protocol):
    """The motion of one problem from section point to section point."""

    @property
    def problem(self) -> Problem:
        """The problem; its excitation has one frequency."""

    @property
    def period(self) -> float:
        """The excitation period T, s."""

    @property
    def slowest_decay(self) -> float:
        """Least rate at which a mode of the joint without contact dies away by damping, 1/s; 0 without damping."""

    def initial(self) -> SectionPoint:
        """The section point of the problem's initial state."""

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """March on from a section point; time counts from 0 there.

        Whole periods marched at once end at the same bits as one after the other.  After an odd number of half
        periods the end is a section point only once it is `mirrored`.

        Raises
        ------
        SolverError
            If the march cannot go on.
        """

    def history(self, start: SectionPoint, periods: int) -> History:
        """The same march with everything that a `History` holds."""

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """The deviation of a point from `origin`, in the coordinates that belong to `origin`, shape ``(n,)``."""

    def norm(self, deviation: FloatArray) -> float:
        """Size of a deviation: of displacements, and of velocities over the excitation frequency, alike."""

    def size(self, point: SectionPoint) -> float:
        """Size of a section point, in the norm of deviations."""

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """`origin` moved by a deviation of shape ``(n,)``; stops are then open or closed as the gaps have it."""

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image, z -> -z; asked for only if the problem is its own.

        Deviations of mirrored points differ from those of the points in their sign only.
        """

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """A point of a neighbouring problem, or of another resolution of the same solver, on this map.

        Stops are open or closed as this problem's gaps have it.

        Raises
        ------
        InputError
            If it is not a point of such a map.
        """


@dataclass(frozen=True)
class Segment:
    """A stretch of an orbit between two switches, and how deviations from the orbit travel along it.

    With tau = t - start, and e a deviation at the start of the whole march, of shape ``(n,)``,

        z_s(t)       = Re sum_k weights[s, k] amplitudes[k] exp(rates[k] tau) + sum_p polynomial[s, p] tau^p
        delta z_s(t) = Re sum_k weights[s, k] (deviations[k] . e) exp(rates[k] tau) + sum_p (drift[s, p] . e) tau^p

    at the places of the P stops.  Deviations have the first K' of the K terms.
    """

    start: float
    """s from the start of the march."""
    end: float
    closed: npt.NDArray[np.bool_]
    """Whether each stop is closed, shape ``(P,)``."""
    rates: ComplexArray
    """1/s, shape ``(K,)``."""
    weights: ComplexArray
    """Shape ``(P, K)``."""
    amplitudes: ComplexArray
    """Shape ``(K,)``."""
    polynomial: FloatArray
    """m, m/s, m/s2, shape ``(P, 3)``."""
    deviations: ComplexArray
    """Shape ``(K', n)``."""
    drift: FloatArray
    """Shape ``(P, 2, n)``."""
    switched: int
    """The stop that switches at the end; -1 if none does."""


@dataclass(frozen=True)
class Linearised:
    """A march over some half periods with its derivative."""

    end: SectionPoint
    matrix: FloatArray
    """Derivative of the end by the start, both in the coordinates that belong to the start, shape ``(n, n)``."""
    trace: Callable[[], tuple[Segment, ...]] = field(repr=False)
    """Gives the march from switch to switch, without gaps in time; called only where it is asked for."""

    @cached_property
    def segments(self) -> tuple[Segment, ...]:
        """The march from switch to switch, without gaps in time."""
        return self.trace()


@runtime_checkable
class Tangent(Protocol):
    """A period map that knows its own derivative."""

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March on from a section point and carry all deviations along; the end is not mirrored."""


@dataclass(frozen=True)
class Followed:
    """A march over some periods, and what became of one deviation."""

    points: tuple[SectionPoint, ...]
    """After each period, shape ``(periods,)``."""
    impulses: FloatArray
    """Of each stop over the whole march, N s, shape ``(stops,)``."""
    switches: int
    growth: FloatArray
    """Logarithm of the deviation's growth in each period, shape ``(periods,)``."""
    deviation: FloatArray
    """At the end, of unit size, in the coordinates that belong to the last point, shape ``(n,)``."""


@runtime_checkable
class Follows(Protocol):
    """A period map that carries one deviation along a long march by itself."""

    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        """March on over whole periods, to the bits of `PeriodMap.march`, and carry a deviation of unit size."""
