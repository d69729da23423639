"""Cycles of stress by rainflow counting, and the fatigue damage that they do, of a motion that arrives in stretches.

**Turning points** are the extrema of a cubic through the stresses and their rates at consecutive samples, both of which
the motion gives.  Samples stand `PER_PERIOD` times in a period, and at each switch, where the rate has a kink.  The
error of the cubic falls with the fourth power of the distance of samples.  The same count from every second sample,
whose errors are 16 times as large, therefore tells the error of sampling: the difference between the damages bounds it.

**Cycles** are those of the four-point method (C. Amzallag et al., Int. J. Fatigue 16 (1994) 287), counted by `fatpack`.
Turning points that close no cycle yet, the residue, are all that is carried from stretch to stretch, so that cutting a
motion changes nothing.  At the end of a motion each range of the residue counts as half a cycle, as by ASTM E1049.  A
period that repeats has no residue: the count begins and ends at its largest stress, where all cycles are closed.

**Damage** adds up by Miner's rule, over the material's S-N line.  A mean stress does no damage by itself.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt
from fatpack import find_rainflow_cycles

from lapjoint.answers.history import History
from lapjoint.problem import FloatArray, Problem, SNLine
from lapjoint.summaries.distributions import BINS, bins_of

PER_PERIOD = 16
"""Samples in a period of the fastest mode that is resolved: a cubic through them misses 1e-4 of its amplitude."""
MOST = 1 << 14
"""Largest number of samples of one period."""
AT_ONCE = 1024
"""Largest number of samples that are evaluated at once, to bound the memory."""


class Rainflow:
    """The rainflow count of one series of turning points, in stretches."""

    def __init__(self) -> None:
        self._residue = np.zeros(0)
        """Turning points that close no cycle yet, and the last value, which may not turn; Pa."""

    def take(self, values: FloatArray) -> FloatArray:
        """Ranges of the cycles that close, (cycles,), when values, (n,), follow that contain all turning points."""
        points = turning_points(np.concatenate([self._residue, values]))
        if points.size < 3:
            self._residue = points
            return np.zeros(0)
        closed, left = _counted(points[:-1])  # the last one may not be a turning point yet
        self._residue = np.append(left, points[-1])
        return closed

    def rest(self) -> tuple[FloatArray, FloatArray]:
        """The last cycles that close, (cycles,), and the ranges of the residue, half a cycle each, (halves,)."""
        if self._residue.size < 2:
            return np.zeros(0), np.zeros(0)
        closed, left = _counted(self._residue)
        return closed, np.abs(np.diff(left))


def _counted(points: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The ranges of the cycles that turning points, (n,), close, (cycles,), and the points that are left."""
    cycles, left = find_rainflow_cycles(points)
    return np.abs(np.diff(cycles, axis=1)[:, 0]) if len(cycles) else np.zeros(0), left


def turning_points(values: FloatArray) -> FloatArray:
    """The first value, the local extrema, and the last value of a series, (n,)."""
    values = values[np.concatenate([[True], np.diff(values) != 0])] if values.size else values
    if values.size < 3:
        return values
    rises = np.diff(values) > 0
    return np.asarray(values[np.concatenate([[True], rises[1:] != rises[:-1], [True]])])


def of_period(values: FloatArray) -> FloatArray:
    """Ranges of the cycles of one period, (n,), that repeats, (cycles,): all are closed."""
    first = int(np.argmax(values))
    rain = Rainflow()
    closed = rain.take(np.concatenate([values[first:], values[: first + 1]]))
    more, halves = rain.rest()
    if halves.size == 2:  # down from the largest stress and up to it again
        more, halves = np.append(more, halves[:1]), halves[:0]
    return np.concatenate([closed, more, halves])


def turning_parts(t: FloatArray, values: FloatArray, rates: FloatArray) -> list[FloatArray]:
    """Of each row of values, (X, m), at times, s, (m,), a part that has all its extrema: its ends, the extrema of the
    cubics by values and rates, (X, m), and the samples beside them."""
    if t.size < 2:
        return list(values)
    h, a, b = np.diff(t), values[:, :-1], values[:, 1:]
    p, q = rates[:, :-1] * h, rates[:, 1:] * h
    # the rate of the cubic at s, 0 < s < 1, is p + s (2 c2 + 3 c3 s), with these coefficients
    c2, c3 = 3 * (b - a) - 2 * p - q, 2 * (a - b) + p + q
    turns = (p * q <= 0) | ((np.abs(c2) < 3 * np.abs(c3)) & (c2**2 > 3 * c3 * p))
    turns[:, [0, -1]] = True
    rows, a, b, p, c2, c3 = np.nonzero(turns)[0], *(one[turns] for one in (a, b, p, c2, c3))
    big = -(c2 + np.copysign(np.sqrt(np.maximum(c2**2 - 3 * c3 * p, 0.0)), c2))
    with np.errstate(divide="ignore", invalid="ignore"):  # of the two roots, none cancels
        s = np.sort(np.stack([big / (3 * c3), p / big]), axis=0)
        at = a + s * (p + s * (c2 + s * c3))
    at = np.where(s < 1, np.where(s > 0, at, a), b)  # a root that is not inside, or not a number, is an end
    parts = np.stack([a, *at, b], axis=-1)
    return [part.ravel() for part in np.split(parts, np.searchsorted(rows, np.arange(1, values.shape[0])))]


@dataclass
class Damage:
    """What cycles have done at each of ``X`` places."""

    damage: FloatArray
    """Damage by Miner's rule, ``(X,)``."""
    coarse: FloatArray
    """The same from every second sample, ``(X,)``."""
    largest: FloatArray
    """Largest range, Pa, ``(X,)``."""
    counts: FloatArray
    """Number of cycles in each bin of the range, ``(X, BINS)``; half cycles count half."""

    @classmethod
    def zero(cls, places: int) -> Damage:
        """No cycle yet."""
        return cls(np.zeros(places), np.zeros(places), np.zeros(places), np.zeros((places, BINS)))


@dataclass(frozen=True)
class Places:
    """Places of a problem whose material has an S-N line."""

    problem: Problem
    x: FloatArray
    """Positions, m, ``(X,)``."""

    @cached_property
    def lines(self) -> tuple[SNLine | None, ...]:
        """The S-N line of each place; None where the material has none."""
        return tuple(self.problem.line.fatigue_at(x) for x in self.x.tolist())

    def turning(
        self, history: History, rate: float, lo: float, hi: float
    ) -> Iterator[tuple[int, list[FloatArray], list[FloatArray]]]:
        """In parts from `lo` to `hi`, s: the number of samples, and at each place the stresses, Pa, with their
        extrema, from all samples and from half of them; `rate` samples a second."""
        line = self.problem.line
        factor = -(line.stress_per_moment_at(self.x) * line.EI_at(self.x))[:, None]
        for t, second in sample_times(rate, lo, hi, history.switch_times):
            values, rates = (factor * history.field(self.x, t, 2, dt) for dt in (0, 1))
            half = turning_parts(t[second], values[:, second], rates[:, second])
            yield t.size, turning_parts(t, values, rates), half

    def range_at(self, damage: FloatArray) -> FloatArray:
        """The range, Pa, of which one cycle does a damage, (X, ...) both; 0 without an S-N line."""
        return np.array(
            [own * 0.0 if line is None else line.range_at(own) for line, own in zip(self.lines, damage, strict=True)]
        )

    def add(self, to: Damage, fine: Sequence[FloatArray], coarse: Sequence[FloatArray], share: float = 1.0) -> None:
        """Add what cycles of some ranges at each place do, each a `share` of a cycle."""
        for i, (line, ranges) in enumerate(zip(self.lines, fine, strict=True)):
            if line is None:
                continue
            to.damage[i] += share * float(line.damage(ranges).sum())
            to.coarse[i] += share * float(line.damage(coarse[i]).sum())
            to.largest[i] = max(to.largest[i], ranges.max(initial=0.0))
            np.add.at(to.counts[i], bins_of(ranges), share)


class CycleCounter:
    """The cycles of a motion at some places, stretch after stretch, from `rate` samples a second."""

    def __init__(self, places: Places, rate: float) -> None:
        self._places, self._rate = places, rate
        self._counters = [(Rainflow(), Rainflow()) for _ in places.x]
        self._waiting: list[tuple[list[FloatArray], list[FloatArray]]] = []
        """Stresses with their extrema at each place, from all samples and from half of them, not counted yet."""
        self._size = 0

    def take(self, history: History, lo: float, hi: float, at_once: bool = True) -> Damage | None:
        """Read the stress between two times, s; each call begins where the last one ended.

        Gives what the cycles do that have closed since the last count.  Short stretches are counted together, which
        gives None until then, unless it is to be done `at_once`.
        """
        for size, fine, coarse in self._places.turning(history, min(self._rate, rate_of(history)), lo, hi):
            self._waiting.append((fine, coarse))
            self._size += size
        return self._count() if at_once or self._size >= AT_ONCE else None

    def _count(self) -> Damage:
        """What the cycles do that close in all that waits."""
        found, waiting = Damage.zero(self._places.x.size), self._waiting
        self._waiting, self._size = [], 0
        if waiting:
            closed = [
                [one.take(np.concatenate([rows[which][i] for rows in waiting])) for which, one in enumerate(pair)]
                for i, pair in enumerate(self._counters)
            ]
            self._places.add(found, [it[0] for it in closed], [it[1] for it in closed])
        return found

    def finish(self) -> Damage:
        """What the last cycles and the residues do; each range of a residue is half a cycle."""
        found = self._count()
        rests = [[one.rest() for one in pair] for pair in self._counters]
        for part, share in enumerate((1.0, 0.5)):
            self._places.add(found, [it[0][part] for it in rests], [it[1][part] for it in rests], share)
        return found


def damage_of_period(places: Places, history: History, finer: float = 1.0) -> Damage:
    """What the cycles of a motion do that is one period and repeats; from at most `finer` times `MOST` samples."""
    rows: list[tuple[list[FloatArray], list[FloatArray]]] = [([], []) for _ in places.x]
    rate = min(rate_of(history), finer * MOST / (history.end - history.start))
    for _, fine, coarse in places.turning(history, rate, history.start, history.end):
        for row, one, other in zip(rows, fine, coarse, strict=True):
            row[0].append(one)
            row[1].append(other)
    found = Damage.zero(places.x.size)
    ranges = [[of_period(np.concatenate(series)) for series in row] for row in rows]
    places.add(found, [it[0] for it in ranges], [it[1] for it in ranges])
    return found


def rate_of(history: History) -> float:
    """Samples a second that resolve the fastest mode and the excitation of a motion."""
    forces, once = history.problem.forces, 2 * math.pi / (history.end - history.start)
    fastest = max(history.highest_mode or 0.0, forces.fastest, forces.usual_rate, once)
    return PER_PERIOD * fastest / (2 * math.pi)


def sample_times(
    rate: float, lo: float, hi: float, switches: FloatArray
) -> Iterator[tuple[FloatArray, npt.NDArray[np.bool_]]]:
    """Times from `lo` to `hi`, s, (m,), and which remain if every second one is left out, in parts that share an end.

    They are multiples of 1 / rate, and the switches between them.
    """
    k = np.arange(math.floor(lo * rate) + 1, math.ceil(hi * rate))
    for first in range(0, max(k.size, 1), AT_ONCE):
        mine = k[first : first + AT_ONCE]
        a = lo if first == 0 else mine[0] / rate
        b = hi if first + AT_ONCE >= k.size else k[first + AT_ONCE] / rate
        grid = mine / rate
        kept = np.concatenate([[a, b], grid[mine % 2 == 0], switches[(switches > a) & (switches < b)]])
        t = np.unique(np.concatenate([kept, grid]))
        yield t, np.isin(t, kept)
