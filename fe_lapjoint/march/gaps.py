"""The gap functions of an integrated motion, for `fe_lapjoint.march.events`."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from fe_lapjoint.march.propagator import Flow
from lapjoint.problem import FloatArray

Coordinates = Callable[[FloatArray, int], FloatArray]
"""A function of times, s, shape ``(m,)``, and of a number dt from 0 to 2.

It gives the dt-th derivative of the modal displacements, kg^1/2 m over s^dt, shape ``(n, m)``.
"""


@dataclass(frozen=True)
class FlowGaps:
    """The gap functions, orientation z - offset, of an exact flow; see `fe_lapjoint.march.events.Gaps`."""

    flow: Flow
    orientation: FloatArray
    """+1 or -1, shape ``(P,)``; see `Model.orientation`."""
    offset: FloatArray
    """m, shape ``(P,)``; see `Model.offset`."""

    def __call__(self, t: FloatArray) -> FloatArray:
        """All gap functions, m, at the times ``(m,)``, shape ``(P, m)``."""
        return np.asarray(self.orientation[:, None] * self.flow.at_stops(t) - self.offset[:, None])

    def at(self, k: int, t: float) -> tuple[float, float]:
        """One gap function and its rate. See `fe_lapjoint.march.events.Gaps.at`."""
        z, rate = self.flow.at_stop(k, t)
        return float(self.orientation[k] * z - self.offset[k]), float(self.orientation[k] * rate)


@dataclass(frozen=True)
class SolutionGaps:
    """The gap functions, orientation z - offset, of a library method's dense output."""

    stops: FloatArray
    """Modes at the stops, kg^-1/2, shape ``(P, n)``."""
    coordinates: Coordinates
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

    def curvature(self, start: float, end: float) -> FloatArray:
        """An estimate of the largest |z''| at the stops: twice the largest of 200 samples.

        It is no bound, but dense output gives none.

        Parameters
        ----------
        start, end : float
            The window, s.

        Returns
        -------
        FloatArray, shape (P,)
            m/s2.
        """
        sampled = np.abs(self.stops @ self.coordinates(np.linspace(start, end, 200), 2))
        return np.asarray(2 * sampled.max(axis=1, initial=0.0))
