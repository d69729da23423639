"""Period maps: the interface by which a solver gives the motion of one problem to the search for orbits.

A *section point* is the state of a motion at a multiple of the excitation period T.  The *period map* takes a section
point to the section point one period later; its fixed points are the motions of period T.  A problem that is its own
mirror image has a finer map, over half a period and then mirrored, z -> -z; its fixed points are the symmetric motions.

A solver must give a `PeriodMap`.  The search is faster if the map also has the methods of `Tangent` (the derivative of
a march) and `Follows` (the growth of one deviation over many periods); finite differences of `PeriodMap.march` replace
missing ones.  A deviation is a vector in the solver's own coordinates.  The search only adds and scales deviations, and
multiplies them by the solver's matrices.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, Protocol, runtime_checkable

import numpy as np

from lapjoint.answers import History
from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.errors import InputError
from lapjoint.orbits.segments import Segment, Segments
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class Passage:
    """The end of a march over some half periods, and the impulses and switches on the way."""

    end: SectionPoint
    """Where the march ends."""
    impulses: FloatArray
    """Impulse of each stop over the march, N s, top positive, bottom negative, shape ``(stops,)``."""
    switches: int
    """Number of switches: openings and closings of stops."""


class PeriodMap(Protocol):
    """The motion of one problem from section point to section point."""

    @property
    def problem(self) -> Problem:
        """The problem; its excitation has a period."""

    @property
    def period(self) -> float:
        """The excitation period T, s."""

    @property
    def lowest_damping_rate(self) -> float:
        """Lowest decay rate zeta_i omega_i of the damped modes of the joint without contact, 1/s; 0 without damping."""

    def initial(self) -> SectionPoint:
        """The section point of the problem's initial state."""

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """March from a section point, with time counted from 0 there.

        A march over several periods ends bit for bit where marches over the single periods end.  The end of a march
        over an odd number of half periods becomes a section point when it is `mirrored`.

        Parameters
        ----------
        start : SectionPoint
            Where the march begins.
        half_periods : int
            Its length, in half periods of the excitation, at least 1.

        Returns
        -------
        Passage
            The end, the impulses and the number of switches.

        Raises
        ------
        SolverError
            If the march cannot be continued.
        """

    def history(self, start: SectionPoint, periods: int) -> History:
        """The march of `march` as a `History`.

        Parameters
        ----------
        start : SectionPoint
            Where the march begins.
        periods : int
            Its length, in periods of the excitation, at least 1.

        Returns
        -------
        History
            The march, which starts at a multiple of the period.

        Raises
        ------
        SolverError
            If the march cannot be continued.
        """

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """The deviation of one section point from another.

        Parameters
        ----------
        point, origin : SectionPoint
            Two section points of this map; their contact states may differ.

        Returns
        -------
        FloatArray, shape (n,)
            The deviation in the coordinates that belong to `origin`.
        """

    def norm(self, deviation: FloatArray) -> float:
        """Size of a deviation: displacements, and velocities divided by the excitation frequency, have equal weight.

        Parameters
        ----------
        deviation : FloatArray, shape (n,)
            In the solver's own coordinates.

        Returns
        -------
        float
            In the unit of the solver's own displacement coordinates.
        """

    def size(self, point: SectionPoint) -> float:
        """Size of a section point: the `norm` of its deviation from rest.

        Parameters
        ----------
        point : SectionPoint
            A point of this map.

        Returns
        -------
        float
            In the unit of `norm`.
        """

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """A section point moved by a deviation; the gaps then decide which stops are open or closed.

        Parameters
        ----------
        origin : SectionPoint
            A point of this map.
        deviation : FloatArray, shape (n,)
            In the coordinates that belong to `origin`.

        Returns
        -------
        SectionPoint
            The moved point; its contact state, and with it its coordinates, may differ from those of `origin`.
        """

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image, z -> -z; called only if the problem is its own mirror image.

        A deviation between mirrored points is the negative of the deviation between the points.

        Parameters
        ----------
        point : SectionPoint
            The end of a march over an odd number of half periods.

        Returns
        -------
        SectionPoint
            A point of this map.
        """

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """A point of another map converted to this map: of a neighbouring problem, or of another resolution of the
        solver.

        This problem's gaps decide which stops are open or closed.

        Parameters
        ----------
        point : SectionPoint
            A point of another map of the same solver.

        Returns
        -------
        SectionPoint
            A point of this map.

        Raises
        ------
        InputError
            If it is not a point of such a map.
        """


MOST_PIECES = 10_000_000
"""Largest number of periods of a march whose motion is stored: more periods would take hours, and all memory."""


def period_pieces(period: float, duration: float) -> list[float]:
    """The durations, s, of the pieces of a march over a `duration`: whole periods, then the rest.

    An `InputError` refuses more than `MOST_PIECES`.
    """
    if duration / period > MOST_PIECES:
        raise InputError(
            f"duration = {duration:g}: at most {MOST_PIECES:g} periods of the excitation, {MOST_PIECES * period:g} s"
        )
    whole = int(duration / period * (1 + 1e-12))
    left = duration - whole * period
    return [period] * whole + [left] * (left > 1e-12 * duration)


def decay_periods(period_map: PeriodMap, decay_times: float, most: int) -> int:
    """Number of periods in `decay_times` decay times 1 / (zeta omega) of the slowest free vibration; 0 without damping.

    A number above `most`, the largest number that the caller marches, is given as ``most + 1``.
    """
    if not period_map.lowest_damping_rate:
        return 0
    rate = period_map.lowest_damping_rate * period_map.period
    return math.ceil(decay_times / rate) if rate * most >= decay_times else most + 1


class Derivative(NamedTuple):
    """Derivative of the end of a march by its start, in the coordinates that belong to the start."""

    matrix: FloatArray
    """Derivative by the start, shape ``(n, n)``."""
    factors: tuple[FloatArray, FloatArray] | None = None
    """Two matrices with the product `matrix`, of shapes ``(n, r)`` and ``(r, n)`` with a small r; None if r is n."""


@dataclass(frozen=True)
class Linearised:
    """A march over some half periods with its derivative."""

    end: SectionPoint
    """End of the march; not mirrored."""
    derivative: Callable[[], Derivative] = field(repr=False)
    """Returns the derivative; called only if it is needed."""
    trace: Callable[[], Sequence[Segment]] = field(repr=False)
    """Returns the march from switch to switch, without gaps in time; called only if it is needed."""
    outline: Callable[[], Sequence[Segment]] | None = field(default=None, repr=False)
    """Returns the march without deviations (`Segment.deviations` has no columns), if that is less work; else None."""

    @cached_property
    def known(self) -> Derivative:
        """The derivative of the end by the start."""
        return self.derivative()

    @property
    def matrix(self) -> FloatArray:
        """Derivative of the end by the start, both in the coordinates that belong to the start, shape ``(n, n)``."""
        return self.known.matrix

    @property
    def multipliers(self) -> ComplexArray:
        """Eigenvalues of `matrix`, shape ``(n,)``: with factors, of their product in reverse order, and 0.

        In a complex pair, the eigenvalue with the positive imaginary part comes first.
        """
        matrix, factors = self.known
        if factors is None:
            return np.linalg.eigvals(matrix).astype(complex)
        own = np.linalg.eigvals(factors[1] @ factors[0])
        return np.concatenate([own, np.zeros(matrix.shape[0] - own.size)])

    @cached_property
    def segments(self) -> Sequence[Segment]:
        """The march from switch to switch, without gaps in time."""
        return self.trace()

    @cached_property
    def motion(self) -> Segments:
        """The march from switch to switch in arrays, perhaps without deviations; there must be stops."""
        return Segments.of(self.segments if self.outline is None else self.outline())


@runtime_checkable
class Tangent(Protocol):
    """A period map that knows its own derivative."""

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March from a section point and carry all deviations along; the end is not mirrored.

        Parameters
        ----------
        start : SectionPoint
            Where the march begins.
        half_periods : int
            Its length, in half periods of the excitation, at least 1.

        Returns
        -------
        Linearised
            The end, and its derivative by the start.

        Raises
        ------
        SolverError
            If the march cannot be continued.
        """


@runtime_checkable
class UnitNorms(Protocol):
    """A period map that knows the size of a unit of each coordinate of a deviation."""

    def unit_norms(self, n: int) -> FloatArray:
        """`PeriodMap.norm` of a unit of each of the n coordinates of a deviation, shape (n,)."""


LEAST_GROWTH = 1e-150
"""Least growth of a deviation over a period: a size is a root of a sum of squares, and the squares of smaller numbers
underflow."""


def rescaled(deviation: FloatArray, norm: Callable[[FloatArray], float]) -> tuple[float, FloatArray]:
    """Size, at least `LEAST_GROWTH`, of a deviation, (n,), of unit size one period earlier; and the deviation,
    rescaled.

    The direction of a deviation that has nearly vanished is lost; another deviation replaces it.
    """
    size = norm(deviation)
    if size < LEAST_GROWTH:
        return LEAST_GROWTH, np.ones_like(deviation) / norm(np.ones_like(deviation))
    return size, deviation / size


@dataclass(frozen=True)
class Followed:
    """A march over some periods, and the growth of one deviation."""

    points: tuple[SectionPoint, ...]
    """The section point after each period."""
    impulses: FloatArray
    """Impulse of each stop over each period, N s, top positive, bottom negative, shape ``(periods, stops)``."""
    switches: int
    """Number of switches: openings and closings of stops."""
    growth: FloatArray
    """Natural logarithm of the deviation's growth, at least `LEAST_GROWTH`, in each period, shape ``(periods,)``."""
    deviation: FloatArray
    """The deviation at the end, of unit size, in the coordinates that belong to the last point, shape ``(n,)``."""


@runtime_checkable
class Follows(Protocol):
    """A period map that carries one deviation along a long march."""

    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        """March over whole periods, with the same bits as `PeriodMap.march`, and carry one deviation along.

        Parameters
        ----------
        start : SectionPoint
            Where the march begins.
        deviation : FloatArray, shape (n,)
            Of unit size in `PeriodMap.norm`, in the coordinates that belong to `start`.
        periods : int
            Length of the march, in periods of the excitation, at least 1.

        Returns
        -------
        Followed
            The section points on the way, and the growth of the deviation from each to the next.

        Raises
        ------
        SolverError
            If the march cannot be continued.
        """
