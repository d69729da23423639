"""The job of a sweep: each cell is solved by the steady state of its problem, from its initial state or along a
chain."""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, ClassVar

from lapjoint.campaigns.job import Job
from lapjoint.campaigns.point import PlainSection, Point, plain_section, point_from, point_of, section_from
from lapjoint.campaigns.random_start import random_initial
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.campaigns.sweep.strobe import strobed
from lapjoint.campaigns.sweep.table import sweep_dataset
from lapjoint.errors import InputError, SolverError
from lapjoint.problem import Problem
from lapjoint.solver import Progress, Solver

if TYPE_CHECKING:
    import xarray as xr


@dataclass(frozen=True)
class SweepJob(Job[Plan, Point]):
    """The work on a sweep: its cells are the points and their starts."""

    longest_batch: ClassVar[int] = 32
    """Largest number of independent cells in a batch, so that the last batches end at about the same time."""

    def chains(self) -> Iterable[tuple[int, ...]]:
        """The cells of each chain, in which each motion starts from the motion before it."""
        return self.spec.chains() if self.spec.chained else ()

    def answer(
        self, cell: int, solver: Solver, section: PlainSection | None, progress: Progress | None = None
    ) -> tuple[Point, PlainSection | None]:
        """The motion of a cell, and where the next cell of a chain starts.

        Where the solver gives up, the next cell starts where this cell did.
        """
        plan = self.spec
        point, number = divmod(cell, plan.starts)
        try:
            problem = _started(plan, point, number, solver)
            start = None if section is None else section_from(section)
            found = solver.steady_state(
                problem, start=start, sensitivity=plan.sensitivity, errors=plan.errors, progress=progress
            )
            samples = strobed(found, plan.strobe, plan.at) if plan.at is not None else {}
        except SolverError as error:
            return Point(message=str(error)), section
        except InputError as error:
            message = str(error)
            where = plan.grid.describe(point) + (f", start {number}" if plan.has_starts else "")
            raise InputError(message if message.startswith(where) else f"{where}: {message}") from None
        answer = replace(point_of(found, plan.summary), strobe=samples)
        return answer, plain_section(found.section_point) if plan.chained else None

    def point(self, fields: Mapping[str, Any]) -> Point:
        """A point from its attributes."""
        return point_from(fields)

    def dataset(self, points: Mapping[int, Point]) -> xr.Dataset:
        """The dataset of all points."""
        return sweep_dataset(self.spec, points)


def _started(plan: Plan, point: int, number: int, solver: Solver) -> Problem:
    """The problem at a point of the grid, with the initial state of one of its starts."""
    problem = plan.grid.problem_at(point)
    if plan.start != "random" and number == 0:
        return problem
    return problem.replace(initial=random_initial(problem, solver, (plan.seed, point, number)))
