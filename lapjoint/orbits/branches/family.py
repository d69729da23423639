"""The period maps of one solver for a problem of which one number varies: what a branch is followed in."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Callable
from copy import copy
from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np

from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError
from lapjoint.orbits.curves.resolution import HasPeriodMap, Refines, zones_of
from lapjoint.orbits.half_periods import HalfPeriods, Return
from lapjoint.orbits.refinement import Refinement
from lapjoint.problem import FloatArray, Problem

_STEP = 3e-8
"""Step of the differences over the scale of the number: rounding, 1e-15 / 3e-8, and curvature leave seven digits, and a
graze that is ten times farther away does not come between."""
_KEPT = 32
"""Number of period maps that are kept: a step, and the differences at its ends, return to the same values."""


@dataclass(frozen=True)
class Zone:
    """A part of the range, and the solver that resolves all problems in it."""

    high: float
    """Its upper end, in the SI unit of the number."""
    solver: HasPeriodMap
    """The solver."""


class Family:
    """The period maps of a problem over a range of one of its numbers.

    Parameters
    ----------
    solver : HasPeriodMap
        The solver.
    problem_at : callable
        Takes a value of the number, and returns the problem with it.
    path : str
        Path of the number, as `lapjoint.Axis` takes it.
    low, high : float
        The range, in the SI unit of the number; `low` < `high`.

    Raises
    ------
    InputError
        If the solver has no period map, or there is no valid problem at an end of the range.
    """

    def __init__(
        self, solver: object, problem_at: Callable[[float], Problem], path: str, low: float, high: float
    ) -> None:
        if not isinstance(solver, HasPeriodMap):
            raise InputError(f"solver = {getattr(solver, 'name', solver)}: gives no period map, and so no branches")
        if not (np.isfinite([low, high]).all() and low < high):
            raise InputError(f"{path}: from {low:g} to {high:g} is no range; both must be finite, and ascend")
        self.problem_at, self.path, self.low, self.high = problem_at, path, float(low), float(high)
        self.zones = [Zone(end, own) for end, own in zones_of(solver, problem_at, self.low, self.high)]
        """Parts of the range of one resolution each, in ascending order."""
        self._highs = [zone.high for zone in self.zones]
        self._first = self
        self.level = 0
        """How many times `finer` leads from the first family to this one."""
        self.marches = 0
        """How many marches with their derivatives have been made so far: what work is measured by."""
        self._maps, self._like = lru_cache(maxsize=_KEPT)(self._made), dict[int, HalfPeriods]()

    def at(self, value: float) -> HalfPeriods:
        """The map over half periods at a value of the number.

        Parameters
        ----------
        value : float
            In its SI unit.

        Returns
        -------
        HalfPeriods
            The map.

        Raises
        ------
        InputError
            If there is no such problem.
        """
        return self._maps(float(value))

    def solver_at(self, value: float) -> HasPeriodMap:
        """The solver with the resolution that it has about a value of the number.

        Parameters
        ----------
        value : float
            In its SI unit.

        Returns
        -------
        HasPeriodMap
            The solver.
        """
        return self.zones[self._zone_of(value)].solver

    def finer(self, value: float) -> tuple[Refinement, Family] | None:
        """The same by a finer self of the solver, and what is known of it about a value of the number.

        Parameters
        ----------
        value : float
            In its SI unit.

        Returns
        -------
        tuple of Refinement and Family, or None
            None if the solver has no finer self.
        """
        return None if self._finer is None else (self._finer[0][self._zone_of(value)], self._finer[1])

    def self_at(self, level: int) -> Family:
        """The same by one of the finer selves of the solver.

        Parameters
        ----------
        level : int
            Its `level`, not below this one's; there is such a self.

        Returns
        -------
        Family
            The period maps.
        """
        found = self
        while found.level < level:
            known = found._finer
            assert known is not None
            found = known[1]
        return found

    def is_a_self_of(self, other: Family) -> bool:
        """Whether one of both comes from the other by `finer`, once or more.

        Parameters
        ----------
        other : Family
            The other one.

        Returns
        -------
        bool
            Whether section points of one can be adopted by the other.
        """
        return self._first is other._first

    @cached_property
    def _finer(self) -> tuple[list[Refinement], Family] | None:
        known, zones = list[Refinement](), list[Zone]()
        for zone in self.zones:
            found = zone.solver.finer(self.problem_at(zone.high)) if isinstance(zone.solver, Refines) else None
            if found is None:
                return None
            known.append(found[0])
            zones.append(Zone(zone.high, found[1]))
        finer = copy(self)
        finer.zones, finer._maps, finer._like = zones, lru_cache(maxsize=_KEPT)(finer._made), {}
        finer.level, finer.marches = self.level + 1, 0
        return known, finer

    def _zone_of(self, value: float) -> int:
        return bisect_left(self._highs, value, hi=len(self._highs) - 1)

    def scale(self, value: float) -> float:
        """What a change of the number is compared with: its size, or the whole range where that includes zero.

        Parameters
        ----------
        value : float
            In its SI unit.

        Returns
        -------
        float
            In the same unit, above zero.
        """
        return abs(value) if self.low > 0 or self.high < 0 else self.high - self.low

    def covers(self, value: float) -> bool:
        """Whether a value of the number is in the range.

        Parameters
        ----------
        value : float
            In its SI unit.

        Returns
        -------
        bool
            Whether it is, or at one of its ends.
        """
        return self.low <= value <= self.high

    def adopted(self, value: float, point: SectionPoint) -> SectionPoint:
        """A section point of a neighbouring problem on the map of this one.

        Parameters
        ----------
        value : float
            Of the number, in its SI unit.
        point : SectionPoint
            Of a problem of this family.

        Returns
        -------
        SectionPoint
            A point of the map at `value`.
        """
        return self.at(value).map.adopted(point)

    def beside(self, value: float, share: float = _STEP) -> tuple[float, ...]:
        """Values so near that differences between the motions are derivatives, the one to be preferred first.

        Parameters
        ----------
        value : float
            In its SI unit.
        share : float
            Their distance over the scale of the number.

        Returns
        -------
        tuple of float
            One or two, none of which leads out of the range: on the other side of a value a graze may lie.
        """
        step = share * self.scale(value)
        inward = ((value + step, value + step <= self.high), (value - step, value - step >= self.low))
        return tuple(other for other, allowed in inward if allowed)

    def linearised(self, value: float, point: SectionPoint, count: int) -> Return:
        """March over some half periods, with the derivatives by the point and, if the solver knows it, by the number.

        Parameters
        ----------
        value : float
            Of the number, in its SI unit.
        point : SectionPoint
            A point of the map there.
        count : int
            Number of half periods.

        Returns
        -------
        Return
            The end of the march and its derivatives, mirrored if `count` is odd.
        """
        self.marches += 1
        return self.at(value).linearised(point, count, self.path)

    def derivative(self, value: float, point: SectionPoint, count: int) -> FloatArray:
        """Derivative of a section point's image by the number, while the point stays where it is.

        Parameters
        ----------
        value : float
            Of the number, in its SI unit.
        point : SectionPoint
            A point of the map there.
        count : int
            Number of half periods; the end is mirrored if it is odd.

        Returns
        -------
        FloatArray, shape (n,)
            In the coordinates that belong to the point, over the unit of the number.  The solver gives it where it
            can; else it comes from a difference, to a side where there are as many switches.
        """
        here = self.at(value)
        known = self.linearised(value, point, count).by_number
        if known is not None:
            return known
        march = here.map.march(point, count)
        moved = here.map.difference(here.map.mirrored(march.end) if count % 2 else march.end, point)
        column = np.zeros(moved.size)
        for other in self.beside(value):
            beside = self.at(other).map
            there = beside.march(beside.adopted(point), count)
            end = here.map.adopted(beside.mirrored(there.end) if count % 2 else there.end)
            column = (here.map.difference(end, point) - moved) / (other - value)
            if there.switches == march.switches:
                break
        return column

    def column(self, value: float, found: Return) -> FloatArray:
        """`derivative` at the start of a march that was made, which may know it.

        Parameters
        ----------
        value : float
            Of the number, in its SI unit.
        found : Return
            The march.

        Returns
        -------
        FloatArray, shape (n,)
            As `derivative` gives it.
        """
        known = found.by_number
        return self.derivative(value, found.start, found.count) if known is None else known

    def _made(self, value: float) -> HalfPeriods:
        """The map at a value: where the first one of its zone knows it from itself, from that."""
        zone = self._zone_of(value)
        like = self._like.get(zone) if self.covers(value) else None  # else there may be no such problem
        made = None if like is None else like.retuned(self.path, value, lambda: self.problem_at(value))
        if made is None:
            made = HalfPeriods(self.zones[zone].solver.period_map(self.problem_at(value)))
            self._like.setdefault(zone, made)
        return made
