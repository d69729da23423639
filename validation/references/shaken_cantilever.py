"""A cantilever with viscous damping under random motion of its base: stationary variances as integrals, by numpy alone.

Relative to a base of acceleration a exp(i omega t), the beam moves as z(x) exp(i omega t) with

    EI z'''' - (m omega^2 - i omega C) z = -m a,

so that, with EI b^4 = m omega^2 - i omega C and w = m a / (m omega^2 - i omega C),

    z = w (1 - A . (exp(-b x), exp(b (x - L)), exp(-i b x), exp(i b (x - L)))),

A from the clamped root and the free tip.  No modes are summed.  The mean square of an answer H a is the integral of
|H|^2 over the one-sided density of a.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from validation.references.panels import gauss_panels

Array = npt.NDArray[np.float64]
ComplexArray = npt.NDArray[np.complex128]


@dataclass(frozen=True)
class ShakenCantilever:
    """The beam."""

    length: float
    """L, m."""
    stiffness: float
    """EI, N m2."""
    mass: float
    """m, kg/m."""
    damping: float
    """C, N s/m2."""

    def answer(self, frequency: Array, x: float, derivative: int) -> ComplexArray:
        """The x-derivative of z, of order 0 to 3, over the acceleration of the base: s^2 m^-derivative, shape (n,), at
        frequencies in Hz, shape (n,), and x in m."""
        omega = 2 * np.pi * frequency
        inertia = self.mass * omega**2 - 1j * omega * self.damping
        b: ComplexArray = np.asarray((inertia / self.stiffness) ** 0.25, dtype=np.complex128)
        weights = self._weights(b)
        shape = _exponentials(b, x - np.array([0.0, self.length, 0.0, self.length]), derivative)
        total = -np.einsum("jn,jn->n", weights, shape)
        return np.asarray((total + (1.0 if derivative == 0 else 0.0)) * self.mass / inertia)

    def absolute_mean_square(self, low: float, high: float, density: float, x: float) -> float:
        """Mean square of the absolute acceleration at x, that of the base included, (m/s2)^2, in a band, Hz, under a
        flat one-sided density of the base's acceleration, (m/s2)^2/Hz."""
        points, weights = self._quadrature(low, high)
        values = np.abs(1 - (2 * np.pi * points) ** 2 * self.answer(points, x, 0)) ** 2
        return float(density * (weights @ values))

    def _weights(self, b: ComplexArray) -> ComplexArray:
        """The weights of exp(-bx), exp(b (x - L)), exp(-ibx) and exp(ib (x - L)), shape ``(4, n)``."""
        offsets = np.array([0.0, self.length, 0.0, self.length])
        rows = [
            _exponentials(b, 0.0 - offsets, 0),
            _exponentials(b, 0.0 - offsets, 1) / b,
            _exponentials(b, self.length - offsets, 2) / b**2,
            _exponentials(b, self.length - offsets, 3) / b**3,
        ]
        matrix = np.moveaxis(np.array(rows), 2, 0)
        given = np.zeros((b.size, 4, 1), dtype=complex)
        given[:, 0] = 1.0  # at the root the motion is that of the base
        return np.asarray(np.linalg.solve(matrix, given)[:, :, 0].T)

    def mean_square(self, low: float, high: float, density: float, x: float, derivative: int, rates: int) -> float:
        """Mean square at x of the x-derivative (order 0 to 3) and t-derivative (order `rates`) of z, m^(2 - 2
        derivative) s^(-2 rates), in a band, Hz, under a flat one-sided density of the base's acceleration,
        (m/s2)^2/Hz."""
        points, weights = self._quadrature(low, high)
        values = np.abs(self.answer(points, x, derivative)) ** 2 * (2 * np.pi * points) ** (2 * rates)
        return float(density * (weights @ values))

    def _quadrature(self, low: float, high: float) -> tuple[Array, Array]:
        """Gauss points and weights, Hz: intervals a fifth of the width of a resonance at most."""
        width = self.damping / self.mass / (2 * np.pi)  # Hz, of each resonance at half its power
        edges = np.linspace(low, high, max(int(np.ceil(5 * (high - low) / width)), 200) + 1)
        return gauss_panels(edges, 8)


def _exponentials(b: ComplexArray, s: Array, derivative: int) -> ComplexArray:
    """exp(-b s), exp(b s), exp(-i b s) and exp(i b s) at distances `s`, ``(4,)``, or an s-derivative; ``(4, n)``."""
    roots = np.array([-1, 1, -1j, 1j])[:, None] * b
    return np.asarray(roots**derivative * np.exp(roots * s[:, None]))
