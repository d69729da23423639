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
    """Bounds on ``m`` terms at ``p`` places, each times exp(-fading (t - start)) from a time t on."""

    start: float
    """s."""
    fading: FloatArray
    """Rate at which each bound falls, 1/s, shape ``(m,)``."""
    value: FloatArray
    """On \\|f\\|, m, shape ``(p, m)``; infinite for what grows."""
    slope: FloatArray
    """On \\|f'\\|, m/s, shape ``(p, m)``; infinite for what grows."""
    curvature: FloatArray
    """On \\|f''\\|, m/s2, shape ``(p, m)``."""

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
        return np.asarray(straying @ np.exp(-np.multiply.outer(self.fading, t - self.start)))

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
        now = np.exp(self.fading * (self.start - t))
        steep, bent = 2 * self.slope[place], self.curvature[place] * width
        return float(np.minimum(steep, bent / 2) @ now) * width, float(np.minimum(steep, bent) @ now)
