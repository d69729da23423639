"""A beam on two pins under every kind of load, against the sum over its sines: displacements, moments, shear forces."""

from __future__ import annotations

import cmath
import math
from collections.abc import Iterator

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import History
from lapjoint.problem.files import from_toml
from validation.case import CaseResult, Level, Say, table
from validation.references.panels import gauss_panels
from validation.references.pinned_beam import PinnedBeam
from validation.uncertainty import elements, refined_vector
from validation.verdict import Check, Estimate, Kind

LOADED = """
title = "Base motion, loads of every kind, five damping ratios"
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
[[point_loads]]
kind = "harmonics"
x = 0.8
angular_frequency = 60.0
harmonics = [{multiple = 3, force = 16.0, phase = -1.1}, {multiple = 1, force = 21.0, phase = 0.5}]
[initial]
kind = "polynomial"
displacement = [0.0, 1.6e-3, -1e-3]
velocity = [0.0, 0.0, 0.16, -0.1]
"""
# Without curvature at the pins, and under a uniform load, short waves hardly ring.
RINGING = """
title = "Viscous damping, from a sampled shape, two harmonics of the base"
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
kind = "harmonics"
angular_frequency = 120.0
harmonics = [{multiple = 1, amplitude = 2e-3, phase = 0.4}, {multiple = 2, amplitude = 3e-4, phase = -0.9}]
[initial]
kind = "sampled"
x = [0.0, 0.2, 0.4, 0.6, 0.8, 1.0, 1.2, 1.4, 1.6]
displacement = [0.0, 7.654e-4, 1.4142e-3, 1.8478e-3, 2e-3, 1.8478e-3, 1.4142e-3, 7.654e-4, 0.0]
velocity = [0.0, -0.0707, -0.1, -0.0707, 0.0, 0.0707, 0.1, 0.0707, 0.0]
"""
OVERDAMPED = RINGING.replace("coefficient = 13.0", "coefficient = 800.0")
"""Damping above critical for the first mode, 2 m omega_1 = 520 N s/m2, and below critical for all others."""
FREE = """
title = "Free beam under a step load and base motion"
[beam]
length = 1.6
bending_stiffness = 1209.6
mass_per_length = 3.768
[damping]
kind = "{kind}"
{value}
[base_motion]
amplitude = 1.5e-3
angular_frequency = 95.0
phase = 1.1
[[point_loads]]
kind = "step"
x = 1.2
force = 42.0
"""
BEAMS = {"loaded": LOADED, "ringing": RINGING, "overdamped": OVERDAMPED}
PLACES, TIMES = (0.3, 0.9), (0.0613, 0.1307)
"""Positions, m, at no node of the coarsest mesh, and times, s, at no multiple of a period."""
DURATION = 0.14  # Length of the motion, s
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
"""Quantities that few modes give for a beam with equal decay rates of all waves; velocity needs the short waves."""
TRUNCATION = {"displacement": 2e-6, "velocity": 1e-5, "slope": 5e-5, "bending moment": 1e-5, "shear force": 1e-4}
"""Error, divided by the largest value of its kind: 24 modes and the static residual lack a part of the waves that a
jump of a load sends out."""
CONSERVED = 1e-7  # Relative error of quadrature, and rounding of the finite elements' rigid-body modes
FEW = 3  # Number of modes, of a motion that six waves drive
SUMMED = 1e-8  # Truncation error of the witness, divided by the largest value of its kind


def found(history: History, x: float, t: float) -> tuple[float, ...]:
    """All quantities of a History at a place and time."""
    parts = (history.displacement, history.velocity, history.slope, history.moment, history.shear)
    return tuple(float(part(x, t)[0, 0]) for part in parts)


def exact(beam: PinnedBeam, x: float, t: float) -> tuple[float, ...]:
    """Displacement, velocity, slope, moment and shear force by the sum over the sines."""
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
        if label != "loaded" and name not in RINGING_SHOWS:
            continue
        size = max(abs(values[i]) for values in witness)
        levels = np.array([[found(history, x, t)[i] for x, t in points] for history in meshes])
        by_mesh = refined_vector(levels, 2.0, order, elements(MESHES[-1]), 1e-7)
        for (x, t), values, b in zip(points, witness, by_mesh, strict=True):
            reference = Estimate(values[i], SUMMED * size, "sum over the sines, by numpy alone", Kind.ANALYTICAL)
            a = Estimate(found(whole, x, t)[i], TRUNCATION[name] * size, f"{MODES} modes")
            for solver, estimate in (("analytic", a), ("FE", b)):
                checks.append(Check(f"{label}, {name} at {x:g} m, {t:g} s: {solver}", unit, estimate, reference))
    return checks


def free_flight(kind: str, value: str, decay: float) -> Iterator[Check]:
    """Centre and rotation of a free beam against the equations of a rigid body, as elastic modes move neither.  Under
    viscous damping of coefficient C both rates decay with 2 a = C / m; modal ratios do not damp a rigid body."""
    problem = from_toml(FREE.format(kind=kind, value=value))
    L, m, Y, w, phase, force, at, t = 1.6, 3.768, 1.5e-3, 95.0, 1.1, 42.0, 1.2, DURATION
    # Under a constant acceleration of 1, and under the motion of the base.
    one = t**2 / 2 if decay == 0 else (t - (1 - math.exp(-2 * decay * t)) / (2 * decay)) / (2 * decay)
    wave = Y * w**2 / (-(w**2) + 2j * decay * w)
    begin, now = wave * cmath.exp(1j * phase), wave * cmath.exp(1j * (w * t + phase))
    leave = (1j * w * begin).imag
    gone = t if decay == 0 else (1 - math.exp(-2 * decay * t)) / (2 * decay)
    centre = force / (m * L) * one + (now - begin).imag - leave * gone
    turn = force * (at - L / 2) / (m * L**3 / 12) * one
    places, weights = gauss_panels(np.linspace(0.0, L, 41), 12)
    for solver in (analytic.Solver(n_modes=MODES), fe_lapjoint.Solver(elements=MESHES[0])):
        z = solver.simulate(problem, DURATION, errors=False).displacement(places, t)[:, 0]
        for name, unit, value_found, reference in (
            ("centre", "m", weights @ z / L, centre),
            ("turn", "rad", weights @ (z * (places - L / 2)) / (L**3 / 12), turn),
        ):
            a = Estimate(float(value_found), CONSERVED * abs(reference), f"{solver.name}, integrated along the beam")
            b = Estimate(reference, 0.0, "rigid body", Kind.ANALYTICAL)
            yield Check(f"free beam, {kind} damping, {name}: {solver.name}", unit, a, b)


def rates() -> Iterator[Check]:
    """Velocity and acceleration against their integrals, with so few modes that the static residual is tested."""
    problem = from_toml(LOADED)
    t, weights = gauss_panels(np.linspace(*TIMES, 201), 20)
    for solver in (analytic.Solver(n_modes=FEW), fe_lapjoint.Solver(elements=MESHES[0])):
        history = solver.simulate(problem, DURATION, errors=False)
        for name, unit, order in (("velocity", "m", 1), ("acceleration", "m/s", 2)):
            integral = history.evaluate(PLACES[0], t, dt=order)[0] @ weights
            ends = history.evaluate(PLACES[0], np.array(TIMES), dt=order - 1)[0]
            u = CONSERVED * float(np.abs(ends).max())
            a = Estimate(float(integral), u, f"{solver.name}, integrated over time")
            b = Estimate(float(ends[1] - ends[0]), u, "what it is the rate of")
            yield Check(f"integral of the {name}: {solver.name}", unit, a, b)


def run(level: Level, say: Say) -> CaseResult:
    """Three beams on two pins, and a free beam under two kinds of damping."""
    checks = []
    for label, text in BEAMS.items():
        say(label)
        checks += compared(label, text)
    for kind, value, decay in (("modal", "ratio = 0.04", 0.0), ("viscous", "coefficient = 11.0", 11.0 / (2 * 3.768))):
        say(f"free, {kind} damping")
        checks += free_flight(kind, value, decay)
    checks += rates()
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.a.uncertainty:.1e}", f"{c.difference:.1e}") for c in checks]
    return CaseResult(
        "pinned-beam",
        "A beam on two pins under every kind of load",
        "Without stops a beam on two pins is a sum over sines. The witness sums it by numpy alone from the problem "
        "file's text: base motion and loads by sines and harmonics with phases, a step load, polynomial and sampled "
        "initial shapes and velocities, five different damping ratios, viscous damping. Compared are displacement, "
        "velocity, slope, bending moment and shear force; of a free beam centre and turn, which obey the equations of "
        "a rigid body; of velocity and acceleration their integrals.",
        checks=tuple(checks),
        tables=(table("Beam on two pins", ("quantity", "unit", "witness", "found", "u", "difference"), rows),),
    )
