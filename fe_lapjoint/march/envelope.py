"""Bounds on how a motion strays from what its value and its rate promise, term by term.

A place's motion is a sum of terms f that die away: exponentials, of which a fast one may be faint.  Over a time w, f
strays from its tangent by at most w^2 max|f''| / 2, and also by 2 w max|f'|; from its chord by w^2 max|f''| / 8, and by
2 max|f|.  The smaller bound counts.  So a mode of a million rad/s that rounding alone excites, or that has died away,
does not shorten the steps of a search, and one that an impact has excited does.
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
    """Bounds on ``m`` terms at ``p`` places, each times exp(-fading (t - start)) from a time t on.

    A term is the motion of a mode, or of whatever else moves, times its share in the motion of a place.
    """

    start: float
    """s."""
    fading: FloatArray
    """Rate at which each bound falls, 1/s, shape ``(m,)``."""
    shares: FloatArray
    """Moduli of the shares, shape ``(p, m)``; with the bounds below they give m, m/s and m/s2."""
    value: FloatArray
    """On \\|f\\| over its share, shape ``(m,)``; infinite for what grows."""
    slope: FloatArray
    """On \\|f'\\| over its share, shape ``(m,)``; infinite for what grows."""
    curvature: FloatArray
    """On \\|f''\\| over its share, shape ``(m,)``."""

    def from_chord(self, t: FloatArray, width: float) -> FloatArray:
        """How far the motion of each place may rise above the higher end of an interval.

        Parameters
        ----------
        t : FloatArray, shape (i,)
            Where intervals begin, s.
        width : float
            Their width, s.

        Returns
        -------
        FloatArray, shape (p, i)
            m.
        """
        return np.asarray(_from_chord(self.shares, self.fading, self.value, self.curvature, t - self.start, width))

    def from_tangent(self, place: int, t: float, width: float) -> tuple[float, float]:
        """How far the motion of a place, and its rate, may stray from their values at a time.

        Parameters
        ----------
        place : int
            Which place.
        t : float
            The time, s.
        width : float
            For how long after it, s.

        Returns
        -------
        float, float
            By how much it may leave its tangent, m: by no more than the part s / width of that after s; and by how much
            its rate may change, m/s.
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
    """How far the motion of one place may rise above the higher end of an interval.

    Parameters
    ----------
    shares, fading, value, curvature : FloatArray, shape (m,)
        As in `Envelope`, of the place.
    since : float
        When the interval begins, s from the start.
    width : float
        Its width, s.

    Returns
    -------
    float
        m.
    """
    above = 0.0
    for k in range(fading.size):
        above += shares[k] * min(2 * value[k], curvature[k] * (width**2 / 8)) * math.exp(-fading[k] * since)
    return above


@njit_called()
def from_tangent(
    shares: FloatArray, fading: FloatArray, slope: FloatArray, curvature: FloatArray, since: float, width: float
) -> tuple[float, float]:
    """How far the motion of one place, and its rate, may stray from their values at a time.

    Parameters
    ----------
    shares, fading, slope, curvature : FloatArray, shape (m,)
        As in `Envelope`, of the place.
    since : float
        The time, s from the start.
    width : float
        For how long after it, s.

    Returns
    -------
    tuple of float
        As `Envelope.from_tangent`, m and m/s.
    """
    stray, turn = 0.0, 0.0
    for k in range(fading.size):
        now, steep, bent = shares[k] * math.exp(-fading[k] * since), 2 * slope[k], curvature[k] * width
        stray += min(steep, bent / 2) * now
        turn += min(steep, bent) * now
    return stray * width, turn
