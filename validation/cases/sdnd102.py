"""An outside benchmark: the problem of Code_Aster's validation case SDND102 (V5.01.102), a wall fixed in space.

A mass on a spring is shaken by its base, and hits a wall that does not move with the base.  The mass is a beam that
hardly bends, over two springs at its ends, with the wall at its middle, and does not turn.  The document compares two
models of its own, so that the closed form is the reference here.

The wall is also a mirror: two such masses, of which the base drives the second in the opposite sense, strike each other
where either would strike the wall.  The gap between the two is twice that to the wall, and the spring half as stiff.
"""

from __future__ import annotations

import math

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, Stop, Support, ViscousDamping
from lapjoint.problem import NamedBeam
from validation.case import CaseResult, Level, Say, number, table
from validation.cases.rigid_bar import RATIO, to_the_limit
from validation.references.mass_beside_wall import MassBesideWall
from validation.references.reading import group
from validation.verdict import Check, Criterion, Estimate, Kind

QUANTITIES = {"impact": "s", "rebound": "s", "impulse": "N s", "peak force": "N", "force half way": "N"}
"""Unit of each number of a contact."""
DURATION = 1.0  # s, as in the document
SOFT = 1e10
"""Bending stiffness, N m2, of the softer of two beams of 1 m; the other is `RATIO` times as stiff."""
BENDS = 1e8  # Bending stiffness, N m2, of the mirrored beams: they may bend, because the beam at the wall bends alike
ROUNDING = 1e-8  # of the largest of a kind: a wall 600 times as stiff as the spring makes rounding grow
SAMPLED = 1100.0  # N: a force that samples of the document's motion do not reach
SOLVERS: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (
    analytic.Solver(n_modes=6),
    fe_lapjoint.Solver(elements=2),
)
TWINS: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (
    analytic.Solver(n_modes=12),  # six of each beam: frequencies with and without the spring alternate
    fe_lapjoint.Solver(elements=2),
)


def as_published() -> MassBesideWall:
    """The mass and the wall of the document."""
    given = group("sdnd102 problem")
    mass, stiffness, ratio, hertz, wall, gap = (
        given[key][0].value for key in ("mass", "stiffness", "ratio", "frequency", "wall", "gap")
    )
    return MassBesideWall(mass, stiffness, ratio, 2 * math.pi * hertz, wall, gap)


def beam(mass: MassBesideWall, bending_stiffness: float) -> Problem:
    """The mass as a beam 1 m long of bending stiffness EI, N m2, between springs at its ends, a wall at its middle."""
    return Problem(
        title="SDND102 (V5.01.102): a mass against a wall fixed in space",
        beam=Beam(length=1.0, bending_stiffness=bending_stiffness, mass_per_length=mass.mass),
        supports=tuple(Support(x=x, translational=mass.stiffness / 2) for x in (0.0, 1.0)),
        stops=(Stop(name="wall", x=0.5, side="top", gap=mass.gap, stiffness=mass.wall, fixed_to="space"),),
        damping=ViscousDamping(coefficient=mass.drag),
        base_motion=BaseMotion(amplitude=1 / mass.omega**2, angular_frequency=mass.omega, phase=math.pi),
    )


def mirrored(mass: MassBesideWall, bending_stiffness: float) -> Problem:
    """The same beam and its mirror image, which strike each other instead of the wall."""
    one, sides = beam(mass, bending_stiffness), {"image": -1.0, "own": 1.0}
    (wall,) = one.stops
    parts = {"length": 1.0, "bending_stiffness": bending_stiffness, "mass_per_length": mass.mass}
    between = tuple(f"{name}:{wall.x:g}" for name in sides)
    return Problem(
        title="SDND102 (V5.01.102): a mass against its mirror image",
        beams=tuple(NamedBeam(name=n, supports=one.supports, base_share=share, **parts) for n, share in sides.items()),
        stops=(Stop(name="mirror", between=between, gap=2 * wall.gap, stiffness=wall.stiffness / 2),),
        damping=one.damping,
        base_motion=one.base_motion,
    )


def answers(solver: analytic.Solver | fe_lapjoint.Solver, problem: Problem, count: int) -> np.ndarray:
    """The numbers of the first `count` contacts by a solver, in the order of QUANTITIES, shape (5 count,); NaN of
    contacts that are missing."""
    history = solver.simulate(problem, DURATION, errors=False)
    contacts = history.contacts[:count]
    middles = -history.contact_force(np.array([(c.start + c.end) / 2 for c in contacts], dtype=float))[0]
    numbers = np.full((count, len(QUANTITIES)), np.nan)
    for row, c, middle in zip(numbers, contacts, middles, strict=False):
        row[:] = c.start, c.end, c.impulse, c.peak_force, middle
    return numbers.ravel()


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers against the closed form."""
    mass = as_published()
    hits = mass.hits(DURATION)
    exact = np.array([(hit.start, hit.end, hit.impulse, hit.peak, hit.middle) for hit in hits]).ravel()
    kinds, units = list(QUANTITIES) * len(hits), list(QUANTITIES.values()) * len(hits)
    checks, found = [], {}
    for solver in SOLVERS:
        say(solver.name)
        soft, stiff = (answers(solver, beam(mass, SOFT * by), len(hits)) for by in (1.0, RATIO))
        found[solver.name] = values, unsure = to_the_limit(soft, stiff, kinds)
        for i, (kind, unit) in enumerate(zip(kinds, units, strict=True)):
            rounding = ROUNDING * float(exact[i % len(QUANTITIES) :: len(QUANTITIES)].max())
            what = f"contact {i // len(QUANTITIES) + 1}: {kind}"
            closed = Estimate(float(exact[i]), 0.0, "closed forms between switches", Kind.ANALYTICAL)
            how = f"{solver.name}, beams {SOFT:g} and {RATIO * SOFT:g} N m2 stiff, taken to the limit"
            own = Estimate(float(values[i]), float(unsure[i]) + rounding, how)
            checks.append(Check(f"{what}: {solver.name}", unit, own, closed))
    for solver, twice in zip(SOLVERS, TWINS, strict=True):
        say(f"{twice.name}, mirrored")
        one = answers(solver, beam(mass, BENDS), len(hits))
        both = answers(twice, mirrored(mass, BENDS), len(hits))
        for i, unit in enumerate(units):
            rounding = ROUNDING * float(exact[i % len(QUANTITIES) :: len(QUANTITIES)].max())
            what = f"contact {i // len(QUANTITIES) + 1}: {kinds[i]}, mirror image against wall: {twice.name}"
            wall, image = (Estimate(float(it[i]), rounding, f"a beam {BENDS:g} N m2 stiff") for it in (one, both))
            checks.append(Check(what, unit, image, wall))
    rows = [
        (kinds[i], units[i], *(number(float(v), 9) for v in (exact[i], *(values[i] for values, _ in found.values()))))
        for i in range(2 * len(QUANTITIES))
    ]
    return CaseResult(
        "sdnd102",
        "Outside benchmark: SDND102",
        "A mass of 25 kg on a damped spring hits a wall that stands still while the base moves. Both solvers give each "
        "contact of the first second as closed forms do. Two mirrored masses that hit each other move as one that hits "
        "the wall. The largest force exceeds what samples show.",
        checks=tuple(checks),
        criteria=(
            Criterion("largest force", "N", max(hit.peak for hit in hits), SAMPLED, math.inf, "samples miss it"),
        ),
        tables=(table("SDND102, first two contacts", ("quantity", "unit", "closed form", "analytic", "FE"), rows),),
    )
