"""The grid of a sweep: its axes, and the problem at each of its points.

The points are numbered in C order: the last axis is the fastest.
"""

from __future__ import annotations

import math
import re
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import suppress
from dataclasses import dataclass
from functools import cached_property, lru_cache
from itertools import product
from typing import Any

import numpy as np

from lapjoint.errors import InputError
from lapjoint.problem import Problem, StepLoad
from lapjoint.problem.excitation import BaseMotion, Excitation
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.forces import multiple_of
from lapjoint.problem.override import assign, path_keys, targets
from lapjoint.problem.random_motion import Random
from lapjoint.problem.records import Record
from lapjoint.problem.tables import copied
from lapjoint.sampling.design import SAMPLE, Samples, describe

FREQUENCY = "base_motion.angular_frequency"
"""Path of the excitation frequency, which is the frequency of the base motion; frequencies of periodic loads keep their
ratio to it."""
MOST_POINTS = 10_000_000
"""Largest number of points of a grid, for its dataset to fit into memory."""
CHECKED_POINTS = 5000
"""Largest number of points of a grid that is validated as a whole before any work, which takes seconds; a larger grid
is validated at its corners."""

UNITS = {
    "x": "m",
    "from": "m",
    "to": "m",
    "gap": "m",
    "length": "m",
    "origin": "m",
    "offset": "m",
    "breadth": "m",
    "height": "m",
    "diameter": "m",
    "outer_diameter": "m",
    "inner_diameter": "m",
    "amplitude": "m",
    "stiffness": "N m-1",
    "damping": "N s m-1",
    "torsional_damping": "N m s rad-1",
    "viscous_damping": "N s m-2",
    "translational": "N m-1",
    "torsional": "N m rad-1",
    "bending_stiffness": "N m2",
    "mass_per_length": "kg m-1",
    "contents_per_length": "kg m-1",
    "added_mass_per_length": "kg m-1",
    "mass": "kg",
    "rotary_inertia": "kg m2",
    "youngs_modulus": "Pa",
    "density": "kg m-3",
    "slope": "1",
    "second_slope": "1",
    "reference_range": "Pa",
    "reference_cycles": "1",
    "knee_cycles": "1",
    "ratio": "1",
    "coefficient": "N s m-2",
    "base_share": "1",
    "gravity_share": "1",
    "angular_frequency": "rad s-1",
    "frequency": "Hz",
    "phase": "rad",
    "rate": "Hz",
    "force": "N",
    "force_per_length": "N m-1",
    "acceleration": "m s-2",
}
"""Units of the fields of a problem, by the last key of their path."""


def in_radians(path: str) -> tuple[str, float]:
    """A path as campaigns keep it, and how many of its units make one of those that are given: a frequency in Hz,
    ``base_motion.frequency``, is kept as an angular frequency in rad/s."""
    part, dot, key = path.rpartition(".")
    return (f"{part}.angular_frequency", 2 * math.pi) if dot and key == "frequency" else (path, 1.0)


@dataclass(frozen=True)
class Axis:
    """One number of the problem, and the values that it takes.

    Parameters
    ----------
    path : str
        Path of the number in the problem, as ``--set`` takes it: ``stops.*.gap``, ``damping.ratio``; `FREQUENCY` sets
        the frequency of all periodic excitation: parts at a whole multiple of another's frequency stay at it.
    values : iterable of float
        The values, in the SI unit of the number, each once, in any sequence.  Those of a ``frequency``, Hz, are kept
        as angular frequencies, rad/s.

    Raises
    ------
    InputError
        If there is no path or no value, or a value is not a number or given twice.
    """

    path: str
    values: tuple[float, ...]

    def __post_init__(self) -> None:
        if not path_keys(self.path):
            raise InputError(f"axis {self.path!r}: must be the path of a number of the problem, as in stops.*.gap")
        path, radians = in_radians(".".join(path_keys(self.path)))
        object.__setattr__(self, "path", path)
        object.__setattr__(self, "values", tuple(value * radians for value in self._numbers(self.values)))
        if not self.values:
            raise InputError(f"axis {self.path}: has no values; must have at least one")
        for value, number in Counter(self.values).items():
            if number > 1:
                raise InputError(
                    f"axis {self.path}: {value:.10g} is given {number} times; each value must be there once"
                )

    def _numbers(self, values: Iterable[Any]) -> Iterator[float]:
        """The values as numbers; InputError if one is none."""
        for value in values:
            number = isinstance(value, int | float | np.integer | np.floating) and not isinstance(value, bool)
            if not number or math.isnan(value):
                raise InputError(f"axis {self.path}: {value!r} must be a number")
            yield float(value)

    @property
    def name(self) -> str:
        """Name of the dimension: ``angular_frequency``, or the path as a word, ``stops_all_gap``."""
        if self.path == FREQUENCY:
            return "angular_frequency"
        return re.sub(r"\W+", "_", self.path.replace("*", "all"))

    @property
    def units(self) -> str:
        """Unit of the values, as CF writes it."""
        named = [UNITS[key] for key in reversed(path_keys(self.path)) if key in UNITS]
        return named[0] if named else "1"


@dataclass(frozen=True)
class Grid:
    """A problem, and the axes along which it is changed; the last one is the fastest.

    Samples of the uncertain numbers of the problem are one more dimension, the slowest, so that all points of a sample
    share its modes.  InputError is raised if there is neither an axis nor a sample, two axes are the same, an axis
    changes what is uncertain, or the grid is too large.
    """

    problem: Problem
    axes: tuple[Axis, ...]
    samples: Samples | None = None

    def __post_init__(self) -> None:
        if not self.axes and self.samples is None:
            raise InputError("axes: there are none; give at least one")
        if self.samples is not None:
            self._check_uncertain()
        names = [axis.name for axis in self.axes]
        for i, axis in enumerate(self.axes):
            if axis.name in names[:i]:
                raise InputError(f"axis {axis.path}: is given twice")
        if self.size > MOST_POINTS:
            raise InputError(f"axes: they span {self.size} points; at most {MOST_POINTS} are allowed")

    def _check_uncertain(self) -> None:
        """Refuse an axis that sets what an uncertain number moves."""
        moved = {
            place: one.name
            for one in self.problem.uncertain
            for path in one.paths
            for place, _ in targets(self._tables, path, one.name)
        }
        for axis in self.axes:
            for path, _ in self._numbers(axis, axis.values[0]):
                for place, _ in targets(self._tables, path, f"axis {axis.path}"):
                    if place in moved:
                        raise InputError(
                            f"axis {axis.path}: sets {place}, of which samples of {moved[place]} are drawn"
                        )

    @property
    def dimensions(self) -> tuple[str, ...]:
        """Names of the dimensions: the samples, if there are any, and the axes."""
        return (*(() if self.samples is None else (SAMPLE,)), *(axis.name for axis in self.axes))

    @property
    def shape(self) -> tuple[int, ...]:
        """Number of samples, if there are any, and of values of each axis."""
        samples = () if self.samples is None else (self.samples.size,)
        return (*samples, *(len(axis.values) for axis in self.axes))

    @property
    def size(self) -> int:
        """Number of points."""
        return math.prod(self.shape)

    def values_at(self, point: int) -> tuple[float, ...]:
        """The value of each axis at a point, by its number, in the units of the axes."""
        places = np.unravel_index(point, self.shape)
        own = places[len(places) - len(self.axes) :]
        return tuple(axis.values[int(i)] for axis, i in zip(self.axes, own, strict=True))

    def describe(self, point: int) -> str:
        """A text for messages that names a point: ``stops.*.gap = 0.001, damping.ratio = 0.08``."""
        values = _described(self.axes, self.values_at(point))
        if self.samples is None:
            return values
        sample = self.sample_at(point)
        drawn = describe(self.problem, self.samples.values[sample], sample)
        return f"{drawn}, {values}" if values else drawn

    def sample_at(self, point: int) -> int:
        """The number of the sample to which a point belongs; 0 if there are no samples."""
        return point // math.prod(len(axis.values) for axis in self.axes)

    def problem_at(self, point: int) -> Problem:
        """The problem at a point; InputError, which names the point, if there is no valid problem there."""
        if self.samples is None:
            return self.with_values(self.values_at(point))
        sample = self.sample_at(point)
        if not self.axes:
            return self.samples.problem(self.problem, sample)
        at, values = _grid_of_sample(self.problem, self.axes, self.samples, sample), self.values_at(point)
        try:
            return at.with_values(values)
        except InputError as error:
            message = str(error).removeprefix(f"{_described(self.axes, values)}: ")
            raise InputError(f"{self.describe(point)}: {message}") from None

    def with_values(self, values: tuple[float, ...]) -> Problem:
        """The problem with any values of the axes, in their units, those of the grid or others; InputError, which names
        the values, if there is no such problem."""
        if self._base_fields:
            with suppress(InputError):
                return self.problem.with_base_numbers(**dict(zip(self._base_fields, values, strict=True)))
        numbers = [
            (path, number, f"axis {axis.path}")
            for axis, value in zip(self.axes, values, strict=True)
            for path, number in self._numbers(axis, value)
        ]
        with suppress(InputError):  # its message would be of parts, and not of tables
            parts = _assigned(self._touched, numbers)
            if parts.keys() <= Excitation.model_fields.keys():
                return self.problem.with_excitation(**parts)
            return problem_from_tables(self._untouched | parts)
        return self._from_tables(_assigned(self._tables, numbers), _described(self.axes, values))

    def _from_tables(self, tables: dict[str, Any], values: str) -> Problem:
        """The problem that tables hold, which some values lead to."""
        try:
            return problem_from_tables(tables, values)
        except InputError as error:
            alone = str(error).removeprefix(f"{values}: ")
            if len(self.axes) == 1 and alone.startswith(f"{self.axes[0].path} = "):
                raise InputError(alone) from None  # it names the value itself
            raise

    @cached_property
    def _base_fields(self) -> tuple[str, ...]:
        """For each axis, the field of a sinusoidal base motion that it sets; empty if an axis sets several numbers, or
        another one."""
        if not isinstance(self.problem.base_motion, BaseMotion):
            return ()
        paths = [path for axis in self.axes for path, _ in self._numbers(axis, axis.values[0])]
        keys = [path_keys(path) for path in paths]
        own = all(len(one) == 2 and one[0] == "base_motion" and one[1] in BaseMotion.model_fields for one in keys)
        return tuple(one[1] for one in keys) if own and len(keys) == len(self.axes) else ()

    @cached_property
    def _tables(self) -> dict[str, Any]:
        return problem_tables(self.problem)

    @cached_property
    def _touched(self) -> dict[str, Any]:
        """The tables in which an axis lies."""
        touched = {path_keys(path)[0] for axis in self.axes for path, _ in self._numbers(axis, axis.values[0])}
        return {key: table for key, table in self._tables.items() if key in touched}

    @cached_property
    def _untouched(self) -> dict[str, Any]:
        """The parts of the problem in which no axis lies."""
        return {key: getattr(self.problem, key) for key in self._tables.keys() - self._touched.keys()}

    def _numbers(self, axis: Axis, value: float) -> list[tuple[str, float]]:
        """The paths that a value of an axis sets, and the number at each path."""
        if axis.path != FREQUENCY:
            return [(axis.path, value)]
        if not self._ratios:
            if self.problem.records or self.problem.random:
                self.problem.require_excitation_frequency(f"axis {FREQUENCY}")
            message = "nothing excites this problem; give it a base_motion or a periodic load"
            raise InputError(f"axis {FREQUENCY}: {message}")
        return [(path, value * ratio) for path, ratio in self._ratios.items()]

    @cached_property
    def _ratios(self) -> dict[str, float]:
        """For each periodic part, by its path, the ratio of its angular frequency to the frequency that an axis sets; 1
        if neither is a multiple of the other."""
        base, loads = self.problem.base_motion, self.problem.point_loads
        found = {} if base is None or isinstance(base, Record | Random) else {FREQUENCY: base.angular_frequency}
        others = StepLoad | Record | Random
        periodic = {i: load.angular_frequency for i, load in enumerate(loads) if not isinstance(load, others)}
        found |= {f"point_loads.{i}.angular_frequency": omega for i, omega in periodic.items()}
        own = found.get(FREQUENCY, self.problem.excitation_frequency)
        return {path: _ratio(omega, own) for path, omega in found.items()}

    def check(self, place: float | str | None = None) -> None:
        """Validate the problems of the grid, or those at its corners, of all samples, where it is large.

        InputError, which names the point, is raised if one is not valid, its excitation has no period, or it has no
        such `place`, m.
        """
        ends = [sorted({0, n - 1}) for n in self.shape]
        if self.samples is not None:
            ends[0] = list(range(self.samples.size))
        corners = [int(np.ravel_multi_index(corner, self.shape)) for corner in product(*ends)]
        for point in range(self.size) if self.size <= CHECKED_POINTS else corners:
            problem = self.problem_at(point)
            problem.require_excitation_frequency(self.describe(point))
            if place is not None:
                try:
                    problem.position(place)
                except InputError as error:
                    raise InputError(f"{self.describe(point)}: {error}") from None


@lru_cache(maxsize=2)
def _grid_of_sample(problem: Problem, axes: tuple[Axis, ...], samples: Samples, sample: int) -> Grid:
    """The axes alone, at a sample; the points of a sample are solved one after the other, and share its problem."""
    return Grid(samples.problem(problem, sample), axes)


def _assigned(tables: dict[str, Any], numbers: list[tuple[str, float, str]]) -> dict[str, Any]:
    """A copy of tables with some numbers changed; each is given as path, number, and the source for messages."""
    changed: dict[str, Any] = copied(tables)
    for path, number, source in numbers:
        assign(changed, path, number, source)
    return changed


def _ratio(omega: float, own: float | None) -> float:
    """The whole number, or its reciprocal, by which an angular frequency multiplies another; 1 where there is none."""
    if own is None:
        return 1.0
    above, below = multiple_of(own, omega), multiple_of(omega, own)
    return float(above) if above else 1 / below if below else 1.0


def _described(axes: tuple[Axis, ...], values: tuple[float, ...]) -> str:
    return ", ".join(f"{axis.path} = {value:.10g}" for axis, value in zip(axes, values, strict=True))
