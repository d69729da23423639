"""An outside benchmark: the problem of Code_Aster's validation case SDND108 (V5.01.108), a mass falls on a stop.

A mass is thrown down at the speed v, falls under gravity g, and meets an elastic stop by the height h below.  With
omega^2 = k / m it meets the stop when h = v t + g t^2 / 2, at the speed w, and is then pressed into the stop by

    d = D (1 - cos(omega t)) + B sin(omega t),    D = g / omega^2,    B = w / omega,

until omega t = 2 theta, with theta the angle of the vector (-D, B).  It leaves at the speed w.

The mass is a beam on a pin that hardly bends: uniform, or light with a mass at its tip.  The coordinate is the
displacement of the tip, whose mass is the moment of inertia about the pin divided by L^2.  The document compares a
damped stop, too.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import analytic
import fe_lapjoint
from lapjoint import Beam, PolynomialShape, Problem, Stop, Support
from lapjoint.problem import Gravity, Mass
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, number, table
from validation.cases.one_mode import RATIO, to_the_limit
from validation.references.reading import group
from validation.verdict import Check, Estimate, Kind

QUANTITIES = {"contact": "s", "release": "s", "impulse": "N s", "peak force": "N", "tip at the end": "m"}
"""Unit of each number."""
DURATION = 1.0  # s, as in the document
LENGTH = 1.0  # m
SOFTEST = 4e6  # Least bending stiffness, N m2: the next two are each `one_mode.RATIO` times as stiff
LIGHT = 0.1  # Moment of inertia of the light beam, divided by that of beam and mass
ROUNDING = 1e-12  # Relative rounding of the closed form
SOLVERS: dict[str, Solver] = {"analytic": analytic.Solver(n_modes=6), "FE": fe_lapjoint.Solver(elements=6)}


@dataclass(frozen=True)
class Falling:
    """The mass, and the stop below it."""

    mass: float
    """kg."""
    gravity: float
    """m/s2, downwards."""
    speed: float
    """m/s, downwards, at first."""
    height: float
    """m, above the stop at first."""
    stop: float
    """N/m."""

    @property
    def answers(self) -> tuple[float, ...]:
        """The numbers of QUANTITIES."""
        g, v, h = self.gravity, self.speed, self.height
        w = math.sqrt(v**2 + 2 * g * h)
        omega, begin = math.sqrt(self.stop / self.mass), (w - v) / g
        D, B = g / omega**2, w / omega
        lasting = 2 * math.atan2(B, -D) / omega
        impulse = -self.stop * (D * lasting + 2 * B / omega)
        rest = DURATION - begin - lasting
        return begin, begin + lasting, impulse, self.stop * (D + math.hypot(D, B)), -h + w * rest - g * rest**2 / 2

    def bars(self, bending_stiffness: float) -> dict[str, Problem]:
        """The mass as bars on a pin of bending stiffness EI, N m2: of uniform mass, and with a mass at the tip."""
        clamp = Support(x=0.0, translational=math.inf)
        stop = Stop(name="stop", x=LENGTH, side="bottom", gap=self.height, stiffness=self.stop)
        found = {}
        for name, share in (("uniform", 1.0), ("with a mass at the tip", LIGHT)):
            beam = 3 * share * self.mass / LENGTH  # kg/m
            carried = (1 - share) * self.mass
            moved = beam * LENGTH / 2 + carried  # the moment of the weight, divided by g L
            found[name] = Problem(
                title="SDND108 (V5.01.108): a mass falls on a stop",
                beam=Beam(length=LENGTH, bending_stiffness=bending_stiffness, mass_per_length=beam),
                supports=(clamp,),
                stops=(stop,),
                masses=(Mass(x=LENGTH, mass=carried),) if carried else (),
                gravity=Gravity(acceleration=-self.gravity * self.mass / moved),
                initial=PolynomialShape(velocity=(0.0, -self.speed / LENGTH)),
            )
        return found


def as_published() -> Falling:
    """The mass of the document."""
    given = group("sdnd108 problem")
    return Falling(*(given[key][0].value for key in ("mass", "gravity", "speed", "height", "stop")))


def answers(solver: Solver, problem: Problem) -> tuple[float, ...]:
    """The numbers of QUANTITIES by a solver; NaN without a contact."""
    history = solver.simulate(problem, DURATION, errors=False)
    if not history.contacts:
        return (math.nan,) * len(QUANTITIES)
    first, end = history.contacts[0], float(history.displacement(LENGTH, DURATION)[0, 0])
    return first.start, first.end, first.impulse, first.peak_force, end


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers and both bars against the closed form."""
    of, checks, rows = as_published(), [], []
    for bar in of.bars(SOFTEST):
        say(bar)
        for name, solver in SOLVERS.items():
            levels = [answers(solver, of.bars(SOFTEST * RATIO**power)[bar]) for power in range(3)]
            for i, ((quantity, unit), exact) in enumerate(zip(QUANTITIES.items(), of.answers, strict=True)):
                found = to_the_limit(levels, i, unit, solver)
                closed = Estimate(exact, ROUNDING * abs(exact), "falling and half a sine", Kind.ANALYTICAL)
                checks.append(Check(f"{quantity}, {bar}: {name}", unit, found, closed))
                rows.append((quantity, unit, bar, name, number(exact, 10), number(found.value, 10)))
    return CaseResult(
        "sdnd108",
        "Outside benchmark: SDND108",
        "A mass of 1 kg is thrown down at 1 m/s, falls under gravity, and meets an elastic stop 2 m below. It is a bar "
        "on a pin that hardly bends, once uniform and once light with a mass at its tip. Beams of three bending "
        "stiffnesses show how far the stiffest is from the rigid bar; the effect of bending is of the order 1 in "
        "1 / EI.",
        checks=tuple(checks),
        tables=(table("SDND108", ("quantity", "unit", "bar", "solver", "closed form", "found"), rows),),
    )
