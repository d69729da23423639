"""The quantities and the places of a summary."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from lapjoint.answers.history import History, penetration_of
from lapjoint.answers.quantities import QUANTITIES, Quantity, checked_quantities
from lapjoint.answers.series import places_of
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.supports_and_stops import readings

IndexArray = npt.NDArray[np.intp]

STATIONS = 33
"""Number of equidistant places along the beam that are sampled in addition to the chosen places."""
ROUNDING = 1e-11
"""Largest value, divided by a quantity's largest magnitude along the beam, that is rounding, and is stated as zero: the
moment at a free end, for example.  Over random joints with 6 to 400 modes, rounding is at most 1e-13 of the largest
magnitude, and every other value at least 1e-5."""
DEFAULT = ("displacement", "velocity", "absolute_acceleration", "moment", "stress")
"""The default quantities of a summary; stress only if the beam has a section."""


@dataclass(frozen=True)
class Selection:
    """Quantities, and the places at which they are sampled: the chosen places, and `STATIONS` along the beam."""

    problem: Problem
    quantities: tuple[Quantity, ...]
    places: tuple[float, ...]
    """The chosen places, m."""

    @cached_property
    def x(self) -> FloatArray:
        """All places, with stops, masses and steps of the beam, m, ascending, shape ``(X,)``."""
        problem = self.problem
        parts = [x for stop in problem.structure.stops for x, _ in stop.reading]
        parts += [mass.x for mass in problem.structure.masses]
        parts += [piece.end for piece in problem.line.pieces]
        return np.unique(np.concatenate([self.places, parts, problem.line.grid(STATIONS)]))

    @cached_property
    def asked(self) -> IndexArray:
        """Indices in `x` of the chosen places, shape ``(places,)``."""
        return np.searchsorted(self.x, self.places)

    @property
    def fatigued(self) -> int:
        """Number of places at which cycles of stress are counted: all, if a material has an S-N line, or none."""
        return self.x.size if self.problem.line.has_fatigue else 0

    @cached_property
    def orders(self) -> tuple[tuple[int, int], ...]:
        """Orders (dx, dt) of the derivatives that are needed, each once; the displacement is always included, for the
        forces of stops."""
        return tuple(dict.fromkeys([(0, 0), *((one.dx, one.dt) for one in self.quantities)]))

    @cached_property
    def factors(self) -> tuple[FloatArray, ...]:
        """The factors of each quantity's derivative, ``(X, 1)``."""
        return tuple(one.factor(self.problem, self.x) for one in self.quantities)

    @cached_property
    def _shares(self) -> FloatArray:
        """How much of the base's motion acts along z at `x`, ``(X,)``."""
        return self.problem.structure.base_shares(self.x)

    @cached_property
    def _stops(self) -> tuple[IndexArray, FloatArray, FloatArray]:
        """Of the stops: which of `x` they see, shape ``(n,)``; the factors, ``(S, n)``; sign times stiffness, N/m,
        ``(S, 1)``."""
        stops = self.problem.structure.stops
        signed = np.array([[stop.sign * stop.stiffness] for stop in stops], dtype=float).reshape(-1, 1)
        x, seen = readings(stops)
        return np.searchsorted(self.x, x), seen, signed

    def values(self, history: History, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The quantities at all places, (Q, X, m), and the stops' forces, N, upwards, (S, m), at times, s, (m,)."""
        found = {(dx, dt): history.field(self.x, t, dx, dt) for dx, dt in self.orders}
        result = np.empty((len(self.quantities), self.x.size, t.size))
        for row, one, factor in zip(result, self.quantities, self.factors, strict=True):
            np.multiply(found[one.dx, one.dt], factor, out=row)
            if one.absolute:
                row += np.outer(self._shares, history.base(t, one.dt))
        at, factors, signed = self._stops
        seen = factors @ found[0, 0][at] + history.base_of_stops(t)
        return result, -signed * np.maximum(penetration_of(self.problem, seen), 0.0)


def keep_largest(values: FloatArray, t: FloatArray, largest: FloatArray, when: FloatArray) -> None:
    """Raise `largest`, (Q, X), to the largest magnitudes of values, (Q, X, m), and note their times in `when`, s."""
    if not t.size:
        return
    size = np.abs(values)
    at = size.argmax(axis=-1)
    found = np.take_along_axis(size, at[..., None], axis=-1)[..., 0]
    more = found > largest
    largest[more], when[more] = found[more], t[at][more]


def is_rounding(peaks: FloatArray) -> npt.NDArray[np.bool_]:
    """Whether a quantity is rounding at a place, from its largest magnitudes, (..., X); see `ROUNDING`."""
    return np.asarray(peaks <= ROUNDING * peaks.max(axis=-1, keepdims=True))


def selection(
    problem: Problem, *, at: Sequence[float] | None = None, quantities: Sequence[str] | None = None
) -> Selection:
    """Quantities, by default the `DEFAULT` ones that the problem has, and places, by default stops and free ends."""
    if quantities is None:
        names = [name for name in DEFAULT if name != "stress" or problem.line.has_sections]
    else:
        names = checked_quantities(problem, quantities, QUANTITIES)
    return Selection(problem, tuple(QUANTITIES[name] for name in names), tuple(places_of(problem, at)))
