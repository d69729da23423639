"""How a chunk of starts is solved."""

from __future__ import annotations

import json
from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any

import numpy as np

from lapjoint.answers.steady_state import Outcome, SectionPoint
from lapjoint.campaigns.basin_chunk import UNBOUND, Chunk
from lapjoint.campaigns.batch import made_solver
from lapjoint.campaigns.point import FAILED, OUTCOME_CODES, plain_section, section_from
from lapjoint.errors import InputError
from lapjoint.orbits import Effort, PeriodMap
from lapjoint.orbits.binding import Binder
from lapjoint.orbits.certified import CertifiedMotion
from lapjoint.orbits.displaced import DisplacedStarts, energy_roots, plane_directions, random_deviation
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.plane import Plane

if TYPE_CHECKING:
    from lapjoint.campaigns.basin_plan import BasinPlan


@dataclass(frozen=True)
class Prepared:
    """What all chunks of one problem need."""

    period_map: PeriodMap
    origin: SectionPoint
    """The section point that is moved."""
    directions: FloatArray
    """Deviations by one unit of each coordinate, ``(2, n)``, or the matrix of `energy_roots`, ``(n, n)``."""
    binder: Binder
    """Knows the library."""


def solve_chunk(plan: BasinPlan, cell: int) -> Chunk:
    """Find where the starts of a cell end.

    Parameters
    ----------
    plan : BasinPlan
        The plan, with libraries if the cell is not one of scouts.
    cell : int
        Number of the cell.

    Returns
    -------
    Chunk
        Where they end.

    Raises
    ------
    InputError
        If the problem cannot be started so.
    """
    value, numbers = plan.cell(cell)
    library = plan.libraries[value] if cell >= plan.values else "[]"
    this = prepared(plan, value, library)
    binder, known = this.binder.again(), len(this.binder.motions)
    ends = binder.ends([start_of(plan, this, value, number) for number in numbers])
    return Chunk(
        motions=[plain_motion(motion) for motion in binder.motions[known:]],
        motion=[UNBOUND if end.motion is None else end.motion for end in ends],
        outcome=[OUTCOME_CODES[FAILED if end.outcome is None else end.outcome.name] for end in ends],
        periods=[end.periods for end in ends],
        pushed=[i for i, end in enumerate(ends) if end.pushes],
        messages=[[i, end.message] for i, end in enumerate(ends) if end.message],
    )


def start_of(plan: BasinPlan, this: Prepared, value: int, number: int) -> SectionPoint:
    """A start.

    Parameters
    ----------
    plan : BasinPlan
        The plan.
    this : Prepared
        What is known of the problem.
    value : int
        Number of the problem.
    number : int
        Number of the start.

    Returns
    -------
    SectionPoint
        A point of the problem's period map.
    """
    if plan.energy is None:
        deviation = np.array(plan.moved_by(number)) @ this.directions
    else:
        deviation = random_deviation(this.directions, plan.energy, (plan.seed, value, number))
    return this.period_map.moved(this.origin, deviation)


def prepared(plan: BasinPlan, value: int, library: str) -> Prepared:
    """What all chunks of a problem need, made once in each process.

    Parameters
    ----------
    plan : BasinPlan
        The plan.
    value : int
        Number of the problem.
    library : str
        Its library, as JSON.

    Returns
    -------
    Prepared
        The same object at every call, as long as it is kept.

    Raises
    ------
    InputError
        If the solver, or the problem, does not allow such starts.
    """
    options = json.dumps(dict(plan.options), sort_keys=True)
    return _prepared(plan.solver, options, plan.problem_at(value), plan.plane, plan.effort, library)


@lru_cache(maxsize=4)
def _prepared(solver: str, options: str, problem: Problem, plane: Plane | None, effort: int, library: str) -> Prepared:
    period_map = period_map_of(solver, json.loads(options), problem)
    origin = period_map.initial()
    if plane is None:
        directions = energy_roots(period_map, problem, origin)
    else:
        directions = plane_directions(period_map, problem, origin, plane)
    motions = [motion_from(plain) for plain in json.loads(library)]
    return Prepared(period_map, origin, directions, Binder(period_map, Effort(max_periods=effort), motions))


def period_map_of(solver: str, options: dict[str, Any], problem: Problem) -> Any:
    """The period map of a problem, by a solver that takes displaced starts.

    Parameters
    ----------
    solver : str
        Entry-point name of the solver.
    options : dict of str to Any
        Its numerical options.
    problem : Problem
        The problem.

    Returns
    -------
    PeriodMap
        It is one of `DisplacedStarts`, too.

    Raises
    ------
    InputError
        If the solver gives no such map, or the excitation has no period.
    """
    problem.require_excitation_frequency("basins")
    make = getattr(made_solver(solver, options), "period_map", None)
    period_map = None if make is None else make(problem)
    if not isinstance(period_map, DisplacedStarts):
        raise InputError(f"solver = {solver!r}: does not say how a start is moved, which basins need")
    return period_map


def plain_motion(motion: CertifiedMotion) -> dict[str, Any]:
    """A motion as values that JSON can hold, to the bit.

    Parameters
    ----------
    motion : CertifiedMotion
        The motion.

    Returns
    -------
    dict of str to Any
        What `motion_from` takes.
    """
    points: Sequence[dict[str, Any]] = [plain_section(point) for point in motion.points]
    multiplier = [motion.multiplier.real, motion.multiplier.imag]
    changed = {"points": points, "multiplier": multiplier, "impulses": list(motion.impulses)}
    return {**vars(motion), **changed, "outcome": motion.outcome.name}


def motion_from(plain: dict[str, Any]) -> CertifiedMotion:
    """The motion from what `plain_motion` made of it.

    Parameters
    ----------
    plain : dict of str to Any
        The values.

    Returns
    -------
    CertifiedMotion
        The motion, with the same bits.
    """
    points = tuple(section_from(point) for point in plain["points"])
    changed = {"points": points, "multiplier": complex(*plain["multiplier"]), "impulses": tuple(plain["impulses"])}
    return CertifiedMotion(**{**plain, **changed, "outcome": Outcome[plain["outcome"]]})
