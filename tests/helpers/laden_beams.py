"""Random beams with steps and masses, and the count of their frequencies in as many digits as mpmath is set to.

The count is the one of Wittrick and Williams on the dynamic stiffness matrix: members are assembled from the textbook
stiffness functions, and the negative pivots of the factorisation are added to the clamped-clamped roots of the members.
It is taken from the problem, and shares no code with the solver.
"""

from __future__ import annotations

import math
from itertools import pairwise

import mpmath as mp
import numpy as np

from lapjoint import Beam, Problem, Stop, Support
from lapjoint.problem.beam import BeamSegment
from lapjoint.problem.masses import Mass
from tests.helpers.dynamic_stiffness import negative_pivots


def random_beam(rng: np.random.Generator, decades: float = 2.0) -> Problem:
    """Up to four segments whose EI and m differ by up to twice `decades`, up to three masses of 1e-6 to 1e6 m L, some
    with a rotary inertia, and up to four supports, fixed or of 1e-6 to 1e12 EI / L^3; a stop is at the tip."""
    L, segments = float(10 ** rng.uniform(-1.0, 1.0)), int(rng.integers(1, 5))
    ends = [_place(L, int(n)) for n in (*np.sort(rng.choice(np.arange(1, 40), segments - 1, replace=False)), 40)]
    EI, m = 10 ** rng.uniform(-decades, decades, segments), 10 ** rng.uniform(-decades, decades, segments)
    beam = Beam(
        length=L,
        segments=tuple(
            BeamSegment(to=float(end), bending_stiffness=float(e), mass_per_length=float(mass))
            for end, e, mass in zip(ends, EI, m, strict=True)
        ),
    )
    return Problem(
        beam=beam,
        masses=tuple(_mass(rng, beam) for _ in range(rng.integers(0, 4))),
        supports=tuple(_support(rng, beam, x) for x in rng.choice(41, rng.integers(0, 5), replace=False)),
        stops=(Stop(x=L, side="top", gap=1e-3, stiffness=float(10 ** rng.uniform(0.0, 7.0)) * beam.EI / L**3),),
    )


def _mass(rng: np.random.Generator, beam: Beam) -> Mass:
    unit, L = beam.m * beam.length, beam.length
    rotary = float(10 ** rng.uniform(-6.0, 6.0)) * unit * L**2 if rng.random() < 0.5 else 0.0
    return Mass(
        x=_place(L, int(rng.integers(0, 41))), mass=float(10 ** rng.uniform(-6.0, 6.0)) * unit, rotary_inertia=rotary
    )


def _support(rng: np.random.Generator, beam: Beam, place: int) -> Support:
    def spring(unit: float) -> float:
        return float(rng.choice([0.0, math.inf, 10 ** rng.uniform(-6.0, 12.0) * unit], p=[0.25, 0.25, 0.5]))

    L, EI = beam.length, beam.EI
    return Support(x=_place(L, place), translational=spring(EI / L**3), torsional=spring(EI / L))


def frequencies_below(problem: Problem, omega: mp.mpf, closed: tuple[int, ...] = ()) -> int:
    """Natural frequencies below `omega`, rad/s, with some stops closed."""
    stops = [problem.stops[i] for i in closed]
    parts = (*problem.supports, *problem.masses, *stops)
    x = sorted({0.0, *(piece.end for piece in problem.beam.pieces), *(part.x for part in parts)})
    n, total = 2 * len(x), 0
    K = mp.zeros(n, n)
    for e, (start, end) in enumerate(pairwise(x)):
        (piece,) = (it for it in problem.beam.pieces if it.start <= start and end <= it.end)
        length, EI = mp.mpf(end) - mp.mpf(start), mp.mpf(piece.EI)
        b = (mp.mpf(piece.inertia) * omega**2 / EI) ** mp.mpf(0.25)
        s = b * length
        c, sn, ch, sh = mp.cos(s), mp.sin(s), mp.cosh(s), mp.sinh(s)
        d = 1 - c * ch
        own = {
            (0, 0): b**3 * (sn * ch + c * sh), (0, 1): b**2 * sn * sh, (0, 2): -(b**3) * (sn + sh),
            (0, 3): b**2 * (ch - c), (1, 1): b * (sn * ch - c * sh), (1, 2): -(b**2) * (ch - c),
            (1, 3): b * (sh - sn), (2, 2): b**3 * (sn * ch + c * sh), (2, 3): -(b**2) * sn * sh,
            (3, 3): b * (sn * ch - c * sh),
        }  # fmt: skip
        for (i, j), value in own.items():
            K[2 * e + i, 2 * e + j] += EI * value / d
            if i != j:
                K[2 * e + j, 2 * e + i] += EI * value / d
        k = int(mp.floor(s / mp.pi))
        total += 0 if k == 0 else k - 1 + int((d > 0) == (k % 2 == 0))
    fixed = set()
    springs = [(it.x, it.translational, it.torsional) for it in problem.supports] + [
        (it.x, it.stiffness, 0.0) for it in stops
    ]
    for place, *both in springs:
        for offset, stiffness in enumerate(both):
            row = 2 * x.index(place) + offset
            if math.isinf(stiffness):
                fixed.add(row)
            else:
                K[row, row] += mp.mpf(stiffness)
    for mass in problem.masses:
        row = 2 * x.index(mass.x)
        K[row, row] -= omega**2 * mp.mpf(mass.mass)
        K[row + 1, row + 1] -= omega**2 * mp.mpf(mass.rotary_inertia)
    return total + negative_pivots(K, [row for row in range(n) if row not in fixed])


def _place(L: float, number: int) -> float:
    """A position, m, in fortieths of the length."""
    return L if number == 40 else number * L / 40
