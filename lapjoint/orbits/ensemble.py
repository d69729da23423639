"""Many marches of one problem at once: a solver that compiles its march does many of them in one call.

An `Ensemble` holds many section points, and advances any of them in place.  `MakesEnsembles` is the optional protocol
of a period map that makes its own ensembles.  For any other period map `ensemble_of` makes one that marches its points
one by one.
"""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, runtime_checkable

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import SolverError
from lapjoint.orbits.compiled_intervals import IndexArray
from lapjoint.orbits.period_map import PeriodMap
from lapjoint.problem import FloatArray


class Ensemble(Protocol):
    """Section points of one period map, its members, which march independently."""

    def march(self, which: IndexArray, periods: int) -> dict[int, str]:
        """March some members, (k,), over whole periods, with the bits of `PeriodMap.march`; return the messages of
        failed members."""

    def deviations(self, which: IndexArray, origin: SectionPoint) -> FloatArray:
        """The deviations of some members, (k,), from a section point `origin`, in its coordinates, (k, n)."""

    def point(self, member: int) -> SectionPoint:
        """The section point of a member."""


@runtime_checkable
class MakesEnsembles(Protocol):
    """A period map that marches many section points at once."""

    def ensemble(self, points: Sequence[SectionPoint]) -> Ensemble:
        """The ensemble of section points of this map; member i is point i."""


class OneByOne:
    """The ensemble of a period map that marches one section point at a time."""

    def __init__(self, period_map: PeriodMap, points: Sequence[SectionPoint]) -> None:
        self._map, self._points = period_map, list(points)

    def march(self, which: IndexArray, periods: int) -> dict[int, str]:
        """March some members.  See `Ensemble.march`."""
        failed: dict[int, str] = {}
        for i in which.tolist():
            try:
                self._points[i] = self._map.march(self._points[i], 2 * periods).end
            except SolverError as error:
                failed[i] = str(error)
        return failed

    def deviations(self, which: IndexArray, origin: SectionPoint) -> FloatArray:
        """Deviations of some members from a section point.  See `Ensemble.deviations`."""
        n = self._map.difference(origin, origin).size
        found = [self._map.difference(self._points[i], origin) for i in which.tolist()]
        return np.array(found).reshape(len(found), n)

    def point(self, member: int) -> SectionPoint:
        """The section point of a member.  See `Ensemble.point`."""
        return self._points[member]


def ensemble_of(period_map: PeriodMap, points: Sequence[SectionPoint]) -> Ensemble:
    """The ensemble of section points of any period map: the solver's own, if it has one."""
    return period_map.ensemble(points) if isinstance(period_map, MakesEnsembles) else OneByOne(period_map, points)
