"""The plan of a sweep: the grid, the solver, and the initial state of each motion.

A *cell* is one motion to be found: a point of the grid, and the number of its start.  Cells are numbered in C order,
with the start fastest.  The plan holds everything that a cell's answer depends on; the answer depends neither on the
sequence of the work nor on the number of workers.
"""

from __future__ import annotations

import json
import platform
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from hashlib import sha256
from importlib.metadata import PackageNotFoundError, version
from itertools import product
from typing import TYPE_CHECKING, Any, ClassVar, Literal, get_args

import numpy as np

from lapjoint.campaigns.grid import Grid
from lapjoint.campaigns.point import Point, plain_section, point_of, section_from
from lapjoint.campaigns.random_start import random_initial
from lapjoint.errors import InputError, SolverError
from lapjoint.problem import Problem
from lapjoint.problem.files import to_toml
from lapjoint.solver import Progress, Solver, make_solver
from lapjoint.summaries.of_orbit import check_names

if TYPE_CHECKING:
    import xarray as xr

Start = Literal["rest", "up", "down", "random"]
"""How motions start; `Plan` says what the words mean."""
MOST_STARTS = 10_000
"""Largest number of starts at a point."""
PACKAGES = ("lapjoint", "numpy", "scipy", "numba")
"""Packages whose versions tell one sweep from another, because answers are computed with them."""


@dataclass(frozen=True)
class Plan:
    """Everything that the answers of a sweep depend on.

    Parameters
    ----------
    grid : Grid
        The problem and the axes.
    solver : str
        Entry-point name of the solver.
    options : mapping
        Numerical options of the solver.
    start : {"rest", "up", "down", "random"}
        "rest": every motion starts from the problem's own initial state.  "up", "down": each motion starts from the
        section point at which the one before it has settled, along the first axis, ascending or descending.
        "random": every motion starts from a random initial state.
    starts : int
        Number of starts at each point; with "rest", the starts after the first are random.
    seed : int
        Seed of the random initial states.
    sensitivity : bool
        Whether to measure how much deviations grew on the way to each motion; it takes about as long again.
    errors : bool
        Whether to estimate the numerical errors of the impulses; it takes less than as long again.
    summary : tuple of str
        Further numbers of each motion, of `lapjoint.summaries.of_orbit.SUMMARIES`.

    Raises
    ------
    InputError
        If a parameter is not allowed.
    """

    noun: ClassVar[str] = "sweep"
    cells_noun: ClassVar[str] = "points"
    longest_batch: ClassVar[int] = 32
    """Largest number of independent cells in a batch, so that the last batches end at about the same time."""

    grid: Grid
    solver: str = "analytic"
    options: Mapping[str, Any] = field(default_factory=dict)
    start: Start = "rest"
    starts: int = 1
    seed: int = 0
    sensitivity: bool = False
    errors: bool = False
    summary: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "summary", check_names(self.summary))
        if any(name.startswith("stress_") for name in self.summary):
            self.grid.problem.beam.require_section("summary of the stress")
        if self.start not in get_args(Start):
            raise InputError(f"start = {self.start!r}: allowed: {', '.join(get_args(Start))}")
        check_integer("starts", self.starts, 1, MOST_STARTS)
        check_integer("seed", self.seed, 0, 2**63 - 1)
        if self.chained and self.starts > 1:
            raise InputError(f"starts = {self.starts}: must be 1 with start = {self.start!r}, which follows one motion")

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

    def problem_at(self, cell: int, solver: Solver) -> Problem:
        """The problem of a cell, with its initial state.

        Parameters
        ----------
        cell : int
            Number of the cell.
        solver : Solver
            Gives the modes that random initial states are made of.

        Returns
        -------
        Problem
            The problem.

        Raises
        ------
        InputError
            If there is no valid problem at this point of the grid; the message names the point.
        """
        point, number = divmod(cell, self.starts)
        problem = self.grid.problem_at(point)
        if self.start != "random" and number == 0:
            return problem
        return problem.replace(initial=random_initial(problem, solver, (self.seed, point, number)))

    def describe(self, cell: int) -> str:
        """A text for messages that names a cell: its point, and its start if there are several.

        Parameters
        ----------
        cell : int
            Number of the cell.

        Returns
        -------
        str
            The text.
        """
        point, number = divmod(cell, self.starts)
        return self.grid.describe(point) + (f", start {number}" if self.has_starts else "")

    def chains(self) -> Iterator[tuple[int, ...]]:
        """The cells of each chain, in the sequence in which they are solved."""
        first, *others = self.grid.axes
        sequence = np.argsort(first.values)
        sequence = sequence[::-1] if self.start == "down" else sequence
        for rest in product(*(range(len(axis.values)) for axis in others)):
            yield tuple(int(np.ravel_multi_index((int(i), *rest), self.grid.shape)) for i in sequence)

    def check(self) -> Solver:
        """Check everything that can be checked before any work, and make the solver.

        Returns
        -------
        Solver
            The solver, with its options.

        Raises
        ------
        InputError
            If the solver does not take its options, or a point has no valid problem.
        """
        solver = make_solver(self.solver, **self.options)
        self.grid.check()
        return solver

    def answer(
        self, cell: int, solver: Solver, section: dict[str, Any] | None, progress: Progress | None = None
    ) -> tuple[Point, dict[str, Any] | None]:
        """What was found for a cell, and where the next one starts: at the cell's own start where the solver gave up.

        See `lapjoint.campaigns.campaign.Campaign.answer`.
        """
        try:
            problem = self.problem_at(cell, solver)
            start = None if section is None else section_from(section)
            found = solver.steady_state(problem, start=start, sensitivity=self.sensitivity, errors=self.errors)
        except SolverError as error:
            return Point(message=str(error)), section
        except InputError as error:
            message = str(error)
            where = self.describe(cell)
            raise InputError(message if message.startswith(where) else f"{where}: {message}") from None
        return point_of(found, self.summary), plain_section(found.section_point) if self.chained else None

    def point(self, fields: Mapping[str, Any]) -> Point:
        """A point from its attributes. See `lapjoint.campaigns.campaign.Campaign.point`."""
        return Point(**fields)

    def dataset(self, points: Mapping[int, Point]) -> xr.Dataset:
        """The dataset of the sweep. See `lapjoint.campaigns.campaign.Campaign.dataset`."""
        from lapjoint.campaigns.dataset import dataset_of

        return dataset_of(self, points)

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes this sweep from any other, as values that JSON can hold; floats are written exactly."""
        return {
            **problem_identity(self.grid.problem),
            "axes": {axis.path: list(axis.values) for axis in self.grid.axes},
            "solver": self.solver,
            "options": dict(self.options),
            "start": self.start,
            "starts": self.starts,
            "seed": self.seed,
            "sensitivity": self.sensitivity,
            "errors": self.errors,
            **({"summary": list(self.summary)} if self.summary else {}),  # as before where there is none
            "versions": versions(),
        }

    @cached_property
    def fingerprint(self) -> str:
        """A digest of the identity, in hexadecimal digits."""
        return digest_of(self.identity, self.options)


def problem_identity(problem: Problem) -> dict[str, str]:
    """What distinguishes a problem from any other: its text, and digests of its records, which are not in it.

    Parameters
    ----------
    problem : Problem
        The problem.

    Returns
    -------
    dict of str
        Part of the identity of work on it.
    """
    samples = {f"samples of {path}": record.digest for path, record in problem.records.items()}
    return {"problem": to_toml(problem, samples=False), **samples}


def digest_of(identity: Mapping[str, Any], options: Mapping[str, Any]) -> str:
    """A digest of what distinguishes work from any other.

    Parameters
    ----------
    identity : mapping of str to Any
        It, as values that JSON can hold.
    options : mapping of str to Any
        The part of it that a user gives as it is: the numerical options of the solver.

    Returns
    -------
    str
        Hexadecimal digits.

    Raises
    ------
    InputError
        If JSON cannot hold the options.
    """
    try:
        text = json.dumps(identity)
    except TypeError as error:
        raise InputError(f"options = {dict(options)!r}: cannot be written to a file: {error}") from None
    return sha256(text.encode()).hexdigest()


def versions() -> dict[str, str]:
    """Versions of Python and of the `PACKAGES`, by name."""

    def installed(name: str) -> str:
        try:
            return version(name)
        except PackageNotFoundError:
            return "unknown"

    return {name: installed(name) for name in PACKAGES} | {"python": platform.python_version()}


def check_integer(name: str, value: object, low: int, high: int) -> None:
    """Refuse what is no integer within a range.

    Parameters
    ----------
    name : str
        What it is, for the message.
    value : object
        What was given.
    low, high : int
        The least that is allowed, and the most.

    Raises
    ------
    InputError
        If it is not allowed.
    """
    if isinstance(value, bool) or not isinstance(value, int) or not low <= value <= high:
        raise InputError(f"{name} = {value!r}: must be an integer from {low} to {high}")
