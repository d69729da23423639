"""The period map of the analytic solver: what the search for periodic motions asks of it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from analytic.ensemble import JointEnsemble
from analytic.march import (
    Coordinates,
    Joint,
    March,
    gap_view,
    march,
    march_linearised,
    march_periods,
    measure_growth,
)
from analytic.march.arcs import JointArcs
from analytic.march.carried import size_of
from analytic.march.field import history_of
from analytic.march.gap_view import outline_of
from analytic.march.initial_state import resumed, started, translated
from analytic.march.joint import DrivenProblem
from analytic.march.loads import Excitation, Harmonics
from analytic.march.march import joined, recorded
from analytic.march.motion import Log, new_log
from analytic.march.static_shapes import free_energy, static_shapes
from lapjoint.answers import History
from lapjoint.answers.contact_state import FREE, ContactState
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.errors import InputError
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.displaced import StaticShapes
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY, change_with
from lapjoint.orbits.period_map import Derivative, Followed, Linearised, Passage, period_pieces
from lapjoint.problem import BaseMotion, FloatArray, Problem
from lapjoint.problem.damping import ROUNDED
from lapjoint.problem.forces import base_acceleration
from lapjoint.problem.symmetry import stop_twins
from lapjoint.solver import Progress


@dataclass(frozen=True)
class PeriodMap:
    """The motion of a problem from section point to section point; see `lapjoint.orbits.PeriodMap`.

    Section points, and deviations from them, hold (q, v) in the modes of their contact state.  The modes of the next
    state cannot carry the whole motion.  The map therefore jumps, by truncation, where the order of two switches
    changes.
    """

    joint: Joint
    name: str
    """Name and options of the solver."""

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self.joint.problem

    @property
    def period(self) -> float:
        """The excitation period, s."""
        assert self.joint.period is not None
        return self.joint.period

    @cached_property
    def arcs(self) -> JointArcs:
        """The closed form of the motion in all contact states. See `lapjoint.orbits.arcs.HasArcs`."""
        return JointArcs(self.joint, self.period)

    @cached_property
    def lowest_damping_rate(self) -> float:
        """Least damping rate zeta omega of a mode of the joint without contact, 1/s; 0 without damping."""
        it = self.joint.coupled(FREE)
        damping_rate = self.joint.modal(FREE).damping_rate if it is None else it.damping / 2
        rounding = 0.0 if it is None else ROUNDED * float(np.abs(it.roots).max())
        return float(damping_rate[damping_rate > rounding].min()) if (damping_rate > rounding).any() else 0.0

    def retuned(self, field: str, value: float, problem: Callable[[], Problem]) -> PeriodMap | None:
        """The map with another amplitude or frequency, if a sine of the base alone drives the beam.

        See `lapjoint.orbits.parameters.Retunes`: `problem` is called only where the new problem is asked for, and
        whatever does not depend on the parameter is kept.
        """
        base = self.problem.base_motion
        if field not in (FREQUENCY, AMPLITUDE) or not isinstance(base, BaseMotion) or self.problem.point_loads:
            return None
        if self.joint.change_by(field) is None or value <= 0:
            return None
        amplitude, omega = (value, base.angular_frequency) if field == AMPLITUDE else (base.amplitude, value)
        moved = self.joint.harmonics.phase.size - 1
        sizes = np.array([1.0, base_acceleration(amplitude, omega), *[amplitude] * moved])
        harmonics = Harmonics(np.full(1 + moved, omega), self.joint.harmonics.phase)
        changes = {field: change_with(field, value, np.ones(1), moved)}
        driven = DrivenProblem(self.joint.loaded, Excitation(harmonics, sizes, 2 * math.pi / omega, changes), problem)
        return PeriodMap(Joint(driven, *self.joint.counts, self.joint.side), self.name)

    def initial(self) -> SectionPoint:
        """The initial state of the problem."""
        return _section_point(started(self.joint))

    @in_one_thread
    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """March over half periods, a period at a time. See `lapjoint.orbits.PeriodMap.march`."""
        whole, half = divmod(half_periods, 2)
        found = march_periods(self.joint, _coordinates(start), self.period, whole)
        end, penetration, switches = found.end, found.penetration, found.switches
        if half:
            last = march(self.joint, end, 0.0, self.period / 2)
            end, penetration = last.end, penetration + last.penetration
            switches += int(np.count_nonzero(last.log.stop >= 0))
        return Passage(_section_point(end), self._impulses(penetration), switches)

    @in_one_thread
    def history(self, start: SectionPoint, periods: int) -> History:
        """The motion over whole periods with its contacts. See `lapjoint.orbits.PeriodMap.history`."""
        return self._recorded(_coordinates(start), [self.period] * periods, None)

    def simulated(self, duration: float, progress: Progress | None) -> History:
        """The motion from the initial state to `duration`, s, in the pieces in which periodic motions are marched."""
        recorded(0.0, new_log(1, max(self.joint.counts), self.joint.stops), duration / self.period)  # at least
        motion = self._recorded(started(self.joint), period_pieces(self.period, duration), progress)
        return replace(motion, end=duration)  # the pieces come to that but for rounding

    def marched(self, duration: float) -> Iterator[Log]:
        """The segments of the motion that `simulated` gives, piece by piece, with the depths of contacts."""
        now = started(self.joint)
        for i, piece in enumerate(period_pieces(self.period, duration)):
            motion = march(self.joint, now, 0.0, piece, depth=True)
            now = motion.end
            yield _later(motion.log, i * self.period)

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """Deviation, as (q, v) in the modes of `origin`. See `lapjoint.orbits.PeriodMap.difference`."""
        if point.state == origin.state:
            return (point.coordinates - origin.coordinates).ravel()
        return translated(self.joint, _coordinates(point), origin.state).y - origin.coordinates.ravel()

    def norm(self, deviation: FloatArray) -> float:
        """|q| + |v| / omega, kg^1/2 m. See `lapjoint.orbits.PeriodMap.norm`."""
        return size_of(np.ascontiguousarray(deviation).reshape(-1, 1), self.period)

    def unit_norms(self, n: int) -> FloatArray:
        """Norms of units of the coordinates. See `lapjoint.orbits.period_map.UnitNorms`."""
        norms = np.ones(n)
        norms[n // 2 :] = self.period / (2 * math.pi)
        return norms

    def size(self, point: SectionPoint) -> float:
        """Norm of the coordinates. See `lapjoint.orbits.PeriodMap.size`."""
        return self.norm(point.coordinates.ravel())

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """The point moved by a deviation, its stops as its gaps imply. See `lapjoint.orbits.PeriodMap.moved`."""
        return resumed(self.joint, origin.state, origin.coordinates + deviation.reshape(2, -1))

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image, whose modes are those of `point`. See `lapjoint.orbits.PeriodMap.mirrored`."""
        twins = stop_twins(self.joint.loaded.problem.structure)
        assert twins is not None
        closed, released = (tuple(twins[k] for k in part) for part in (point.state.closed, point.state.released))
        return SectionPoint(ContactState(closed, released), -point.coordinates)

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """A point found with other numbers of modes, or other gaps. See `lapjoint.orbits.PeriodMap.adopted`."""
        stops = range(len(self.joint.loaded.problem.structure.stops))
        if point.nodes is not None or not all(k in stops for k in point.state.closed):
            raise InputError("start: is no section point of the analytic solver for a joint with these stops")
        coordinates = np.asarray(point.coordinates)
        real = coordinates.dtype.kind in "fiu"
        if not real or coordinates.ndim != 2 or coordinates.shape[0] != 2 or not coordinates.size:
            raise InputError(
                f"start: has coordinates of type {coordinates.dtype} and shape {coordinates.shape}; the analytic "
                "solver takes two rows of real numbers, displacements and velocities of one mode or more"
            )
        return resumed(self.joint, point.state, coordinates)

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March on and carry all deviations along. See `lapjoint.orbits.Tangent.linearised`."""
        begin, duration = _coordinates(start), half_periods * self.period / 2
        end, matrix = march_linearised(self.joint, begin, duration, np.eye(start.coordinates.size))
        if end.state != start.state:
            if self.joint.damped:
                matrix = self.joint.whole_map(end.state, start.state) @ matrix
            else:
                matrix = _passed_on(self.joint.passage(end.state, start.state).S, matrix)
        known = Derivative(matrix)

        def motion() -> March:
            return march(self.joint, begin, 0.0, duration)

        return Linearised(_section_point(end), lambda: known, lambda: gap_view(motion()), lambda: outline_of(motion()))

    @in_one_thread
    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        """March on and carry one deviation along. See `lapjoint.orbits.Follows.followed`."""
        found = measure_growth(self.joint, _coordinates(start), deviation, self.period, periods)
        states = {slot: self.joint.state_in(slot) for slot in set(found.slots.tolist())}
        sizes = {slot: self.joint.count(state) for slot, state in states.items()}
        points = tuple(
            SectionPoint(states[slot], part[:, : sizes[slot]])
            for slot, part in zip(found.slots.tolist(), found.coordinates, strict=True)
        )
        return Followed(points, self._impulses(found.penetrations), found.switches, found.growth, found.deviation)

    def ensemble(self, points: Sequence[SectionPoint]) -> JointEnsemble:
        """Many section points that march on in one compiled call. See `lapjoint.orbits.ensemble.Many.ensemble`."""
        return JointEnsemble(self.joint, self.period, [_coordinates(point) for point in points])

    def static_shapes(self, origin: SectionPoint, places: FloatArray) -> StaticShapes:
        """Static shapes of unit forces. See `lapjoint.orbits.displaced.DisplacedStarts.static_shapes`."""
        shapes, compliance = static_shapes(self.joint, origin.state, places)
        still, it = np.zeros_like(shapes), self.joint.coupled(origin.state)
        both = np.concatenate([shapes, still], axis=1), np.concatenate([still, shapes], axis=1)
        if it is not None:
            both = both[0] @ it.back.T, both[1] @ it.back.T
        return StaticShapes(*both, compliance)

    def energy(self, origin: SectionPoint) -> FloatArray:
        """Energy of deviations. See `lapjoint.orbits.displaced.DisplacedStarts.energy`."""
        return free_energy(self.joint, origin.state)

    def _impulses(self, penetration: FloatArray) -> FloatArray:
        """Impulses, N s, from the time integrals of the penetrations, m s, each of shape ``(..., P)``."""
        if self.joint.damped:
            penetration = penetration[..., self.joint.force_rows]
        return (
            np.array([stop.sign * stop.stiffness for stop in self.joint.loaded.problem.structure.stops]) * penetration
        )

    def _recorded(self, start: Coordinates, pieces: list[float], progress: Progress | None) -> History:
        now, motions, size = start, [], 0.0
        for i, piece in enumerate(pieces):
            motions.append(march(self.joint, now, 0.0, piece, depth=True))
            now, size = motions[-1].end, recorded(size, motions[-1].log)
            if progress is not None:
                progress(float(i + 1), float(len(pieces)))
        motion = _as_one(motions, self.period)
        return history_of(self.name, motion.joint, motion.log)


def _passed_on(S: FloatArray, deviations: FloatArray) -> FloatArray:
    """Deviations (dq, dv), as columns, in the modes of another state; `S` is the linear part of the passage."""
    n = deviations.shape[0] // 2
    return np.concatenate([S @ deviations[:n], S @ deviations[n:]])


def _as_one(motions: list[March], period: float) -> March:
    """Recorded marches that follow each other, a period apart, each from its own time 0, as one."""
    if len(motions) == 1:
        return motions[0]
    logs = [_later(motion.log, i * period) for i, motion in enumerate(motions)]
    total = np.sum([motion.penetration for motion in motions], axis=0)
    return March(motions[-1].joint, joined(logs), motions[-1].end, total)


def _later(log: Log, by: float) -> Log:
    """The segments of a log with all times `by` seconds later."""
    return log._replace(start=log.start + by, end=log.end + by)


def _coordinates(point: SectionPoint) -> Coordinates:
    return Coordinates(point.state, point.coordinates[0], point.coordinates[1])


def _section_point(point: Coordinates) -> SectionPoint:
    return SectionPoint(point.state, np.array((point.q, point.v)))
