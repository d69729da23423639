"""Viscous damping beside a mass and a step, which couples the modes: a shaken cantilever against its closed form."""

from __future__ import annotations

import math

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, Problem, Support, ViscousDamping
from lapjoint.problem import BeamSegment, FloatArray, Mass
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.references.dragged_cantilever import DraggedCantilever
from validation.uncertainty import elements, refined_vector
from validation.verdict import Check, Estimate, Kind

BEAMS = {
    "near resonance": DraggedCantilever((0.4, 0.6), (300.0, 120.0), (3.0, 1.2), 0.9, 0.01, 12.0, 1e-3, 27.0),
    "overdamped": DraggedCantilever((0.55, 0.45), (120.0, 300.0), (1.5, 1.5), 2.0, 0.03, 400.0, 1e-3, 180.0),
}
"""Two cantilevers; in the second one, of one mass per length, slow modes do not oscillate."""
PLACES, TIMES = np.array([0.31, 0.77, 1.0]), np.array([0.0, 0.013])
"""Positions, m, and times after a whole number of periods, s."""
QUANTITIES = {"displacement": ("m", 0, 4.0), "slope": ("1", 1, 3.0)}
"""Unit of each quantity, its order as an x-derivative, and the order in which finite elements converge."""
MODES, MESHES = (12, 24), (8, 16, 32)
FLOOR = 1e-8  # of the largest value of its kind: rounding of both solvers
SUMMED = 1e-12  # rounding of the closed form, of the largest value of its kind


def problem_of(beam: DraggedCantilever) -> Problem:
    """The cantilever as a problem."""
    parts = zip(np.cumsum(beam.lengths).tolist(), beam.stiffness, beam.inertia, strict=True)
    segments = tuple(BeamSegment(to=to, bending_stiffness=EI, mass_per_length=m) for to, EI, m in parts)
    length = segments[-1].to
    return Problem(
        title="A stepped cantilever with a mass at its tip, viscously damped",
        beam=Beam(length=length, segments=segments),
        masses=(Mass(x=length, mass=beam.mass, rotary_inertia=beam.rotary),),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        damping=ViscousDamping(coefficient=beam.drag),
        base_motion=BaseMotion(amplitude=beam.amplitude, angular_frequency=beam.omega),
    )


def answers(solver: Solver, beam: DraggedCantilever, dx: int) -> FloatArray:
    """A quantity at all places and times in the steady state, by a solver, ``(places * times,)``."""
    history = solver.steady_state(problem_of(beam), errors=False).history
    period = 2 * math.pi / beam.omega
    start = round(history.start / period) * period
    return np.asarray(history.evaluate(PLACES, start + TIMES, dx=dx).ravel())


def compared(label: str, beam: DraggedCantilever) -> list[Check]:
    """One cantilever by both solvers."""
    checks = []
    for name, (unit, dx, order) in QUANTITIES.items():
        exact = beam.evaluate(PLACES, TIMES, dx).ravel()
        size = float(np.abs(exact).max())
        few, many = (answers(analytic.Solver(n_modes=n), beam, dx) for n in MODES)
        unsure = float(np.abs(many - few).max()) + FLOOR * size
        levels = np.array([answers(fe_lapjoint.Solver(elements=n), beam, dx) for n in MESHES])
        by_mesh = refined_vector(levels, 2.0, order, elements(MESHES[-1]), FLOOR)
        points = [(x, t) for x in PLACES.tolist() for t in TIMES.tolist()]
        for (x, t), value, a, b in zip(points, exact.tolist(), many.tolist(), by_mesh, strict=True):
            reference = Estimate(value, SUMMED * size, "exponentials, by numpy alone", Kind.ANALYTICAL)
            own = Estimate(a, unsure, f"{MODES[1]} modes, compared with {MODES[0]}")
            for solver, estimate in (("analytic", own), ("FE", b)):
                checks.append(Check(f"{label}, {name} at {x:g} m, {t:g} s: {solver}", unit, estimate, reference))
    return checks


def run(level: Level, say: Say) -> CaseResult:
    """Both cantilevers."""
    checks = []
    for label, beam in BEAMS.items():
        say(label)
        checks += compared(label, beam)
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.a.uncertainty:.1e}", f"{c.difference:.1e}") for c in checks]
    return CaseResult(
        "dragged-masses",
        "Viscous damping beside a mass and a step",
        "Viscous damping acts along the beam and not on the mass at its tip, so that it couples the modes. The steady "
        "vibration of a shaken cantilever has a closed form, of exponentials in each segment.",
        checks=tuple(checks),
        tables=(table("Shaken cantilever", ("quantity", "unit", "closed form", "found", "u", "difference"), rows),),
    )
