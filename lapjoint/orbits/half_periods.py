"""The map over any number of half periods; after an odd number follows the mirror image z -> -z."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import cast

import numpy as np

from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.orbits.finite_differences import FiniteDifferences
from lapjoint.orbits.period_map import Linearised, PeriodMap, Tangent, UnitNorms
from lapjoint.orbits.watch import SegmentWatch, Watch
from lapjoint.problem import FloatArray
from lapjoint.problem.symmetry import mirror_twins

_TINY = float(np.finfo(float).tiny)
"""Least size of a section point by which other sizes are divided, in the unit of `PeriodMap.norm`."""


def gives(map_: PeriodMap, more: type) -> bool:
    """Whether a period map has the methods of another protocol, too.

    The class is examined first, because Python caches the answer for a class.  The map itself is examined if its class
    lacks the methods.
    """
    return issubclass(type(map_), more) or isinstance(map_, more)


@dataclass(frozen=True)
class HalfPeriodMarch:
    """A march over some half periods with its derivative, mirrored if their number is odd."""

    end: SectionPoint
    """The end of the march, mirrored if `count` is odd."""
    half_periods: HalfPeriods
    """The map by which the march was made."""
    linearised: Linearised
    """The march and its derivative before mirroring."""
    count: int
    """Number of half periods."""

    @cached_property
    def matrix(self) -> FloatArray:
        """Derivative of the end by the start, in the coordinates that belong to the start, shape ``(n, n)``."""
        return -self.linearised.matrix if self.count % 2 else self.linearised.matrix

    @property
    def multipliers(self) -> ComplexArray:
        """Eigenvalues of `matrix`, shape ``(n,)``; of a complex pair the positive imaginary part comes first."""
        own = self.linearised.multipliers
        return -own.conj() if self.count % 2 else own

    @cached_property
    def watch(self) -> Watch:
        """Distances from all stops during the march."""
        twins = self.half_periods.twins if self.count % 2 else None
        return SegmentWatch(self.half_periods.map.problem, self.linearised.segments, twins)


@dataclass(frozen=True)
class HalfPeriods:
    """The map of one problem over any number of half periods."""

    map: PeriodMap

    @cached_property
    def twins(self) -> tuple[int, ...] | None:
        """The twin of each stop, if the problem is its own mirror image."""
        return mirror_twins(self.map.problem)

    @cached_property
    def tangent(self) -> Tangent:
        """The solver's own derivative, or finite differences."""
        return cast(Tangent, self.map) if gives(self.map, Tangent) else FiniteDifferences(self.map)

    @property
    def least(self) -> int:
        """Half periods of the finest map: 1 if the problem is its own mirror image, else 2."""
        return 2 if self.twins is None else 1

    @cached_property
    def _unit_norms(self) -> dict[int, FloatArray]:
        return {}

    def unit_norms(self, n: int) -> FloatArray:
        """`PeriodMap.norm` of a unit of each of the n coordinates of a deviation, shape (n,)."""
        if n not in self._unit_norms:
            map_ = self.map
            known = (
                cast(UnitNorms, map_).unit_norms(n)
                if gives(map_, UnitNorms)
                else [map_.norm(unit) for unit in np.eye(n)]
            )
            self._unit_norms[n] = np.asarray(known, dtype=float)
        return self._unit_norms[n]

    def growth(self, matrix: FloatArray) -> float:
        """Largest element of a march's derivative `matrix`, (n, n), with coordinates scaled to units of size 1.

        It is nan or inf if the derivative overflows double precision.
        """
        unit = self.unit_norms(len(matrix))
        with np.errstate(over="ignore", invalid="ignore"):
            return float(np.max(np.abs(matrix) * unit[:, None] / unit, initial=0.0))

    def marched(self, point: SectionPoint, count: int) -> SectionPoint:
        """The end of a march over `count` half periods, a multiple of `least`; mirrored if `count` is odd."""
        end = self.map.march(point, count).end
        return self.map.mirrored(end) if count % 2 else end

    def linearised(self, point: SectionPoint, count: int) -> HalfPeriodMarch:
        """A march over `count` half periods, a multiple of `least`, with its derivative; mirrored if `count` is odd."""
        found = self.tangent.linearised(point, count)
        return HalfPeriodMarch(self.map.mirrored(found.end) if count % 2 else found.end, self, found, count)

    def relative(self, deviation: FloatArray, point: SectionPoint) -> float:
        """Size of a deviation, (n,), as a fraction of the size of the section point to which its coordinates belong."""
        return self.map.norm(deviation) / self.size(point)

    def size(self, point: SectionPoint) -> float:
        """`PeriodMap.size` of a section point, or the least number above zero."""
        return max(self.map.size(point), _TINY)

    def apart(self, point: SectionPoint, origin: SectionPoint) -> float:
        """Distance of two section points, as a fraction of the size of the second."""
        return self.relative(self.map.difference(point, origin), origin)
