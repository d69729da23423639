"""One solver at one resolution over a range of a parameter, and a range cut into zones of one resolution each."""

from __future__ import annotations

import math
from collections import OrderedDict
from collections.abc import Callable, Iterable, Iterator
from itertools import pairwise
from typing import Any, Protocol, cast, runtime_checkable

import numpy as np

from lapjoint.errors import InputError
from lapjoint.orbits.arcs import Arcs, HasArcs
from lapjoint.orbits.branches.options import ContinuationOptions
from lapjoint.orbits.half_periods import gives
from lapjoint.orbits.parameters import Retunes
from lapjoint.orbits.period_map import PeriodMap
from lapjoint.orbits.refinement import Refinement
from lapjoint.parts import require
from lapjoint.problem import Problem
from lapjoint.problem.excitation import begun_later
from lapjoint.problem.symmetry import mirror_twins

_KEPT = 32
"""Number of cached period maps: Newton's method and difference quotients return to a few values of the parameter."""
_LOOKED_AT = 9
"""Number of problems, evenly spread over a zone, of which the most demanding one determines the resolution."""
_ZONE = 8.0
"""Approximate ratio of the ends of a zone.  At a change of resolution the curve jumps by its numerical error, so zones
are few."""


@runtime_checkable
class HasPeriodMap(Protocol):
    """A solver with a period map."""

    @property
    def name(self) -> str:
        """Name and options in a line."""

    def period_map(self, problem: Problem) -> PeriodMap:
        """The motion of a problem from section point to section point; `InputError` if its excitation has no period."""


@runtime_checkable
class Resolves(Protocol):
    """A solver that chooses its resolution for each problem, and can use one resolution for several problems."""

    def resolving(self, problems: Iterable[Problem]) -> HasPeriodMap:
        """The solver with a fixed resolution, which the most demanding of some problems needs."""


@runtime_checkable
class Refines(Protocol):
    """A solver that gives a finer solver, by which its errors are estimated."""

    def finer(self, problem: Problem) -> tuple[Refinement, HasPeriodMap] | None:
        """The order and bound of the refinement, and a finer solver; None if there is none."""


class Resolution:
    """One solver at one resolution, for a problem of which one parameter varies.

    Parameters
    ----------
    solver : HasPeriodMap
        The solver; its resolution does not depend on the problem.
    problem_at : callable
        Takes a value of the parameter, and returns the problem with that value.
    path : str
        Path of the parameter, as `lapjoint.Axis` takes it.
    low, high : float
        The range of the parameter, in its SI unit.
    options : ContinuationOptions
        The numerical options.
    """

    def __init__(
        self,
        solver: HasPeriodMap,
        problem_at: Callable[[float], Problem],
        path: str,
        low: float,
        high: float,
        options: ContinuationOptions,
    ) -> None:
        self.solver, self.problem_at, self.path = solver, problem_at, path
        self.low, self.high, self.options = low, high, options
        self._maps: OrderedDict[float, PeriodMap] = OrderedDict()
        self._first: PeriodMap | None = None
        self._finer: tuple[Refinement, Resolution] | None = None

    def map(self, value: float) -> PeriodMap:
        """The period map at a value of the parameter, in its SI unit; `InputError` if there is no such problem."""
        if value in self._maps:
            self._maps.move_to_end(value)
            return self._maps[value]
        made = None
        if self._first is not None and gives(self._first, Retunes) and self.low <= value <= self.high:
            made = cast(Retunes, self._first).retuned(self.path, value, lambda: self.problem_at(value))
        if made is None:
            made = self.solver.period_map(self.problem_at(value))
            self._first = self._first or made
        self._maps[value] = made
        if len(self._maps) > _KEPT:
            self._maps.popitem(last=False)
        return made

    def map_from(self, value: float, phase: float, **changes: Any) -> PeriodMap:
        """The period map at a value of the parameter, in its SI unit, of the problem with `changes`, for sections at a
        `phase`, a fraction of the excitation period: its excitation counts time from there."""
        problem = self.problem_at(value)
        time = phase * problem.require_excitation_period("branch")
        loads = tuple(begun_later(load, time) for load in problem.point_loads)
        moved = problem.with_excitation(base_motion=begun_later(problem.base_motion, time), point_loads=loads)
        return self.solver.period_map(moved.replace(**changes) if changes else moved)

    def arcs(self, value: float) -> Arcs:
        """The arcs at a value of the parameter, in its SI unit; `InputError` if there is no such problem."""
        return cast(HasArcs, self.map(value)).arcs

    def scale(self, value: float) -> float:
        """Size of the parameter, or of the whole range if the range includes zero; above zero.  Changes of the
        parameter are divided by this size."""
        return abs(value) if self.low > 0 or self.high < 0 else self.high - self.low

    def difference_step(self, value: float) -> float:
        """Step of a difference quotient by the parameter, in its unit, with the sign that stays within the range."""
        step = self.options.difference_step * self.scale(value)
        return step if value + step <= self.high else -step

    @property
    def finer(self) -> tuple[Refinement, Resolution] | None:
        """The order and bound of the refinement, and the next finer resolution; None if the solver has no finer one."""
        if self._finer is None and isinstance(self.solver, Refines):
            found = self.solver.finer(self.problem_at(self.high))
            if found is not None:
                finer = Resolution(found[1], self.problem_at, self.path, self.low, self.high, self.options)
                self._finer = found[0], finer
        return self._finer

    def and_finer(self) -> Iterator[Resolution]:
        """This resolution, then ever finer resolutions, each made when it is needed."""
        here = self
        yield here
        while here.finer is not None:
            here = here.finer[1]
            yield here


class ParameterRange:
    """A range of a parameter, cut into zones of one resolution each.

    Parameters
    ----------
    solver : HasPeriodMap
        The solver.
    problem_at : callable
        Takes a value of the parameter, and returns the problem with that value.
    path : str
        Path of the parameter, as `lapjoint.Axis` takes it.
    low, high : float
        The range, in the SI unit of the parameter; `low` < `high`.
    options : ContinuationOptions, optional
        The numerical options.

    Raises
    ------
    InputError
        If the solver has no period map or no arcs, or there is no valid problem at an end of the range.
    """

    def __init__(
        self,
        solver: object,
        problem_at: Callable[[float], Problem],
        path: str,
        low: float,
        high: float,
        options: ContinuationOptions | None = None,
    ) -> None:
        owner = f"solver = {getattr(solver, 'name', solver)}"
        require(solver, HasPeriodMap, owner, "branches")
        solver = cast(HasPeriodMap, solver)
        if not (np.isfinite([low, high]).all() and low < high):
            raise InputError(f"{path}: from {low:g} to {high:g} is no range; both must be finite, and ascend")
        for protocol in (PeriodMap, HasArcs):
            require(solver.period_map(problem_at(low)), protocol, f"the period map of {owner}", "branches")
        self.path, self.low, self.high, self.options = path, float(low), float(high), options or ContinuationOptions()
        self.zones = [
            (end, Resolution(own, problem_at, path, self.low, self.high, self.options))
            for end, own in zones_of(solver, problem_at, self.low, self.high)
        ]
        """The upper end of each zone, ascending, and the resolution there, which may be used over the whole range."""
        ends = (problem_at(self.low), problem_at(self.high))
        self.least = 1 if all(mirror_twins(problem) is not None for problem in ends) else 2
        """Half periods of the shortest motions: 1 if the problems at both ends are their own mirror images, else 2."""

    def resolution(self, value: float) -> Resolution:
        """The resolution of the zone that contains a value of the parameter, or of the nearest zone."""
        return next((one for end, one in self.zones if value <= end), self.zones[-1][1])


def zones_of(
    solver: HasPeriodMap, problem_at: Callable[[float], Problem], low: float, high: float
) -> list[tuple[float, HasPeriodMap]]:
    """A range of a parameter, cut into zones: the upper end of each, ascending, and the solver with the resolution of
    the zone.

    Neighbouring zones with one resolution are merged.
    """
    if not isinstance(solver, Resolves):
        return [(high, solver)]
    count = max(1, round(math.log(high / low, _ZONE))) if low > 0 else 1
    edges = [low, *(np.geomspace(low, high, count + 1)[1:-1].tolist() if count > 1 else []), high]
    found = list[tuple[float, HasPeriodMap]]()
    for first, last in pairwise(edges):
        own = solver.resolving([problem_at(float(value)) for value in np.linspace(first, last, _LOOKED_AT)])
        if found and found[-1][1] == own:
            own = found.pop()[1]
        found.append((last, own))
    return found
