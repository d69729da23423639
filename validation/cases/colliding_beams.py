"""Two free beams that collide: the closed form of rigid ones, and what every collision conserves.

Rigid beams of masses M and moments of inertia J, which meet at distances a from their centres with a closing speed v,
move as one mass mu on the stop's spring k while they touch:

    1 / mu = sum (1 / M + a^2 / J),    duration pi sqrt(mu / k),    impulse 2 mu v

Beams that bend keep momentum, angular momentum and, undamped, energy: the initial ones are closed forms.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History, Problem, Stop
from lapjoint.problem import BeamsStart, BeamStart, FloatArray, NamedBeam
from validation.case import CaseResult, Level, Say, number, table
from validation.cases.motions import refined_by
from validation.cases.rigid_bar import RATIO, to_the_limit
from validation.cases.transient import WITNESS_TOLERANCE
from validation.invariants import witness
from validation.references.panels import gauss_panels
from validation.uncertainty import refined_estimate
from validation.verdict import Check, Criterion, Estimate, Kind

MASSES = 1.0, 0.7  # Of the upper and the lower beam, kg; both are 1 m long
MEET = 0.7, 0.4  # Where they meet, m from their left ends
VELOCITY = 0.3, 0.2  # Of the lower beam at its left end, m/s, and its growth, 1/s; the upper one is at rest
GAP, SPRING = 0.01, 2000.0  # m, N/m
SOFT = 2.5e5  # Bending stiffness, N m2, of the softer of two nearly rigid pairs; the other is `RATIO` times as stiff
BENDING = 1.0, 2.0  # Bending stiffness of the beams that bend, N m2
STRUCK, DURATION = 0.15, 0.4  # End of the motion of rigid beams, and of beams that bend, s: the contacts are over
PANELS = 40  # Equal panels a beam, so that their ends are nodes of all finite elements, and where the beams meet
FLOOR = 1e-8  # Relative rounding of sums over the beams, of functions that a stiff spring makes large
ORDER = {"analytic": 4.0, "FE": 2.0}  # Least order of the energy after several contacts
LEVELS = {"quick": (24, 36, 54), "standard": (36, 54, 81), "full": (48, 72, 108)}  # Modes of both beams together
ELEMENTS = 10, 20, 40  # Of each beam


def pair(*bending_stiffness: float) -> Problem:
    """An upper beam at rest, and a lower one that flies at it."""
    beams = tuple(
        NamedBeam(name=name, origin=MEET[0] - at, length=1.0, bending_stiffness=EI, mass_per_length=m)
        for name, at, EI, m in zip(("upper", "lower"), MEET, bending_stiffness, MASSES, strict=True)
    )
    between = tuple(f"{beam.name}:{at:g}" for beam, at in zip(beams, MEET, strict=True))
    return Problem(
        beams=beams,
        stops=(Stop(between=between, gap=GAP, stiffness=SPRING),),
        initial=BeamsStart(beams=(BeamStart(beam="lower", velocity=VELOCITY),)),
    )


class Conserved(NamedTuple):
    """What a collision conserves."""

    momentum: float
    """kg m/s"""
    angular_momentum: float
    """Angular momentum about the left end of the upper beam, kg m2/s."""
    energy: float
    """J"""


UNITS = "kg m/s", "kg m2/s", "J"  # Of the numbers of `Conserved`


def at_first() -> Conserved:
    """What the lower beam brings, in closed form."""
    (v, w), m, x = VELOCITY, MASSES[1], MEET[0] - MEET[1]
    momentum = m * (v + w / 2)
    return Conserved(momentum, x * momentum + m * (v / 2 + w / 3), m * (v**2 + v * w + w**2 / 3) / 2)


def momenta(history: History, t: float) -> FloatArray:
    """Momentum, kg m/s, and angular momentum about its left end, kg m2/s, of each beam, shape (2, 2)."""
    s, w = gauss_panels(np.linspace(0.0, 1.0, PANELS + 1), 5)
    found = []
    for start, m in zip(history.problem.line.starts, MASSES, strict=True):
        speed = history.velocity(start + s, t)[:, 0]
        found.append([m * (w @ speed), m * (w @ (s * speed))])
    return np.array(found)


def at_last(history: History) -> Conserved:
    """What both beams have in the end, by quadrature; the stop is open then."""
    t, line = history.end, history.problem.line
    s, w = gauss_panels(np.linspace(0.0, 1.0, PANELS + 1), 5)
    (p, turn), (q, other) = momenta(history, t)
    energy = 0.0
    for start, beam in zip(line.starts, line.beams, strict=True):
        speed, curvature = (history.evaluate(start + s, np.array([t]), **how)[:, 0] for how in ({"dt": 1}, {"dx": 2}))
        energy += float(w @ (beam.m * speed**2 + beam.EI * curvature**2)) / 2
    return Conserved(float(p + q), float(turn + other + (MEET[0] - MEET[1]) * q), energy)


def rigid() -> dict[str, tuple[str, float]]:
    """Unit and closed form of the contact of rigid beams, and of the momenta after it."""
    masses, arms = np.array(MASSES), np.array(MEET) - 0.5
    mu = 1 / float(np.sum(1 / masses + 12 * arms**2 / masses))
    speed = VELOCITY[0] + VELOCITY[1] * MEET[1]
    start, impulse = GAP / speed, 2 * mu * speed
    brought = np.array([0.0, at_first().momentum]), np.array([0.0, MASSES[1] * (VELOCITY[0] / 2 + VELOCITY[1] / 3)])
    found = {
        "impact": ("s", start),
        "rebound": ("s", start + math.pi * math.sqrt(mu / SPRING)),
        "impulse": ("N s", impulse),
    }
    for i, sign in enumerate((1.0, -1.0)):
        found[f"momentum {i + 1}"] = "kg m/s", float(brought[0][i]) + sign * impulse
        found[f"angular momentum {i + 1}"] = "kg m2/s", float(brought[1][i]) + sign * impulse * MEET[i]
    return found


def struck(solver: analytic.Solver | fe_lapjoint.Solver, EI: float) -> FloatArray:
    """The same by a solver, of beams of this stiffness."""
    history = solver.simulate(pair(EI, EI), STRUCK, errors=False)
    (contact,) = history.contacts
    return np.array([contact.start, contact.end, contact.impulse, *momenta(history, STRUCK).ravel()])


def run(level: Level, say: Say) -> CaseResult:
    """Rigid beams against the closed form, and beams that bend against what they bring along."""
    closed, checks, rows = rigid(), [], []
    criteria: list[Criterion] = []
    kinds = [name.rstrip(" 12") for name in closed]
    for solver in (analytic.Solver(n_modes=8), fe_lapjoint.Solver(elements=1)):
        say(f"{solver.name}, nearly rigid")
        values, unsure = to_the_limit(struck(solver, SOFT), struck(solver, RATIO * SOFT), kinds)
        for (name, (unit, exact)), value, error in zip(closed.items(), values, unsure, strict=True):
            true = Estimate(exact, 0.0, "rigid beams", Kind.ANALYTICAL)
            how = f"beams {SOFT:g} and {RATIO * SOFT:g} N m2 stiff, taken to the limit"
            own = Estimate(float(value), float(error) + FLOOR * abs(exact), how)
            checks.append(Check(f"rigid, {name}: {solver.name}", unit, own, true))
            rows.append((name, unit, solver.name, number(exact, 9), number(float(value), 9)))
    problem, first = pair(*BENDING), at_first()
    solvers: dict[str, tuple[list[analytic.Solver] | list[fe_lapjoint.Solver], float]] = {
        "analytic": ([analytic.Solver(n_modes=n) for n in LEVELS[level]], 1.5),
        "FE": ([fe_lapjoint.Solver(elements=n) for n in ELEMENTS], 2.0),
    }
    for name, (levels, ratio) in solvers.items():
        say(name)
        runs = [solver.simulate(problem, DURATION, errors=False) for solver in levels]
        ends = [at_last(run) for run in runs]
        criteria += witness(runs[-1], WITNESS_TOLERANCE, levels[-1].name)
        for i, field in enumerate(Conserved._fields):
            what = field.replace("_", " ")
            found = refined_estimate([end[i] for end in ends], ratio, ORDER[name], refined_by(levels[-1]), FLOOR)
            brought = Estimate(first[i], 0.0, "closed form of the initial state", Kind.ANALYTICAL)
            checks.append(Check(f"{what} after {len(runs[-1].contacts)} contacts: {name}", UNITS[i], found, brought))
            rows.append((what, UNITS[i], levels[-1].name, number(first[i], 9), number(ends[-1][i], 9)))
    return CaseResult(
        "colliding-beams",
        "Colliding beams",
        "A free beam flies at another one. If both hardly bend, they collide as rigid ones do in closed form. If they "
        "bend, they strike each other several times, and momentum, angular momentum and energy stay what the first "
        "beam brought along.",
        checks=tuple(checks),
        criteria=tuple(criteria),
        tables=(table("Collisions", ("quantity", "unit", "solver", "closed form", "computed"), rows),),
    )
