r"""A stop that presses the straight beam: one mass on a spring, which the stop pushes away from rest.

The mass is a free beam that hardly bends, over a spring and a stop at its middle; it does not turn.  The stop presses
it by the interference d.  With omega^2 = (k + k_s) / m and omega_0^2 = k / m the mass moves, while the stop is closed,

    z = -Z (1 - cos(omega t)),    Z = k_s d / (k + k_s),

and where k_s > k the stop lets go of it at z = -d, after T = acos(-k / k_s) / omega.  The mass then swings on its
spring, and meets the stop again 2 atan2(|v| / omega_0, d) / omega_0 later, with v the velocity at which it was let go.
"""

from __future__ import annotations

import math
from dataclasses import dataclass

import analytic
import fe_lapjoint
from lapjoint import Beam, Problem, Stop, Support
from validation.case import CaseResult, Level, Say, number, table
from validation.verdict import Check, Estimate, Kind

QUANTITIES = {"release": "s", "impulse": "N s", "force at first": "N", "next impact": "s", "pull of the spring": "N"}
"""Unit of each number."""
STIFF = 1e10
"""Bending stiffness EI of the beam, N m2."""
BENT = 2 / 128
"""Relative effect of bending on a number, over k_s L^3 / EI: half of the beam bends by L^3 / 128 EI under a unit of its
own inertia, and rings by as much after the sudden press."""
SOLVERS: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (
    analytic.Solver(n_modes=8),
    fe_lapjoint.Solver(elements=2),
)


@dataclass(frozen=True)
class Pressed:
    """The mass, its spring, and the stop that presses it."""

    mass: float = 100.0
    """kg."""
    stiffness: float = 1e4
    """N/m, of the spring."""
    stop: float = 1e5
    """N/m, of the stop."""
    interference: float = 2e-3
    """d, m."""

    @property
    def answers(self) -> tuple[float, ...]:
        """The numbers of QUANTITIES."""
        k, stop, d = self.stiffness, self.stop, self.interference
        omega, slow, Z = math.sqrt((k + stop) / self.mass), math.sqrt(k / self.mass), stop * d / (k + stop)
        release = math.acos(-k / stop) / omega
        speed = Z * omega * math.sin(omega * release)
        impulse = stop * (d * release - Z * (release - math.sin(omega * release) / omega))
        away = 2 * math.atan2(speed / slow, d) / slow
        return release, impulse, stop * d, release + away, k * math.hypot(d, speed / slow)

    def beam(self, bending_stiffness: float) -> Problem:
        """The mass as a beam 1 m long of bending stiffness EI, N m2, with spring and stop at its middle."""
        stop = Stop(name="stop", x=0.5, side="top", gap=-self.interference, stiffness=self.stop)
        return Problem(
            title="A stop that presses a mass on a spring",
            beam=Beam(length=1.0, bending_stiffness=bending_stiffness, mass_per_length=self.mass),
            supports=(Support(x=0.5, translational=self.stiffness),),
            stops=(stop,),
        )


def answers(solver: analytic.Solver | fe_lapjoint.Solver, of: Pressed, bending_stiffness: float) -> tuple[float, ...]:
    """The numbers of QUANTITIES by a solver, on a beam of bending stiffness EI, N m2; NaN without two contacts."""
    exact = of.answers
    history = solver.simulate(of.beam(bending_stiffness), 1.2 * exact[3], errors=False)
    if len(history.contacts) < 2:
        return (math.nan,) * len(QUANTITIES)
    first, second = history.contacts[:2]
    farthest = (first.end + second.start) / 2
    pull = -of.stiffness * float(history.displacement(0.5, farthest)[0, 0])
    return first.end, first.impulse, -float(history.contact_force(0.0)[0, 0]), second.start, pull


def run(level: Level, say: Say) -> CaseResult:
    """Both solvers against the closed form."""
    of, checks, rows = Pressed(), [], []
    found = {}
    for solver in SOLVERS:
        say(solver.name)
        found[solver.name] = answers(solver, of, STIFF)
    for i, (quantity, unit) in enumerate(QUANTITIES.items()):
        closed = Estimate(of.answers[i], 0.0, "cosines of the mass on one spring or both", Kind.ANALYTICAL)
        for name, values in found.items():
            own = Estimate(values[i], BENT * of.stop / STIFF * values[i], f"{name}, a beam {STIFF:g} N m2 stiff")
            checks.append(Check(f"{quantity}: {name}", unit, own, closed))
        numbers = (of.answers[i], *(values[i] for values in found.values()))
        rows.append((quantity, unit, *(number(float(value), 9) for value in numbers)))
    return CaseResult(
        "pressed",
        "A stop that presses the straight beam",
        "A stop with an interference of 2 mm pushes a mass of 100 kg on a spring away from rest, lets go of it, and is "
        "met again. Both solvers give the numbers of the closed form.",
        checks=tuple(checks),
        tables=(table("Pressed mass", ("quantity", "unit", "closed form", "analytic", "FE"), rows),),
    )
