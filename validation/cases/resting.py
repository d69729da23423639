r"""Static equilibria under gravity, loads and preload: against closed forms, and against what marches settle to.

A cantilever rests on a stop under its tip.  With w the deflection of its tip without the stop, f that by a unit force,

    w = int_0^L M(x) (L - x) / EI dx,    f = int_0^L (L - x)^2 / EI dx,

and M(x) the moment of all loads beyond x, the stop of stiffness k pushes it by R = (w - gap) / (f + 1 / k), if that is
above 0.  Of a uniform beam under a uniform load q that is (q L^4 / 8 EI - gap) / (L^3 / 3 EI + 1 / k).  The clamp takes
the rest of the loads and of their moment.
"""

from __future__ import annotations

import math
from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import FREE, Beam, ModalDamping, Problem, StepLoad, Stop, Support
from lapjoint.answers import Equilibrium
from lapjoint.problem import AtEquilibrium, BeamSegment, FloatArray, Gravity, Mass, UniformLoad
from validation.case import CaseResult, Level, Say, table
from validation.cases.together import joint
from validation.references.panels import gauss_panels
from validation.verdict import Check, Estimate, Kind

Solver = analytic.Solver | fe_lapjoint.Solver
SOLVERS: tuple[Solver, ...] = (analytic.Solver(n_modes=24), fe_lapjoint.Solver(elements=12))
EXACT = 1e-11  # Relative error of closed forms and of the quadrature of their polynomials, by differences
SEEDS = {"quick": (1, 2), "standard": tuple(range(1, 7)), "full": tuple(range(1, 25))}
"""Random joints of the case `together` whose marches are compared."""
DAMPED, DECAYS = 0.7, 30.0
"""Damping ratio of a march that settles, and its length in decay times of the slowest mode: 1e-13 is left."""
SETTLED = 1e-8
"""Error of the ends of such marches, and motion from equilibrium, divided by the largest of a kind: of what the modes
left out carry, the static residual of 24 modes lacks (2 / 24 pi)^4, 5e-7, and they carry less than a hundredth."""
DURATION = 1.5  # s, of such a motion


@dataclass(frozen=True)
class Cantilever:
    """A cantilever of segments under constant loads over a stop."""

    segments: tuple[tuple[float, float, float], ...]
    """End, m, bending stiffness, N m2, and mass per length, kg/m, of each segment."""
    stop: float
    """Stiffness, N/m."""
    gap: float
    """m."""
    gravity: float = 0.0
    """m/s2, downwards."""
    masses: tuple[tuple[float, float], ...] = ()
    """Position, m, and mass, kg."""
    uniform: tuple[tuple[float, float, float], ...] = ()
    """Start, m, end, m, and force per length, N/m, downwards."""
    points: tuple[tuple[float, float], ...] = ()
    """Position, m, and force, N, downwards."""
    contents: float = 0.0
    """kg/m."""
    added: float = 0.0
    """kg/m."""

    @property
    def length(self) -> float:
        """m."""
        return self.segments[-1][0]

    @property
    def problem(self) -> Problem:
        """The cantilever as a problem."""
        parts = tuple(BeamSegment(to=x, bending_stiffness=EI, mass_per_length=m) for x, EI, m in self.segments)
        fluid = {"contents_per_length": self.contents, "added_mass_per_length": self.added}
        return Problem(
            beam=Beam(length=self.length, segments=parts, **fluid),
            supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
            stops=(Stop(x=self.length, side="bottom", gap=self.gap, stiffness=self.stop),),
            masses=tuple(Mass(x=x, mass=mass) for x, mass in self.masses),
            gravity=Gravity(acceleration=-self.gravity),
            uniform_loads=tuple(UniformLoad(start=a, to=b, force_per_length=-q) for a, b, q in self.uniform),
            point_loads=tuple(StepLoad(x=x, force=-force) for x, force in self.points),
        )

    @property
    def loads(self) -> tuple[list[tuple[float, float, float]], list[tuple[float, float]]]:
        """All loads, downwards: along pieces, m, m and N/m, and at points, m and N."""
        starts = (0.0, *(x for x, *_ in self.segments))
        weight = [
            (a, b, self.gravity * (m + self.contents)) for a, (b, _, m) in zip(starts, self.segments, strict=False)
        ]
        return [*weight, *self.uniform], [*((x, self.gravity * m) for x, m in self.masses), *self.points]

    def moment(self, x: FloatArray) -> FloatArray:
        """Moment about positions, m, of all loads beyond, N m, as by a force downwards."""
        pieces, points = self.loads
        total = sum((force * np.maximum(at - x, 0.0) for at, force in points), np.zeros_like(x))
        for a, b, q in pieces:
            total = total + q / 2 * (np.maximum(b - x, 0.0) ** 2 - np.maximum(a - x, 0.0) ** 2)
        return np.asarray(total)

    @property
    def answers(self) -> tuple[float, ...]:
        """The numbers of QUANTITIES."""
        pieces, points = self.loads
        edges = np.unique(
            [0.0, *(x for x, *_ in self.segments), *(x for x, _ in points), *(x for p in pieces for x in p[:2])]
        )
        x, w = gauss_panels(edges, 6)
        ends, stiffness = (np.array([segment[i] for segment in self.segments]) for i in (0, 1))
        bent = w * (self.length - x) / stiffness[np.searchsorted(ends, x)]
        free, flexible = float(bent @ self.moment(x)), float(bent @ (self.length - x))
        push = max((free - self.gap) / (flexible + 1 / self.stop), 0.0)
        whole = sum((b - a) * q for a, b, q in pieces) + sum(force for _, force in points)
        about = float(self.moment(np.zeros(1))[0])
        return push, flexible * push - free, whole - push, about - push * self.length


QUANTITIES = {"force of the stop": "N", "tip": "m", "force of the clamp": "N", "couple of the clamp": "N m"}
"""Unit of each number."""
UNIFORM = ((1.4, 310.0, 2.3),)
CANTILEVERS = {
    "gravity": Cantilever(UNIFORM, 900.0, 4e-3, gravity=9.81),
    "gravity, out of reach": Cantilever(UNIFORM, 900.0, 0.5, gravity=9.81),
    "pressed alone": Cantilever(UNIFORM, 900.0, -7e-3),
    "gravity on contents, not on added mass": Cantilever(UNIFORM, 2.5e5, -1e-3, gravity=9.81, contents=0.9, added=1.7),
    "two segments and all loads": Cantilever(
        ((0.5, 310.0, 2.3), (1.4, 95.0, 1.2)),
        3.1e3,
        -2e-3,
        gravity=9.81,
        masses=((1.4, 0.7), (0.8, 0.4)),
        uniform=((0.3, 0.9, 21.0), (0.0, 0.6, -13.0)),
        points=((1.1, 8.0),),
        contents=0.5,
        added=0.8,
    ),
}


def answers(found: Equilibrium) -> tuple[tuple[float, float], ...]:
    """The numbers of QUANTITIES, with their stated errors."""
    tip, errors = found.problem.line.length, found.errors
    return (
        (float(found.contact_forces[0]), float(errors.contact_forces[0])),
        (float(found.displacement(tip)[0]), errors.displacement),
        (float(found.support_forces[0]), float(errors.support_forces[0])),
        (float(found.support_moments[0]), float(errors.support_moments[0])),
    )


def against_closed_forms() -> Iterator[Check]:
    """Every cantilever by both solvers."""
    for label, of in CANTILEVERS.items():
        for solver in SOLVERS:
            numbers = answers(solver.equilibrium(of.problem))
            for (what, unit), (value, error), exact in zip(QUANTITIES.items(), numbers, of.answers, strict=True):
                closed = Estimate(exact, EXACT * abs(exact), "integrals of the moment", Kind.ANALYTICAL)
                found = Estimate(value, error, f"{solver.name}, as stated")
                yield Check(f"{label}, {what}: {solver.name}", unit, found, closed)


def settled(seed: int) -> Iterator[Check]:
    """A random joint without excitation: both equilibria, the end of a damped march, and a start in equilibrium."""
    loose = joint(seed).replace(base_motion=None, damping=ModalDamping(ratio=DAMPED))
    both = [solver.equilibrium(loose) for solver in SOLVERS]
    places = np.array([stop.x for stop in loose.stops])  # at these elements lack nothing, as they are nodes
    size = max(float(np.abs(both[0].displacement(places)).max()), 1e-300)
    pressed = max(float(both[0].contact_forces.max()), 1e-300)
    for what, unit, values, errors in (
        (
            "deflection",
            "m",
            [it.displacement(places) for it in both],
            [np.full(places.size, it.errors.displacement) for it in both],
        ),
        ("contact force", "N", [it.contact_forces for it in both], [it.errors.contact_forces for it in both]),
    ):
        for i in range(places.size):
            one, other = (
                Estimate(float(value[i]), float(error[i]), f"{solver.name}, as stated")
                for value, error, solver in zip(values, errors, SOLVERS, strict=True)
            )
            yield Check(f"joint {seed}, {what} {i + 1}: analytic against FE", unit, one, other)
    end = DECAYS / (DAMPED * float(SOLVERS[0].modes(loose, FREE, 1).angular_frequencies[0]))
    for solver, found in zip(SOLVERS, both, strict=True):
        marched = solver.simulate(loose, end, errors=False)
        resting = solver.simulate(loose.replace(initial=AtEquilibrium()), DURATION, errors=False)
        moved = np.abs(
            resting.displacement(places, np.linspace(0.0, DURATION, 7)) - found.displacement(places)[:, None]
        )
        still = Estimate(float(moved.max()), 0.0, solver.name)
        rest = Estimate(0.0, SETTLED * size, "it rests")
        yield Check(f"joint {seed}, motion from equilibrium: {solver.name}", "m", still, rest)
        for what, unit, now, then, largest in (
            ("deflection", "m", marched.displacement(places, end)[:, 0], found.displacement(places), size),
            ("force", "N", np.abs(marched.contact_force(end)[:, 0]), found.contact_forces, pressed),
        ):
            for i, (a, b) in enumerate(zip(now.tolist(), then.tolist(), strict=True)):
                ended = Estimate(a, SETTLED * largest, f"{solver.name}, march of {end:g} s")
                rest = Estimate(b, 0.0, "equilibrium")
                yield Check(f"joint {seed}, {what} {i + 1} that a march settles to: {solver.name}", unit, ended, rest)


def run(level: Level, say: Say) -> CaseResult:
    """Closed forms, and random joints."""
    say("cantilevers over a stop")
    checks = list(against_closed_forms())
    for seed in SEEDS[level]:
        say(f"joint {seed}")
        checks += settled(seed)
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "resting",
        "Static equilibrium under gravity, loads and preload",
        "Cantilevers over a stop under their tips, uniform or of two segments, under gravity, masses, uniform loads "
        "and point forces, with gaps and interferences: force of the stop, deflection, and what the clamp takes, "
        "against integrals of the moment. Random joints with every part: both solvers' equilibria, and those against "
        "the ends of heavily damped marches from the straight beam. A motion that starts in equilibrium stays.",
        checks=tuple(checks),
        tables=(table("Equilibria", ("quantity", "unit", "reference", "found", "difference", "allowed"), rows),),
    )
