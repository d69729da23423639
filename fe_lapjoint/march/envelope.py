"""Bounds on how far a motion strays from its tangent and from its chord, term by term.

A place's motion is a sum of terms f that die away: exponentials, of which a fast one may be faint.  Over a time w, f
strays from its tangent by at most w^2 max|f''| / 2, and also by 2 w max|f'|; from its chord by w^2 max|f''| / 8, and by
2 max|f|.  The smaller bound counts.  A mode of a million rad/s that rounding alone excites, or that has died away, does
not shorten the steps of a search; a mode that an impact has excited does.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint.compiled.arrays import zeros
from lapjoint.compiled.compiling import njit_called, njit_inner
from lapjoint.problem import FloatArray


@dataclass(frozen=True, eq=False)
class Envelope:
    """Bounds on ``m`` terms at ``p`` places from a time t on, each times exp(-fading (t - start)).

    A term is the motion of a mode, of a load's answer or of a rigid body.  A share is the factor of a term in the
    motion of a place.
    """

    start: float
    """Start of the motion, s."""
    fading: FloatArray
    """Rate at which each bound falls, 1/s, shape ``(m,)``."""
    shares: FloatArray
    """Moduli of the shares, shape ``(p, m)``; with the bounds below they give m, m/s and m/s2."""
    value: FloatArray
    r"""Bound on \|f\| over its share, shape ``(m,)``; infinite for a term that grows."""
    slope: FloatArray
    r"""Bound on \|f'\| over its share, shape ``(m,)``; infinite for a term that grows."""
    curvature: FloatArray
    r"""Bound on \|f''\| over its share, shape ``(m,)``."""

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """How far each place may rise above the higher end of intervals from `t`, s, ``(i,)``: m, shape ``(p, i)``."""
        return np.asarray(_from_chord(self.shares, self.fading, self.value, self.curvature, t - self.start, width))

    def from_tangent(self, place: int, t: float, width: float) -> tuple[float, float]:
        """How far a place, m, and its rate, m/s, may stray within `width` seconds from their values at time `t`.

        A part s of that time accounts for at most the part s / width of the displacement.
        """
        since = t - self.start
        stray, turn = from_tangent(self.shares[place], self.fading, self.slope, self.curvature, since, width)
        return float(stray), float(turn)


@njit_called()
def _from_chord(
    shares: FloatArray, fading: FloatArray, value: FloatArray, curvature: FloatArray, since: FloatArray, width: float
) -> FloatArray:
    """See `Envelope.from_chord`; `since` is the time from the start of the motion, s, shape ``(i,)``."""
    result = zeros((shares.shape[0], since.size))
    for u in range(shares.shape[0]):
        for i in range(since.size):
            result[u, i] = from_chord(shares[u], fading, value, curvature, since[i], width)
    return result


@njit_inner()
def from_chord(
    shares: FloatArray, fading: FloatArray, value: FloatArray, curvature: FloatArray, since: float, width: float
) -> float:
    """`Envelope.from_chord`, m, for one place with bounds ``(m,)`` and one interval, `since` seconds after `start`."""
    above = 0.0
    for k in range(fading.size):
        above += shares[k] * min(2 * value[k], curvature[k] * (width**2 / 8)) * math.exp(-fading[k] * since)
    return above


@njit_called()
def from_tangent(
    shares: FloatArray, fading: FloatArray, slope: FloatArray, curvature: FloatArray, since: float, width: float
) -> tuple[float, float]:
    """`Envelope.from_tangent` for one place, with bounds ``(m,)``, `since` seconds after the start: m and m/s."""
    stray, turn = 0.0, 0.0
    for k in range(fading.size):
        now, steep, bent = shares[k] * math.exp(-fading[k] * since), 2 * slope[k], curvature[k] * width
        stray += min(steep, bent / 2) * now
        turn += min(steep, bent) * now
    return stray * width, turn
