"""How a chunk of starts is solved, and which values of its result are stored."""

from __future__ import annotations

import json
from dataclasses import dataclass, field
from functools import lru_cache
from typing import Any, NamedTuple, TypedDict, cast

import numpy as np

from lapjoint.answers.steady_state import Outcome, SectionPoint
from lapjoint.campaigns.basins.spec import BasinPlan
from lapjoint.campaigns.batch import made_solver
from lapjoint.campaigns.point import FAILED, OUTCOME_CODES, PlainSection, plain_section, section_from
from lapjoint.errors import InputError
from lapjoint.orbits import Effort, PeriodMap
from lapjoint.orbits.binding import Binder
from lapjoint.orbits.branches.resolution import HasPeriodMap
from lapjoint.orbits.certified import CertifiedMotion
from lapjoint.orbits.displaced import DisplacedStarts, energy_roots, plane_directions, random_deviation
from lapjoint.parts import require
from lapjoint.problem import FloatArray, Problem
from lapjoint.problem.plane import Plane
from lapjoint.solver import Progress

UNBOUND = -1
"""Index in place of a motion for a start that is bound to no motion."""
NO_LIBRARY = "[]"
"""A library without motions."""


class PlainMotion(TypedDict):
    """A certified motion as values that JSON can hold; the fields are those of `CertifiedMotion`."""

    points: list[PlainSection]
    symmetric: bool
    outcome: str
    """Name of the outcome."""
    residual: float
    multiplier: list[float]
    """Real and imaginary part of the multiplier."""
    impulses: list[float]


class Failure(NamedTuple):
    """A march that could not go on; a journal holds it as a list, in this sequence."""

    start: int
    """The start, by its place in the chunk."""
    reason: str


@dataclass(frozen=True)
class ChunkEnds:
    """Where the starts of a chunk end, as values that JSON can hold."""

    motions: list[PlainMotion] = field(default_factory=list)
    """The certified motions that were found in the chunk and are not in the library."""
    motion: list[int] = field(default_factory=list)
    """Index of the motion to which each start is bound, or `UNBOUND`; motions of the library are numbered first."""
    outcome: list[int] = field(default_factory=list)
    """Number of the outcome of each start, see `lapjoint.campaigns.point.OUTCOME_CODES`."""
    periods: list[int] = field(default_factory=list)
    """Excitation periods marched from each start."""
    pushed: list[int] = field(default_factory=list)
    """Starts of the chunk whose march was pushed off an unstable motion that it could not leave."""
    messages: list[Failure] = field(default_factory=list)
    """Marches that could not go on."""
    message: str = ""
    """Why there is no answer at all; empty where there is one."""

    def whole(self, count: int) -> ChunkEnds:
        """The ends of `count` starts: if there is no answer at all, all starts have failed for its reason."""
        if not self.message:
            return self
        reasons = [Failure(i, self.message) for i in range(count)]
        return ChunkEnds([], [UNBOUND] * count, [OUTCOME_CODES[FAILED]] * count, [0] * count, [], reasons)


@dataclass(frozen=True)
class Prepared:
    """What all chunks of one problem need."""

    period_map: PeriodMap
    """The period map, which must also implement `DisplacedStarts`."""
    origin: SectionPoint
    """The section point from which all starts are displaced."""
    directions: FloatArray
    """Deviations by one unit of each coordinate, ``(2, n)``, or the matrix of `energy_roots`, ``(n, n)``."""
    binder: Binder
    """Knows the library."""


def solve_chunk(plan: BasinPlan, cell: int, library: str, progress: Progress | None = None) -> ChunkEnds:
    """Where the starts of a chunk end, given a library of known motions as text, see `library_text`."""
    try:
        value, starts = plan.chunk(cell)
        this = prepared(plan, value, library)
        binder, known = this.binder.again(), len(this.binder.motions)
        ends = binder.ends([start_of(plan, this, value, number) for number in starts], progress)
    except InputError as error:
        raise InputError(f"{_described(plan, cell)}: {error}" if plan.grid else str(error)) from None
    return ChunkEnds(
        motions=[plain_motion(motion) for motion in binder.motions[known:]],
        motion=[UNBOUND if end.motion is None else end.motion for end in ends],
        outcome=[OUTCOME_CODES[FAILED if end.outcome is None else end.outcome.name] for end in ends],
        periods=[end.periods for end in ends],
        pushed=[i for i, end in enumerate(ends) if end.pushes],
        messages=[Failure(i, end.message) for i, end in enumerate(ends) if end.message],
    )


def _described(plan: BasinPlan, cell: int) -> str:
    """A text for messages that names a cell of several problems."""
    value, starts = plan.chunk(cell)
    which = "scouts" if cell < plan.values else f"starts {starts[0]} to {starts[-1]}"
    return which if plan.grid is None else f"{plan.grid.describe(value)}, {which}"


def start_of(plan: BasinPlan, this: Prepared, value: int, number: int) -> SectionPoint:
    """A start of one of the problems, as a point of its period map."""
    if plan.energy is None:
        i, j = divmod(number, plan.shape[1])  # the second coordinate is the fastest
        deviation = np.array([plan.axes[0][i], plan.axes[1][j]]) @ this.directions
    else:
        deviation = random_deviation(this.directions, plan.energy, (plan.seed, value, number))
    return this.period_map.moved(this.origin, deviation)


def prepared(plan: BasinPlan, value: int, library: str = NO_LIBRARY) -> Prepared:
    """What all chunks of a problem need, made once in each process.

    InputError is raised if the solver or the problem does not allow such starts.
    """
    options = json.dumps(dict(plan.options), sort_keys=True)
    return _prepared(plan.solver, options, plan.problem_at(value), plan.plane, plan.effort, library)


@lru_cache(maxsize=4)
def _prepared(solver: str, options: str, problem: Problem, plane: Plane | None, effort: int, library: str) -> Prepared:
    period_map = _period_map(solver, options, problem)
    origin = period_map.initial()
    if plane is None:
        directions = energy_roots(period_map, problem, origin)
    else:
        directions = plane_directions(period_map, problem, origin, plane)
    motions = [motion_from(plain) for plain in json.loads(library)]
    return Prepared(period_map, origin, directions, Binder(period_map, Effort(max_periods=effort), motions))


def _period_map(solver: str, options: str, problem: Problem) -> Any:
    """The period map of a problem, which is one of `DisplacedStarts`, too; InputError if the solver gives none."""
    problem.require_excitation_frequency("basins")
    made, owner = made_solver(solver, options), f"solver = {solver!r}"
    require(made, HasPeriodMap, owner, "basins")
    period_map = cast(HasPeriodMap, made).period_map(problem)
    for protocol in (PeriodMap, DisplacedStarts):
        require(period_map, protocol, f"the period map of {owner}", "basins")
    return period_map


def library_text(scouts: ChunkEnds) -> str:
    """The motions that scouts found as one text, which also serves as the key of a cache."""
    return json.dumps(scouts.motions)


def plain_motion(motion: CertifiedMotion) -> PlainMotion:
    """A motion as values that JSON can hold, to the bit."""
    return PlainMotion(
        points=[plain_section(point) for point in motion.points],
        symmetric=motion.symmetric,
        outcome=motion.outcome.name,
        residual=motion.residual,
        multiplier=[motion.multiplier.real, motion.multiplier.imag],
        impulses=list(motion.impulses),
    )


def motion_from(plain: PlainMotion) -> CertifiedMotion:
    """The motion of which `plain_motion` made the values, with the same bits."""
    return CertifiedMotion(
        points=tuple(section_from(point) for point in plain["points"]),
        symmetric=plain["symmetric"],
        outcome=Outcome[plain["outcome"]],
        residual=plain["residual"],
        multiplier=complex(*plain["multiplier"]),
        impulses=tuple(plain["impulses"]),
    )
