"""Newton's method for a boundary value problem, with one more equation as a border.

With scaled unknowns v = u / scale, the equations F(u) = 0 and the border row . (v - v_guess) = 0 are solved together.
Each step dv solves

    [ F_u scale ] dv = - [ F                   ]
    [ row       ]        [ row . (v - v_guess) ]

Each row of the first block is divided by its largest entry, which makes the rows dimensionless.  After a short step the
next step uses the same derivative: this changes the speed of convergence, not the solution.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace

import numpy as np
from scipy.linalg.lapack import dgetrf, dgetrs

from lapjoint.errors import InputError, SolverError
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem, Linearisation
from lapjoint.problem import FloatArray


@dataclass(frozen=True)
class Solution:
    """A solution of a boundary value problem, with the curve's tangent there."""

    u: FloatArray
    """The unknowns."""
    linearisation: Linearisation
    """Equations and derivative at the solution, or at the point before the last, tiny Newton step."""
    tangent: FloatArray
    """Unit tangent of the curve in scaled unknowns, with a positive product with the border row."""
    orientation: int
    """Sign of the determinant of the derivative bordered by this tangent; the sign is constant along a smooth curve."""


def solve(
    problem: BoundaryProblem, guess: FloatArray, scale: FloatArray, row: FloatArray, exact: bool = False
) -> Solution | None:
    """The solution to which Newton's method leads from a guess, in the hyperplane through the guess with the normal
    `row`.

    `guess`, `scale` (the size of each unknown) and `row` (for scaled unknowns) have shape (n + F + 1,).  With `exact`,
    the derivative is evaluated anew for every step.  None if Newton's method finds no solution.
    """
    options = problem.resolution.options
    u, last, shortest, kept = guess, np.zeros(guess.size), np.inf, False
    last[-1] = 1.0
    try:
        for _ in range(options.newton_iterations):
            kept = not (exact or kept) and shortest <= options.chord  # fast modes may need a new derivative soon
            if not kept:
                found = problem.linearised(u)
                bordered = np.empty((row.size, row.size), order="F")  # as LAPACK takes it
                J = np.multiply(found.jacobian, scale, out=bordered[:-1])
                sizes = np.abs(J).max(axis=1)
                sizes[sizes == 0] = 1.0
                J /= sizes[:, None]
                bordered[-1] = row
                lu, pivots, singular = dgetrf(bordered, overwrite_a=True)
                chain, residual = found.chain, found.residual
                if singular:
                    return None
            else:
                chain = problem.chain(u)
                residual = problem.residual(u, chain)
            right = np.empty(row.size)
            np.divide(residual, sizes, out=right[:-1])
            right[-1] = row @ ((u - guess) / scale)
            step = dgetrs(lu, pivots, right, overwrite_b=True)[0]
            length = math.sqrt(step @ step)
            if not kept:
                if not length <= min(options.newton_radius, options.newton_growth * shortest):
                    return None
                shortest = min(shortest, length)
            elif not length <= shortest:
                continue
            u = u - step * scale
            if length <= options.newton_tolerance:
                tangent = dgetrs(lu, pivots, last)[0]
                turned = np.count_nonzero(lu.diagonal() < 0) + np.count_nonzero(pivots != np.arange(u.size))
                sign = -1 if turned % 2 else 1
                return Solution(u, replace(found, chain=chain), tangent / math.sqrt(tangent @ tangent), sign)
    except (InputError, SolverError):  # there is no such problem, or no such motion
        return None
    return None
