"""Newton's method for the fixed points of some turns, from near or far, and whether a march is bound for one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fe_lapjoint.march.system import ComplexArray
from fe_lapjoint.turns import Point, Turns
from lapjoint.errors import SolverError
from lapjoint.problem import FloatArray

_STEPS = 14  # of Newton's method; near an orbit the residual squares in each
_PATIENCE = 5  # steps in which the residual must halve
_FARTHEST = 1.5  # relative residual from which on Newton is tried
_FINEST = 1e-13  # relative residual not improved upon
_MARGINAL = 1e-9  # multipliers nearer to the unit circle are on it as far as can be told
_GROWING = 1e-6  # a multiplier above 1 by more than this is no rounding of 1
_TURNING = 1e-6  # of the modulus: an imaginary part above tells a complex pair
_THERE = 1e-8  # relative distance within which a march has reached an orbit
_LINEAR = 0.25  # or else: largest departure from the linearised map, over the step that this map makes
_SLOWER = 0.5  # and over what the slowest multiplier takes off the distance


@dataclass(frozen=True)
class Orbit:
    """A fixed point of `turns` turns."""

    turns: int
    point: Point
    matrix: FloatArray
    """Derivative of the map, in the modes of the point's state, shape ``(2 n, 2 n)``."""
    multipliers: ComplexArray
    """Its eigenvalues, largest modulus first, shape ``(2 n,)``."""
    clearance: float = np.inf
    """Distance to the nearest of the orbit's other points: of its mirror image, if it is not symmetric."""

    @property
    def moduli(self) -> FloatArray:
        """Moduli of the multipliers, descending."""
        return np.abs(self.multipliers)

    @property
    def stable(self) -> bool:
        """Whether all multipliers are within the unit circle, for certain."""
        return bool(self.moduli[0] < 1 - _MARGINAL)

    @property
    def unstable(self) -> bool:
        """Whether a multiplier is outside the unit circle, for certain."""
        return bool(self.moduli[0] > 1 + _GROWING)

    @property
    def spirals_out(self) -> bool:
        """Whether the leading multipliers are a complex pair outside the unit circle."""
        leading = self.multipliers[0]
        return bool(abs(leading) > 1 + _MARGINAL and abs(leading.imag) > _TURNING * abs(leading))


def newton(turns: Turns, point: Point, count: int, tolerance: float) -> Orbit | None:
    """A fixed point of `count` turns, from `point`; None if there is none to be found from here."""
    allowed, residuals = _FARTHEST, [np.inf] * _PATIENCE
    for _ in range(_STEPS):
        try:
            turned = turns.after(point, count)
        except SolverError:  # a step of Newton's led out of what can be marched
            return None
        change = turns.seen_from(point.state, turned.end) - point.y
        residual = turns.size(change) / max(turns.size(point.y), np.finfo(float).tiny)
        if not ((residual <= allowed and residual < residuals[-_PATIENCE] / 2) or residual <= tolerance):
            return None
        matrix = turns.matrix(point, turned)
        if residual <= tolerance and (residual <= _FINEST or residual > residuals[-1] / 4):
            multipliers = np.linalg.eigvals(matrix).astype(complex)
            return Orbit(count, point, matrix, multipliers[np.argsort(-np.abs(multipliers), kind="stable")])
        allowed = 4 * max(residual, 1e-6)
        residuals.append(residual)
        try:
            y = point.y + np.linalg.solve(np.eye(change.size) - matrix, change)
        except np.linalg.LinAlgError:
            return None
        point = turns.settled(Point(point.state, y))
    return None


def least(turns: Turns, orbit: Orbit, tolerance: float) -> Orbit:
    """The orbit over the fewest turns after which it repeats, with its clearance."""
    point, distances = orbit.point, [np.inf]
    for count in range(1, orbit.turns):
        point = turns.after(point).end
        distance = turns.size(turns.seen_from(orbit.point.state, point) - orbit.point.y)
        if orbit.turns % count == 0 and distance <= 1e-5 * turns.size(orbit.point.y):
            found = newton(turns, orbit.point, count, tolerance)
            if found is not None and found.stable:
                return replace(found, clearance=min(distances))
        distances.append(distance)
    return replace(orbit, clearance=min(distances))


def bound_for(turns: Turns, orbit: Orbit, sections: Sequence[Point]) -> bool:
    """Whether a march, of which `sections` are points `orbit.turns` turns apart, has come into the orbit's basin.

    It has if its last steps went as the linearised map M says: if after - M before is small against (I - M) before,
    the step that M makes.  At any other fixed point the two are equal, so that no neighbouring orbit passes.  It must
    be smaller, too, than what an orbit that attracts slowly takes off the distance, or a motion of many more periods
    around that orbit would pass.  And the march must be well nearer to this point of the orbit than to the others,
    which are fixed points as well.
    """
    away = [turns.seen_from(orbit.point.state, section) - orbit.point.y for section in sections]
    if turns.size(away[-1]) <= _THERE * turns.size(orbit.point.y):
        return True
    if turns.size(away[-1]) > _LINEAR * orbit.clearance:
        return False
    steps = list(pairwise(away))[-2:]
    return len(steps) == 2 and all(_as_linearised(turns, orbit, *step) for step in steps)


def _as_linearised(turns: Turns, orbit: Orbit, before: FloatArray, after: FloatArray) -> bool:
    mapped = orbit.matrix @ before
    departure = turns.size(after - mapped)
    slower = _SLOWER * (1 - float(orbit.moduli[0])) * turns.size(before)
    return departure <= min(_LINEAR * turns.size(before - mapped), slower)
