"""Steady states of a rigid bar between stops: closed motions, and the fate of deviations from them.

Only marches and finite differences are used, so that nothing is shared with the search on trial.
"""

from __future__ import annotations

import math

import numpy as np

from validation.references.rigid_bar import Array, BarMotion, RigidBar

_DIFFERENCE = 1e-6  # Step of the finite differences over the size of the motion: the cube root of rounding
_REPEATS = 1e-3  # Distance over the size of the motion to which a settled march repeats
_STEPS, _CLOSES = 20, 1e-12
"""Most steps of Newton's method, and the distance over the size of the motion at which it stops."""


def periodic(bar: RigidBar, periods: int = 1, settle: int = 30) -> BarMotion:
    """The motion over `periods` excitation periods that closes, by Newton's method after `settle` periods."""
    begun = bar.march(settle * periods * bar.period)
    y = np.concatenate([begun.u, begun.v])
    for _ in range(_STEPS):
        motion, matrix = linearised(bar, y, periods)
        step = np.linalg.solve(np.eye(y.size) - matrix, motion.y - y)
        y = y + step
        if _size(bar, step) <= _CLOSES * _size(bar, y):
            return bar.march(periods * bar.period, *np.split(y, 2))
    raise ArithmeticError("Newton's method does not close the motion")


def period_multiple(bar: RigidBar, settle: int = 60, most: int = 6) -> int:
    """Excitation periods after which the motion repeats that is reached after `settle` periods; 0 if none do."""
    u, v = bar.initial
    points = []
    for n in range(settle + most + 1):
        if n >= settle:
            points.append(np.concatenate([u, v]))
        # The loads are those of a whole number of periods earlier.
        motion = bar.march(bar.period, u, v)
        u, v = motion.u, motion.v
    for n in range(1, most + 1):
        if _size(bar, points[n] - points[0]) <= _REPEATS * _size(bar, points[0]):
            return n
    return 0


def linearised(bar: RigidBar, y: Array, periods: int = 1) -> tuple[BarMotion, Array]:
    """A march over some excitation periods from y = (u, v), shape (2 n,), and the derivative of its end by its start,
    shape (2 n, 2 n), by differences."""
    scale = np.repeat([1.0, 2 * math.pi / bar.period], y.size // 2) * _size(bar, y) * _DIFFERENCE

    def end(start: Array) -> Array:
        return bar.march(periods * bar.period, *np.split(start, 2)).y

    columns = [(end(y + e) - end(y - e)) / (2 * e.sum()) for e in np.diag(scale)]
    return bar.march(periods * bar.period, *np.split(y, 2)), np.stack(columns, axis=1)


def multipliers(motion: BarMotion) -> Array:
    """Floquet multipliers, complex, shape (2 n,), largest modulus first, of a motion that closes over whole excitation
    periods."""
    first, bar = motion.flows[0], motion.bar
    y = np.concatenate([first.motion(np.array([0.0]), d)[:, 0] for d in (0, 1)])
    found = np.linalg.eigvals(linearised(bar, y, round(motion.flows[-1].end / bar.period))[1])
    return np.asarray(found[np.argsort(-np.abs(found))])


def mirrors_itself(motion: BarMotion) -> bool:
    """Whether z(t + T / 2) = -z(t) over the period T, to a thousandth of the largest displacement."""
    half = motion.flows[-1].end / 2
    t = np.linspace(0.0, half, 40)[1:-1]
    one, other = (np.array([motion.evaluate(x, s) for x in (0.0, motion.bar.length)]) for s in (t, t + half))
    return bool(np.abs(one + other).max() < _REPEATS * np.abs(one).max())


def _size(bar: RigidBar, y: Array) -> float:
    u, v = np.split(y, 2)
    return float(np.linalg.norm(u) + np.linalg.norm(v) * bar.period / (2 * math.pi))
