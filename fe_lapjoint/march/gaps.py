"""The gap functions of an integrated motion, for `fe_lapjoint.march.events`."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from fe_lapjoint.march.propagator import Coordinates, Flow
from fe_lapjoint.march.system import SAMPLES
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class FlowGaps:
    """The gap functions, orientation z - offset, of an exact flow; see `fe_lapjoint.march.events.Gaps`."""

    flow: Flow
    orientation: FloatArray
    """+1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """m, shape ``(P,)``; see `Model.offset`."""
    step: float
    """Of the grid that is searched, from the start of the flow on, s."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions, m, at the times ``(m,)``, shape ``(P, m)``."""
        return np.asarray(self.orientation[:, None] * self.flow.at_stops(t) - self.offset[:, None])

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate. See `fe_lapjoint.march.events.Gaps.at`."""
        z, rate = self.flow.at_stop(k, t)
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)

    @cached_property
    def curvature(self) -> FloatArray:
        """Bounds on the curvature, m/s2, ``(P,)``. See `fe_lapjoint.march.events.Gaps.curvature`."""
        envelope, place_of = self.flow.envelope, self.flow.system.place_of
        return np.asarray((envelope.shares @ envelope.curvature)[place_of])

    def at_step(self, k: int, i: int) -> tuple[float, float, float, float]:
        """One gap function and its rate at both ends of a step. See `fe_lapjoint.march.events.Gaps.at_step`."""
        sign, offset = float(self.orientation[k]), float(self.offset[k])
        z, rate, z_end, rate_end = self.flow.at_step(k, self.step, i)
        return sign * z - offset, sign * rate, sign * z_end - offset, sign * rate_end

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """Bounds on what lies between the ends of intervals. See `fe_lapjoint.march.events.Gaps.from_chord`."""
        return np.asarray(self.flow.envelope.from_chord(t, width)[self.flow.system.place_of])

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """Bounds on a gap function. See `fe_lapjoint.march.events.Gaps.ceiling`."""
        above = self.flow.above_troughs(k, side * float(self.orientation[k]), t, width)
        return np.asarray((side * ends - above).max(axis=0) + self.from_chord(t, width)[k])

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """Bounds on what lies ahead. See `fe_lapjoint.march.events.Gaps.from_tangent`."""
        return self.flow.envelope.from_tangent(int(self.flow.system.place_of[k]), t, width)

    @property
    def rounding(self) -> FloatArray:
        """What rounding makes of the gap functions, m, shape ``(P,)``."""
        return np.asarray(self.flow.rounding + np.finfo(float).eps * np.abs(self.offset))


@dataclass(frozen=True)
class SolutionGaps:
    """The gap functions, orientation z - offset, of a library method's dense output."""

    stops: FloatArray
    """Modes at the stops, kg^-1/2, shape ``(P, n)``."""
    coordinates: Coordinates
    start: float
    """The window begins, s."""
    end: float
    """It ends, s."""
    orientation: FloatArray
    """+1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """m, shape ``(P,)``; see `Model.offset`."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions, m, at the times ``(m,)``, shape ``(P, m)``."""
        z = self.stops @ self.coordinates(t, 0)
        return np.asarray(self.orientation[:, None] * z - self.offset[:, None])

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate. See `fe_lapjoint.march.events.Gaps.at`."""
        z, rate = (float(self.stops[k] @ self.coordinates(np.array([t]), dt)[:, 0]) for dt in (0, 1))
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)

    def at_step(self, k: int, i: int) -> tuple[float, float, float, float]:
        """One gap function and its rate at both ends of a step. See `fe_lapjoint.march.events.Gaps.at_step`."""
        begin, end = self.grid[i : i + 2].tolist()
        return *self.at(k, begin), *self.at(k, end)

    @cached_property
    def grid(self) -> FloatArray:
        """The times of the grid that is searched, s, shape ``(SAMPLES + 1,)``."""
        return np.linspace(self.start, self.end, SAMPLES + 1)

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """Estimates for intervals. See `fe_lapjoint.march.events.Gaps.from_chord`."""
        return np.asarray(np.multiply.outer(self.curvature * (width**2 / 8), np.ones_like(t)))

    def ceiling(self, k: int, t: FloatArray, width: float, ends: FloatArray, side: float = 1.0) -> FloatArray:
        """Estimates in place of bounds. See `fe_lapjoint.march.events.Gaps.ceiling`."""
        return np.asarray((side * ends).max(axis=0) + self.from_chord(t, width)[k])

    def from_tangent(self, k: int, t: float, width: float) -> tuple[float, float]:
        """Estimates for what lies ahead. See `fe_lapjoint.march.events.Gaps.from_tangent`."""
        bent = float(self.curvature[k]) * width
        return bent * width / 2, bent

    @cached_property
    def curvature(self) -> FloatArray:
        """Twice the largest of 200 samples of |z''| at the stops, m/s2, shape ``(P,)``.

        It is no bound, but dense output gives none.
        """
        sampled = np.abs(self.stops @ self.coordinates(np.linspace(self.start, self.end, 200), 2))
        return np.asarray(2 * sampled.max(axis=1, initial=0.0))

    @cached_property
    def rounding(self) -> FloatArray:
        """What rounding makes of the gap functions, m, shape ``(P,)``."""
        q = np.abs(self.coordinates(np.array([self.start]), 0)[:, 0])
        return np.asarray(32 * np.finfo(float).eps * (np.abs(self.stops) @ q + np.abs(self.offset)))
