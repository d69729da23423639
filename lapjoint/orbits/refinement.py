r"""How far an answer is from the truth, from how far it is from that of a finer self of its solver.

Let e be the error of an answer and e' that of the same answer at `ratio` = r times the resolution.  If the error falls
with the p-th power of the resolution or faster, |e'| <= |e| / r^p.  Only the difference d = e - e' is seen, and so

    |e| <= |d| + |e'|,    |e'| <= |d| / (r^p - 1).

A single number's d can be small by chance while its e' is not, for numbers converge irregularly, and change sign on the
way; numbers of one motion share its error.  So the second term takes the largest |d| of all of them.  `SAFETY` is for
what does not converge as fast as that.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from lapjoint.problem import FloatArray

SAFETY = 3.0
"""Stated errors over those that the order of convergence gives: where a mesh hardly resolves contacts of a stiff stop,
one in twenty true errors is larger than those, up to three times."""
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

    def bounds(self, differences: FloatArray, largest: FloatArray | float) -> FloatArray:
        """Errors of numbers of one motion, from their differences.

        Parameters
        ----------
        differences : FloatArray, shape (n,)
            Differences between the two solvers, of any sign, in one unit.
        largest : FloatArray, shape (n,), or float
            Largest difference of those numbers that share an error with each.

        Returns
        -------
        FloatArray, shape (n,)
            In the same unit.
        """
        return np.asarray(SAFETY * (np.abs(differences) + largest / math.expm1(self.order * math.log(self.ratio))))


def one_after_other(steps: Sequence[Refinement]) -> Refinement:
    """Several refinements, each of the finer self of the one before, as one.

    Parameters
    ----------
    steps : sequence of Refinement
        One or more.

    Returns
    -------
    Refinement
        What is known of the finest solver.
    """
    return Refinement(steps[-1].name, math.prod(one.ratio for one in steps), min(one.order for one in steps))
