"""Frequencies of beams on springs of any stiffness against the roots of the characteristic equation, to 60 digits."""

from __future__ import annotations

import math
from itertools import product

import mpmath as mp
import pytest
from beams import UNIT

import fe_lapjoint
from lapjoint import FREE, Problem, Support

KAPPA = (1e-12, 1e-6, 1e-3, 3e-2, 1.0, 1e6, math.inf)
Ends = tuple[tuple[float, float], tuple[float, float]]
"""Translational and torsional stiffness, over EI / L^3 and EI / L, of the springs at both ends."""


def determinant(beta: mp.mpf, ends: Ends) -> mp.mpf:
    """Of the boundary conditions z'' = +- kt z', z''' = -+ k z on z = a cos + b sin + c cosh + d sinh of beta x."""
    rows = []
    for x, sign, (k, kt) in ((mp.mpf(0), 1, ends[0]), (mp.mpf(1), -1, ends[1])):
        s, c, sh, ch = mp.sin(beta * x), mp.cos(beta * x), mp.sinh(beta * x), mp.cosh(beta * x)
        z, z1 = (c, s, ch, sh), (-s, c, sh, ch)
        z2, z3 = (-c, -s, ch, sh), (s, -c, sh, ch)
        moment = [beta**2 * z2[i] - sign * mp.mpf(kt) * beta * z1[i] for i in range(4)]
        shear = [beta**3 * z3[i] + sign * mp.mpf(k) * z[i] for i in range(4)]
        rows += [moment if math.isfinite(kt) else list(z1), shear if math.isfinite(k) else list(z)]
    return mp.det(mp.matrix(rows))


def root_near(omega: float, ends: Ends) -> float:
    """The angular frequency nearest to an estimate."""
    with mp.workdps(60):
        start = mp.sqrt(mp.mpf(omega))
        beta = mp.findroot(
            lambda b: determinant(b, ends), (start, start * (1 + mp.mpf(10) ** -9)), tol=mp.mpf(10) ** -90
        )
        return float(beta**2)


def springs(kappa: float) -> dict[str, Ends]:
    return {
        "both ends alike": ((kappa, 0.0), (kappa, 0.0)),
        "both ends unlike": ((kappa, 0.0), (3 * kappa, 0.0)),
        "one end": ((kappa, kappa), (0.0, 0.0)),
        "a pin and a torsional spring": ((math.inf, kappa), (0.0, 0.0)),
        "a pin and a spring": ((math.inf, 0.0), (kappa, 0.0)),
        "a stiff one and a soft one": ((1e6, 0.0), (kappa, 0.0)),
    }


@pytest.mark.parametrize(
    ("elements", "kappa"),
    [
        *product((8, 40), KAPPA),
        (200, KAPPA[0]),
        *(pytest.param(200, it, marks=pytest.mark.thorough) for it in KAPPA[3::3]),
    ],
)
def test_frequencies_keep_their_digits_however_soft_the_springs(kappa: float, elements: int) -> None:
    for name, ends in springs(kappa).items():
        supports = tuple(Support(x=float(x), translational=k, torsional=kt) for x, (k, kt) in enumerate(ends))
        problem = Problem(beam=UNIT, supports=supports)
        for omega in fe_lapjoint.Solver(elements=elements).modes(problem, FREE, 2).angular_frequencies:
            if omega == 0.0:
                assert name in ("a pin and a spring", "one end"), name
                continue
            # Discretisation: (beta / n)^4 / 1440 for a beam's own modes, less for those that hardly bend it; rounding
            # leaves 1e-10 of the modes of 200 elements, and 1e-12 of those that soft springs make.
            allowed = omega**2 / elements**4 / 300 + (1e-12 if omega < 1e-2 else 3e-10)
            assert omega == pytest.approx(root_near(omega, ends), rel=allowed), f"{name}, {kappa:g}"
