"""Newton's method for fixed points of the map over some half periods of the excitation: orbits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from lapjoint.answers.steady_state import ComplexArray, SectionPoint
from lapjoint.errors import SolverError
from lapjoint.orbits.approach import Forecast, forecast
from lapjoint.orbits.half_periods import HalfPeriodMarch, HalfPeriods
from lapjoint.orbits.watch import Watch
from lapjoint.problem import FloatArray

RESIDUAL = 1e-9
"""Largest distance between start and end of an orbit, divided by the size of the motion.  One more step of Newton's
method follows, which about squares it."""
FAR = 2.0
"""Largest residual of a guess from which Newton's method is tried, divided by the motion's size."""
_STEPS = 14
"""Largest number of steps of Newton's method: near an orbit two or three are enough, and far from it some steps bring
no progress."""
_PATIENCE = 5
"""Number of steps within which the residual must halve."""
REAL = 1e-6
"""Largest imaginary part of a multiplier that counts as real, divided by its modulus: rounding splits a repeated real
multiplier into a complex pair."""
GROWS = 1e-6
"""A multiplier counts as outside the unit circle if its modulus exceeds 1 by this; a smaller excess is rounding."""
_MARGINAL = 1e-9
"""A multiplier counts as within the unit circle if its modulus is below 1 by this; a smaller difference is rounding."""
BEYOND_ROUNDING = 1 / float(np.finfo(float).eps)
"""Growth of a deviation over a march beyond which rounding at the start alone decides the end."""


@dataclass(frozen=True)
class Orbit:
    """A fixed point of the map over some half periods."""

    half_periods: int
    """Number of half periods after which the motion repeats, mirrored if the number is odd."""
    point: SectionPoint
    """Where the motion begins."""
    residual: float
    """Distance between start and end of the last march, divided by the size of the motion; `point` is one Newton step
    more exact."""
    last: HalfPeriodMarch
    """The march from `point`, or from the point before the last Newton step, where the derivative is nearly the
    same."""

    @property
    def symmetric(self) -> bool:
        """Whether half of the motion mirrors the other half: the orbit has an odd number of half periods."""
        return self.half_periods % 2 == 1

    @property
    def period_multiple(self) -> int:
        """Excitation periods after which the motion repeats."""
        return self.half_periods if self.symmetric else self.half_periods // 2

    @cached_property
    def values(self) -> ComplexArray:
        """Multipliers over `half_periods`, largest modulus first, shape ``(n,)``."""
        values = self.last.multipliers
        return values[np.argsort(-np.abs(values), kind="stable")]

    @cached_property
    def spectrum(self) -> tuple[ComplexArray, ComplexArray]:
        """Multipliers over `half_periods`, largest modulus first, ``(n,)``, and eigenvectors as columns ``(n, n)``."""
        values, vectors = np.linalg.eig(self.last.matrix)
        order = np.argsort(-np.abs(values), kind="stable")
        return values[order].astype(complex), vectors[:, order].astype(complex)

    @cached_property
    def leading(self) -> complex:
        """The multiplier of largest modulus."""
        return complex(self.values[0]) if self.values.size else 0.0

    @property
    def multipliers(self) -> ComplexArray:
        """Multipliers over the motion's whole period, largest modulus first, shape ``(n,)``."""
        return self.values**2 if self.symmetric else self.values

    @property
    def stable(self) -> bool:
        """Whether all multipliers are certainly within the unit circle."""
        return abs(self.leading) < 1 - _MARGINAL

    @property
    def unstable(self) -> bool:
        """Whether a multiplier is certainly outside the unit circle."""
        return abs(self.leading) > 1 + GROWS

    @property
    def spirals_out(self) -> bool:
        """Whether nearby motions leave the orbit in spirals: its leading multipliers are a complex pair outside the
        circle."""
        return self.unstable and abs(self.leading.imag) > REAL * abs(self.leading)

    @cached_property
    def watch(self) -> Watch:
        """The orbit's distances from all stops."""
        return self.last.watch

    def forecast(self, deviation: FloatArray, most: int) -> Forecast:
        """The forecast for a deviation, (n,), from the orbit, see `approach.forecast`; it tests at most `most` periods
        one by one."""
        size = float(np.linalg.norm(self.point.coordinates))
        return forecast(self.watch, self.last.matrix, self.spectrum[1], deviation, size, most)


def find_orbit(half_periods: HalfPeriods, guess: SectionPoint, count: int, farthest: float) -> Orbit | None:
    """A fixed point of the map over `count` half periods, stable or not; None if Newton's method finds none.

    Newton's method ends at once if the residual of the guess is above `farthest`, a fraction of the size of the motion.
    It also ends if deviations grow by more than `BEYOND_ROUNDING`, because rounding then decides where the march ends.
    """
    point, allowed, residuals = guess, farthest, [np.inf] * _PATIENCE
    for _ in range(_STEPS):
        try:
            found = half_periods.linearised(point, count)
            step = half_periods.map.difference(found.end, point)
        except SolverError:  # the solver cannot march from this point
            return None
        residual = half_periods.relative(step, point)
        if not (residual <= RESIDUAL or (residual <= allowed and residual < residuals[-_PATIENCE] / 2)):
            return None
        if not half_periods.growth(found.matrix) <= BEYOND_ROUNDING:
            return None
        try:
            correction = np.asarray(np.linalg.solve(np.eye(step.size) - found.matrix, step), dtype=float)
        except np.linalg.LinAlgError:
            return None
        point = half_periods.map.moved(point, correction)
        if residual <= RESIDUAL:
            return Orbit(count, point, residual, found)
        allowed = 4 * max(residual, 1e-6)
        residuals.append(residual)
    return None
