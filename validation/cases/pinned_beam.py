"""A beam on two pins under every kind of load, against the sum over its sines: displacements, moments, shear forces."""

from __future__ import annotations

import analytic
import fe_lapjoint
from lapjoint import History
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.references.pinned_beam import PinnedBeam
from validation.uncertainty import refined_estimate
from validation.verdict import Check, Estimate, Kind

LOADED = """
title = "Base motion, step and sine loads, five damping ratios"
[beam]
length = 1.6
material = {youngs_modulus = 2.1e11, density = 7850.0}
section = {shape = "rectangle", breadth = 0.04, height = 0.012}
[[supports]]
x = 0.0
translational = inf
[[supports]]
x = 1.6
translational = inf
[damping]
kind = "modal"
ratio = [0.011, 0.023, 0.047, 0.031, 0.06]
[base_motion]
amplitude = 1.5e-3
angular_frequency = 95.0
phase = 1.1
[[point_loads]]
kind = "step"
x = 0.5
force = 42.0
[[point_loads]]
kind = "sine"
x = 1.2
force = 35.0
angular_frequency = 170.0
phase = -0.6
[initial]
kind = "polynomial"
displacement = [0.0, 1.6e-3, -1e-3]
velocity = [0.0, 0.0, 0.16, -0.1]
"""
# Without curvature at the pins, and under a uniform load, waves of all lengths hardly ring.
RINGING = """
title = "Viscous damping, from a sampled shape"
[beam]
length = 1.6
material = {youngs_modulus = 2.1e11, density = 7850.0}
section = {shape = "rectangle", breadth = 0.04, height = 0.012}
[[supports]]
x = 0.0
translational = inf
[[supports]]
x = 1.6
translational = inf
[damping]
kind = "viscous"
coefficient = 13.0
[base_motion]
amplitude = 2e-3
angular_frequency = 120.0
phase = 0.4
[initial]
kind = "sampled"
x = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6]
displacement = [0.0, 7.654e-4, 1.4142e-3, 1.8478e-3, 2e-3, 1.8478e-3, 1.4142e-3, 7.654e-4, 0.0]
velocity = [0.0, -0.0707, -0.1, -0.0707, 0.0, 0.0707, 0.1, 0.0707, 0.0]
"""
BEAMS = {"loaded": LOADED, "ringing": RINGING}
PLACES, TIMES = (0.3, 0.9), (0.0613, 0.1307)  # m and s: no node of the coarsest mesh, no multiple of a period
DURATION = 0.14  # s
MODES, MESHES = 24, (8, 16, 32)
QUANTITIES = (
    # name, unit, and the order in which finite elements converge at a place
    ("displacement", "m", 4.0),
    ("velocity", "m/s", 4.0),
    ("slope", "1", 3.0),
    ("bending moment", "N m", 2.0),
    ("shear force", "N", 1.0),
)
RINGING_SHOWS = ("displacement", "slope")
"""What few modes have of a beam whose waves of all lengths are damped alike: not the velocity of the short ones."""
TRUNCATION = {"displacement": 2e-6, "velocity": 1e-5, "slope": 5e-5, "bending moment": 1e-5, "shear force": 1e-4}
"""Of the largest value of its kind: what 24 modes and the static residual leave of waves that a jump sent out."""
SUMMED = 1e-8  # of the same: what the witness leaves out


def found(history: History, x: float, t: float) -> tuple[float, ...]:
    """All quantities of a History at a place and time."""
    parts = (history.displacement, history.velocity, history.slope, history.moment, history.shear)
    return tuple(float(part(x, t)[0, 0]) for part in parts)


def exact(beam: PinnedBeam, x: float, t: float) -> tuple[float, ...]:
    """The same by the sum."""
    z = (beam.evaluate(x, t), beam.evaluate(x, t, dt=1), beam.evaluate(x, t, dx=1))
    return (*z, beam.moment(x, t), beam.shear(x, t))


def compared(label: str, text: str) -> list[Check]:
    """One beam by both solvers."""
    problem, beam = from_toml(text), PinnedBeam.from_toml(text)
    whole = analytic.Solver(n_modes=MODES).simulate(problem, DURATION, errors=False)
    meshes = [fe_lapjoint.Solver(elements=n).simulate(problem, DURATION, errors=False) for n in MESHES]
    points = [(x, t) for x in PLACES for t in TIMES]
    witness = [exact(beam, x, t) for x, t in points]
    checks = []
    for i, (name, unit, order) in enumerate(QUANTITIES):
        if label == "ringing" and name not in RINGING_SHOWS:
            continue
        size = max(abs(values[i]) for values in witness)
        for (x, t), values in zip(points, witness, strict=True):
            reference = Estimate(values[i], SUMMED * size, "sum over the sines, by numpy alone", Kind.ANALYTICAL)
            a = Estimate(found(whole, x, t)[i], TRUNCATION[name] * size, f"{MODES} modes")
            levels = [found(history, x, t)[i] for history in meshes]
            b = refined_estimate(levels, 2.0, order, f"{MESHES[-1]} elements", 1e-7)
            for solver, estimate in (("analytic", a), ("FE", b)):
                checks.append(Check(f"{label}, {name} at {x:g} m, {t:g} s: {solver}", unit, estimate, reference))
    return checks


def run(level: Level, say: Say) -> CaseResult:
    """Both beams."""
    checks = []
    for label, text in BEAMS.items():
        say(label)
        checks += compared(label, text)
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.a.uncertainty:.1e}", f"{c.difference:.1e}") for c in checks]
    return CaseResult(
        "pinned-beam",
        "A beam on two pins under every kind of load",
        "Without stops a beam on two pins is a sum over sines. The witness sums it by numpy alone from the problem "
        "file's text: base motion and sine loads with phases, a step load, polynomial and sampled initial shapes and "
        "velocities, five different damping ratios, viscous damping. Compared are displacement, velocity, slope, "
        "bending moment and shear force.",
        checks=tuple(checks),
        tables=(table("Beam on two pins", ("quantity", "unit", "witness", "found", "u", "difference"), rows),),
    )
