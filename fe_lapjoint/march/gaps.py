"""The gap functions of an integrated motion, for `fe_lapjoint.march.events`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_lapjoint.march.propagator import Flow
from lapjoint.problem import FloatArray

Coordinates = Callable[[FloatArray, int], FloatArray]
"""Modal displacements (order 0), velocities (1) or accelerations (2) at times ``(m,)``: ``(n, m)``."""


@dataclass(frozen=True)
class FlowGaps:
    """The gap functions of an exact flow; see `fe_lapjoint.march.events.Gaps`."""

    flow: Flow
    orientation: FloatArray
    offset: FloatArray

    def __call__(self, t: FloatArray) -> FloatArray:
        """All at the times ``(m,)``."""
        return np.asarray(self.orientation[:, None] * self.flow.at_stops(t) - self.offset[:, None])

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One and its rate."""
        z, rate = self.flow.at_stop(k, t)
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)


@dataclass(frozen=True)
class SolutionGaps:
    """The gap functions of a library method's dense output."""

    stops: FloatArray
    coordinates: Coordinates
    orientation: FloatArray
    offset: FloatArray

    def __call__(self, t: FloatArray) -> FloatArray:
        """All at the times ``(m,)``."""
        z = self.stops @ self.coordinates(t, 0)
        return np.asarray(self.orientation[:, None] * z - self.offset[:, None])

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One and its rate."""
        z, rate = (float(self.stops[k] @ self.coordinates(np.array([t]), order)[:, 0]) for order in (0, 1))
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)

    def curvature(self, start: float, end: float) -> FloatArray:
        """Twice the largest sampled |z''| at the stops over a window: no bound, but all there is."""
        sampled = np.abs(self.stops @ self.coordinates(np.linspace(start, end, 200), 2))
        return np.asarray(2 * sampled.max(axis=1, initial=0.0))
