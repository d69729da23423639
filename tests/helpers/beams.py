"""Beams and supports that many tests begin with."""

from __future__ import annotations

import math

from lapjoint import BaseMotion, Beam, ModalDamping, Problem, Stop, Support

CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
UNIT = Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0)
LONG = Beam(length=2.0, bending_stiffness=1e5, mass_per_length=10.0)


def unit_cantilever(*stops: Stop) -> Problem:
    """A cantilever of EI = m = L = 1 on a base that moves by 1e-3 at 7 rad/s, twice its first frequency."""
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=stops,
        damping=ModalDamping(ratio=0.05),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=7.0),
    )
