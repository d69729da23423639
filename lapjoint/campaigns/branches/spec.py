"""The question of a search for branches: the problem, the parameter that changes, the solver, and the starts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lapjoint.campaigns.grid import Axis, Grid, in_radians
from lapjoint.campaigns.identity import check_integer, check_seed, problem_identity, versions
from lapjoint.campaigns.job import Spec
from lapjoint.campaigns.sweep.spec import MOST_STARTS
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solver import Solver

if TYPE_CHECKING:
    from lapjoint.orbits.branches.resolution import ParameterRange

MAX_POINTS = 5000
"""Default of the largest number of points of a branch: twice as many as the paper's joint needs from 1 to 5000
rad/s."""
MOST_POINTS = 1_000_000
"""Largest number of points of a branch that may be asked for."""
EFFORT = 100_000
"""Default of the number of points of all branches together, each counted by its period multiple, after which no further
branch is followed: a quarter to half an hour of work in one process.  The paper's joint with a damping ratio of 0.02
needs some 60 000 points from 100 rad/s on, with four periods."""
MOST_MULTIPLE = 64
"""Largest period multiple of branches."""
_PARTS = 3
"""Number of the form in which a journal keeps parts; a journal of another form is not resumed."""
_KEPT = 8
"""Number of searches whose period maps are cached: several values of a second parameter are searched simultaneously."""


@dataclass(frozen=True)
class BranchSpec(Spec):
    """The question of a search: everything on which its branches depend.  The fields are the arguments of
    `lapjoint.branch`.

    `first` and `last` are the ends of the range; those of a ``frequency``, Hz, are kept as angular frequencies, rad/s.
    The starts at the ends are always included: at each, the motion from the initial state, and the motion without
    contact.  `effort` is the limit at each value of the second parameter, `also_over`.  `InputError` is raised if a
    value is not allowed.
    """

    noun: ClassVar[str] = "search for branches"
    grows: ClassVar[bool] = True
    problem: Problem
    path: str
    first: float
    last: float
    solver: str = "analytic"
    options: Mapping[str, Any] = field(default_factory=dict)
    max_period_multiple: int = 1
    starts: int = 0
    seed: int = 0
    errors: bool = True
    max_points: int = MAX_POINTS
    effort: int = EFFORT
    also_over: Axis | None = None
    from_grazes: bool = False

    def __post_init__(self) -> None:
        check_integer("max_period_multiple", self.max_period_multiple, 1, MOST_MULTIPLE)
        check_integer("starts", self.starts, 0, MOST_STARTS)
        check_integer("max_points", self.max_points, 2, MOST_POINTS)
        check_integer("effort", self.effort, 1, MOST_POINTS)
        check_seed(self.seed)
        path, radians = in_radians(self.path)
        for name, value in (("from", self.first), ("to", self.last)):
            if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
                raise InputError(f"{name} = {value!r}: must be a finite number")
        kept = {"path": path, "first": self.first * radians, "last": self.last * radians}
        for key, own in kept.items():
            object.__setattr__(self, key, own)
        if self.first == self.last:
            raise InputError(f"to = {self.last:g}: must differ from {self.first:g}, where the range begins")
        if self.also_over is not None and self.also_over.path == self.axis.path:
            raise InputError(
                f"also_over = {self.also_over.path}: is the number that changes along the branches already"
            )

    @cached_property
    def axis(self) -> Axis:
        """The parameter, and the ends of its range, ascending."""
        return Axis(self.path, tuple(sorted((float(self.first), float(self.last)))))

    @cached_property
    def grid(self) -> Grid:
        """The problems at the ends of the range, and between them."""
        return Grid(self.problem, (self.axis,))

    @property
    def values(self) -> int:
        """Number of values of the second parameter; 1 without one."""
        return 1 if self.also_over is None else len(self.also_over.values)

    def at(self, value: int) -> BranchSpec:
        """The question at one value of the second parameter, by its number; `InputError` if there is no such
        problem."""
        if self.also_over is None:
            return self
        return replace(self, problem=Grid(self.problem, (self.also_over,)).problem_at(value), also_over=None)

    @property
    def size(self) -> int:
        """Number of starts, those at the ends of the range included."""
        return self.starts + 2

    def problem_at(self, value: float) -> Problem:
        """The problem with a value of the parameter, in its SI unit."""
        return self.grid.with_values((value,))

    def value_of(self, start: int) -> float:
        """The parameter at a start, in its SI unit: first the ends of the range, then random values, evenly spread."""
        if start < 2:
            return float((self.first, self.last)[start])
        low, high = self.axis.values
        return float(np.random.default_rng((self.seed, start)).uniform(low, high))

    def check(self) -> Solver:
        """Check everything that can be checked before any work, and make the solver with its options; `InputError` if
        not."""
        solver = super().check()
        axes = (self.axis,) if self.also_over is None else (self.also_over, self.axis)
        Grid(self.problem, axes).check()
        return solver

    def kept(self, count: int) -> str:
        """A number of parts that are done as the subject of a sentence, with its verb."""
        return f"{count} {'part of the work is' if count == 1 else 'parts of the work are'}"

    @property
    def nothing_kept(self) -> str:
        """A sentence for a journal without parts."""
        return "nothing was done"

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this from any other search, as values that JSON can hold; floats are written exactly."""
        return {
            "content": "branches",
            "parts": _PARTS,
            **problem_identity(self.problem),
            "path": self.axis.path,
            "range": [float(self.first), float(self.last)],
            "solver": self.solver,
            "options": dict(self.options),
            "max_period_multiple": self.max_period_multiple,
            "starts": self.starts,
            "seed": self.seed,
            "errors": self.errors,
            "max_points": self.max_points,
            "effort": self.effort,
            "also_over": None if self.also_over is None else {self.also_over.path: list(self.also_over.values)},
            **({"from_grazes": True} if self.from_grazes else {}),
            "versions": versions(),
        }


class _Key:
    """A search as the key of a cache: two searches with one fingerprint are equal."""

    def __init__(self, spec: BranchSpec) -> None:
        self.spec = spec

    def __hash__(self) -> int:
        return hash(self.spec.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and other.spec.fingerprint == self.spec.fingerprint


def range_of(spec: BranchSpec) -> ParameterRange:
    """The range of the parameter, at one value of a second parameter, with its period maps; made once in each process.

    `InputError` is raised if the solver has no arcs, or there is no valid problem at an end of the range.
    """
    return _range(_Key(spec))


@lru_cache(maxsize=_KEPT)
def _range(key: _Key) -> ParameterRange:
    from lapjoint.orbits.branches.resolution import ParameterRange

    spec = key.spec
    low, high = spec.axis.values
    return ParameterRange(spec.check(), spec.problem_at, spec.path, low, high)
