"""One degree of freedom with elastic stops under white noise: its stationary density in closed form, by numpy alone.

    u'' + gamma u' + U'(u) = a(t),    U = (omega^2 u^2 + k_t (u - g_t)_+^2 + k_b (-u - g_b)_+^2) / 2,

with white a of two-sided density S0 per rad/s, has the stationary density

    p(u, u') = N exp(-(gamma / (pi S0)) (u'^2 / 2 + U)).

This density satisfies the stationary Fokker-Planck equation for any U; substitution shows it.  So u' is Gaussian and
independent of u, and u crosses a level upwards at the rate p(u) sigma / sqrt(2 pi) per second, with the density p(u) of
the displacement and sigma^2 = pi S0 / gamma.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from validation.references.panels import gauss_panels

Array = npt.NDArray[np.float64]
_REACH = 9.0  # Range in standard deviations of the motion without stops: the density beyond is below 1e-17


@dataclass(frozen=True)
class Gibbs:
    """The oscillator between its stops."""

    omega: float
    """Angular frequency without stops, rad/s."""
    gamma: float
    """Viscous damping per unit mass, 1/s."""
    density: float
    """Two-sided density S0 of the acceleration per rad/s, (m/s2)^2 s."""
    top: tuple[float, float]
    """Gap, m, and stiffness per unit mass, 1/s2, of the stop above."""
    bottom: tuple[float, float]
    """Gap, m, and stiffness per unit mass, 1/s2, of the stop below."""

    @property
    def speed(self) -> float:
        """Standard deviation of u', m/s."""
        return math.sqrt(math.pi * self.density / self.gamma)

    def potential(self, u: Array) -> Array:
        """U per unit mass, m2/s2, of displacements in m, shape (n,)."""
        beyond = self.top[1] * np.maximum(u - self.top[0], 0.0) ** 2
        beyond = beyond + self.bottom[1] * np.maximum(-u - self.bottom[0], 0.0) ** 2
        return np.asarray((self.omega**2 * u**2 + beyond) / 2)

    def _grid(self) -> tuple[Array, Array]:
        """Gauss points and weights, m, over `_REACH` standard deviations to either side; stops, where U'' jumps, end an
        interval."""
        reach = _REACH * self.speed / self.omega
        inner = np.clip([-self.bottom[0], self.top[0]], -reach, reach)
        edges = np.unique(np.concatenate([np.linspace(-reach, reach, 2001), inner]))
        return gauss_panels(edges, 8)

    def mean(self, power: int) -> float:
        """The mean of u^power, m^power."""
        u, w = self._grid()
        p = np.exp(-self.potential(u) / self.speed**2)
        return float((w * p) @ u**power / (w @ p))

    def probability(self, low: float, high: float) -> float:
        """The share of time in which the displacement is between two levels, m."""
        u, w = self._grid()
        p = w * np.exp(-self.potential(u) / self.speed**2)
        whole = float(p.sum())
        reach = _REACH * self.speed / self.omega
        low, high = max(low, -reach), min(high, reach)
        edges = np.unique(
            np.concatenate([np.linspace(low, high, 401), np.clip([-self.bottom[0], self.top[0]], low, high)])
        )
        points, weights = gauss_panels(edges, 8)
        return float(weights @ np.exp(-self.potential(points) / self.speed**2)) / whole

    def upcrossings(self, level: float) -> float:
        """Rate at which the displacement crosses a level, m, upwards, 1/s."""
        u, w = self._grid()
        whole = float(w @ np.exp(-self.potential(u) / self.speed**2))
        p = float(np.exp(-self.potential(np.array([level]))[0] / self.speed**2)) / whole
        return p * self.speed / math.sqrt(2 * math.pi)
