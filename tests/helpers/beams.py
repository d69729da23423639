"""Beams and supports that many tests begin with."""

from __future__ import annotations

import math
from typing import Any

from lapjoint import BaseMotion, Beam, ModalDamping, Problem, Stop, Support

CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
UNIT = Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0)
LONG = Beam(length=2.0, bending_stiffness=1e5, mass_per_length=10.0)


def unit_cantilever(*stops: Stop, omega: float = 7.0, ratio: float = 0.05) -> Problem:
    """A cantilever of EI = m = L = 1 on a base that moves by 1e-3, by default at twice its first frequency."""
    return Problem(
        beam=UNIT,
        supports=(CLAMP,),
        stops=stops,
        damping=ModalDamping(ratio=ratio),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=omega),
    )


def with_stops(problem: Problem, *changes: dict[str, Any]) -> Problem:
    """The problem with other values of fields of its first stops, which keep their number."""
    first = [stop.model_copy(update=change) for stop, change in zip(problem.stops, changes, strict=False)]
    return problem.replace(stops=(*first, *problem.stops[len(first) :]))
