r"""The error of an answer, from its distance to the answer at a finer resolution of its solver.

Let e be the error of an answer, and e' its error at `ratio` = r times the resolution.  If the error falls with the p-th
power of the resolution or faster, |e'| <= |e| / r^p.  Only the difference d = e - e' is known.  From it follow

    |e| <= |d| + |e'|,    |e'| <= |d| / (r^p - 1).

The d of one number can be small by chance although its e' is not, because errors fall irregularly and may change sign.
All numbers of one motion have errors of similar size.  In the bound of |e'| the largest |d| of all these numbers is
therefore taken.  `SAFETY` allows for numbers that converge more slowly than assumed.

A derivative of the displacement converges more slowly than the displacement.  Each derivative by x multiplies the part
of the k-th mode by k, and each derivative by t by k^2, because a beam's frequencies go with the square of the wave
number.  The order p is therefore less by one for each derivative by x, and by two for each by t, down to `LEAST_ORDER`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint.problem import FloatArray

SAFETY = 3.0
"""Factor between the stated error and the error by the order of convergence.  Where a mesh hardly resolves contacts
with a stiff stop, one true error in twenty is larger than the error by the order, up to three times."""
LEAST_ORDER = 1.0
"""Least order of convergence of any derivative: after a kink of a force the acceleration of mode k goes with k^-2, and
the sum of the truncated modes with k^-1."""
ROUNDING = 1e-12
"""Relative error that refinement does not show: the error of located switches, and of arithmetic."""


@dataclass(frozen=True)
class Refinement:
    """A finer resolution of a solver, and the order with which its errors fall."""

    name: str
    """Name and options of the finer solver."""
    ratio: float
    """Resolution of the finer solver divided by that of the solver, above 1."""
    order: float
    """Order of convergence that nearly all problems reach."""

    def bounds(self, differences: FloatArray, largest: FloatArray | float, dx: int = 0, dt: int = 0) -> FloatArray:
        """Errors of numbers of one motion, (n,), from the differences between two solvers, (n,), in one unit.

        `largest` is the largest difference of all numbers with errors of similar size, (n,) or one for all.  `dx` and
        `dt` are the orders of the derivatives of the displacement that the numbers are; both are 0 for numbers of
        contacts.
        """
        order = max(self.order - dx - 2 * dt, LEAST_ORDER)
        return np.asarray(SAFETY * (np.abs(differences) + largest / math.expm1(order * math.log(self.ratio))))
