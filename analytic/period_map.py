"""The period map of the analytic solver: what the search for periodic motions asks of it."""

from __future__ import annotations

import math
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from numba import njit

from analytic.march import Coordinates, Joint, March, joined, march
from analytic.motion import history_of
from analytic.start import initial_coordinates, initial_state, resumed, translated
from analytic.state import DRIFTING, OSCILLATING, SPLIT
from analytic.tables import mirrored
from analytic.tangent import _flow, _saltation
from lapjoint.answers import History
from lapjoint.answers.contact_state import FREE
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.period_map import Followed, Linearised, Passage, Segment
from lapjoint.problem import FloatArray, Problem
from lapjoint.solver import Progress


@dataclass(frozen=True)
class PeriodMap:
    """See `lapjoint.orbits.PeriodMap`; deviations are (q, v) in the modes of a section point's contact state."""

    joint: Joint
    name: str

    @property
    def problem(self) -> Problem:
        """The problem."""
        return self.joint.problem

    @cached_property
    def period(self) -> float:
        """The excitation period, s."""
        assert self.problem.excitation_frequency is not None
        return 2 * math.pi / self.problem.excitation_frequency

    @cached_property
    def slowest_decay(self) -> float:
        """Least decay of a mode of the free joint, 1/s; 0 without damping."""
        decay = self.joint.family.state(FREE, self.joint.count(FREE)).decay
        return float(decay[decay > 0].min(initial=math.inf)) if (decay > 0).any() else 0.0

    def initial(self) -> SectionPoint:
        """The initial state."""
        state = initial_state(self.problem)
        return _section_point(Coordinates(state, *initial_coordinates(self.problem, self.joint.model(state).modes)))

    def march(self, start: SectionPoint, half_periods: int) -> Passage:
        """March on, piece by piece of a period."""
        now, total, switches = _coordinates(start), np.zeros(len(self.problem.stops)), 0
        for piece in self._pieces(half_periods):
            motion = march(self.joint, now, 0.0, piece, record=False)
            now, total = motion.end, total + motion.penetration
        return Passage(_section_point(now), self._impulses(total), switches)

    def _pieces(self, half_periods: int) -> list[float]:
        return [self.period] * (half_periods // 2) + [self.period / 2] * (half_periods % 2)

    def _impulses(self, penetration: FloatArray) -> FloatArray:
        return np.array([stop.sign * stop.stiffness for stop in self.problem.stops]) * penetration

    def history(self, start: SectionPoint, periods: int) -> History:
        """The march with its contacts."""
        return self._recorded(start, [self.period] * periods, None)

    def simulated(self, duration: float, progress: Progress | None) -> History:
        """The motion from the initial state over any duration, s, in the same pieces as the search marches."""
        whole = int(duration / self.period * (1 + 1e-12))
        left = duration - whole * self.period
        pieces = [self.period] * whole + [left] * (left > 1e-12 * duration)
        return self._recorded(self.initial(), pieces, progress)

    def _recorded(self, start: SectionPoint, pieces: list[float], progress: Progress | None) -> History:
        now, motions = _coordinates(start), []
        for i, piece in enumerate(pieces):
            motions.append(march(self.joint, now, 0.0, piece, depth=True))
            now = motions[-1].end
            if progress is not None:
                progress(float(i + 1), float(len(pieces)))
        return history_of(self.problem, self.name, self.joint, joined(motions, self.period))

    def difference(self, point: SectionPoint, origin: SectionPoint) -> FloatArray:
        """(q, v) of a point less that of `origin`, in the modes of the latter's contact state."""
        one = _coordinates(point)
        if point.state != origin.state:
            one = translated(self.joint, one, origin.state)
        return one.y - origin.coordinates.ravel()

    def norm(self, deviation: FloatArray) -> float:
        """Of displacements, and of velocities times period / 2 pi."""
        q, v = deviation.reshape(2, -1)
        return float(np.linalg.norm(q) + np.linalg.norm(v) * self.period / (2 * math.pi))

    def size(self, point: SectionPoint) -> float:
        """Norm of the coordinates."""
        return self.norm(point.coordinates.ravel())

    def moved(self, origin: SectionPoint, deviation: FloatArray) -> SectionPoint:
        """Moved in the modes of its contact state, then in the state that the gaps have it in."""
        return self.adopted(SectionPoint(origin.state, origin.coordinates + deviation.reshape(2, -1)))

    def mirrored(self, point: SectionPoint) -> SectionPoint:
        """The mirror image."""
        state = mirrored(self.problem, point.state)
        assert state is not None
        return SectionPoint(state, -point.coordinates)

    def adopted(self, point: SectionPoint) -> SectionPoint:
        """A point with other numbers of modes, or of other gaps."""
        return _section_point(resumed(self.joint, point))

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March on and carry all deviations along."""
        motion = march(self.joint, _coordinates(start), 0.0, half_periods * self.period / 2)
        n = start.coordinates.size
        carried = _carried_along(self.joint.tables, motion.log, np.eye(n))
        size = 2 * self.joint.count(motion.end.state)
        matrix = carried[-1][:size]
        if motion.end.state != start.state:
            S = self.joint.passage(motion.end.state, start.state).S
            matrix = np.kron(np.eye(2), S) @ matrix
        return Linearised(_section_point(motion.end), matrix, lambda: _segments(self.joint, motion, carried))

    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        now, points, growth = _coordinates(start), [], np.zeros(periods)
        total = np.zeros(len(self.problem.stops))
        for i in range(periods):
            motion = march(self.joint, now, 0.0, self.period)
            d = _carried_along(self.joint.tables, motion.log, deviation[:, None].copy())[-1][:, 0]
            deviation = d[: 2 * self.joint.count(motion.end.state)]
            size = self.norm(deviation)
            growth[i] = math.log(size)
            deviation = deviation / size
            now = motion.end
            total += motion.penetration
            points.append(_section_point(now))
        return Followed(tuple(points), self._impulses(total), 0, growth, deviation)


def _coordinates(point: SectionPoint) -> Coordinates:
    return Coordinates(point.state, point.coordinates[0], point.coordinates[1])


def _section_point(point: Coordinates) -> SectionPoint:
    return SectionPoint(point.state, np.stack([point.q, point.v]))


@njit(cache=True)
def _carried_along(tables: Any, log: Any, deviations: Any) -> Any:
    rows = 2 * log.q.shape[1]
    result = np.zeros((log.slot.size + 1, rows, deviations.shape[1]))
    now = deviations.copy()
    result[0, : now.shape[0]] = now
    for i in range(log.slot.size):
        _flow(tables, log.slot[i], log.end[i] - log.start[i], now)
        if log.stop[i] >= 0 and i + 1 < log.slot.size:
            now = _saltation(tables, log, i, now)
        result[i + 1, : now.shape[0]] = now
    return result


def _segments(joint: Joint, motion: March, carried: Any) -> tuple[Segment, ...]:
    from analytic import kernel

    log, harmonics, problem = motion.log, joint.harmonics, joint.problem
    result = []
    for i in range(log.slot.size):
        state = joint.state_in(int(log.slot[i]))
        model = joint.model(state)
        n = model.size
        q, v = log.q[i, :n], log.v[i, :n]
        theta = harmonics.theta(float(log.start[i]))
        c, poly = kernel.amplitudes(q, v, theta, harmonics.omega, model.kind, model.roots, model.static, model.harmonic)
        kind, roots = model.kind, model.roots
        split = np.flatnonzero(kind == SPLIT)
        dq, dv = carried[i][:n], carried[i][n : 2 * n]
        dev = np.zeros((n + split.size, dq.shape[1]), dtype=complex)
        rates = np.concatenate([np.where(kind == DRIFTING, 0, roots[:, 0]), roots[split, 1], 1j * harmonics.omega])
        osc = kind == OSCILLATING
        a, b = roots[osc, 0].real[:, None], roots[osc, 0].imag[:, None]
        dev[:n][osc] = dq[osc] - 1j * (dv[osc] - a * dq[osc]) / b
        if split.size:
            r1, r2 = roots[split, 0].real[:, None], roots[split, 1].real[:, None]
            dev[split] = (dv[split] - r2 * dq[split]) / (r1 - r2)
            dev[n:] = (r1 * dq[split] - dv[split]) / (r1 - r2)
        at = model.at_stops
        drifting = kind == DRIFTING
        drift = np.stack([at[:, drifting] @ dq[drifting], at[:, drifting] @ dv[drifting]], axis=1)
        forced = at @ model.harmonic.T + model.residual_at_stops[1:].T
        polynomial = at @ poly
        polynomial[:, 0] += model.residual_at_stops[0]
        amplitudes = np.concatenate([c[:, 0], c[split, 1], -1j * np.exp(1j * theta)])
        weights = np.concatenate([at, at[:, split], forced], axis=1)
        result.append(
            Segment(
                start=float(log.start[i]),
                end=float(log.end[i]),
                closed=np.array([k in state for k in range(len(problem.stops))]),
                rates=rates,
                weights=weights.astype(complex),
                amplitudes=amplitudes,
                polynomial=polynomial,
                deviations=dev,
                drift=drift,
                switched=int(log.stop[i]),
            )
        )
    return tuple(result)
