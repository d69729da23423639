"""The plan of a sweep: the grid, the solver, and the initial state of each motion.

A *cell* is one motion to be found: a point of the grid, and the number of its start.  Cells are numbered in C order,
with the start fastest.  The plan holds everything on which a cell's answer depends.  The answer depends neither on the
sequence of the work nor on the number of workers.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, Literal, get_args

import numpy as np

from lapjoint.campaigns.dataset import SWEEP
from lapjoint.campaigns.grid import MOST_POINTS, Grid
from lapjoint.campaigns.identity import check_integer, check_seed, problem_identity, versions
from lapjoint.campaigns.job import Spec
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.solver import Solver
from lapjoint.summaries.fatigue_of_orbit import OF_FATIGUE
from lapjoint.summaries.of_orbit import check_names

Start = Literal["rest", "up", "down", "random"]
"""How motions start: from the problem's own initial state; from the section point at which the motion before settled,
along the first axis, ascending or descending; from a random initial state."""
MOST_STARTS = 10_000
"""Largest number of starts at a point."""
MOST_STROBES = 10_000
"""Largest number of stroboscopic samples of a motion."""


@dataclass(frozen=True)
class Plan(Spec):
    """Everything that a sweep depends on; the fields are the arguments of `lapjoint.sweep`, with problem and axes as
    `grid`.

    InputError is raised if a value is not allowed.
    """

    noun: ClassVar[str] = SWEEP
    cells_noun: ClassVar[str] = "points"

    grid: Grid
    solver: str = "analytic"
    options: Mapping[str, Any] = field(default_factory=dict)
    start: Start = "rest"
    starts: int = 1
    seed: int = 0
    sensitivity: bool = False
    errors: bool = False
    summary: tuple[str, ...] = ()
    strobe: int = 0
    at: float | str | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "summary", check_names(self.summary))
        if any(name.startswith("stress_") for name in self.summary):
            self.grid.problem.line.require_sections("summary of the stress")
        for name in self.summary:
            if name in OF_FATIGUE and not self.grid.problem.line.has_fatigue:
                raise InputError(f"summary {name!r}: no material has an S-N line; give [beam.material.fatigue]")
        if self.start not in get_args(Start):
            raise InputError(f"start = {self.start!r}: allowed: {', '.join(get_args(Start))}")
        check_integer("starts", self.starts, 1, MOST_STARTS)
        check_seed(self.seed)
        self._check_strobe()
        if self.chained and not self.grid.axes:
            raise InputError(f"start = {self.start!r}: follows the motion along an axis, and there is none")
        if self.chained and self.starts > 1:
            raise InputError(f"starts = {self.starts}: must be 1 with start = {self.start!r}, which follows one motion")

    def _check_strobe(self) -> None:
        """Check the number of stroboscopic samples, and find their place."""
        check_integer("strobe", self.strobe, 0, MOST_STROBES)
        if not self.strobe:
            if self.at is not None:
                raise InputError(f"at = {self.at}: is the place of samples; give their number, strobe, too")
            return
        if self.size * self.strobe > MOST_POINTS:
            raise InputError(
                f"strobe = {self.strobe}: {self.size} points have {self.size * self.strobe} samples; at most "
                f"{MOST_POINTS} are allowed"
            )
        object.__setattr__(self, "at", _place_on(self.grid.problem, self.at))

    @property
    def chained(self) -> bool:
        """Whether each motion starts from the one before it."""
        return self.start in ("up", "down")

    @property
    def has_starts(self) -> bool:
        """Whether there is a dimension of starts."""
        return self.start == "random" or self.starts > 1

    @property
    def size(self) -> int:
        """Number of cells."""
        return self.grid.size * self.starts

    @property
    def shape(self) -> tuple[int, ...]:
        """Shape of the cells: the grid's, and the starts where there is a dimension of them."""
        return (*self.grid.shape, self.starts) if self.has_starts else self.grid.shape

    def chains(self) -> Iterator[tuple[int, ...]]:
        """The cells of each chain, in the sequence in which they are solved."""
        first = len(self.grid.shape) - len(self.grid.axes)
        sequence = np.argsort(self.grid.axes[0].values)
        sequence = sequence[::-1] if self.start == "down" else sequence
        cells = np.moveaxis(np.arange(self.grid.size).reshape(self.grid.shape), first, 0)[sequence]
        for chain in cells.reshape(sequence.size, -1).T:
            yield tuple(chain.tolist())

    def check(self) -> Solver:
        """Make the solver; InputError if it does not take its options, or a point has no valid problem."""
        solver = super().check()
        self.grid.check(self.at)
        return solver

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this sweep from any other, as values that JSON can hold; floats are written exactly."""
        return {
            **problem_identity(self.grid.problem),
            "axes": {axis.path: list(axis.values) for axis in self.grid.axes},
            **({} if self.grid.samples is None else {"samples": self.grid.samples.identity}),
            "solver": self.solver,
            "options": dict(self.options),
            "start": self.start,
            "starts": self.starts,
            "seed": self.seed,
            "sensitivity": self.sensitivity,
            "errors": self.errors,
            **({"summary": list(self.summary)} if self.summary else {}),  # as before where there is none
            **({"strobe": self.strobe, "at": self.at} if self.strobe else {}),
            "versions": versions(),
        }


def _place_on(problem: Problem, at: float | str | None) -> float | str:
    """The place `at`, m, or a beam and a position; by default that of the stop farthest from the root, or the tip.

    InputError is raised if the problem has no such place.
    """
    x = problem.one_position(at)
    return problem.line.exact_place(x) if at is None else at
