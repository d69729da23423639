"""The segments of an orbit between its switches, and deviations along each, as a solver gives them."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple, overload

import numpy as np
import numpy.typing as npt

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.problem import FloatArray


class Segment(NamedTuple):
    """The part of an orbit between two switches, and the deviations from the orbit along it.

    With tau = t - start, and e a deviation at the start of the whole march, of shape ``(n,)``,

        z_s(t)       = Re sum_k weights[s, k] amplitudes[k] exp(rates[k] tau) + sum_p polynomial[s, p] tau^p
        delta z_s(t) = Re sum_k weights[s, k] (deviations[k] . e) exp(rates[k] tau) + sum_p (drift[s, p] . e) tau^p

    at the positions of the P stops.  Deviations have the first K' of the K terms.
    """

    start: float
    """Start of the segment, s from the start of the march."""
    end: float
    """End of the segment, s from the start of the march."""
    closed: npt.NDArray[np.bool_]
    """Whether each stop is closed, shape ``(P,)``."""
    rates: ComplexArray
    """Exponents of the terms, 1/s, shape ``(K,)``; their real parts are not positive."""
    weights: ComplexArray
    """Displacement at each stop by each term of unit amplitude, m per unit of the amplitudes, shape ``(P, K)``."""
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


@dataclass(frozen=True, eq=False)
class Segments(Sequence[Segment]):
    """The ``S`` segments of an orbit in arrays, padded with zeros if segments have different numbers of terms.

    Each `Segment` is made on access.
    """

    start: FloatArray
    """`Segment.start` of each segment, s, shape ``(S,)``."""
    end: FloatArray
    """`Segment.end` of each, s, shape ``(S,)``."""
    closed: npt.NDArray[np.bool_]
    """`Segment.closed` of each, shape ``(S, P)``."""
    terms: npt.NDArray[np.intp]
    """Number of terms of each segment, and number of terms of its deviations, shape ``(S, 2)``."""
    rates: ComplexArray
    """`Segment.rates` of each, 1/s, shape ``(S, K)``."""
    weights: ComplexArray
    """`Segment.weights` of each, m per unit of the amplitudes, shape ``(S, P, K)``."""
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

    @staticmethod
    def of(segments: Sequence[Segment]) -> Segments:
        """Segments, at least one, in the order of time, in arrays."""
        if isinstance(segments, Segments):
            return segments
        terms = np.array([(one.rates.size, one.deviations.shape[0]) for one in segments])
        K, own = terms.max(axis=0).tolist()
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
        )

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
        """The segment with an index that is not negative."""
        K, own = self.terms[i].tolist()
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
        )


def _padded(parts: list[ComplexArray], size: int) -> ComplexArray:
    """``S`` arrays of shape ``(..., k)`` as one of shape ``(S, ..., size)``, with zeros after the shorter ones."""
    made = np.zeros((len(parts), *parts[0].shape[:-1], size), dtype=complex)
    for one, part in zip(made, parts, strict=True):
        one[..., : part.shape[-1]] = part
    return made
