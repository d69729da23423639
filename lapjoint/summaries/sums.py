"""The sums over a motion from which its summary follows."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, fields, replace
from typing import Any, Self

import numpy as np
import numpy.typing as npt

from lapjoint.problem import FloatArray
from lapjoint.summaries.distributions import BINS

CountArray = npt.NDArray[np.int64]
OF_CONTACTS = ("impulse", "peak_force", "contact_duration", "impact_speed")
"""Quantities of a contact that have distributions: their magnitudes, in N s, N, s and m/s."""


@dataclass
class Sums:
    """Sums over a motion, cut into units of equal duration, each longer than the time of correlation of the motion.

    The first index of an array is the unit, U; then follow the quantity, Q, and the place, X, or the stop, S.
    """

    duration: float
    """Duration of a unit, s."""
    samples: CountArray
    """Number of samples, shape ``(U,)``."""
    total: FloatArray
    """Sum of the samples, shape ``(U, Q, X)``."""
    squares: FloatArray
    """Sum of the squares of the samples, shape ``(U, Q, X)``."""
    peak: FloatArray
    """Largest magnitude, shape ``(U, Q, X)``."""
    force_squares: FloatArray
    """Sum of the squares of the samples of the forces of the stops, N2, shape ``(U, S)``."""
    force_peak: FloatArray
    """Largest force, N, shape ``(U, S)``."""
    contacts: CountArray
    """Number of contacts that begin, shape ``(U, S)``."""
    time_in_contact: FloatArray
    """Time in contact, s, shape ``(U, S)``."""
    impulse: FloatArray
    """Impulse, N s, top positive, shape ``(U, S)``."""
    dissipated: FloatArray
    """Energy that the stops take and keep, J, shape ``(U, S)``."""
    largest: FloatArray
    """Largest value of each of `OF_CONTACTS`, shape ``(U, S, 4)``."""
    counts: CountArray
    """Uncut contacts in each bin of each of `OF_CONTACTS`, shape ``(U, S, 4, BINS)``."""
    received: FloatArray
    """The most that the stops take of each contact, J, shape ``(U, S)``."""
    work: FloatArray
    """Sum of the samples of the power of the excitation, W, shape ``(U,)``."""
    damage: FloatArray
    """Fatigue damage of the cycles that close, shape ``(U, X)``; ``(U, 0)`` without an S-N line."""
    coarse_damage: FloatArray
    """The same from every second sample."""
    largest_range: FloatArray
    """Largest range of stress of a cycle, Pa, shape ``(U, X)``."""
    range_counts: FloatArray
    """Cycles in each bin of the range of stress, shape ``(U, X, BINS)``; half cycles count half."""

    @classmethod
    def zero(cls, units: int, duration: float, quantities: int, places: int, stops: int, fatigued: int = 0) -> Self:
        """Sums that are all zero, for numbers of units, each of a duration, s, of quantities, of places, of
        stops, and of places with an S-N line."""
        shape, of_stops = (units, quantities, places), (units, stops)
        return cls(
            duration,
            np.zeros(units, dtype=np.int64),
            np.zeros(shape),
            np.zeros(shape),
            np.zeros(shape),
            np.zeros(of_stops),
            np.zeros(of_stops),
            np.zeros(of_stops, dtype=np.int64),
            np.zeros(of_stops),
            np.zeros(of_stops),
            np.zeros(of_stops),
            np.zeros((*of_stops, len(OF_CONTACTS))),
            np.zeros((*of_stops, len(OF_CONTACTS), BINS), dtype=np.int64),
            np.zeros(of_stops),
            np.zeros(units),
            np.zeros((units, fatigued)),
            np.zeros((units, fatigued)),
            np.zeros((units, fatigued)),
            np.zeros((units, fatigued, BINS)),
        )

    def without_bins(self) -> Sums:
        """The same without the counts in bins, which take most of the memory."""
        return replace(self, counts=self.counts[..., :0], range_counts=self.range_counts[..., :0])

    def plain(self) -> dict[str, Any]:
        """The sums as values for JSON; floats are exact, and empty bins are left out."""
        found: dict[str, Any] = {}
        for name in _NAMES:
            value = getattr(self, name)
            if name in _SPARSE:
                where = np.flatnonzero(value)
                found[name] = [list(value.shape), where.tolist(), value.ravel()[where].tolist()]
            elif name == "duration":
                found[name] = float(value)
            else:
                found[name] = [list(value.shape), value.ravel().tolist()]
        return found

    @classmethod
    def from_plain(cls, plain: dict[str, Any]) -> Self:
        """The sums from the values of `plain`, bit for bit."""
        found: dict[str, Any] = {"duration": plain["duration"]}
        for name in _NAMES[1:]:
            kind = np.int64 if name in _COUNTS else float
            if name in _SPARSE:
                shape, where, numbers = plain[name]
                value = np.zeros(int(np.prod(shape)), dtype=kind)
                value[where] = numbers
            else:
                shape, numbers = plain[name]
                value = np.array(numbers, dtype=kind)
            found[name] = value.reshape(shape)
        return cls(**found)

    @classmethod
    def joined(cls, parts: Sequence[Sums]) -> Sums:
        """The units of several motions, one after the other."""
        arrays = {name: np.concatenate([getattr(part, name) for part in parts]) for name in _NAMES[1:]}
        return Sums(parts[0].duration, **arrays)


_NAMES = tuple(field.name for field in fields(Sums))
_SPARSE = ("counts", "range_counts")
_COUNTS = ("samples", "contacts", "counts")
