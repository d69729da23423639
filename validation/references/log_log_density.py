"""A density that is straight between breakpoints on paper with two logarithmic scales, by numpy alone.

Its integrals are Gauss sums over the logarithm of the frequency: the integrand is a smooth exponential between
breakpoints.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from validation.references.panels import gauss_panels

Array = npt.NDArray[np.float64]


@dataclass(frozen=True)
class LogLogDensity:
    """A one-sided density."""

    breakpoints: tuple[tuple[float, float], ...]
    """Frequency, Hz, and density, the square of a unit over Hz; ascending; nothing lies outside of them."""

    def at(self, f: Array) -> Array:
        """The density, square of the unit over Hz, at frequencies `f`, Hz, shape (n,) both."""
        found = np.zeros(f.size)
        for (f1, s1), (f2, s2) in zip(self.breakpoints, self.breakpoints[1:], strict=False):
            here = (f >= f1) & (f <= f2)
            found[here] = s1 * (f[here] / f1) ** (math.log(s2 / s1) / math.log(f2 / f1))
        return found

    def integral(self, rates: int, power: int = 1) -> float:
        """The integral over the frequency f of ((2 pi f)^(2 rates) S)^power; negative `rates` integrate over time."""
        edges = np.log([f for f, _ in self.breakpoints])
        edges = np.concatenate([np.linspace(a, b, 41)[:-1] for a, b in itertools.pairwise(edges)])
        edges = np.append(edges, math.log(self.breakpoints[-1][0]))
        logarithms, weights = gauss_panels(edges, 8)
        f = np.exp(logarithms)
        return float(weights @ (f * ((2 * math.pi * f) ** (2 * rates) * self.at(f)) ** power))
