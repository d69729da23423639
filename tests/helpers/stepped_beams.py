"""Natural frequencies of beams with steps, masses and springs in eighty digits; random ones; nothing of a solver.

Exact members between nodes have the textbook dynamic stiffness.  With K(omega) of the free degrees of freedom and d_e =
1 - cos s cosh s of each member, s = beta l, the frequencies are the zeros of det K times the product of the d_e, which
has no poles.  Those below omega are counted by Wittrick and Williams: the negative pivots of K, and the clamped
frequencies of the members.  Roots are bracketed by their count, so that none is missed.
"""

from __future__ import annotations

import math
from typing import Any

import mpmath as mp
import numpy as np

from lapjoint import Beam, Problem, Support
from lapjoint.problem import BeamSegment, Mass

DIGITS = 80
_CLOSE = 1e-9  # relative distance of two roots, below which they are taken for one of multiplicity two


class ExactBeam:
    """The dynamic stiffness of a problem's joint without contact."""

    def __init__(self, problem: Problem) -> None:
        beam = problem.beam
        parts = [*problem.supports, *problem.masses]
        self.x = sorted({0.0, beam.length, *(it.x for it in parts), *(piece.end for piece in beam.pieces)})
        ends = [(self.x[i], self.x[i + 1]) for i in range(len(self.x) - 1)]
        own = [next(p for p in beam.pieces if p.start <= a and b <= p.end) for a, b in ends]
        with mp.workdps(DIGITS):
            self.members = [
                (mp.mpf(b) - mp.mpf(a), mp.mpf(p.EI), mp.mpf(p.inertia)) for (a, b), p in zip(ends, own, strict=True)
            ]
        n = 2 * len(self.x)
        self.spring, self.mass = [mp.mpf(0)] * n, [mp.mpf(0)] * n
        for support in problem.supports:
            for j, k in enumerate((support.translational, support.torsional)):
                self.spring[2 * self.x.index(support.x) + j] += mp.mpf(k)
        for mass in problem.masses:
            for j, size in enumerate((mass.mass, mass.rotary_inertia)):
                self.mass[2 * self.x.index(mass.x) + j] += mp.mpf(size)
        self.free = [i for i in range(n) if mp.isfinite(self.spring[i])]
        rows = [(1.0, s.x / beam.length) for s in problem.supports if s.translational]
        rows += [(0.0, 1.0) for s in problem.supports if s.torsional]
        self.rigid = 2 - int(np.linalg.matrix_rank(np.array(rows))) if rows else 2

    def pivots(self, omega: Any) -> tuple[int, Any]:
        """The number of frequencies below `omega`, and the function whose zeros they are."""
        n, count, value = 2 * len(self.x), 0, mp.mpf(1)
        K = [[mp.mpf(0)] * n for _ in range(n)]
        for e, (length, EI, m) in enumerate(self.members):
            beta = mp.sqrt(omega) * mp.root(m / EI, 4)
            s = beta * length
            c, sn, ch, sh = mp.cos(s), mp.sin(s), mp.cosh(s), mp.sinh(s)
            d = 1 - c * ch
            value *= d
            near, far = EI * beta**3 / d, EI * beta**3 / d
            entries = (
                (0, 0, near * (sn * ch + c * sh)), (0, 1, EI * beta**2 / d * sn * sh), (0, 2, -far * (sn + sh)),
                (0, 3, EI * beta**2 / d * (ch - c)), (1, 1, EI * beta / d * (sn * ch - c * sh)),
                (1, 2, -EI * beta**2 / d * (ch - c)), (1, 3, EI * beta / d * (sh - sn)),
                (2, 2, near * (sn * ch + c * sh)), (2, 3, -EI * beta**2 / d * sn * sh),
                (3, 3, EI * beta / d * (sn * ch - c * sh)),
            )  # fmt: skip
            for i, j, entry in entries:
                K[2 * e + i][2 * e + j] += entry
                if i != j:
                    K[2 * e + j][2 * e + i] += entry
            k = int(mp.floor(s / mp.pi))
            count += 0 if k == 0 else k - 1 + int((d > 0) == (k % 2 == 0))
        for i in self.free:
            K[i][i] += self.spring[i] - omega**2 * self.mass[i]
        for p, i in enumerate(self.free):  # elimination without pivoting: eighty digits are enough
            pivot = K[i][i]
            count += int(pivot < 0)
            value *= pivot
            for j in self.free[p + 1 : p + 5]:
                if K[j][i]:
                    factor = K[j][i] / pivot
                    for q in self.free[p + 1 : p + 5]:
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


def random_problem(rng: np.random.Generator, *, ratio: float = 1e3, heaviest: float = 1e3) -> Problem:
    """A beam of up to four segments, on springs and fixed supports, with up to three masses; L = 1 m or so.

    `ratio` is that of stiffness from segment to segment, at most; `heaviest` the largest mass over that of the beam.
    """
    L = float(rng.uniform(0.5, 3.0))
    number = int(rng.integers(1, 5))
    cuts = np.sort(rng.uniform(0.05, 0.95, number - 1))
    while number > 1 and np.diff([0.0, *cuts, 1.0]).min() < 0.03:
        cuts = np.sort(rng.uniform(0.05, 0.95, number - 1))
    ends = [*(float(cut * L) for cut in cuts), L]
    EI = [float(10 ** rng.uniform(0, math.log10(ratio))) for _ in ends]
    m = [float(10 ** rng.uniform(0, math.log10(ratio) / 2)) for _ in ends]
    segments = tuple(
        BeamSegment(to=to, bending_stiffness=a, mass_per_length=b) for to, a, b in zip(ends, EI, m, strict=True)
    )
    beam = Beam(length=L, segments=segments)
    masses = []
    for _ in range(int(rng.integers(0, 4))):
        size = float(10 ** rng.uniform(-3, math.log10(heaviest))) * beam.m * L
        x = float(rng.choice([0.0, L, rng.uniform(0.1, 0.9) * L, ends[0]]))
        turning = float(10 ** rng.uniform(-5, 0)) * size * L**2 if rng.random() < 0.5 else 0.0
        masses.append(Mass(x=x, mass=size, rotary_inertia=turning))
    unit = beam.EI / L**3
    kind = rng.integers(0, 4)
    if kind == 0:
        supports: tuple[Support, ...] = (Support(x=0.0, translational=math.inf, torsional=math.inf),)
    elif kind == 1:
        supports = (Support(x=0.0, translational=math.inf), Support(x=L, translational=math.inf))
    elif kind == 2:
        supports = tuple(
            Support(x=x, translational=float(unit * 10 ** rng.uniform(-6, 6)), torsional=float(rng.choice([0.0, unit])))
            for x in (0.0, 0.4 * L, L)
        )
    else:
        supports = ()
    return Problem(beam=beam, supports=supports, masses=tuple(masses))


def harsh_problem(rng: np.random.Generator, *, ratio: float, heaviest: float) -> Problem:
    """A beam with a short segment, heavy masses of which two are close, and springs from soft to stiff or none."""
    step, length = float(rng.uniform(0.1, 0.9)), float(10 ** rng.uniform(-3.3, -1))
    ends = (step, min(step + length, 0.99), 1.0)
    EI, m = 10 ** rng.uniform(0, math.log10(ratio), 3), 10 ** rng.uniform(0, math.log10(ratio) / 2, 3)
    segments = tuple(
        BeamSegment(to=to, bending_stiffness=a, mass_per_length=b)
        for to, a, b in zip(ends, EI.tolist(), m.tolist(), strict=True)
    )
    beam = Beam(length=1.0, segments=segments)
    x = [float(rng.choice([0.0, 1.0, step, rng.uniform(0.0, 1.0)])) for _ in range(2)]
    x.append(min(1.0, x[0] + float(10 ** rng.uniform(-3, -1))))
    size = beam.m * 10 ** rng.uniform(-6, math.log10(heaviest), 3)
    turning = beam.m * 10 ** rng.uniform(-10, math.log10(heaviest), 3) * (rng.random(3) < 0.5)
    masses = tuple(
        Mass(x=at, mass=a, rotary_inertia=b) for at, a, b in zip(x, size.tolist(), turning.tolist(), strict=True)
    )
    supports = tuple(
        Support(
            x=at,
            translational=float(beam.EI * 10 ** rng.uniform(-12, 8)),
            torsional=float(rng.choice([0.0, beam.EI * 10 ** rng.uniform(-12, 6)])),
        )
        for at in (0.0, 1.0)[: int(rng.integers(0, 3))]
    )
    return Problem(beam=beam, supports=supports, masses=masses)
