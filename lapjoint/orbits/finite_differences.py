"""The derivative of a period map whose solver does not give it, from marches that begin a small step from each
other."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint.answers import History
from lapjoint.answers.steady_state import SectionPoint
from lapjoint.orbits.period_map import Derivative, Followed, Linearised, PeriodMap, rescaled
from lapjoint.orbits.segments import Segment
from lapjoint.problem import FloatArray

_STEP = 1e-6
"""Step of the differences, as a fraction of the size of the motion: the errors by rounding, 1e-16 / 1e-6, and by
curvature, 1e-12, leave ten digits."""
_SMALL = 1e-7
"""Distance between two marches that are followed together, divided by the size of the motion: small enough for linear
growth, and large enough that rounding, 1e-16, leaves nine digits."""
_PER_HALF_PERIOD = 64
"""Least number of samples in half a period: parabolas between the samples then follow the low modes."""


@dataclass(frozen=True)
class FiniteDifferences:
    """The derivative of a period map; see `lapjoint.orbits.period_map.Tangent` and `Follows`."""

    map: PeriodMap

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """March from a section point, and from two neighbours for each coordinate.  See `lapjoint.orbits.Tangent`."""
        end = self.map.march(start, half_periods).end
        periods, until = math.ceil(half_periods / 2), half_periods * self.map.period / 2
        history = self.map.history(start, periods)
        times, switched = _samples(history, until)
        n = self.map.difference(start, start).size
        size = max(self.map.size(start), self.map.size(end))
        matrix, moves = np.zeros((n, n)), np.zeros((len(self.map.problem.stops), times.size, n))
        for i in range(n):
            unit = np.zeros(n)
            unit[i] = _STEP * size / self.map.norm(np.eye(n)[i])
            ends, z = [], []
            for sign in (1, -1):
                beside = self.map.moved(start, sign * unit)
                ends.append(self.map.difference(self.map.march(beside, half_periods).end, start))
                z.append(_at_stops(self.map.history(beside, periods), times))
            matrix[:, i] = (ends[0] - ends[1]) / (2 * unit[i])
            moves[:, :, i] = (z[0] - z[1]) / (2 * unit[i])
        return Linearised(end, lambda: Derivative(matrix), lambda: _segments(history, times, switched, moves))

    def followed(self, start: SectionPoint, deviation: FloatArray, periods: int) -> Followed:
        """March together with a neighbour whose distance is reset each period.  See `lapjoint.orbits.Follows`."""
        now, points, growth = start, [], np.zeros(periods)
        impulses, switches = np.zeros((periods, len(self.map.problem.stops))), 0
        for i in range(periods):
            passage = self.map.march(now, 2)
            length = _SMALL * max(self.map.size(now), self.map.size(passage.end), np.finfo(float).tiny)
            beside = self.map.march(self.map.moved(now, length * deviation), 2).end
            now = passage.end
            size, deviation = rescaled(self.map.difference(beside, now) / length, self.map.norm)
            growth[i] = math.log(size)
            impulses[i] = passage.impulses
            switches += passage.switches
            points.append(now)
        return Followed(tuple(points), impulses, switches, growth, deviation)


def _samples(history: History, until: float) -> tuple[FloatArray, FloatArray]:
    """Times of samples from 0 to `until`, s, with the switches among them, and the stop that switches then, or -1.

    Both have the shape ``(m,)``.
    """
    stops = {float(time): stop for time, stop in _switches(history) if 0 < time <= until}
    count = max(8, math.ceil(_PER_HALF_PERIOD * until / (history.end - history.start)))
    times = np.unique(np.concatenate([np.linspace(0.0, until, 2 * count + 1), list(stops)]))
    return times, np.array([stops.get(float(time), -1) for time in times], dtype=int)


def _switches(history: History) -> list[tuple[float, int]]:
    """Times of switches from the start of a history, s, and the stops that switch, by time."""
    starts = [(contact.start, contact.stop) for contact in history.contacts if not contact.open_start]
    ends = [(contact.end, contact.stop) for contact in history.contacts if not contact.open_end]
    return sorted((time - history.start, stop) for time, stop in starts + ends)


def _at_stops(history: History, times: FloatArray) -> FloatArray:
    """What the gaps of the P stops see, m, ``(P, m)``, at times from the start of a history, s, ``(m,)``."""
    return history.seen_by_stops(np.minimum(history.start + times, history.end))


def _segments(history: History, times: FloatArray, switched: FloatArray, moves: FloatArray) -> tuple[Segment, ...]:
    """Segments between samples, in which the motion is a parabola in time, and deviations change linearly.

    `times`, s, and `switched`, the stop that switches or -1, have the shape ``(m,)``; `moves` holds the displacement at
    each stop and time by each deviation, m, shape ``(P, m, n)``.
    """
    stops = history.problem.structure.stops
    z = _at_stops(history, times)
    speed = history.seen_by_stops(history.start + times[:-1], 1)
    none = np.zeros(0, dtype=complex)
    segments = []
    for j, width in enumerate(np.diff(times)):
        state = history.state_at(history.start + times[j] + width / 2)
        bend = (z[:, j + 1] - z[:, j] - speed[:, j] * width) / width**2
        segments.append(
            Segment(
                start=float(times[j]),
                end=float(times[j + 1]),
                closed=np.array([k in state for k in range(len(stops))], dtype=bool),
                rates=none,
                weights=np.zeros((len(stops), 0), dtype=complex),
                amplitudes=none,
                polynomial=np.stack([z[:, j], speed[:, j], bend], axis=1),
                deviations=np.zeros((0, moves.shape[2]), dtype=complex),
                drift=np.stack([moves[:, j], (moves[:, j + 1] - moves[:, j]) / width], axis=1),
                switched=int(switched[j + 1]),
            )
        )
    return tuple(segments)
