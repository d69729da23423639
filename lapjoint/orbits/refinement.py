r"""How far an answer is from the truth, from how far it is from that of a finer self of its solver.

Let e be the error of an answer and e' that of the same answer at `ratio` = r times the resolution.  If the error falls
with the p-th power of the resolution or faster, |e'| <= |e| / r^p.  Only the difference d = e - e' is seen, and so

    |e| <= |d| + |e'|,    |e'| <= |d| / (r^p - 1).

A single number's d can be small by chance while its e' is not, for numbers converge irregularly, and change sign on the
way; numbers of one motion share its error.  So the second term takes the largest |d| of all of them.  `SAFETY` is for
what does not converge as fast as that.

A derivative of the displacement converges more slowly than the displacement: each derivative by x multiplies the part
of the k-th mode by k, and each by t by k^2, for frequencies of a beam go with the square of the wave number.  So p is
less by one for each derivative by x, and by two for each by t, down to `LEAST_ORDER`.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from lapjoint.problem import FloatArray

SAFETY = 3.0
"""Stated errors over those that the order of convergence gives: where a mesh hardly resolves contacts of a stiff stop,
one in twenty true errors is larger than those, up to three times."""
LEAST_ORDER = 1.0
"""Power of the resolution with which errors of any derivative fall at least: after a kink of a force the acceleration
of mode k falls with k^-2, and the sum of the modes that are left out with k^-1."""
ROUNDING = 1e-12
"""Relative error that refinement does not show: a switch is located to some 1e-13 of a period, and arithmetic is as
exact."""


@dataclass(frozen=True)
class Refinement:
    """What is known of a finer self of a solver."""

    name: str
    """Name and options of the finer solver."""
    ratio: float
    """Its resolution over that of the solver, above 1."""
    order: float
    """Least power of the resolution with which errors fall, but for few problems."""

    def bounds(self, differences: FloatArray, largest: FloatArray | float, dx: int = 0, dt: int = 0) -> FloatArray:
        """Errors of numbers of one motion, (n,), from their differences between the two solvers, (n,), of any sign, in
        one unit.

        `largest` is the largest difference of the numbers that share an error with each, (n,) or one for all; `dx` and
        `dt` are the orders of the derivatives of the displacement that the numbers are, 0 for those of contacts.
        """
        order = max(self.order - dx - 2 * dt, LEAST_ORDER)
        return np.asarray(SAFETY * (np.abs(differences) + largest / math.expm1(order * math.log(self.ratio))))
