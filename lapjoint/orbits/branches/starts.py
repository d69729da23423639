"""Motions from which curves are followed: each a contact sequence, and a guess of the unknowns."""

from __future__ import annotations

from dataclasses import dataclass, field, replace

import numpy as np

from lapjoint.answers.contact_state import FREE, stop_of
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem
from lapjoint.orbits.branches.point import SAME, CurvePoint, holding, resectioned
from lapjoint.orbits.branches.resolution import ParameterRange, Resolution
from lapjoint.orbits.branches.sequence_changes import nearest, violated
from lapjoint.orbits.half_periods import HalfPeriods
from lapjoint.orbits.newton import FAR, Orbit, find_orbit
from lapjoint.orbits.search import TRANSIENT, Effort, SteadyStateSearch
from lapjoint.orbits.watch import switches_of
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Start:
    """A motion from which a curve is followed, in the terms of `BoundaryProblem`."""

    sequence: ContactSequence
    """Contact sequence of the motion."""
    half_periods: int
    """Half periods of the excitation after which the motion repeats."""
    phase: float
    """Time of the section, divided by the excitation period."""
    unknowns: FloatArray = field(repr=False)
    """Coordinates of the section, durations divided by the length of the motion, and the parameter."""
    tied: frozenset[int] = frozenset()
    """Events that are simultaneous with the previous event, see `BoundaryProblem.tied`."""
    away_from: tuple[float, SectionPoint] | None = None
    """The bifurcation at which the branch begins: the parameter, and the motion there; None if none is known."""
    direction: FloatArray | None = field(default=None, repr=False)
    """Direction along the curve that is followed first, in the units of the unknowns; None for a growing parameter."""

    @property
    def value(self) -> float:
        """The parameter, in its SI unit."""
        return float(self.unknowns[-1])

    @staticmethod
    def at(point: CurvePoint, away_from: tuple[float, SectionPoint] | None = None) -> Start:
        """A curve point as a start; the curve is followed first in the direction of its tangent."""
        problem = point.problem
        way = None if away_from is None else point.tangent * point.scale
        own = problem.sequence, problem.half_periods, problem.phase
        return Start(*own, point.u, problem.tied, away_from, way)

    def solved(self, of: ParameterRange) -> CurvePoint | None:
        """The start as a curve point, with its tangent in the direction that is followed first; None if Newton's method
        does not find the motion again."""
        problem = BoundaryProblem(of.resolution(self.value), self.sequence, self.half_periods, self.phase, self.tied)
        found = at_parameter(problem, self.unknowns) or nearest(problem, self.unknowns)
        if found is None or violated(found):
            return None
        if found.problem.events >= 2 and self.away_from is None:
            moved, u, _ = resectioned(found)
            found = at_parameter(moved, u) or found
        if self.direction is None or self.direction.size != found.u.size:
            return found if found.tangent[-1] >= 0 else found.turned()
        return found if float(found.tangent @ (self.direction / found.scale)) >= 0 else found.turned()


def at_parameter(problem: BoundaryProblem, guess: FloatArray) -> CurvePoint | None:
    """The motion near a guess, shape (n + F + 1,), at the guess's parameter; None if Newton's method finds none.

    The tangent points towards a larger parameter.
    """
    return holding(problem, guess, guess.size - 1)


def start_from(of: ParameterRange, value: float, point: SectionPoint, most_multiple: int) -> Start | None:
    """The periodic motion near the end of a march from a section point, at a parameter in its SI unit; None if none is
    found."""
    resolution = of.resolution(value)
    half = HalfPeriods(resolution.map(value))
    try:
        found = periodic_motion(half, half.map.adopted(point), most_multiple, SAME)
        if found is None:
            return None
        point, half_periods = found
        return of_motion(resolution, value, point, half_periods * (of.least if half_periods % 2 else 1))
    except SolverError:
        return None


def periodic_motion(
    half: HalfPeriods, point: SectionPoint, most_multiple: int, same: float
) -> tuple[SectionPoint, int] | None:
    """The periodic motion near the end of a march, and the fewest half periods after which it repeats; None if none is
    found.

    Two motions are one if their distance, divided by their size, is below `same`.  A march that fails raises
    `SolverError`.
    """
    effort = Effort(max_period_multiple=most_multiple, max_periods=TRANSIENT, growth=False)
    motion = SteadyStateSearch(half.map, effort).run(point).motion
    if isinstance(motion, Orbit):
        return motion.point, motion.half_periods  # over its least period
    for count in range(half.least, 2 * most_multiple + 1):
        if count % half.least == 0 and (count % 2 == 0 or half.least == 1):
            orbit = find_orbit(half, motion.point, count, FAR)
            if orbit is not None:
                return orbit.point, _least(half, orbit, same)
    return None


def _least(half: HalfPeriods, orbit: Orbit, same: float) -> int:
    """The fewest half periods after which a motion repeats."""
    for count in range(half.least, orbit.half_periods, half.least):
        if orbit.half_periods % count == 0 and half.apart(half.marched(orbit.point, count), orbit.point) < same:
            return count
    return orbit.half_periods


def of_motion(resolution: Resolution, value: float, point: SectionPoint, half_periods: int) -> Start:
    """The start at the motion with a known section point at a multiple of the excitation period; a march gives its
    contact sequence."""
    half = HalfPeriods(resolution.map(value))
    segments = half.linearised(point, half_periods).linearised.motion
    at = np.flatnonzero(segments.switched >= 0)
    shares = np.diff(segments.end[at], prepend=0.0) / (half_periods * half.map.period / 2)
    switches = switches_of(half.map.problem.structure.stops)[segments.switched[at]]
    sequence = ContactSequence(point.state, tuple(switches.tolist()))
    stops = [stop_of(switch) for switch in sequence.stops]
    at_once = np.abs(shares) < SAME
    tied = frozenset(i for i in range(1, at.size) if at_once[i] and stops[i] != stops[i - 1])
    problem = BoundaryProblem(resolution, sequence, half_periods, 0.0, tied)
    u = problem.packed(resolution.arcs(value).coordinates(point), shares, value)
    return Start(sequence, half_periods, 0.0, u, tied)


def without_contact(of: ParameterRange, value: float) -> Start | None:
    """The motion without contact, at a parameter in its SI unit; None if the motion would reach a stop, or does not
    exist."""
    resolution = of.resolution(value)
    arcs = resolution.arcs(value)
    problem = BoundaryProblem(resolution, ContactSequence(FREE), of.least, 0.0)
    n = arcs.unit_norms(FREE).size
    u = np.append(np.zeros(n), value)
    try:  # the equations are linear
        found = problem.linearised(u)
        u[:n] -= np.linalg.solve(found.jacobian[:, :n], found.residual)
        point = at_parameter(problem, u)
    except (InputError, SolverError, np.linalg.LinAlgError):
        return None
    if point is None or (point.extrema.violation > 0).any():
        return None
    return replace(Start.at(point), direction=None)
