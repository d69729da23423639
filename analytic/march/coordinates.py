"""Where a motion is at a moment: a contact state, and the displacements and velocities of its modes."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Coordinates:
    """Modal coordinates in a contact state, at a moment."""

    state: ContactState
    q: FloatArray
    """Modal displacements, kg^1/2 m, shape ``(N,)``."""
    v: FloatArray
    """Modal velocities, kg^1/2 m/s, shape ``(N,)``."""
    held: tuple[int, ...] = ()
    """Stops that may not switch for one period of the fastest mode; see `analytic.march.touching`."""

    @property
    def y(self) -> FloatArray:
        """q, kg^1/2 m, and v, kg^1/2 m/s, in one array, shape ``(2 N,)``."""
        return np.concatenate([self.q, self.v])

    def moved(self, y: FloatArray) -> Coordinates:
        """Coordinates in this contact state with a copy of `y` = (q, v), shape ``(2 N,)``; no stop is held."""
        return Coordinates(self.state, y[: self.q.size].copy(), y[self.q.size :].copy())
