"""Bounds on how far a motion leaves its tangent at one time, and its chord between two times, summed over its terms.

The motion of a place is a sum of decaying exponentials f; a fast term may have a tiny amplitude.  Over a time w, f
leaves its tangent by at most the smaller of w^2 max|f''| / 2 and 2 w max|f'|, and its chord by at most the smaller of
w^2 max|f''| / 8 and 2 max|f|.  A mode of a million rad/s that rounding alone excites, or that has died away, does not
shorten the steps of a search, because its bound is tiny; a mode that an impact has excited does.
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
    """Bounds on ``m`` terms at ``p`` places: from a time t on, a term stays below its bound times exp(-fading (t -
    start)).

    A term is the motion of a mode or of a rigid body, or the response to a load.  A share is the factor of a term in
    the motion of a place.
    """

    start: float
    """Start of the motion, s."""
    fading: FloatArray
    """Rate at which each bound falls, 1/s, shape ``(m,)``."""
    shares: FloatArray
    """Absolute values of the shares, shape ``(p, m)``; a share times `value`, `slope`, `curvature` is in m, m/s,
    m/s2."""
    value: FloatArray
    """Bound on |f|, divided by the share of the term, shape ``(m,)``; infinite for a term that grows."""
    slope: FloatArray
    """Bound on |f'|, divided by the share of the term, shape ``(m,)``; infinite for a term that grows."""
    curvature: FloatArray
    """Bound on |f''|, divided by the share of the term, shape ``(m,)``."""

    def from_chord(self, t: FloatArray, width: float, places: slice = slice(None)) -> FloatArray:
        """How far `places` may exceed the larger of their values at both ends of an interval, m, shape ``(p, i)``.

        Interval i lasts `width` seconds from `t[i]`, s.
        """
        return np.asarray(
            _from_chord(self.shares[places], self.fading, self.value, self.curvature, t - self.start, width)
        )

    def from_tangent(self, place: int, t: float, width: float) -> tuple[float, float]:
        """How far a place may leave its tangent at time `t`, m, and how far its rate may change, m/s, within `width`
        seconds.

        After s < width seconds the place has left its tangent by at most s / width times that displacement.
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
