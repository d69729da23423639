"""How a cell of a sweep is solved: by the steady state of its problem, from its initial state or along a chain."""

from __future__ import annotations

from lapjoint.campaigns.point import PlainSection, Point, plain_section, point_of, section_from
from lapjoint.campaigns.random_start import random_initial
from lapjoint.campaigns.sweep.spec import Plan
from lapjoint.errors import InputError, SolverError
from lapjoint.problem import Problem
from lapjoint.solver import Solver


def solve_point(
    plan: Plan, cell: int, solver: Solver, section: PlainSection | None
) -> tuple[Point, PlainSection | None]:
    """The motion of a cell, and where the next cell of a chain starts.

    Where the solver gives up, the next cell starts where this cell did.
    """
    point, number = divmod(cell, plan.starts)
    try:
        problem = _started(plan, point, number, solver)
        start = None if section is None else section_from(section)
        found = solver.steady_state(problem, start=start, sensitivity=plan.sensitivity, errors=plan.errors)
    except SolverError as error:
        return Point(message=str(error)), section
    except InputError as error:
        message = str(error)
        where = plan.grid.describe(point) + (f", start {number}" if plan.has_starts else "")
        raise InputError(message if message.startswith(where) else f"{where}: {message}") from None
    return point_of(found, plan.summary), plain_section(found.section_point) if plan.chained else None


def _started(plan: Plan, point: int, number: int, solver: Solver) -> Problem:
    """The problem at a point of the grid, with the initial state of one of its starts."""
    problem = plan.grid.problem_at(point)
    if plan.start != "random" and number == 0:
        return problem
    return problem.replace(initial=random_initial(problem, solver, (plan.seed, point, number)))
