"""Bounds on how a motion strays from what its value and its rate promise, term by term.

A place's motion is a sum of terms f that die away: exponentials, of which a fast one may be faint.  Over a time w, f
strays from its tangent by at most w^2 max|f''| / 2, and also by 2 w max|f'|; from its chord by w^2 max|f''| / 8, and by
2 max|f|.  The smaller bound counts.  So a mode of a million rad/s that rounding alone excites, or that has died away,
does not shorten the steps of a search, and one that an impact has excited does.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

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
        straying = np.minimum(2 * self.value, self.curvature * (width**2 / 8))
        fade = np.exp(np.multiply.outer(self.start - t, self.fading))
        return np.asarray(self.shares @ (straying * fade).T)

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
        now = self.shares[place] * np.exp(self.fading * (self.start - t))
        steep, bent = 2 * self.slope, self.curvature * width
        return float(np.minimum(steep, bent / 2).dot(now)) * width, float(np.minimum(steep, bent).dot(now))
