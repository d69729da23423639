"""Forces that are linear between knots, in blocks, so that endless forces need no more memory than short ones."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property, lru_cache
from typing import Any, Protocol

import numpy as np

from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.realisation import Realisation
from lapjoint.problem.schema import FloatArray, IntArray

KNOTS = 4096
"""Number of intervals in a block, of the random force with the highest rate: a block takes 0.1 MB."""
_EVEN = 1e-9
"""Relative difference of two times between knots, below which it is rounding."""
_KEPT = 4
"""Number of blocks that are cached: a march, and the evaluation of its latest part, need two or three."""
_CREST = 4.0
"""Size of a Gaussian force, divided by its root mean square: the force exceeds this size 6e-5 of the time."""


class SampledForce(Protocol):
    """A force whose size is linear between knots: N of a point load, m/s2 of the inertia of a moving base."""

    @property
    def shape(self) -> LoadShape:
        """Where the force acts."""

    @property
    def end(self) -> float:
        """The last knot, s; infinite where there is none."""

    @property
    def rate(self) -> float | None:
        """Knots per second, Hz, of a force that is made when it is asked for; None for a record."""

    @property
    def usual_rate(self) -> float:
        """Root mean square of the rate of change, divided by that of the force, 1/s; for a sine this is its angular
        frequency."""

    @property
    def size(self) -> float:
        """A magnitude that the force hardly exceeds."""

    def knots_within(self, start: float, end: float) -> FloatArray:
        """The knots from one time to another, s, ascending, shape (K,)."""

    def at(self, t: FloatArray) -> FloatArray:
        """The force at times `t`, s, (m,), up to the end: size, positive upwards."""


@dataclass(frozen=True, eq=False)
class RecordedForce:
    """A recorded force: all its knots are known."""

    shape: LoadShape
    """Where the force acts."""
    knots: FloatArray
    """Times, s, ascending from 0, shape ``(K,)``."""
    values: FloatArray
    """Force at the knots, shape ``(K,)``; positive upwards."""

    @property
    def end(self) -> float:
        """The last knot, s."""
        return float(self.knots[-1])

    @property
    def rate(self) -> None:
        """None: see `SampledForce.rate`."""
        return

    @cached_property
    def usual_rate(self) -> float:
        """See `SampledForce.usual_rate`; 0 for a force that is 0."""
        h, f = np.diff(self.knots), self.values
        square = float(h @ (f[1:] ** 2 + f[1:] * f[:-1] + f[:-1] ** 2)) / 3
        return float(np.sqrt(np.sum(np.diff(f) ** 2 / h) / square)) if square > 0 else 0.0

    @cached_property
    def size(self) -> float:
        """The largest magnitude."""
        return float(np.abs(self.values).max())

    def knots_within(self, start: float, end: float) -> FloatArray:
        """The knots from one time to another. See `SampledForce.knots_within`."""
        return np.asarray(self.knots[(self.knots >= start) & (self.knots <= end)])

    def at(self, t: FloatArray) -> FloatArray:
        """The force at given times. See `SampledForce.at`."""
        return np.asarray(np.interp(t, self.knots, self.values))


@dataclass(frozen=True, eq=False)
class RandomForce:
    """A random force: any part of it is made when it is asked for."""

    shape: LoadShape
    """Where the force acts."""
    realisation: Realisation
    """The signal that it follows."""
    factor: float
    """The force, per unit of the signal."""

    @property
    def end(self) -> float:
        """Infinite: it has no last knot."""
        return np.inf

    @property
    def rate(self) -> float:
        """Knots per second, Hz."""
        return self.realisation.rate

    @property
    def usual_rate(self) -> float:
        """The root mean square of the rate of change, divided by that of the force, 1/s."""
        density = self.realisation.density
        return float(np.sqrt(density.moment(2) / density.moment(0)))

    @property
    def size(self) -> float:
        """`_CREST` times the force's root mean square."""
        return _CREST * abs(self.factor) * float(np.sqrt(self.realisation.density.moment(0)))

    def knots_within(self, start: float, end: float) -> FloatArray:
        """The knots from one time to another. See `SampledForce.knots_within`."""
        return self.realisation.knots(start, end)

    def at(self, t: FloatArray) -> FloatArray:
        """The force at given times. See `SampledForce.at`."""
        return self.factor * self.realisation.at(t)


class SeenBase(Protocol):
    """A motion y(t) of the base whose acceleration is linear between knots."""

    def at(self, t: FloatArray, derivative: int = 0) -> FloatArray:
        """y, or its `derivative`-th t-derivative, at times `t`, s, (m,): m, m/s or m/s2."""


@dataclass(frozen=True, eq=False)
class Ramps:
    """A block of several forces that are linear between common knots."""

    time: FloatArray
    """The knots, s, ascending, shape ``(K,)``."""
    force: FloatArray
    """The forces at the knots, N or N/m, shape ``(K, R)``."""
    step: float | None = None
    """The time between most knots of all blocks, s; None if it is not known."""
    base: FloatArray | None = None
    """Displacement, m, and velocity, m/s, of the base at the knots, shape ``(K, 2)``; None if no stop sees them.  The
    first force is then minus the acceleration of the base."""

    @property
    def end(self) -> float:
        """The last knot, s."""
        return float(self.time[-1])

    @cached_property
    def slope(self) -> FloatArray:
        """Slope of each force from each knot on, N/s or N/(m s), shape ``(K - 1, R)``."""
        return np.diff(self.force, axis=0) / np.diff(self.time)[:, None]

    @cached_property
    def spacing(self) -> float:
        """The time between knots, s, if it is the same for most; else 0."""
        if self.step is not None:
            return self.step
        between = np.diff(self.time)
        middle = float(np.median(between))
        even = np.abs(between - middle) <= _EVEN * (middle + np.abs(self.time[1:]) * np.finfo(float).eps / _EVEN)
        return (float(self.time[-1] - self.time[0]) / between.size if even.all() else middle) if even.any() else 0.0

    def until(self, t: float) -> float:
        """The first knot after a time, s; infinite after the last one."""
        return (
            float(self.time[i]) if (i := int(np.searchsorted(self.time, t, side="right"))) < self.time.size else np.inf
        )

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The forces, N or N/m, and their slopes, N/s or N/(m s), at times `t`, s, shape (m,); each of shape (m, R).

        At a knot the slope is that of the ramp after the knot.  Before the first knot and after the last, the nearest
        ramp is extended.
        """
        j = self._before(t)
        return self.force[j] + self.slope[j] * (t - self.time[j])[:, None], self.slope[j]

    def base_at(self, t: FloatArray) -> FloatArray:
        """Displacement of the base that stops fixed in space see, and three derivatives, at times `t`, s, (m,).

        The shape is (4, m), in m over powers of s; the third derivative jumps at knots, and is that after the knot.
        """
        if self.base is None:
            return np.zeros((4, t.size))
        j = self._before(t)
        s, (y, v), a, jerk = t - self.time[j], self.base[j].T, -self.force[j, 0], -self.slope[j, 0]
        return np.stack([y + s * (v + s * (a / 2 + s * jerk / 6)), v + s * (a + s * jerk / 2), a + s * jerk, jerk])

    def _before(self, t: FloatArray) -> IntArray:
        """The ramp at each time, from 0 to K - 2, shape ``(m,)``."""
        return np.asarray(np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, self.time.size - 2))


class RampBlocks:
    """The knots and values of ``R >= 1`` sampled forces, in blocks, up to the end of the force that ends first.

    Recorded forces are one block.  With random forces, a block has `KNOTS` intervals of the random force with the
    highest rate, and begins and ends at a knot of this force.  The other forces get a knot there, on their ramps.  A
    time on the edge of two blocks belongs to the second block.
    """

    def __init__(self, forces: tuple[SampledForce, ...], base: SeenBase | None = None) -> None:
        self.forces = forces
        self.base = base
        """The motion of the base that stops fixed in space see; the first force is minus its acceleration."""
        self.end = min(force.end for force in forces)
        """Time at which the first force ends, s; infinite if none does."""
        self._fastest = max((force.rate for force in forces if force.rate is not None), default=None)
        self._block = lru_cache(maxsize=_KEPT)(self._made_block)

    def __reduce__(self) -> tuple[Any, ...]:
        return RampBlocks, (self.forces, self.base)

    @property
    def rate(self) -> float:
        """Usual number of knots per second, Hz."""
        if self._fastest is not None:
            return self._fastest
        return 1 / float(np.median(np.diff(self._block(0).time)))

    def block_at(self, t: float) -> Ramps:
        """The block that a time is in, not to be written to; between two blocks, the second."""
        return self._block(int(self._numbers(np.array([t]))[0]))

    def until(self, t: float) -> float:
        """The first knot after a time. See `Ramps.until`."""
        return self.block_at(t).until(t)

    def at(self, t: FloatArray) -> tuple[FloatArray, FloatArray]:
        """The forces and their slopes at given times. See `Ramps.at`."""
        number = self._numbers(t)
        force, slope = np.empty((2, t.size, len(self.forces)))
        for k in np.unique(number).tolist():
            here = number == k
            force[here], slope[here] = self._block(k).at(t[here])
        return force, slope

    def base_at(self, t: FloatArray) -> FloatArray:
        """The base that stops fixed in space see, and three derivatives. See `Ramps.base_at`."""
        number, found = self._numbers(t), np.zeros((4, t.size))
        for k in np.unique(number).tolist() if self.base is not None else ():
            here = number == k
            found[:, here] = self._block(k).base_at(t[here])
        return found

    def _numbers(self, t: FloatArray) -> IntArray:
        """Number of the block that each time is in, shape ``(m,)``."""
        if self._fastest is None:
            return np.zeros(t.size, dtype=np.int64)
        t, length = np.clip(t, 0.0, self.end), KNOTS / self._fastest
        k = np.floor(t / length).astype(np.int64)
        k += self._edge(k + 1) <= t
        k -= self._edge(k) > t
        return np.asarray(k - ((k > 0) & (self._edge(k) >= self.end)))

    def _edge(self, k: IntArray) -> FloatArray:
        """Times at which blocks begin, s, shape ``(m,)``."""
        assert self._fastest is not None
        return np.asarray(k * KNOTS / self._fastest)

    def _made_block(self, k: int) -> Ramps:
        start, end, step = 0.0, self.end, None
        if self._fastest is not None:
            start, end = self._edge(np.array([k, k + 1])).tolist()
            end, step = min(end, self.end), 1 / self._fastest
        time = np.unique(np.concatenate([[start, end], *(force.knots_within(start, end) for force in self.forces)]))
        near = _EVEN * (end - start) / time.size  # knots of two forces, a rounding apart
        time = time[np.append(True, np.diff(time) > near)]
        time[-1] = end
        base = None if self.base is None else np.stack([self.base.at(time, order) for order in (0, 1)], axis=1)
        return Ramps(time, np.stack([force.at(time) for force in self.forces], axis=1), step, base)
