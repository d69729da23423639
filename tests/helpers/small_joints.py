"""Joints that are quick to solve, for tests of campaigns."""

from __future__ import annotations

import math
from typing import Any

from lapjoint import BaseMotion, Beam, ModalDamping, Problem, Stop, Support, ViscousDamping
from lapjoint.problem.random_motion import RandomBaseMotion, RandomLoad

LOW, HIGH = 3e-4, 4e-4  # m
"""Amplitudes of `TOUCHING`, between which it first touches its stop: its branch has a graze and two folds."""


def cantilever(**changes: Any) -> Problem:
    """A viscously damped cantilever with one stop at its tip, whose base moves by `LOW`."""
    given: dict[str, Any] = {
        "beam": Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        "supports": (Support(x=0.0, translational=math.inf, torsional=math.inf),),
        "stops": (Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        "damping": ViscousDamping(coefficient=0.8),
        "base_motion": BaseMotion(amplitude=LOW, angular_frequency=5.0),
    }
    return Problem(**(given | changes))


TOUCHING = cantilever()
SHAKEN = cantilever(
    title="Shaken",
    beam=Beam(length=1.0, bending_stiffness=200.0, mass_per_length=1.0),
    stops=(Stop(x=1.0, side="top", gap=1e-4, stiffness=1e4),),
    damping=ModalDamping(ratio=0.1),
    base_motion=RandomBaseMotion(psd=[[5.0, 1.0], [40.0, 1.0]]),
    point_loads=(RandomLoad(x=0.5, psd=[[5.0, 1.0], [40.0, 1.0]], seed=7),),
)
