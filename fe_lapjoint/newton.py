"""Newton's method for the fixed points of some turns, from near or far, and whether a march is bound for one."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import pairwise

import numpy as np

from fe_lapjoint.turns import Point, Turns
from lapjoint.problem import FloatArray

_STEPS = 14  # of Newton's method; near an orbit the residual squares in each
_PATIENCE = 5  # steps in which the residual must halve
_FARTHEST = 1.5  # relative residual from which on Newton is tried
_FINEST = 1e-13  # relative residual not improved upon
_MARGINAL = 1e-9  # multipliers nearer to the unit circle are on it as far as can be told
_NEAR = 1e-2  # relative distance within which a march is taken to be bound for a stable orbit
_LINEAR = 0.25  # or else: largest departure from the linearised map, over the deviation


@dataclass(frozen=True)
class Orbit:
    """A stable fixed point of `turns` turns."""

    turns: int
    point: Point
    matrix: FloatArray
    """Derivative of the map, in the modes of the point's state, shape ``(2 n, 2 n)``."""
    moduli: FloatArray
    """Moduli of its eigenvalues, descending, shape ``(2 n,)``."""


def newton(turns: Turns, point: Point, count: int, tolerance: float) -> Orbit | None:
    """A stable fixed point of `count` turns, from `point`; None if there is none to be found from here."""
    allowed, residuals = _FARTHEST, [np.inf] * _PATIENCE
    for _ in range(_STEPS):
        turned = turns.after(point, count)
        change = turns.seen_from(point.state, turned.end) - point.y
        residual = turns.size(change) / max(turns.size(point.y), np.finfo(float).tiny)
        if not ((residual <= allowed and residual < residuals[-_PATIENCE] / 2) or residual <= tolerance):
            return None
        matrix = turns.matrix(point, turned)
        if residual <= tolerance and (residual <= _FINEST or residual > residuals[-1] / 4):
            return _stable(count, point, matrix)
        allowed = 4 * max(residual, 1e-6)
        residuals.append(residual)
        try:
            y = point.y + np.linalg.solve(np.eye(change.size) - matrix, change)
        except np.linalg.LinAlgError:
            return None
        point = turns.settled(Point(point.state, y))
    return None


def _stable(count: int, point: Point, matrix: FloatArray) -> Orbit | None:
    moduli = np.sort(np.abs(np.linalg.eigvals(matrix)))[::-1]
    return Orbit(count, point, matrix, moduli) if moduli[0] < 1 - _MARGINAL else None


def least(turns: Turns, orbit: Orbit, tolerance: float) -> Orbit:
    """The orbit over the fewest turns after which it repeats."""
    size = turns.size(orbit.point.y)
    for count in (n for n in range(1, orbit.turns) if orbit.turns % n == 0):
        end = turns.seen_from(orbit.point.state, turns.after(orbit.point, count).end)
        if turns.size(end - orbit.point.y) <= 1e-5 * size:
            found = newton(turns, orbit.point, count, tolerance)
            if found is not None:
                return found
    return orbit


def bound_for(turns: Turns, orbit: Orbit, sections: Sequence[Point]) -> bool:
    """Whether a march, of which `sections` are points `orbit.turns` turns apart, has come into the orbit's basin.

    It has if it is near, or if the last steps went as the linearised map says: then the deviation is one that
    the map, which is a contraction in the end, governs.
    """
    away = [turns.seen_from(orbit.point.state, section) - orbit.point.y for section in sections]
    if turns.size(away[-1]) <= _NEAR * turns.size(orbit.point.y):
        return True
    steps = list(pairwise(away))[-2:]
    return len(steps) == 2 and all(
        turns.size(after - orbit.matrix @ before) <= _LINEAR * turns.size(before) for before, after in steps
    )
