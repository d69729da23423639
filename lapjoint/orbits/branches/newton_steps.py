r"""The linear algebra of Newton's method on a curve: its tangent, and the shortest step back to it.

With the derivative J, n x (n + 1), of what vanishes on the curve, the tangent is what J takes to zero.  Neither that
nor the step is singular at a fold, where both come from J^T = Q R.
"""

from __future__ import annotations

import math

import numpy as np

from lapjoint.compiling import njit_called
from lapjoint.problem import FloatArray

_FOLDED = 1e6
"""Largest change of the motion over that of the number, both relative, up to which the curve does not fold: rounding
then takes six of sixteen digits."""


def jacobian(matrix: FloatArray, column: FloatArray, weights: FloatArray) -> FloatArray:
    """[P_x - 1, P_p] in scaled coordinates.

    Parameters
    ----------
    matrix : FloatArray, shape (n, n)
        P_x of a march.
    column : FloatArray, shape (n,)
        P_p times the scale of the number.
    weights : FloatArray, shape (n,)
        `scaling` of the coordinates.

    Returns
    -------
    FloatArray, shape (n, n + 1)
        Dimensionless.
    """
    J = np.empty((weights.size, weights.size + 1))
    _write_jacobian(np.ascontiguousarray(matrix), np.ascontiguousarray(column), weights, J)
    return J


@njit_called()
def _write_jacobian(matrix: FloatArray, column: FloatArray, weights: FloatArray, J: FloatArray) -> None:
    """`jacobian`, written to J: numpy takes two to four times as long for matrices of this size."""
    n = weights.size
    for i in range(n):
        for j in range(n):
            J[i, j] = matrix[i, j] * (weights[i] / weights[j])
        J[i, i] -= 1.0
        J[i, n] = weights[i] * column[i]


def newton_step(J: FloatArray, F: FloatArray, fixed: bool) -> FloatArray:
    """The step of Newton's method.

    Parameters
    ----------
    J : FloatArray, shape (n, n + 1)
        Derivative of F, scaled.
    F : FloatArray, shape (n,)
        What is to vanish, scaled.
    fixed : bool
        Whether the number is to stay as it is.

    Returns
    -------
    FloatArray, shape (n + 1,)
        The shortest (u, w) with J (u, w) = -F, or that with w = 0.
    """
    if fixed:
        return np.append(np.linalg.solve(J[:, :-1], -F), 0.0)
    along, step = tangent_and_step(J, -F)
    return shortest(step, along)


def shortest(step: FloatArray, along: FloatArray) -> FloatArray:
    """A step without its part along the curve.

    Parameters
    ----------
    step : FloatArray, shape (n + 1,)
        (u, w), scaled.
    along : FloatArray, shape (n + 1,)
        The unit tangent.

    Returns
    -------
    FloatArray, shape (n + 1,)
        The rest.
    """
    return step - float(step @ along) * along


def tangent_and_step(J: FloatArray, right: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The unit vector t with J t = 0, and a vector with J y = `right`.

    Parameters
    ----------
    J : FloatArray, shape (n, n + 1)
        `jacobian`.
    right : FloatArray, shape (n,)
        Scaled.

    Returns
    -------
    t, y : FloatArray, shape (n + 1,)
        t has any direction, y any part along t.

    Notes
    -----
    With the number's part of t as one, and of y as zero, its other parts solve one system each.  Where the curve folds
    that system is singular; near there t loses nothing, as its errors are along itself, and y gains too much of t.
    """
    sides, found = np.empty((J.shape[0], 2)), np.zeros((J.shape[1], 2))
    sides[:, 0], sides[:, 1], found[-1, 0] = -J[:, -1], right, 1.0
    try:
        found[:-1] = np.linalg.solve(J[:, :-1], sides)
        size = float(np.linalg.norm(found[:, 0]))
    except np.linalg.LinAlgError:
        size = math.inf
    if size < _FOLDED:
        return found[:, 0] / size, found[:, 1]
    Q, R = np.linalg.qr(J.T, mode="complete")
    return Q[:, -1], Q[:, :-1] @ np.linalg.solve(R[:-1].T, right)
