"""A one-sided power spectral density, given by breakpoints between which log S is linear in log f.

Between two breakpoints S = S1 (f / f1)^b.  With u = log(f2 / f1) and c = log(S2 / S1) + (p + 1) u,

    integral of f^p S df = S1 f1^(p + 1) u (exp(c) - 1) / c.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.problem.schema import FloatArray


@dataclass(frozen=True)
class Density:
    """A density S(f) with breakpoints, and 0 outside of them."""

    frequency: tuple[float, ...]
    """Frequencies of the breakpoints, Hz, positive and ascending; two at least."""
    density: tuple[float, ...]
    """Densities at the breakpoints, square of a unit over Hz, positive."""

    @property
    def lowest(self) -> float:
        """The first breakpoint, Hz."""
        return self.frequency[0]

    @property
    def top(self) -> float:
        """The last breakpoint, Hz."""
        return self.frequency[-1]

    def at(self, f: FloatArray) -> FloatArray:
        """The density at frequencies `f`, Hz, shape (m,): square of the unit over Hz, 0 outside of the breakpoints."""
        inside = (f >= self.lowest) & (f <= self.top)
        found = np.zeros(np.shape(f))
        found[inside] = np.exp(np.interp(np.log(f[inside]), np.log(self.frequency), np.log(self.density)))
        return found

    def moment(self, power: int) -> float:
        """The integral of (2 pi f)^power S over all frequencies, square of the unit over s^power, or infinite.

        With `power` 0 it is the variance of the signal, with 2 the variance of its rate of change, and with -2 the
        variance of its integral over time.
        """
        with np.errstate(over="ignore", invalid="ignore"):
            f, s = np.array(self.frequency), np.log(self.density)
            u = np.diff(np.log(f))
            c = np.diff(s) + (power + 1) * u
            share = np.where(np.abs(c) > 0, np.expm1(c) / np.where(c == 0, 1.0, c), 1.0) * u
            parts = np.exp(s[:-1] + power * np.log(2 * np.pi) + (power + 1) * np.log(f[:-1])) * share
            return float(np.nan_to_num(np.sum(parts), nan=np.inf, posinf=np.inf))
