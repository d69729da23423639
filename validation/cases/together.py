"""Random joints with masses, steps, static loads, preload and stops in space together: do both solvers agree?

Each joint is drawn by its own seed, and none is left out.  Lengths are divided by the beam's, stiffnesses by the EI of
its first segment, and masses by the mass that the beam has with the first segment's section.
"""

from __future__ import annotations

import math

import numpy as np

from lapjoint import BaseMotion, Beam, ModalDamping, Outcome, Problem, Stop, Support
from lapjoint.problem import BeamSegment, Gravity, Mass, UniformLoad
from validation.case import CaseResult, Level, Say, table
from validation.cases.motions import compare_contacts
from validation.cases.steady import compare_steady
from validation.cases.transient import WITNESS_TOLERANCE
from validation.invariants import witness
from validation.verdict import Check, Criterion

SEEDS = {"quick": (1,), "standard": (1, 2, 3), "full": tuple(range(1, 9))}
ELEMENTS = {"quick": 32, "standard": 48, "full": 64}  # of the finest of three meshes
CONTACTS, PERIODS = 5, 5  # First contacts compared, and excitation periods in which they are sought
FIRST = 3.516  # First frequency of the uniform cantilever, in units of sqrt(EI / m) / L^2
AMPLITUDE = 1e-3  # of the base, in beam lengths: gaps and static deflections have its size


def joint(seed: int) -> Problem:
    """A cantilever with every kind of part."""
    rng = np.random.default_rng(seed)

    def between(low: float, high: float) -> float:
        return float(rng.uniform(low, high))

    step = between(0.25, 0.75)
    segments = (
        BeamSegment(to=step, bending_stiffness=1.0, mass_per_length=1.0),
        BeamSegment(to=1.0, bending_stiffness=between(0.3, 1.0), mass_per_length=between(0.5, 1.0)),
    )
    omega = between(0.5, 2.5) * FIRST
    pressed, met, wall = (between(0.3, 1.0) for _ in range(3))
    sides = ("top", "bottom") if rng.random() < 0.5 else ("bottom", "top")
    return Problem(
        title=f"Random joint {seed}",
        beam=Beam(
            length=1.0,
            segments=segments,
            contents_per_length=between(0.0, 0.3),
            added_mass_per_length=between(0.0, 0.3),
        ),
        supports=(
            Support(x=0.0, translational=math.inf, torsional=math.inf),
            Support(x=between(0.2, 0.9), translational=10 ** between(-1.0, 1.0)),
        ),
        masses=(
            Mass(x=1.0, mass=between(0.0, 0.5), rotary_inertia=between(0.0, 0.02)),
            Mass(x=between(0.2, 0.9), mass=between(0.0, 0.5)),
        ),
        stops=(
            Stop(x=pressed, side=sides[0], gap=-between(0.0, 0.3) * AMPLITUDE, stiffness=10 ** between(0.5, 2.0)),
            Stop(x=met, side=sides[1], gap=between(0.1, 0.6) * AMPLITUDE * met**2, stiffness=10 ** between(0.5, 2.0)),
            Stop(
                x=wall,
                side="top" if rng.random() < 0.5 else "bottom",
                gap=between(0.0, 1.0) * AMPLITUDE,
                stiffness=10 ** between(0.5, 2.0),
                fixed_to="space",
            ),
        ),
        gravity=Gravity(acceleration=-between(0.0, 4.0) * AMPLITUDE),
        uniform_loads=(UniformLoad(start=between(0.0, 0.5), to=between(0.6, 1.0), force_per_length=AMPLITUDE),),
        damping=ModalDamping(ratio=between(0.03, 0.1)),
        base_motion=BaseMotion(amplitude=AMPLITUDE, angular_frequency=omega, phase=between(-math.pi, math.pi)),
    )


def judged(seed: int, level: Level) -> tuple[list[Check | Criterion], tuple[object, ...]]:
    """First contacts and steady state of one joint, and a row of the table."""
    problem, finest = joint(seed), ELEMENTS[level]
    duration = PERIODS * problem.require_excitation_period("contacts")
    contacts, exact, fe = compare_contacts(problem, duration, CONTACTS, finest, stated=True)
    found: list[Check | Criterion] = [*contacts]
    if level != "quick":
        found += [item for history in (exact, fe) for item in witness(history, WITNESS_TOLERANCE, history.solver)]
    point = compare_steady(problem, finest)
    found.append(point.same_period)
    if Outcome.UNDECIDED not in point.outcomes:
        found += [
            Check(f"impulse of {name}", "N s", a, b, explanation=point.explanation)
            for name, a, b in zip(problem.stop_names, point.analytic, point.fe, strict=True)
        ]
    row = (seed, len(contacts) // 3, point.outcomes[0].name.lower(), point.period_multiple)
    return found, (*row, *(estimate.value for estimate in point.analytic))


def run(level: Level, say: Say) -> CaseResult:
    """All joints of the level."""
    checks: list[Check] = []
    criteria: list[Criterion] = []
    rows = []
    for seed in SEEDS[level]:
        say(f"joint {seed}")
        found, row = judged(seed, level)
        rows.append(row)
        for item in found:
            named = {**item.__dict__, "name": f"joint {seed}: {item.name}"}
            if isinstance(item, Check):
                checks.append(Check(**named))
            else:
                criteria.append(Criterion(**named))
    columns = ("joint", "contacts", "steady state", "periods", *(f"impulse of stop {k} (N s)" for k in (1, 2, 3)))
    return CaseResult(
        "together",
        "Random joints with every part together",
        "Cantilevers of two segments with contents, added mass, masses, gravity, a uniform load, a stop that presses, "
        "a stop at a gap and a stop fixed in space, drawn at random. First contacts from the straight beam and "
        "impulses of the steady state are compared; three numbers of modes and three meshes give their uncertainty.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("Random joints", columns, rows),),
    )
