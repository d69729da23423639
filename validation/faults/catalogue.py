"""All faults, and the control."""

from __future__ import annotations

from validation.faults.fault import Fault
from validation.faults.in_analytic import ANALYTIC
from validation.faults.in_beams import BEAMS
from validation.faults.in_branches import BRANCHES
from validation.faults.in_damped import DAMPED
from validation.faults.in_fe import FE
from validation.faults.in_ground import GROUND
from validation.faults.in_parts import PARTS
from validation.faults.in_random import RANDOM
from validation.faults.in_summaries import SUMMARIES

FAULTS: tuple[Fault, ...] = (*ANALYTIC, *FE, *GROUND, *RANDOM, *SUMMARIES, *BRANCHES, *PARTS, *DAMPED, *BEAMS)

CONTROL = Fault(
    "control",
    "no fault",
    "fe_lapjoint:Assembly._matrices",
    "Two factors change places, and nothing is other than it was: this must not be caught.",
    old="inertia * h * m",
    new="h * inertia * m",
)
