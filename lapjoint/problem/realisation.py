r"""A stationary Gaussian signal with a given density; any part of it can be made at any time, without the others.

White noise is filtered by a linear phase filter with finitely many taps g, so that the samples

    a_n = sum over m of g_m w_(n + M - 1 - m)

are Gaussian and exactly stationary, whatever the taps are.  The noise comes in blocks, each from a generator of its
own: `numpy.random.SeedSequence` with the seed, and the numbers of the part and of the block as the spawn key.  The
samples then depend on the seed alone, and not on which of them were asked for before.

*Taps.*  Between samples the signal is linear, which multiplies the density of the samples by sinc^4(f / rate) and
repeats it around multiples of the rate: at rate - f the density is (f / (rate - f))^4 of that at f.  The samples are
therefore given the density S / sinc^4.  The taps are the Fourier series of its square root, under a Kaiser window.  The
window smears the edges over `SMEAR` of the lowest frequency (or of the width of the band, if that is less), and passes
`LEAK` of the amplitude far from them, as long as `MOST_TAPS` taps are enough.  The taps are scaled so that the variance
up to half the rate is that of the density.

*Integrals.*  The taps are symmetric and their sum is 0.  Both integrals over time of the piecewise linear signal are
then filtered noise with as many taps, and exactly stationary: nothing drifts away.
"""

from __future__ import annotations

import math
from functools import lru_cache
from typing import Any

import numpy as np

from lapjoint.problem.density import Density
from lapjoint.problem.schema import FloatArray, IntArray

SMEAR = 0.05
"""Width over which the edges of the density smear, divided by the lowest frequency, or by the width of the band if that
is less."""
LEAK = 1e-5
"""Amplitude that passes far outside of the band, divided by the largest amplitude: 1e-10 of the density."""
MOST_TAPS = 2**20
"""Largest number of taps: a block of samples then takes 8 MB, and its transforms 64 MB."""
_FINER = 4
"""Number of frequencies at which the filter is laid out, divided by the number of taps: 20 of them are within an
edge."""
_LEAST_BLOCK = 2**12
"""Least number of samples in a block: in a shorter block the generator would take longer to make than its numbers."""
_KEPT = 8
"""Number of filters that are cached, of 1 MB each for a band of two decades."""


def _taps_needed(density: Density, rate: float) -> float:
    """Number of taps that limit the width of the edges to `SMEAR`."""
    return _edge_of_one_tap(rate) / (SMEAR * min(density.lowest, density.top - density.lowest))


def _edge_of_one_tap(rate: float) -> float:
    """Width of an edge times the number of taps, Hz, by Kaiser's rule."""
    return (-20 * math.log10(LEAK) - 7.95) / (2.285 * 2 * math.pi) * rate


def edge(density: Density, rate: float) -> float:
    """Width of the range over which the edges of a density smear, Hz, at `rate` samples a second."""
    return _edge_of_one_tap(rate) / min(_taps_needed(density, rate), MOST_TAPS)


@lru_cache(maxsize=_KEPT)
def taps_for(density: Density, rate: float) -> FloatArray:
    """The taps, shape (M,), M odd, that give white noise of unit variance a density, at `rate` samples a second.

    They have the unit of the signal, and are not to be written to. The rate is at least twice the top of the density.
    """
    M = int(min(np.ceil(_taps_needed(density, rate)), MOST_TAPS)) // 2 * 2 + 1
    N = 1 << (_FINER * M - 1).bit_length()
    f = np.asarray(np.fft.rfftfreq(N, 1 / rate), dtype=float)
    interpolated = np.sinc(f / rate) ** 4
    wanted = np.fft.irfft(np.sqrt(density.at(f) * (rate / 2) / interpolated), N)
    window = np.kaiser(M, 0.1102 * (-20 * math.log10(LEAK) - 8.7))  # Kaiser's rule for this leak
    taps = np.roll(wanted, M // 2)[:M] * window
    taps -= window * (taps.sum() / window.sum())
    passed = np.abs(np.fft.rfft(taps, N)) ** 2 @ interpolated * (2 / N)
    taps *= np.sqrt(density.moment(0) / passed)
    taps.flags.writeable = False
    return taps


def integrated(taps: FloatArray, rate: float) -> tuple[FloatArray, FloatArray]:
    """The taps of the first and the second integral over time of the signal that is linear between samples.

    `taps`, shape (M,), are symmetric and 0 in sum; the integrals have their shape, and their unit times s and s^2.
    """
    h, before = 1 / rate, np.append(0.0, taps[:-1])
    first = np.cumsum(h * (before + taps) / 2)
    first = (first - first[::-1]) / 2  # odd, but for rounding
    second = np.cumsum(h * (np.append(0.0, first[:-1]) + h * (2 * before + taps) / 6))
    return first, (second + second[::-1]) / 2


class Realisation:
    """The realisation with a `seed` of a density, `rate` samples a second, linear between samples.

    `part` numbers independent signals with one seed, from 0.
    """

    def __init__(self, density: Density, rate: float, seed: int, part: int) -> None:
        self.density, self.rate, self.seed, self.part = density, rate, seed, part
        self._noise = lru_cache(maxsize=2)(self._made_noise)
        self._filter = lru_cache(maxsize=3)(self._made_filter)
        self._block = lru_cache(maxsize=4)(self._made_block)

    def __reduce__(self) -> tuple[Any, ...]:
        return Realisation, (self.density, self.rate, self.seed, self.part)

    def knots(self, start: float, end: float) -> FloatArray:
        """The times of the samples from `start` to `end`, s, ascending, shape (n,)."""
        found = np.arange(np.floor(start * self.rate), np.ceil(end * self.rate) + 1) / self.rate
        return np.asarray(found[(found >= start) & (found <= end)])

    def at(self, t: FloatArray, integral: int = 0) -> FloatArray:
        """The signal at times `t`, s, shape (m,), from 0 on, integrated over time `integral` times, 0 to 2."""
        t = np.asarray(t, dtype=float)
        n = np.maximum(np.floor(t * self.rate), 0.0)
        n += (n + 1) / self.rate <= t
        n -= (n / self.rate > t) & (n > 0)
        s, at = t - n / self.rate, n.astype(np.int64)
        a = self._samples(at, 0)
        slope = (self._samples(at + 1, 0) - a) * self.rate
        if integral == 0:
            return np.asarray(a + slope * s)
        first = self._samples(at, 1)
        if integral == 1:
            return np.asarray(first + s * (a + s * slope / 2))
        return np.asarray(self._samples(at, 2) + s * (first + s * (a / 2 + s * slope / 6)))

    def _samples(self, n: IntArray, integral: int) -> FloatArray:
        """The samples with numbers `n`, of the signal or an integral of it, shape ``(m,)``."""
        found, block = np.empty(n.size), n // self._size
        for k in np.unique(block).tolist():
            here = block == k
            found[here] = self._block(k, integral)[n[here] - k * self._size]
        return found

    @property
    def _size(self) -> int:
        """Samples in a block: a power of two, not less than the number of taps."""
        M = int(taps_for(self.density, self.rate).size)
        return max(_LEAST_BLOCK, 1 << (M - 1).bit_length())

    def _made_noise(self, k: int) -> FloatArray:
        seeds = np.random.SeedSequence(self.seed, spawn_key=(self.part, k))
        return np.random.Generator(np.random.PCG64(seeds)).standard_normal(self._size)

    def _made_filter(self, integral: int) -> Any:
        taps = taps_for(self.density, self.rate)
        return np.fft.rfft(taps if integral == 0 else integrated(taps, self.rate)[integral - 1], 2 * self._size)

    def _made_block(self, k: int, integral: int) -> FloatArray:
        """Samples of block `k`, by overlap and save, of the noise of this block and the next."""
        M, L = taps_for(self.density, self.rate).size, self._size
        noise = np.concatenate([self._noise(k), self._noise(k + 1)])
        made = np.fft.irfft(np.fft.rfft(noise) * self._filter(integral), 2 * L)[M - 1 : M - 1 + L]
        made.flags.writeable = False
        return made
