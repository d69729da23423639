"""Natural frequencies of beams with steps, masses, springs and closed stops in eighty digits; nothing of a solver.

Exact members between nodes have the textbook dynamic stiffness.  With K(omega) of the free degrees of freedom and d_e =
1 - cos s cosh s of each member, s = beta l, the frequencies are the zeros of det K times the product of the d_e, which
has no poles.  Those below omega are counted by Wittrick and Williams: the negative pivots of K, and the clamped
frequencies of the members.  Roots are bracketed by their count, so that none is missed.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import pairwise
from typing import Any

import mpmath as mp
import numpy as np

from analytic.modes.characteristic_equation import Layout
from lapjoint import Problem
from lapjoint.problem import Mass

DIGITS = 80
_CLOSE = 1e-9  # relative distance of two roots, below which they are taken for one of multiplicity two
_REACH = 4  # unknowns of two neighbouring nodes: the matrix is 0 farther from its diagonal


Springs = Sequence[tuple[float, float, float]]
"""Place, m, translational stiffness, N/m, and torsional stiffness, N m, of each spring."""


class ExactBeam:
    """The dynamic stiffness of a beam with nodes `x`, m: EI and inertia of each member, springs, masses."""

    def __init__(
        self,
        x: Sequence[float],
        EI: Sequence[float],
        inertia: Sequence[float],
        springs: Springs,
        masses: Sequence[Mass] = (),
    ) -> None:
        with mp.workdps(DIGITS):
            lengths = [mp.mpf(b) - mp.mpf(a) for a, b in pairwise(x)]
        self.members = [(length, mp.mpf(k), mp.mpf(m)) for length, k, m in zip(lengths, EI, inertia, strict=True)]
        self.spring, self.mass = [mp.mpf(0)] * (2 * len(x)), [mp.mpf(0)] * (2 * len(x))
        for place, *both in springs:
            for j, k in enumerate(both):
                self.spring[2 * x.index(place) + j] += mp.mpf(k)
        for mass in masses:
            for j, size in enumerate((mass.mass, mass.rotary_inertia)):
                self.mass[2 * x.index(mass.x) + j] += mp.mpf(size)
        rows = [(1.0, place / x[-1]) for place, k, _ in springs if k] + [(0.0, 1.0) for *_, k in springs if k]
        self.rigid = 2 - int(np.linalg.matrix_rank(np.array(rows))) if rows else 2

    @classmethod
    def of(cls, problem: Problem, closed: Sequence[int] = ()) -> ExactBeam:
        """A problem's joint with some stops closed."""
        beam, stops = problem.beam, [problem.stops[k] for k in closed]
        parts = [*problem.supports, *problem.masses, *stops]
        x = sorted({0.0, beam.length, *(it.x for it in parts), *(piece.end for piece in beam.pieces)})
        own = [next(p for p in beam.pieces if p.start <= a and b <= p.end) for a, b in pairwise(x)]
        springs = [(it.x, it.translational, it.torsional) for it in problem.supports]
        springs += [(it.x, it.stiffness, 0.0) for it in stops]
        return cls(x, [p.EI for p in own], [p.inertia for p in own], springs, problem.masses)

    @classmethod
    def of_layout(cls, layout: Layout) -> ExactBeam:
        """A uniform beam without masses, whose unit of omega is 1 / L^2 of sqrt(EI / m)."""
        x, one = layout.x.tolist(), [1.0] * layout.spans.size
        springs = list(zip(x, layout.translational.tolist(), layout.torsional.tolist(), strict=True))
        return cls(x, one, one, springs)

    def pivots(self, omega: Any) -> tuple[int, Any]:
        """The number of frequencies below `omega`, and the function whose zeros they are."""
        count, value = 0, mp.mpf(1)
        free = [i for i, spring in enumerate(self.spring) if not math.isinf(spring)]
        K = [[mp.mpf(0)] * len(self.spring) for _ in self.spring]
        for e, (length, EI, m) in enumerate(self.members):
            beta = mp.sqrt(omega) * mp.root(m / EI, 4)
            s = beta * length
            c, sn, ch, sh = mp.cos(s), mp.sin(s), mp.cosh(s), mp.sinh(s)
            d = 1 - c * ch
            value *= d
            forces, moments, turns = EI * beta**3 / d, EI * beta**2 / d, EI * beta / d
            entries = (
                (0, 0, forces * (sn * ch + c * sh)), (0, 1, moments * sn * sh), (0, 2, -forces * (sn + sh)),
                (0, 3, moments * (ch - c)), (1, 1, turns * (sn * ch - c * sh)), (1, 2, -moments * (ch - c)),
                (1, 3, turns * (sh - sn)), (2, 2, forces * (sn * ch + c * sh)), (2, 3, -moments * sn * sh),
                (3, 3, turns * (sn * ch - c * sh)),
            )  # fmt: skip
            for i, j, entry in entries:
                K[2 * e + i][2 * e + j] += entry
                if i != j:
                    K[2 * e + j][2 * e + i] += entry
            k = int(mp.floor(s / mp.pi))
            count += 0 if k == 0 else k - 1 + int((d > 0) == (k % 2 == 0))
        for i in free:
            K[i][i] += self.spring[i] - omega**2 * self.mass[i]
        for p, i in enumerate(free):  # elimination without pivoting: eighty digits are enough
            pivot = K[i][i]
            count += int(pivot < 0)
            value *= pivot
            for j in free[p + 1 : p + _REACH]:
                if K[j][i]:
                    factor = K[j][i] / pivot
                    for q in free[p + 1 : p + _REACH]:
                        K[j][q] -= factor * K[i][q]
        return count, value

    def frequencies(self, count: int, digits: float = 1e-18) -> list[float]:
        """The lowest `count` angular frequencies, rad/s; those of rigid-body modes are 0."""
        with mp.workdps(DIGITS):
            return [0.0] * min(self.rigid, count) + [
                float(self._root(i, digits)) for i in range(self.rigid + 1, count + 1)
            ]

    def _root(self, number: int, digits: float) -> Any:
        """The frequency of a number, counted from 1: halved until it is alone, then by Illinois' secants."""
        low, high = self._bracket(number)
        (below, f), (above, g) = self.pivots(low), self.pivots(high)
        while above - below > 1 and high > low * (1 + _CLOSE):
            middle = mp.sqrt(low * high)
            count, value = self.pivots(middle)
            low, f, below, high, g, above = (
                (low, f, below, middle, value, count) if count >= number else (middle, value, count, high, g, above)
            )
        side = 0
        while high - low > digits * high and above - below == 1:
            middle = (low * g - high * f) / (g - f)
            value = self.pivots(middle)[1]
            if value == 0:
                return middle
            if (value > 0) == (g > 0):
                high, g, f, side = middle, value, f / 2 if side > 0 else f, 1
            else:
                low, f, g, side = middle, value, g / 2 if side < 0 else g, -1
        return (low + high) / 2

    def _bracket(self, number: int) -> tuple[Any, Any]:
        high = mp.mpf(self.members[0][1] / self.members[0][2]) ** 0.5 / sum(length for length, *_ in self.members) ** 2
        while self.pivots(high)[0] < number:
            high *= 16
        low = high / 16
        while self.pivots(low)[0] >= number:
            low, high = low / 16, low
        return low, high
