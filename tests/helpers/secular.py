"""A cantilever that sways from rest, mode by mode in forty digits: exact through resonance, without damping too.

EI = m = L = 1.  Each mode is the oscillator q'' + 2 zeta omega q' + omega^2 q = F sin(Omega t + phase).  Forced and
free motion cancel but for a part of detuning times phase, of which forty digits leave more than twenty.
"""

from __future__ import annotations

import math
from functools import cache
from typing import Any, NamedTuple

import mpmath as mp
import numpy as np

from lapjoint.problem import FloatArray

MODES = 60
_DIGITS = 40
_BESIDE = 1e-25  # relative: so far beside an exact resonance the secular motion is the same to 23 digits


class Wave(NamedTuple):
    """What drives the beam at one frequency."""

    base: float
    """Amplitude of the base, m."""
    tip: float
    """Amplitude of a force at the tip, N."""
    frequency: float
    """rad/s."""
    phase: float
    """rad."""


@cache
def wave_numbers() -> tuple[Any, ...]:
    """beta of the lowest modes, 1/m; their frequencies are beta^2."""
    with mp.workdps(_DIGITS):
        start = [1.875, *((n + 0.5) * math.pi for n in range(1, MODES))]
        return tuple(mp.findroot(lambda b: mp.cos(b) + 1 / mp.cosh(b), x) for x in start)


def tip_from_rest(waves: list[Wave], ratio: float, times: FloatArray) -> FloatArray:
    """Displacement of the tip over the base, m, shape ``(times,)``, at times, s, with a damping ratio of every mode."""
    return np.array([float(_tip(waves, ratio, t)) for t in times.tolist()])


def _tip(waves: list[Wave], ratio: float, t: float) -> Any:
    with mp.workdps(_DIGITS):
        z = mp.mpf(0)
        for n, beta in enumerate(wave_numbers()):
            # of unit norm: 2 (-1)^n at the tip, and 2 sigma / beta as the integral over the beam
            sigma = (mp.sinh(beta) - mp.sin(beta)) / (mp.cosh(beta) + mp.cos(beta))
            tip = 2 * (-1) ** n
            for wave in waves:
                force = wave.base * mp.mpf(wave.frequency) ** 2 * 2 * sigma / beta + wave.tip * tip
                z += tip * _oscillator(force, beta**2, mp.mpf(ratio), mp.mpf(wave.frequency), wave.phase, mp.mpf(t))
        return z


def _oscillator(force: Any, omega: Any, ratio: Any, w: Any, phase: float, t: Any) -> Any:
    """Displacement of one mode that starts from rest."""
    if abs(omega - w) < _BESIDE * w:
        w += _BESIDE * w
    answer = force * mp.expj(phase) / mp.mpc(omega**2 - w**2, 2 * ratio * omega * w)
    x, v = -answer.imag, -w * answer.real
    a, b = ratio * omega, omega * mp.sqrt(1 - ratio**2)
    free = mp.exp(-a * t) * (x * mp.cos(b * t) + (v + a * x) / b * mp.sin(b * t))
    return (answer * mp.expj(w * t)).imag + free
