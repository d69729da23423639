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

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import NamedTuple, Protocol, overload, runtime_checkable

import numpy as np
import numpy.typing as npt

from lapjoint.answers import History
from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem


@dataclass(frozen=True)
class Passage:
    """What a march over some half periods comes to."""

    end: SectionPoint
    """Where it ends."""
    impulses: FloatArray
    """Impulse of each stop over the march, N s, top positive, bottom negative, shape ``(stops,)``."""
    switches: int
    """How often a stop opened or closed."""


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
        """March on from a section point; time counts from 0 there.

        Whole periods marched at once end at the same bits as one after the other.  After an odd number of half
        periods the end is a section point only once it is `mirrored`.

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
            If the march cannot go on.
        """

    def history(self, start: SectionPoint, periods: int) -> History:
        """The same march with everything that a `History` holds.

        Parameters
        ----------
        start : SectionPoint
            Where the march begins.
        periods : int
            Its length, in periods of the excitation, at least 1.

        Returns
        -------
        History
            It starts at a multiple of the period.

        Raises
        ------
        SolverError
            If the march cannot go on.
        """

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """The deviation of one section point from another.

        Parameters
        ----------
        point, origin : SectionPoint
            The two, of this map; their contact states may differ.

        Returns
        -------
        FloatArray, shape (n,)
            In the coordinates that belong to `origin`.
        """

    def norm(self, deviation: FloatArray) -> float:
        """Size of a deviation: of displacements, and of velocities over the excitation frequency, alike.

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
        """Size of a section point: that of its deviation from rest.

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
            The moved point; its contact state, and so its coordinates, may be of another kind.
        """

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image, z -> -z; asked for only if the problem is its own.

        Deviations of mirrored points differ from those of the points in their sign only.

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
        """A point of a neighbouring problem, or of another resolution of the same solver, on this map.

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
"""Largest number of periods of a march whose motion is kept: more would take hours, and all the memory there is."""


def period_pieces(period: float, duration: float) -> list[float]:
    """The pieces in which a march of any duration goes on, as the search does: whole periods, and what is left.

    Parameters
    ----------
    period : float
        Excitation period, s.
    duration : float
        Of the whole march, s.

    Returns
    -------
    list of float
        Durations of the pieces, s.

    Raises
    ------
    InputError
        If these are more than `MOST_PIECES`.
    """
    if duration / period > MOST_PIECES:
        raise InputError(
            f"duration = {duration:g}: at most {MOST_PIECES:g} periods of the excitation, {MOST_PIECES * period:g} s"
        )
    whole = int(duration / period * (1 + 1e-12))
    left = duration - whole * period
    return [period] * whole + [left] * (left > 1e-12 * duration)


class SegmentChange(NamedTuple):
    """How an orbit moves between two switches with a number of its problem, while its start stays where it is.

    At the positions of the P stops and at one time, with the K terms of the `Segment`,

        dz_s(t)/dp = Re sum_k (waves[s, k] + secular[s, k] tau) exp(rates[k] tau) + sum_p polynomial[s, p] tau^p
    """

    waves: ComplexArray
    """m over the number's unit, shape ``(P, K)``."""
    secular: ComplexArray
    """m/s over the number's unit, shape ``(P, K)``."""
    polynomial: FloatArray
    """m, m/s and m/s2 over the number's unit, shape ``(P, 3)``."""


class Segment(NamedTuple):
    """The part of an orbit between two switches, and how deviations from the orbit travel along it.

    With tau = t - start, and e a deviation at the start of the whole march, of shape ``(n,)``,

        z_s(t)       = Re sum_k weights[s, k] amplitudes[k] exp(rates[k] tau) + sum_p polynomial[s, p] tau^p
        delta z_s(t) = Re sum_k weights[s, k] (deviations[k] . e) exp(rates[k] tau) + sum_p (drift[s, p] . e) tau^p

    at the positions of the P stops.  Deviations have the first K' of the K terms.
    """

    start: float
    """Time of its start, s from the start of the march."""
    end: float
    """Time of its end, s from the start of the march."""
    closed: npt.NDArray[np.bool_]
    """Whether each stop is closed, shape ``(P,)``."""
    rates: ComplexArray
    """Exponents of the terms, 1/s, shape ``(K,)``; their real parts are not positive."""
    weights: ComplexArray
    """Displacement at each stop by each term, m over the unit of the amplitudes, shape ``(P, K)``."""
    amplitudes: ComplexArray
    """Amplitudes of the orbit's terms at the start of the segment, in the solver's own unit, shape ``(K,)``."""
    polynomial: FloatArray
    """Coefficients of the orbit's polynomial at each stop, m, m/s and m/s2, shape ``(P, 3)``."""
    deviations: ComplexArray
    """Rows that give the amplitudes of a deviation's terms from e, shape ``(K', n)``."""
    drift: FloatArray
    """Rows that give a deviation's polynomial at each stop from e, m and m/s, shape ``(P, 2, n)``."""
    switched: int
    """The stop that switches at the end; -1 if none does."""
    change: SegmentChange | None = None
    """How it moves with a number of the problem; None if that was not asked for."""


class Timed(Sequence[Segment]):
    """The ``S`` segments of an orbit, which know when each is."""

    start: FloatArray
    """`Segment.start` of each, s, shape ``(S,)``."""
    end: FloatArray
    """`Segment.end` of each, s, shape ``(S,)``."""

    def __len__(self) -> int:
        return self.start.size

    @overload
    def __getitem__(self, i: int) -> Segment: ...
    @overload
    def __getitem__(self, i: slice) -> tuple[Segment, ...]: ...
    def __getitem__(self, i: int | slice) -> Segment | tuple[Segment, ...]:
        if isinstance(i, slice):
            return tuple(self[k] for k in range(*i.indices(len(self))))
        return self._one(range(len(self))[i])

    def _one(self, i: int) -> Segment:
        """The segment with an index, which is not negative."""
        raise NotImplementedError

    def at(self, t: float) -> Segment:
        """The segment at a time.

        Parameters
        ----------
        t : float
            s from the start of the orbit.

        Returns
        -------
        Segment
            The earlier one where two meet, and the last one if there is none.
        """
        there = np.flatnonzero((self.start <= t) & (t <= self.end))
        return self[int(there[0]) if there.size else len(self) - 1]


@dataclass(frozen=True, eq=False)
class Segments(Timed):
    """The ``S`` segments of an orbit, all their parts in arrays; each `Segment` is made when it is asked for.

    A segment with fewer terms than another has terms of no size instead, after its own.
    """

    start: FloatArray
    """`Segment.start` of each, s, shape ``(S,)``."""
    end: FloatArray
    """`Segment.end` of each, s, shape ``(S,)``."""
    closed: npt.NDArray[np.bool_]
    """`Segment.closed` of each, shape ``(S, P)``."""
    terms: npt.NDArray[np.intp]
    """Number of terms of each, and of those that deviations have, shape ``(S, 2)``."""
    rates: ComplexArray
    """`Segment.rates` of each, 1/s, shape ``(S, K)``."""
    weights: ComplexArray
    """`Segment.weights` of each, m over the unit of the amplitudes, shape ``(S, P, K)``."""
    amplitudes: ComplexArray
    """`Segment.amplitudes` of each, in the solver's own unit, shape ``(S, K)``."""
    polynomial: FloatArray
    """`Segment.polynomial` of each, m, m/s and m/s2, shape ``(S, P, 3)``."""
    deviations: ComplexArray
    """`Segment.deviations` of each, shape ``(S, K', n)``."""
    drift: FloatArray
    """`Segment.drift` of each, m and m/s, shape ``(S, P, 2, n)``."""
    switched: npt.NDArray[np.intp]
    """`Segment.switched` of each, shape ``(S,)``."""
    change: SegmentChange | None = None
    """`Segment.change` of all, its arrays of the shapes ``(S, P, K)`` and ``(S, P, 3)``; None if not asked for."""

    @staticmethod
    def of(segments: Sequence[Segment]) -> Segments:
        """Segments in arrays.

        Parameters
        ----------
        segments : sequence of Segment
            At least one, in the order of time.

        Returns
        -------
        Segments
            The same.
        """
        if isinstance(segments, Segments):
            return segments
        terms = np.array([(one.rates.size, one.deviations.shape[0]) for one in segments])
        K, own = terms.max(axis=0).tolist()
        changes = [one.change for one in segments if one.change is not None]
        change = None
        if changes:
            waves, secular = (_padded([getattr(one, name) for one in changes], K) for name in ("waves", "secular"))
            change = SegmentChange(waves, secular, np.array([one.polynomial for one in changes]))
        return Segments(
            start=np.array([one.start for one in segments]),
            end=np.array([one.end for one in segments]),
            closed=np.array([one.closed for one in segments]),
            terms=terms,
            rates=_padded([one.rates for one in segments], K),
            weights=_padded([one.weights for one in segments], K),
            amplitudes=_padded([one.amplitudes for one in segments], K),
            polynomial=np.array([one.polynomial for one in segments]),
            deviations=_padded([one.deviations.T for one in segments], own).transpose(0, 2, 1),
            drift=np.array([one.drift for one in segments]),
            switched=np.array([one.switched for one in segments], dtype=np.intp),
            change=change,
        )

    def _one(self, i: int) -> Segment:
        K, own = self.terms[i].tolist()
        change = self.change
        return Segment(
            start=float(self.start[i]),
            end=float(self.end[i]),
            closed=self.closed[i],
            rates=self.rates[i, :K],
            weights=self.weights[i, :, :K],
            amplitudes=self.amplitudes[i, :K],
            polynomial=self.polynomial[i],
            deviations=self.deviations[i, :own],
            drift=self.drift[i],
            switched=int(self.switched[i]),
            change=None
            if change is None
            else SegmentChange(change.waves[i, :, :K], change.secular[i, :, :K], change.polynomial[i]),
        )


@dataclass(frozen=True, eq=False)
class MadeSegments(Timed):
    """The ``S`` segments of an orbit, each of which is made when it is first asked for."""

    start: FloatArray
    """`Segment.start` of each, s, shape ``(S,)``."""
    end: FloatArray
    """`Segment.end` of each, s, shape ``(S,)``."""
    make: Callable[[int], Segment]
    """Makes one by its index."""
    _made: dict[int, Segment] = field(default_factory=dict, repr=False)

    def _one(self, i: int) -> Segment:
        if i not in self._made:
            self._made[i] = self.make(i)
        return self._made[i]


def _padded(parts: list[ComplexArray], size: int) -> ComplexArray:
    """Arrays of shape ``(..., k)`` as one of shape ``(S, ..., size)``, with zeros after those that are shorter."""
    made = np.zeros((len(parts), *parts[0].shape[:-1], size), dtype=complex)
    for one, part in zip(made, parts, strict=True):
        one[..., : part.shape[-1]] = part
    return made


class Derivative(NamedTuple):
    """Derivative of a march's end, in the coordinates that belong to its start."""

    matrix: FloatArray
    """By the start, shape ``(n, n)``."""
    by_number: FloatArray | None = None
    """By a number of the problem, while the start stays where it is, over the number's unit, shape ``(n,)``; None if it
    was not asked for."""
    factors: tuple[FloatArray, FloatArray] | None = None
    """Two matrices of which `matrix` is the product, of shapes ``(n, r)`` and ``(r, n)`` with few r; None if r is n."""


@dataclass(frozen=True)
class Linearised:
    """A march over some half periods with its derivative."""

    end: SectionPoint
    """Where it ends; not mirrored."""
    derivative: Callable[[], Derivative] = field(repr=False)
    """Gives its derivative; called only where it is asked for."""
    trace: Callable[[], Sequence[Segment]] = field(repr=False)
    """Gives the march from switch to switch, without gaps in time; called only where it is asked for."""
    outline: Callable[[], Sequence[Segment]] | None = field(default=None, repr=False)
    """Gives the same as `trace` without deviations, for e of no coordinates, where that is less work."""
    alone: Callable[[FloatArray], Sequence[Segment]] | None = field(default=None, repr=False)
    """Gives the same for multiples of one deviation, whose one coordinate is e, where that is less work."""

    @cached_property
    def known(self) -> Derivative:
        """Its derivative."""
        return self.derivative()

    @property
    def matrix(self) -> FloatArray:
        """Derivative of the end by the start, both in the coordinates that belong to the start, shape ``(n, n)``."""
        return self.known.matrix

    @property
    def by_number(self) -> FloatArray | None:
        """See `Derivative.by_number`."""
        return self.known.by_number

    @property
    def multipliers(self) -> ComplexArray:
        """Eigenvalues of `matrix`, shape ``(n,)``: those of its factors the other way round, and 0.

        Of a pair the one with the positive imaginary part comes first.
        """
        matrix, _, factors = self.known
        if factors is None:
            return np.linalg.eigvals(matrix).astype(complex)
        own = np.linalg.eigvals(factors[1] @ factors[0])
        return np.concatenate([own, np.zeros(matrix.shape[0] - own.size)])

    @cached_property
    def segments(self) -> Sequence[Segment]:
        """The march from switch to switch, without gaps in time."""
        return self.trace()

    @cached_property
    def arrays(self) -> Segments:
        """The same in arrays, if there are stops."""
        return Segments.of(self.segments)

    def with_one(self, deviation: FloatArray) -> Segments:
        """The same in arrays, if there are stops, for multiples of one deviation alone.

        Parameters
        ----------
        deviation : FloatArray, shape (n,)
            In the coordinates that belong to the start.

        Returns
        -------
        Segments
            Deviations have one coordinate.
        """
        if self.alone is not None:
            return Segments.of(self.alone(deviation))
        whole, column = self.arrays, deviation[:, None]
        return replace(whole, deviations=whole.deviations @ column, drift=whole.drift @ column)

    @cached_property
    def motion(self) -> Segments:
        """The same in arrays, if there are stops, for those who ask for the orbit's own motion alone."""
        return self.arrays if self.outline is None else Segments.of(self.outline())


@runtime_checkable
class Tangent(Protocol):
    """A period map that knows its own derivative."""

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March on from a section point and carry all deviations along; the end is not mirrored.

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
            If the march cannot go on.
        """


@runtime_checkable
class UnitNorms(Protocol):
    """A period map that knows the size of a unit of each coordinate of a deviation."""

    def unit_norms(self, n: int) -> FloatArray:
        """`PeriodMap.norm` of the units.

        Parameters
        ----------
        n : int
            Number of coordinates.

        Returns
        -------
        FloatArray, shape (n,)
            In the unit of `PeriodMap.norm`.
        """


@dataclass(frozen=True)
class Followed:
    """A march over some periods, and what became of one deviation."""

    points: tuple[SectionPoint, ...]
    """The section point after each period, as many as periods."""
    impulses: FloatArray
    """Impulse of each stop over each period, N s, top positive, bottom negative, shape ``(periods, stops)``."""
    switches: int
    """How often a stop opened or closed."""
    growth: FloatArray
    """Natural logarithm of the deviation's growth in each period, shape ``(periods,)``."""
    deviation: FloatArray
    """The deviation at the end, of unit size, in the coordinates that belong to the last point, shape ``(n,)``."""


@runtime_checkable
class Follows(Protocol):
    """A period map that carries one deviation along a long march by itself."""

    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        """March on over whole periods, to the bits of `PeriodMap.march`, and carry one deviation along.

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
            If the march cannot go on.
        """
