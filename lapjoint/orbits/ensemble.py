"""Many marches of one problem at once: a solver that compiles its march does many of them in one call.

An `Ensemble` holds many section points and marches any of them on in place.  `Many` is the optional protocol of a
period map that makes one; `ensemble_of` makes one of any other period map, whose marches are then made one by one.
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
    """Section points of one period map that march on, each for itself."""

    def march(self, which: IndexArray, periods: int) -> dict[int, str]:
        """March some of them on, to the bits of `PeriodMap.march`.

        Parameters
        ----------
        which : ndarray of int, shape (k,)
            The members that march.
        periods : int
            Length of the march, in periods of the excitation, at least 1.

        Returns
        -------
        dict of int to str
            Why a march cannot go on, by the member; these stay anywhere.
        """

    def deviations(self, which: IndexArray, origin: SectionPoint) -> FloatArray:
        """The deviations of some of them from a section point.

        Parameters
        ----------
        which : ndarray of int, shape (k,)
            The members.
        origin : SectionPoint
            A point of the same map.

        Returns
        -------
        FloatArray, shape (k, n)
            In the coordinates that belong to `origin`.
        """

    def point(self, member: int) -> SectionPoint:
        """Where a member is.

        Parameters
        ----------
        member : int
            Its number.

        Returns
        -------
        SectionPoint
            A point of the map.
        """


@runtime_checkable
class Many(Protocol):
    """A period map that marches many section points at once."""

    def ensemble(self, points: Sequence[SectionPoint]) -> Ensemble:
        """Section points that march on together.

        Parameters
        ----------
        points : sequence of SectionPoint
            Points of this map.

        Returns
        -------
        Ensemble
            Its members are numbered as `points` are.
        """


class OneByOne:
    """The ensemble of a period map that marches one section point at a time.

    Parameters
    ----------
    period_map : PeriodMap
        The motion of the problem.
    points : sequence of SectionPoint
        Points of the map.
    """

    def __init__(self, period_map: PeriodMap, points: Sequence[SectionPoint]) -> None:
        self._map, self._points = period_map, list(points)

    def march(self, which: IndexArray, periods: int) -> dict[int, str]:
        """March some of them on. See `Ensemble.march`."""
        failed: dict[int, str] = {}
        for i in which.tolist():
            try:
                self._points[i] = self._map.march(self._points[i], 2 * periods).end
            except SolverError as error:
                failed[i] = str(error)
        return failed

    def deviations(self, which: IndexArray, origin: SectionPoint) -> FloatArray:
        """Their deviations from a section point. See `Ensemble.deviations`."""
        n = self._map.difference(origin, origin).size
        found = [self._map.difference(self._points[i], origin) for i in which.tolist()]
        return np.array(found).reshape(len(found), n)

    def point(self, member: int) -> SectionPoint:
        """Where a member is. See `Ensemble.point`."""
        return self._points[member]


def ensemble_of(period_map: PeriodMap, points: Sequence[SectionPoint]) -> Ensemble:
    """Section points that march on together, by any period map.

    Parameters
    ----------
    period_map : PeriodMap
        The motion of the problem.
    points : sequence of SectionPoint
        Points of the map.

    Returns
    -------
    Ensemble
        The solver's own, if it is one of `Many`.
    """
    return period_map.ensemble(points) if isinstance(period_map, Many) else OneByOne(period_map, points)
