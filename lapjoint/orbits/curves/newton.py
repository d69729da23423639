r"""Newton's method for a boundary value problem, bordered by one more equation.

With scaled unknowns v = u / scale, the equations F(u) = 0 and the border row . (v - v_guess) = c are solved together:

    [ F_u scale ] dv = [ -F                        ]
    [ row       ]      [ c - row . (v - v_guess)   ]

Rows of the first block are divided by their largest entry, which takes the units from them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.curves.boundary_problem import BoundaryProblem, Linearisation
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Solution:
    """A solution of a boundary value problem, with the curve's tangent there."""

    u: FloatArray
    """The unknowns."""
    linearisation: Linearisation
    """Equations and derivative, there or a last, tiny step before."""
    tangent: FloatArray
    """Unit tangent of the curve in scaled unknowns, towards the border row."""


def solve(
    problem: BoundaryProblem, guess: FloatArray, scale: FloatArray, row: FloatArray, most: int | None = None
) -> Solution | None:
    """The solution nearest to a guess, up to the hyperplane through the guess that a border row is normal to.

    Parameters
    ----------
    problem : BoundaryProblem
        The equations.
    guess : FloatArray, shape (n + M + 1,)
        The unknowns to begin with.
    scale : FloatArray, shape (n + M + 1,)
        Size of each unknown.
    row : FloatArray, shape (n + M + 1,)
        The border, for scaled unknowns.
    most : int, optional
        Largest number of iterations; by default that of the options.

    Returns
    -------
    Solution, or None
        None if Newton's method finds none.
    """
    options = problem.resolution.options
    u, last, shortest = guess, np.zeros(guess.size), np.inf
    last[-1] = 1.0
    try:
        for _ in range(most or options.newton_iterations):
            found = problem.linearised(u)
            A, b = bordered(found, scale, row)
            b[-1] = -float(row @ ((u - guess) / scale))
            if not (np.isfinite(A).all() and np.isfinite(b).all()):
                return None
            step, tangent = np.linalg.solve(A, np.stack([b, last], axis=1)).T
            length = float(np.linalg.norm(step))
            if not length <= min(options.newton_radius, 2 * shortest):
                return None
            shortest = min(shortest, length)
            u = u + step * scale
            if length <= options.newton_tolerance:
                return Solution(u, found, tangent / np.linalg.norm(tangent))
    except (InputError, SolverError, np.linalg.LinAlgError):  # no such problem, or motion
        return None
    return None


def bordered(found: Linearisation, scale: FloatArray, row: FloatArray) -> tuple[FloatArray, FloatArray]:
    """The matrix of Newton's method, and its right side with zero for the border.

    Parameters
    ----------
    found : Linearisation
        Equations and derivative.
    scale : FloatArray, shape (n + M + 1,)
        Size of each unknown.
    row : FloatArray, shape (n + M + 1,)
        The border, for scaled unknowns.

    Returns
    -------
    FloatArray, shape (n + M + 1, n + M + 1)
        The matrix.
    FloatArray, shape (n + M + 1,)
        The right side.
    """
    J = found.jacobian * scale
    sizes = np.abs(J).max(axis=1)
    sizes[sizes == 0] = 1.0
    A = np.concatenate([J / sizes[:, None], row[None]])
    return A, np.append(-found.residual / sizes, 0.0)
