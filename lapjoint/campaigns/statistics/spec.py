"""The question of statistics: the problem, the duration of its motions, and the number of realisations.

A realisation is the problem with other seeds of its random parts: each seed plus the number of the realisation.  A cell
is one realisation.  Each sample of uncertain numbers has realisations of its own.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import Any, ClassVar

import numpy as np

from lapjoint.campaigns.identity import check_integer, problem_identity, versions
from lapjoint.campaigns.job import Spec
from lapjoint.errors import InputError
from lapjoint.problem import Problem
from lapjoint.problem.random_motion import LARGEST_SEED
from lapjoint.sampling.design import Samples, describe
from lapjoint.solver import Solver
from lapjoint.summaries.measure import Measure, measure
from lapjoint.summaries.quantities import selection

MOST_SEEDS = 100_000
"""Largest number of realisations."""


@dataclass(frozen=True)
class Realisations(Spec):
    """Everything that statistics depend on; the fields are the arguments of `lapjoint.statistics`.

    InputError is raised if the number of realisations, `seeds`, is not allowed.
    """

    noun: ClassVar[str] = "run of statistics"
    cells_noun: ClassVar[str] = "realisations"

    problem: Problem
    duration: float
    seeds: int = 1
    solver: str = "analytic"
    options: Mapping[str, Any] = field(default_factory=dict)
    at: tuple[float, ...] | None = None
    quantities: tuple[str, ...] | None = None
    settle: float | None = None
    rate: float | None = None
    samples: Samples | None = None

    def __post_init__(self) -> None:
        check_integer("seeds", self.seeds, 1, MOST_SEEDS)
        if self.seeds > 1 and not self.problem.random:
            raise InputError(
                f"seeds = {self.seeds}: nothing in this problem is random, so all realisations would be one; give it a "
                'base_motion or a load of kind = "random", or leave seeds out'
            )

    @property
    def size(self) -> int:
        """Number of realisations, of all samples."""
        return self.seeds * (1 if self.samples is None else self.samples.size)

    def check(self) -> Solver:
        """Make the solver; InputError if it does not take its options, or the motions cannot be summarised so."""
        solver = super().check()
        for sample in range(1 if self.samples is None else self.samples.size):
            self.measure(solver, sample)
        return solver

    def measure(self, solver: Solver, sample: int = 0) -> Measure:
        """How each motion, of a sample if there are any, is summarised; modes from the solver give the time in which
        motions settle.

        InputError is raised if an argument is not allowed, or the time to settle leaves no motion.
        """
        problem = self.problem_of(sample)
        try:
            what = selection(problem, at=self._at(problem), quantities=self.quantities)
            return measure(what, solver, self.duration, seeds=self.seeds, settle=self.settle, rate=self.rate)
        except InputError as error:
            if self.samples is None:
                raise
            here = describe(self.problem, self.samples.values[sample], sample)
            raise InputError(f"{here}: {error}") from None

    def _at(self, problem: Problem) -> Sequence[float] | None:
        """The chosen places on the line of beams of a sample, whose lengths can be others."""
        if self.at is None or self.samples is None:
            return self.at
        return [problem.position(self.problem.line.exact_place(x)) for x in self.at]

    def problem_of(self, sample: int) -> Problem:
        """The problem at a sample; InputError if there is none."""
        return self.problem if self.samples is None else self.samples.problem(self.problem, sample)

    def realisation(self, cell: int) -> Problem:
        """The problem of a cell: of its sample, with the seeds of a realisation; cell 0 has the seeds of the problem
        itself."""
        sample, number = divmod(cell, self.seeds)
        number += 0 if self.samples is None else self.samples.noise(sample) * self.seeds
        problem = self.problem_of(sample)
        return problem.with_seeds(lambda own: (own + number) % (LARGEST_SEED + 1)) if number else problem

    @cached_property
    def identity(self) -> dict[str, Any]:
        """What distinguishes these statistics from any other, as values that JSON can hold."""
        given = {
            name: getattr(self, name) for name in ("duration", "seeds", "solver", "at", "quantities", "settle", "rate")
        }
        return {
            **problem_identity(self.problem),
            **{name: list(value) if isinstance(value, tuple) else value for name, value in given.items()},
            **({} if self.samples is None else {"samples": self.samples.identity}),
            "options": dict(self.options),
            "versions": versions(),
        }


def lasting(problem: Problem, duration: float | None) -> float:
    """The duration that is asked for, s, or that of the shortest record; InputError if there is neither."""
    if duration is not None:
        return float(duration)
    if not np.isfinite(problem.longest):
        raise InputError("duration: is missing; only a problem with a record has a duration of its own")
    return problem.longest
