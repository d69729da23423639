"""The parts of an orbit between its switches, and how deviations from it travel along each, as a solver gives them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, fields
from typing import NamedTuple, overload

import numpy as np
import numpy.typing as npt

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.problem import FloatArray


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
        return self[self.index_at(t)]

    def index_at(self, t: float) -> int:
        """The index of that segment.

        Parameters
        ----------
        t : float
            s from the start of the orbit.

        Returns
        -------
        int
            As `at` has it.
        """
        i = int(np.searchsorted(self.end, t))
        return i if i < len(self) and self.start[i] <= t else len(self) - 1


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

    def part(self, first: int, last: int) -> Segments:
        """Some segments that follow each other, without their change with a number.

        Parameters
        ----------
        first, last : int
            Index of the first one, and of the one after the last.

        Returns
        -------
        Segments
            Its arrays are views of these.
        """
        own = {one.name: getattr(self, one.name) for one in fields(self) if one.name != "change"}
        return Segments(**{name: values[first:last] for name, values in own.items()})

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
