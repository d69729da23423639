r"""A stepped cantilever with a mass at its tip under viscous damping, shaken by its base: the vibration that remains.

Every segment, with complex amplitudes z(x, t) = Im(Z(x) exp(i t w)) under a base that moves by Y sin(w t), obeys

    EI Z'''' = (m w^2 - i w C) Z + m w^2 Y,

so that Z is a constant and four exponentials; displacement, slope, moment and shear go through the step, the root is
clamped, and the tip mass M with its rotary inertia J gives EI Z'' = w^2 J Z' and EI Z''' = -w^2 M (Z + Y) at the tip.
The constants follow from one linear system, by numpy alone.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class DraggedCantilever:
    """Two segments from the root to the tip, a mass at the tip, and the base."""

    lengths: tuple[float, float]
    """m."""
    stiffness: tuple[float, float]
    """EI, N m2."""
    inertia: tuple[float, float]
    """m, kg/m."""
    mass: float
    """M, kg."""
    rotary: float
    """J, kg m2."""
    drag: float
    """C, N s/m2."""
    amplitude: float
    """Y, m."""
    omega: float
    """w, rad/s."""

    def evaluate(self, x: FloatArray, t: FloatArray, dx: int = 0) -> FloatArray:
        """z or an x-derivative at places, m, ``(n,)``, and times, s, ``(m,)``: m^(1 - dx), ``(n, m)``."""
        rates, particular, constants = self._solved()
        found = np.zeros(x.size, dtype=complex)
        for i, at in enumerate(x.tolist()):
            s = int(at > self.lengths[0])
            local = at - s * self.lengths[0]
            found[i] = (self._waves(rates[s], s, local, dx)) @ constants[4 * s : 4 * s + 4]
            found[i] += particular[s] if dx == 0 else 0.0
        return np.asarray(np.imag(np.outer(found, np.exp(1j * self.omega * t))))

    def _waves(self, rates: np.ndarray, s: int, x: float, dx: int) -> np.ndarray:
        """The exponentials of a segment, or a derivative, each at most 1 in the segment, ``(4,)``."""
        return np.asarray(rates**dx * np.exp(rates * x - np.maximum(rates.real, 0.0) * self.lengths[s]))

    def _solved(self) -> tuple[list[np.ndarray], list[complex], np.ndarray]:
        """Exponents of both segments, 1/m, their constant parts and the factors of the exponentials, m, ``(8,)``."""
        w, rates, particular = self.omega, [], []
        for EI, m in zip(self.stiffness, self.inertia, strict=True):
            fourth = complex(m * w**2, -w * self.drag)
            rates.append((fourth / EI) ** 0.25 * np.array([1, 1j, -1, -1j]))
            particular.append(-m * w**2 * self.amplitude / fourth)
        matrix, right = np.zeros((8, 8), dtype=complex), np.zeros(8, dtype=complex)
        (a, b), (EI, EJ) = self.lengths, self.stiffness
        for d in (0, 1):
            matrix[d, :4] = self._waves(rates[0], 0, 0.0, d)
        right[0] = -particular[0]
        for d, (one, other) in enumerate(((1.0, 1.0), (1.0, 1.0), (EI, EJ), (EI, EJ))):
            matrix[2 + d, :4] = one * self._waves(rates[0], 0, a, d)
            matrix[2 + d, 4:] = -other * self._waves(rates[1], 1, 0.0, d)
        right[2] = particular[1] - particular[0]
        tip = [self._waves(rates[1], 1, b, d) for d in range(4)]
        matrix[6, 4:] = EJ * tip[2] - w**2 * self.rotary * tip[1]
        matrix[7, 4:] = EJ * tip[3] + w**2 * self.mass * tip[0]
        right[7] = -(w**2) * self.mass * (self.amplitude + particular[1])
        size = np.abs(matrix).max(axis=1)
        return rates, particular, np.linalg.solve(matrix / size[:, None], right / size)
