"""What is asked of a search for branches: the problem, the number that changes, the solver, and the starts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np

from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.campaigns.identity import check_integer, digest_of, problem_identity, versions
from lapjoint.campaigns.sweep.spec import MOST_STARTS
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solver import Solver, make_solver

if TYPE_CHECKING:
    from lapjoint.orbits.branches.resolution import ParameterRange

MAX_POINTS = 5000
"""Default of the largest number of points of a branch: twice what the paper's joint needs from 1 to 5000 rad/s."""
MOST_POINTS = 1_000_000
"""Largest number of points of a branch that may be asked for."""
EFFORT = 100_000
"""Default of the number of points of all branches together, each counted by its period multiple, from which on no
further branch is followed: a quarter to half an hour of work in one process.  The paper's joint with a damping ratio of
0.02 needs some 60 000 from 100 rad/s on, with four periods."""
MOST_MULTIPLE = 64
"""Largest period multiple of branches."""
_PARTS = 3
"""Number of the form in which a journal keeps the parts of the work: another one is not gone on with."""
_KEPT = 8
"""Number of searches whose period maps are kept: values of a second number are searched at the same time."""


@dataclass(frozen=True)
class BranchSpec:
    """Everything that branches depend on.

    Parameters
    ----------
    problem : Problem
        The problem that has all that the number does not change.
    path : str
        Path of the number, as `lapjoint.Axis` takes it.
    first, last : float
        The range of the number, in its SI unit, in either direction.
    solver : str
        Entry-point name of the solver.
    options : mapping
        Numerical options of the solver.
    max_period_multiple : int
        Largest period multiple of branches.
    starts : int
        Number of random starts; the problem's own initial state and the motion without contact at both ends of the
        range are always among them.
    seed : int
        Seed of the random starts.
    errors : bool
        Whether to estimate the errors of the bifurcations.
    max_points : int
        Largest number of points of a branch.
    effort : int
        Number of points of all branches together, each counted by its period multiple, from which on no further branch
        is followed; with a second number, at each of its values.
    also_over : Axis, optional
        A second number, and the values for which all this is done; without it, all is done once.
    from_grazes : bool
        Whether motions are looked for beside each graze that have its contact every second period alone.

    Raises
    ------
    InputError
        If a parameter is not allowed.
    """

    noun: ClassVar[str] = "search for branches"
    """What it is called in messages."""
    cells_noun: ClassVar[str] = "parts"
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
        check_integer("seed", self.seed, 0, 2**63 - 1)
        for name, value in (("from", self.first), ("to", self.last)):
            if isinstance(value, bool) or not isinstance(value, int | float) or not np.isfinite(value):
                raise InputError(f"{name} = {value!r}: must be a finite number")
        if self.first == self.last:
            raise InputError(f"to = {self.last:g}: must differ from {self.first:g}, where the range begins")
        if self.also_over is not None and self.also_over.path == self.axis.path:
            raise InputError(
                f"also_over = {self.also_over.path}: is the number that changes along the branches already"
            )

    @cached_property
    def axis(self) -> Axis:
        """The number, and the ends of its range, ascending."""
        return Axis(self.path, tuple(sorted((float(self.first), float(self.last)))))

    @cached_property
    def grid(self) -> Grid:
        """The problems at the ends of the range, and between them."""
        return Grid(self.problem, (self.axis,))

    @property
    def values(self) -> int:
        """Number of values of the second number; 1 without it."""
        return 1 if self.also_over is None else len(self.also_over.values)

    def at(self, value: int) -> BranchSpec:
        """What is asked at one value of the second number.

        Parameters
        ----------
        value : int
            Number of the value.

        Returns
        -------
        BranchSpec
            Of the problem with that value; this one where there is no second number.

        Raises
        ------
        InputError
            If there is no such problem; the message names the value.
        """
        if self.also_over is None:
            return self
        return replace(self, problem=Grid(self.problem, (self.also_over,)).problem_at(value), also_over=None)

    @property
    def size(self) -> int:
        """Number of starts, those from the ends of the range included."""
        return self.starts + 2

    def problem_at(self, value: float) -> Problem:
        """The problem with a value of the number.

        Parameters
        ----------
        value : float
            In its SI unit.

        Returns
        -------
        Problem
            The problem.
        """
        return self.grid.with_values((value,))

    def value_of(self, start: int) -> float:
        """The value of the number at a start: the ends of the range first, then random ones, evenly spread.

        Parameters
        ----------
        start : int
            Number of the start.

        Returns
        -------
        float
            In the SI unit of the number.
        """
        if start < 2:
            return float((self.first, self.last)[start])
        low, high = self.axis.values
        return float(np.random.default_rng((self.seed, start)).uniform(low, high))

    def check(self) -> Solver:
        """Check everything that can be checked before any work, and make the solver.

        Returns
        -------
        Solver
            The solver, with its options.

        Raises
        ------
        InputError
            If the solver does not take its options, or there is no valid problem at an end of the range.
        """
        solver = make_solver(self.solver, **self.options)
        axes = (self.axis,) if self.also_over is None else (self.also_over, self.axis)
        Grid(self.problem, axes).check()
        return solver

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

    @cached_property
    def fingerprint(self) -> str:
        """A digest of the identity, in hexadecimal digits."""
        return digest_of(self.identity, self.options)


class _Key:
    """A search as a key: two with the same fingerprint are one."""

    def __init__(self, spec: BranchSpec) -> None:
        self.spec = spec

    def __hash__(self) -> int:
        return hash(self.spec.fingerprint)

    def __eq__(self, other: object) -> bool:
        return isinstance(other, _Key) and other.spec.fingerprint == self.spec.fingerprint


def range_of(spec: BranchSpec) -> ParameterRange:
    """The range of the parameter with its period maps.

    Parameters
    ----------
    spec : BranchSpec
        What is asked, at one value of a second number.

    Returns
    -------
    ParameterRange
        Made once in each process.

    Raises
    ------
    InputError
        If the solver has no arcs, or there is no valid problem at an end of the range.
    """
    return _range(_Key(spec))


@lru_cache(maxsize=_KEPT)
def _range(key: _Key) -> ParameterRange:
    from lapjoint.orbits.branches.resolution import ParameterRange

    spec = key.spec
    low, high = spec.axis.values
    return ParameterRange(spec.check(), spec.problem_at, spec.path, low, high)
