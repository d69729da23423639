"""The plan of basins: which starts, of which problems, and the largest effort for each.

Starts are the points of a grid in a plane, or random points (`lapjoint.orbits.displaced`).  They are solved in
*chunks*, so that many march at once.  Each problem begins with a chunk of *scouts*: some of the starts, evenly spread.
The motions in which scouts end are the *library* of the problem, which every other chunk knows from the beginning.  The
result of a chunk depends only on the plan and on this library, and neither on the sequence of the work nor on the
number of workers.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar, NamedTuple

import numpy as np

from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.campaigns.identity import check_integer, check_seed, problem_identity, versions
from lapjoint.campaigns.job import Spec
from lapjoint.errors import InputError
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.plane import Plane
from lapjoint.solver import Solver

CHUNK = 64
"""Number of starts in a chunk: enough for a compiled call to pay, few enough for an interrupt to lose little."""
SCOUTS = 16
"""Largest number of starts of a problem that are scouts."""
MOST_STARTS = 10_000_000
"""Largest number of starts of all problems together, for the dataset to fit into memory."""
EFFORT = 4000
"""Default of the largest number of excitation periods marched from a start."""
MOST_PERIODS = 1_000_000
"""Largest number of excitation periods that may be asked for."""
_WIDE = 3.0
"""Half the default width of a plane, divided by base amplitude plus gap: most motions are not much larger."""


class Chunk(NamedTuple):
    """The content of a cell: some starts of one of the problems."""

    value: int
    """Number of the problem along `over`."""
    starts: tuple[int, ...] | range
    """Numbers of the starts."""


@dataclass(frozen=True)
class BasinPlan(Spec):
    """Everything that basins depend on; the fields are the arguments of `lapjoint.basins`, with `shape` for its `grid`.

    InputError is raised if a value is not allowed.
    """

    noun: ClassVar[str] = "search for basins"
    cells_noun: ClassVar[str] = "chunks of starts"

    problem: Problem
    solver: str = "analytic"
    options: Mapping[str, Any] = field(default_factory=dict)
    plane: Plane | None = None
    shape: tuple[int, int] = (40, 40)
    ranges: tuple[tuple[float, float], tuple[float, float]] | None = None
    energy: float | None = None
    starts: int = 1000
    seed: int = 0
    effort: int = EFFORT
    over: Axis | None = None

    def __post_init__(self) -> None:
        if (self.plane is None) == (self.energy is None):
            raise InputError("basins: give a plane of starts, or the energy of random ones, and not both")
        for number in self.shape:
            check_integer("grid", number, 1, MOST_STARTS)
        check_integer("starts", self.starts, 1, MOST_STARTS)
        check_seed(self.seed)
        check_integer("effort", self.effort, 1, MOST_PERIODS)
        if self.energy is not None and not 0 < self.energy < math.inf:
            raise InputError(f"energy = {self.energy!r}: must be positive and finite, in J")
        for low, high in self.ranges or ():
            if not (math.isfinite(low) and math.isfinite(high) and low < high):
                raise InputError(f"range = {low:g}:{high:g}: must have finite ends, the lower one first")
        if self.count * self.values > MOST_STARTS:
            raise InputError(f"basins: {self.count * self.values} starts; at most {MOST_STARTS} are allowed")

    @property
    def values(self) -> int:
        """Number of problems: values of `over`, or 1."""
        return 1 if self.over is None else len(self.over.values)

    @property
    def count(self) -> int:
        """Number of starts of each problem."""
        return self.starts if self.plane is None else self.shape[0] * self.shape[1]

    @property
    def chunks(self) -> int:
        """Number of chunks of each problem, without the chunk of scouts."""
        return -(-self.count // CHUNK)

    @property
    def size(self) -> int:
        """Number of cells: first the scouts of each problem, then the other chunks, problem after problem."""
        return self.values * (1 + self.chunks)

    @cached_property
    def grid(self) -> Grid | None:
        """The problems along `over`, if there are several."""
        return None if self.over is None else Grid(self.problem, (self.over,))

    def problem_at(self, value: int) -> Problem:
        """One of the problems, by its number along `over`; InputError, which names the value, if it is not valid."""
        return self.problem if self.grid is None else self.grid.problem_at(value)

    def _default_ranges(self, plane: Plane) -> tuple[tuple[float, float], tuple[float, float]]:
        """Ranges of the plane's coordinates: from minus to plus `_WIDE` times base amplitude plus gap, m, and this
        times the frequency, m/s."""
        problem = self.problem
        gaps = [abs(stop.gap) for stop in problem.stops if stop.gap]
        base = problem.base_motion
        size = (float(np.median(gaps)) if gaps else 1e-3 * problem.line.beams[0].length) + float(
            getattr(base, "amplitude", 0.0)
        )
        omega = problem.require_excitation_frequency("basins")
        first, second = (_WIDE * size * (omega if one.kind == "v" else 1.0) for one in plane.coordinates)
        return (-first, first), (-second, second)

    @cached_property
    def axes(self) -> tuple[FloatArray, FloatArray]:
        """Values of the plane's coordinates, m or m/s, each of shape ``(n,)``; one value is the middle of its range."""
        assert self.plane is not None
        ranges = self.ranges or self._default_ranges(self.plane)
        first, second = (
            np.linspace(low, high, n) if n > 1 else np.array([(low + high) / 2])
            for (low, high), n in zip(ranges, self.shape, strict=True)
        )
        return first, second

    def chunk(self, cell: int) -> Chunk:
        """The content of a cell, by its number."""
        if cell < self.values:
            return Chunk(cell, self._scouts)
        value, chunk = divmod(cell - self.values, self.chunks)
        return Chunk(value, range(chunk * CHUNK, min((chunk + 1) * CHUNK, self.count)))

    @cached_property
    def _scouts(self) -> tuple[int, ...]:
        """The numbers of the scouts of each problem."""
        if self.plane is None or min(self.shape) < 2:
            return tuple(np.unique(np.linspace(0, self.count - 1, min(SCOUTS, self.count)).astype(int)).tolist())
        side = math.isqrt(SCOUTS)
        rows, columns = (np.unique(np.linspace(0, n - 1, min(side, n)).astype(int)) for n in self.shape)
        return tuple((rows[:, None] * self.shape[1] + columns).ravel().tolist())

    def check(self) -> Solver:
        """Make the solver; InputError if it does not take its options, or there is no valid problem or plane."""
        solver = super().check()
        if self.grid is not None:
            self.grid.check()
        if self.plane is not None:
            self.plane.check(self.problem)
        return solver

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes these basins from any other, as values that JSON can hold."""
        return {
            **problem_identity(self.problem),
            "solver": self.solver,
            "options": dict(self.options),
            "plane": None if self.plane is None else str(self.plane),
            "grid": None if self.plane is None else [axis.tolist() for axis in self.axes],
            "energy": self.energy,
            "starts": self.count,
            "seed": self.seed if self.plane is None else None,
            "effort": self.effort,
            "over": None if self.over is None else {self.over.path: list(self.over.values)},
            "versions": versions(),
        }
