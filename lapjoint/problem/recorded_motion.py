r"""A motion whose acceleration is continuous and linear between knots, from samples of it, the velocity or
displacement.

*Acceleration* is linear between samples.  *Displacement* is the C2 cubic spline through the samples (not-a-knot).
*Velocity* is the C1 quadratic spline through the samples whose knots lie half-way between them, without the first and
the last (de Boor's not-a-knot condition): knots at the samples would leave one constant free, and a_{k+1} = 2 dv / h -
a_k would carry the noise of every sample on to the end of the record, see docs/theory.md.

Samples inserted on the interpolant do not change it; of velocity only if the points half-way between old samples stay
half-way between new ones, as when each interval is cut into three.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.problem.schema import FloatArray

_GAUSS = np.polynomial.legendre.leggauss(3)  # exact for polynomials of degree 5; integrands have at most 4


@dataclass(frozen=True, eq=False)
class RecordedMotion:
    """A motion with ``K`` knots."""

    time: FloatArray
    """The knots, s, from 0, shape ``(K,)``."""
    acceleration: FloatArray
    """Acceleration at the knots, m/s2, shape ``(K,)``; linear between them."""
    start: tuple[float, float]
    """Displacement, m, and velocity, m/s, at 0."""

    @cached_property
    def _integrals(self) -> tuple[FloatArray, FloatArray]:
        """Velocity, m/s, and displacement, m, at the knots."""
        h, a = np.diff(self.time), self.acceleration
        v = np.append(0.0, np.cumsum(h * (a[:-1] + a[1:]) / 2)) + self.start[1]
        y = np.append(0.0, np.cumsum(h * (v[:-1] + h * (2 * a[:-1] + a[1:]) / 6))) + self.start[0]
        return v, y

    def at(self, t: FloatArray, derivative: int = 0) -> FloatArray:
        """The motion, or its `derivative`-th t-derivative, at times `t`, s, (m,), within the record: m, m/s or m/s2."""
        j = np.clip(np.searchsorted(self.time, t, side="right") - 1, 0, self.time.size - 2)
        (v, y), s = self._integrals, np.asarray(t) - self.time[j]
        a, slope = self.acceleration[j], (np.diff(self.acceleration) / np.diff(self.time))[j]
        if derivative == 2:
            return np.asarray(a + slope * s)
        if derivative == 1:
            return np.asarray(v[j] + s * (a + s * slope / 2))
        return np.asarray(y[j] + s * (v[j] + s * (a / 2 + s * slope / 6)))

    def line(self, derivative: int) -> tuple[float, float]:
        """The straight line nearest to a derivative of the motion, in the mean square over time: its value at mid-time,
        and its slope.

        The value is the mean of the derivative, in m / s^derivative; the slope is in m / s^(derivative + 1).
        """
        T, half = float(self.time[-1]), np.diff(self.time)[:, None] / 2
        t = (self.time[:-1, None] + half + half * _GAUSS[0]).ravel()
        w, values = (half * _GAUSS[1]).ravel(), self.at(t, derivative)
        return float(values @ w) / T, 12 * float((values * (t - T / 2)) @ w) / T**3

    def without(self, derivative: int, value: float, slope: float) -> RecordedMotion:
        """The motion minus a motion whose `derivative`-th derivative is a straight line, given as by `line`."""
        first, (y, v) = value - slope * float(self.time[-1]) / 2, self.start
        if derivative == 2:
            return RecordedMotion(self.time, self.acceleration - first - slope * self.time, self.start)
        if derivative == 1:
            return RecordedMotion(self.time, self.acceleration - slope, (y, v - first))
        return RecordedMotion(self.time, self.acceleration, (y - first, v - slope))


def motion_through(time: FloatArray, values: FloatArray, derivative: int) -> RecordedMotion:
    """The motion whose `derivative`-th derivative, 0 to 2, goes through `values`, m over powers of s, shape (n,).

    Their times `time`, s, ascend from 0, shape (n,). The motion begins at rest as far as the samples leave that open.
    """
    if derivative == 2:
        return RecordedMotion(time, values, (0.0, 0.0))
    from scipy.interpolate import CubicSpline, PPoly, make_interp_spline

    if derivative == 0:
        spline = CubicSpline(time, values)
        return RecordedMotion(time, spline(time, 2), (float(values[0]), float(spline(0.0, 1))))
    found = make_interp_spline(time, values, k=min(2, time.size - 1))
    knots = np.unique(PPoly.from_spline(found).x)
    return RecordedMotion(knots, np.asarray(found(knots, 1), dtype=float), (0.0, float(values[0])))
