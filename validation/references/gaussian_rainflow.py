"""Fatigue damage by a Gaussian stress of a known spectrum: by random signals and by formulas, with numpy alone.

**Signals** are sums over a fine grid of frequencies with normal coefficients (S. O. Rice, Bell Syst. Tech. J. 23 (1944)
282), sampled so closely that extrema are missed by less than 1e-3 of an amplitude.  Cycles are counted by the
three-point rule of ASTM E1049-85 (2017), 5.4.4.

**Formulas** give the damage a second of ranges S by N = K S^-m, with the moments m_n of the one-sided density over
(2 pi f)^n, g = m_2 / sqrt(m_0 m_4), and the rates nu = sqrt(m_2 / m_0) / 2 pi of upward crossings of zero and
nu_p = sqrt(m_4 / m_2) / 2 pi of peaks:

- narrow band: D = nu (2 sqrt(2 m_0))^m Gamma(1 + m / 2) / K (J. W. Miles, J. Aeronaut. Sci. 21 (1954) 753), which no
  Gaussian stress exceeds (I. Rychlik, Probab. Eng. Mech. 8 (1993) 1);
- Wirsching and Light, J. Struct. Div. 106 (1980) 1593: D times a + (1 - a) (1 - sqrt(1 - g^2))^b, with
  a = 0.926 - 0.033 m and b = 1.587 m - 2.323;
- Dirlik, PhD thesis, University of Warwick, 1985: nu_p times the mean of S^m over an exponential and two Rayleigh
  distributions.

The numbers of Wirsching and Light and of Dirlik were not read in the originals, but in the public program FLife, which
quotes them.
"""

from __future__ import annotations

import itertools
import math
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

PER_PERIOD = 64
"""Samples in a period of the highest frequency: an extremum is missed by (pi / 64)^2 / 6 of the amplitude in the
mean."""


def ranges_of(values: Array) -> tuple[Array, Array]:
    """Ranges of whole and of half cycles, (n,) and (k,), of a series."""
    rises = np.diff(values) > 0
    turns = values[np.concatenate([[True], rises[1:] != rises[:-1], [True]])].tolist()
    whole, half, points = list[float](), list[float](), list[float]()
    for point in turns:
        points.append(point)
        while len(points) >= 3 and abs(points[-1] - points[-2]) >= abs(points[-2] - points[-3]):
            size = abs(points[-2] - points[-3])
            if len(points) == 3:
                half.append(size)
                del points[0]
            else:
                whole.append(size)
                del points[-3:-1]
    half += [abs(b - a) for a, b in itertools.pairwise(points)]
    return np.array(whole), np.array(half)


@dataclass(frozen=True)
class GaussianStress:
    """A Gaussian stress of mean zero."""

    frequencies: Array
    """Equidistant frequencies of a grid, Hz, (n,)."""
    density: Array
    """One-sided density at the frequencies, Pa2/Hz, (n,)."""
    slope: float
    """m."""
    cycles: float
    """K, Pa^m: one cycle of 1 Pa does the damage 1 / K."""

    def moment(self, order: int) -> float:
        """m_n, Pa2 s^-n."""
        values = self.density * (2 * math.pi * self.frequencies) ** order
        return float(np.trapezoid(values, self.frequencies))

    @property
    def regularity(self) -> float:
        """g, the ratio of crossings of zero to peaks: 1 of a narrow band."""
        return self.moment(2) / math.sqrt(self.moment(0) * self.moment(4))

    def narrow(self) -> float:
        """Damage a second of a narrow band."""
        rate = math.sqrt(self.moment(2) / self.moment(0)) / (2 * math.pi)
        m, twice = self.slope, 2 * math.sqrt(2 * self.moment(0))
        return float(rate * twice**m * math.gamma(1 + m / 2) / self.cycles)

    def wirsching_light(self) -> float:
        """Damage a second by Wirsching and Light."""
        m, width = self.slope, math.sqrt(1 - self.regularity**2)
        a, b = 0.926 - 0.033 * m, 1.587 * m - 2.323
        return float(self.narrow() * (a + (1 - a) * (1 - width) ** b))

    def dirlik(self) -> float:
        """Damage a second by Dirlik."""
        m0, m1, m2, m4 = (self.moment(order) for order in (0, 1, 2, 4))
        g, x, m = self.regularity, m1 / m0 * math.sqrt(m2 / m4), self.slope
        d1 = 2 * (x - g**2) / (1 + g**2)
        r = (g - x - d1**2) / (1 - g - d1 + d1**2)
        d2 = (1 - g - d1 + d1**2) / (1 - r)
        d3 = 1 - d1 - d2
        q = 1.25 * (g - d3 - d2 * r) / d1
        mean = d1 * q**m * math.gamma(1 + m) + 2 ** (m / 2) * math.gamma(1 + m / 2) * (d2 * abs(r) ** m + d3)
        return float(math.sqrt(m4 / m2) / (2 * math.pi) * (2 * math.sqrt(m0)) ** m * mean / self.cycles)

    def simulated(self, signals: int, seed: int) -> tuple[float, float]:
        """Mean damage a second of random signals, each as long as the grid is fine, and its standard error."""
        f, rng = self.frequencies, np.random.default_rng(seed)
        step, first = f[1] - f[0], round(f[0] / (f[1] - f[0]))
        count = 2 ** math.ceil(math.log2(PER_PERIOD * f[-1] / step))
        found = []
        for _ in range(signals):
            spectrum = np.zeros(count // 2 + 1, dtype=complex)
            a, b = rng.standard_normal((2, f.size))
            spectrum[first : first + f.size] = np.sqrt(self.density * step) * (a + 1j * b)
            whole, half = ranges_of(np.fft.irfft(spectrum, count) * (count / 2))
            found.append(((whole**self.slope).sum() + (half**self.slope).sum() / 2) * step / self.cycles)
        return float(np.mean(found)), float(np.std(found, ddof=1) / math.sqrt(signals))
