"""The shared package: segments, fluids, masses, static loads, and stops that press or stand still, as they are given.

Both solvers share what these parts mean: which stiffness, inertia and weight the beam has where, and what a stop sees.
The references are the values of the file by `tomllib`, and plain arithmetic.
"""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from lapjoint import FREE, History, Problem
from lapjoint.orbits import parameters
from lapjoint.problem import FloatArray
from lapjoint.problem.files import from_toml, to_toml
from lapjoint.problem.load_shape import LoadShape
from validation.case import CaseResult, Level, Say
from validation.cases.as_given import as_given, overridden, read_as_written, same
from validation.verdict import Check

ROUNDING = 1e-14  # Relative rounding of a few operations
FILE = """
title = "Every kind of further part"
[beam]
length = 1.8
material = {youngs_modulus = 7.1e10, density = 2713.0}
contents_per_length = 0.85
added_mass_per_length = 1.37
[[beam.segments]]
to = 0.55
section = {shape = "tube", outer_diameter = 0.061, inner_diameter = 0.047}
[[beam.segments]]
to = 1.15
material = {youngs_modulus = 2.05e11, density = 7890.0}
section = {shape = "rectangle", breadth = 0.033, height = 0.021}
[[beam.segments]]
to = 1.8
section = {shape = "circle", diameter = 0.036}
[[supports]]
x = 0.0
translational = inf
torsional = inf
[[masses]]
name = "clevis"
x = 1.8
mass = 2.6
rotary_inertia = 3.7e-3
[[masses]]
x = 0.7
mass = 0.45
[[stops]]
name = "pad"
x = 0.7
side = "bottom"
gap = -4.1e-4
stiffness = 2.9e5
[[stops]]
name = "wall"
x = 1.8
side = "top"
gap = 1.9e-3
stiffness = 6.3e4
fixed_to = "space"
[[stops]]
name = "floor"
x = 1.8
side = "bottom"
gap = 2.3e-3
stiffness = 5.9e4
fixed_to = "base"
[gravity]
acceleration = -9.73
[[uniform_loads]]
from = 0.35
to = 1.25
force_per_length = -31.0
[[uniform_loads]]
to = 0.95
force_per_length = 17.0
[[uniform_loads]]
from = 0.15
force_per_length = 5.5
[base_motion]
amplitude = 1.7e-3
angular_frequency = 83.0
phase = 0.61
"""
PARTS = (
    (
        0.0,
        0.55,
        7.1e10 * math.pi * (0.061**4 - 0.047**4) / 64,
        2713.0 * math.pi * (0.061**2 - 0.047**2) / 4,
        0.061 / 2,
        7.1e10,
    ),
    (0.55, 1.15, 2.05e11 * 0.033 * 0.021**3 / 12, 7890.0 * 0.033 * 0.021, 0.021 / 2, 2.05e11),
    (1.15, 1.8, 7.1e10 * math.pi * 0.036**4 / 64, 2713.0 * math.pi * 0.036**2 / 4, 0.036 / 2, 7.1e10),
)
"""Start and end, m, bending stiffness, N m2, mass per length, kg/m, distance of the faces from the axis, m, and Young's
modulus, Pa, of each segment by arithmetic."""
CONTENTS, ADDED = 0.85, 1.37  # kg/m
CARRIED = ((1.8, 2.6), (0.7, 0.45))  # Position, m, and mass, kg
LOADS = ((0.35, 1.25, -31.0), (0.0, 0.95, 17.0), (0.15, 1.8, 5.5))  # Start and end, m, and force per length, N/m
AMPLITUDE, OMEGA, PHASE = 1.7e-3, 83.0, 0.61  # of the base: m, rad/s, rad
STOPS = ((0.7, -1, -4.1e-4, 2.9e5, False), (1.8, 1, 1.9e-3, 6.3e4, True), (1.8, -1, 2.3e-3, 5.9e4, False))
"""Position, m, sign, gap, m, stiffness, N/m, of each stop, and whether it stands still."""
OVERRIDES = {
    "beam.segments[1].to=1.05": ("beam.segments[1].to", 1.05),
    "beam.segments.0.section.inner_diameter=0.04": ("beam.segments[0].section.inner_diameter", 0.04),
    "beam.contents_per_length=0.2": ("beam.contents_per_length", 0.2),
    "masses.clevis.rotary_inertia=1e-3": ("masses[0].rotary_inertia", 1e-3),
    "masses[1].mass=0.9": ("masses[1].mass", 0.9),
    "gravity.acceleration=1.62": ("gravity.acceleration", 1.62),
    "uniform_loads[0].from=0.4": ("uniform_loads[0].from", 0.4),
    "stops.pad.gap=-1e-4": ("stops[0].gap", -1e-4),
}
"""Arguments of ``--set``, and the one value that each changes."""


TWO = """
title = "Two beams that one base shakes"
[[beams]]
name = "upper"
length = 1.3
bending_stiffness = 31.0
mass_per_length = 2.3
base_share = 0.7
gravity_share = 0.4
[[beams.masses]]
x = 0.9
mass = 0.35
[[beams]]
name = "lower"
origin = 0.6
length = 0.8
bending_stiffness = 47.0
mass_per_length = 1.9
base_share = -0.3
gravity_share = -0.8
[[stops]]
between = ["upper:0.85", "lower:0.27"]
gap = 4e-4
stiffness = 5.3e4
[[stops]]
x = "lower:0.7"
side = "top"
gap = 6e-4
stiffness = 3.1e4
fixed_to = "space"
[[point_loads]]
kind = "step"
x = "lower:0.7"
force = 11.0
[gravity]
acceleration = -9.73
[base_motion]
amplitude = 1.7e-3
angular_frequency = 83.0
phase = 0.61
"""
BEAMS = ((1.3, 2.3, 0.35, 0.7, 0.4), (0.8, 1.9, 0.0, -0.3, -0.8))
"""Length, m, mass per length, kg/m, lumped mass, kg, and shares of the base's motion and of gravity of each beam."""
BETWEEN = (0.85, 0.27, 4e-4, 5.3e4)  # Positions on the first and the second beam, m, gap, m, and stiffness, N/m
IN_SPACE = (0.7, 6e-4, 3.1e4)  # Position on the second beam, m, gap, m, and stiffness, N/m
SHAPES = (7e-4, -1.1e-3)  # Displacement of each beam over the square of the position on it, 1/m


def along_the_beam(problem: Problem) -> Iterator[Check]:
    """Stiffness, inertia and stress of each segment, and where two meet."""
    beam = problem.line
    for i, (start, end, EI, mass, *_) in enumerate(PARTS):
        piece, name = beam.pieces[i], f"segment {i + 1}"
        for what, found, exact, unit in (
            ("start", piece.start, start, "m"),
            ("end", piece.end, end, "m"),
            ("stiffness", piece.EI, EI, "N m2"),
            ("mass on which gravity acts", piece.mass, mass + CONTENTS, "kg/m"),
            ("mass that moves", piece.inertia, mass + CONTENTS + ADDED, "kg/m"),
        ):
            yield same(f"{name}: {what}", found, exact, unit, 10 * ROUNDING)
        x = np.array([(start + end) / 2, end])  # at a step the values are those of the segment to the left
        for at, found_EI, found_m in zip(x, beam.EI_at(x), beam.inertia_at(x), strict=True):
            yield same(f"stiffness at {at:g} m", found_EI, EI, "N m2", 10 * ROUNDING)
            yield same(f"inertia at {at:g} m", found_m, mass + CONTENTS + ADDED, "kg/m", 10 * ROUNDING)
        found = beam.stress_per_moment_at(x[:1])[0]
        yield same(f"stress per moment at {x[0]:g} m", found, stress_per_moment(i), "1/m3", 10 * ROUNDING)
    for i in (1, 2):
        step = PARTS[i][0]
        larger = max(stress_per_moment(i - 1), stress_per_moment(i))
        found = beam.stress_per_moment_at(np.array([step]))[0]
        yield same(f"stress per moment at the step at {step:g} m", found, larger, "1/m3", 10 * ROUNDING)
    L = 1.8
    soft = L / sum((end - start) / EI for start, end, EI, *_ in PARTS)
    heavy = sum((end - start) * (mass + CONTENTS + ADDED) for start, end, _, mass, *_ in PARTS) / L
    yield same("stiffness of the whole beam", beam.EI, soft, "N m2", 10 * ROUNDING)
    yield same("mass per length of the whole beam", beam.m, heavy, "kg/m", 10 * ROUNDING)


def stress_per_moment(i: int) -> float:
    """c / I of a segment, 1/m3."""
    _, _, EI, _, face, E = PARTS[i]
    return face / (EI / E)


def resultant(shape: LoadShape) -> tuple[float, float]:
    """Sum of the forces of a load of size 1, and their moment about the root."""
    forces = [*shape.points, *(((start + end) / 2, (end - start) * force) for start, end, force in shape.pieces)]
    return sum(force for _, force in forces), sum(x * force for x, force in forces)


def loads(problem: Problem) -> Iterator[Check]:
    """Resultants of the weight, of the inertia and of all constant and harmonic forces, at one time."""
    dry = [((start + end) / 2, (end - start) * (mass + CONTENTS)) for start, end, _, mass, *_ in PARTS]
    around = [((start + end) / 2, (end - start) * ADDED) for start, end, *_ in PARTS]
    weight, inertia = (*dry, *CARRIED), (*dry, *around, *CARRIED)
    pushed = tuple(((start + end) / 2, (end - start) * force) for start, end, force in LOADS)
    t = 0.0217
    acceleration = AMPLITUDE * OMEGA**2 * math.sin(OMEGA * t + PHASE)
    acting = [
        *((x, -9.73 * m) for x, m in weight),
        *pushed,
        *((x, acceleration * m) for x, m in inertia),
    ]
    now = np.array([t])
    by_force = [(float(one.at(now)[0]), resultant(one.shape)) for one in problem.forces.every]
    structure = problem.structure
    for name, found, parts, unit in (
        ("weight", resultant(structure.weight), weight, "kg"),
        ("inertia", resultant(structure.inertia), inertia, "kg"),
        ("forces", tuple(sum(size * both[i] for size, both in by_force) for i in (0, 1)), acting, "N"),
    ):
        for value, exact, what in zip(
            found, (sum(f for _, f in parts), sum(x * f for x, f in parts)), ("", " m"), strict=True
        ):
            yield same(f"{name}, {'moment' if what else 'sum'}", value, exact, unit + what, 100 * ROUNDING)
    found_loads = [one for one in problem.forces.constant if one.shape != structure.weight]
    for i, (one, (start, end, force)) in enumerate(zip(found_loads, LOADS, strict=True)):
        ((a, b, size),) = one.shape.pieces
        for what, found_value, exact in (("start", a, start), ("end", b, end), ("force", one.force * size, force)):
            yield same(f"uniform load {i + 1}: {what}", found_value, exact, "N/m" if what == "force" else "m")


def by_excitation(problem: Problem) -> Iterator[Check]:
    """Derivatives of the logarithms of all amplitudes by those of the base's motion: Y omega^2 of the inertia, and Y of
    what the stops in space see."""
    known = {parameters.FREQUENCY: (2 / OMEGA, 0.0, 1 / OMEGA), parameters.AMPLITUDE: (*(1 / AMPLITUDE,) * 2, 0.0)}
    for path, exact in known.items():
        change = parameters.excitation_change(problem, path)
        assert change is not None
        found = (*change.sizes.tolist(), change.frequency)
        for what, a, b in zip(("inertia", "motion of stops", "frequency"), found, exact, strict=False):
            yield same(f"derivative of the {what} by {path}", a, b, "SI", ROUNDING)


def seen(problem: Problem) -> Iterator[Check]:
    """Forces of stops that press the straight beam or stand still, and moments on both sides of a step, of a motion in
    closed form."""

    def motion(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        shape = 9e-4 * (x**3, 3 * x**2, 6 * x, np.full_like(x, 6.0))[dx]
        return np.outer(shape, OMEGA**dt * np.sin(OMEGA * t + dt * math.pi / 2))

    history = History(problem, "written down", 0.0, 0.08, np.zeros(0), (FREE,), (), motion)
    for t in (0.0123, 0.0391, 0.0612):
        wave, y = 9e-4 * math.sin(OMEGA * t), AMPLITUDE * math.sin(OMEGA * t + PHASE)
        for k, (x, sign, gap, stiffness, still) in enumerate(STOPS):
            z = wave * x**3 + (y if still else 0.0)
            force = -sign * stiffness * max(sign * z - gap, 0.0)
            name = f"force of {problem.stop_names[k]} at {t:g} s"
            yield same(name, history.contact_force(t)[k, 0], force, "N", 1e4 * ROUNDING)
            yield same(f"what {problem.stop_names[k]} sees at {t:g} s", history.seen_by_stops(t)[k, 0], z, "m", 1e-12)
        yield same(f"base at {t:g} s", history.base(t)[0], y, "m", 100 * ROUNDING)
        for start, end, EI, *_ in PARTS:
            for x in ((start + end) / 2, end):
                moment = EI * 6 * wave * x
                yield same(f"moment at {x:g} m, {t:g} s", history.moment(x, t)[0, 0], moment, "N m", 100 * ROUNDING)
        for i in (1, 2):
            x = PARTS[i][0]
            moment = PARTS[i - 1][2] * 6 * wave * x
            stress = -max(stress_per_moment(i - 1), stress_per_moment(i)) * moment
            found = history.bending_stress(x, t)[0, 0]
            yield same(f"stress at the step at {x:g} m, {t:g} s", found, stress, "Pa", 100 * ROUNDING)


def of_two_beams(problem: Problem) -> Iterator[Check]:
    """What base motion and gravity act on, and what stops see and do, of two beams in a motion in closed form."""
    for name, shape, share in (("inertia", problem.structure.inertia, 3), ("weight", problem.structure.weight, 4)):
        exact = sum(it[share] * (it[0] * it[1] + it[2]) for it in BEAMS)
        yield same(f"two beams: {name}, sum", resultant(shape)[0], exact, "kg", 100 * ROUNDING)
    upper, lower = problem.line.starts

    def motion(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        second = x >= lower
        own = x - np.where(second, lower, upper)
        return np.outer(np.where(second, SHAPES[1], SHAPES[0]) * own**2, np.sin(OMEGA * t))

    history = History(problem, "written down", 0.0, 0.08, np.zeros(0), (FREE,), (), motion)
    (first, second, gap, stiffness), (x, height, hard) = BETWEEN, IN_SPACE
    for t in (0.0123, 0.0591, 0.0612):
        wave, y = math.sin(OMEGA * t), AMPLITUDE * math.sin(OMEGA * t + PHASE)
        apart = wave * (SHAPES[1] * second**2 - SHAPES[0] * first**2) + (BEAMS[1][3] - BEAMS[0][3]) * y
        at_wall = wave * SHAPES[1] * x**2 + BEAMS[1][3] * y
        for k, (z, free, k_stop) in enumerate(((apart, gap, stiffness), (at_wall, height, hard))):
            yield same(f"two beams: what stop {k + 1} sees at {t:g} s", history.seen_by_stops(t)[k, 0], z, "m", 1e-12)
            force = k_stop * max(z - free, 0.0)
            yield same(
                f"two beams: force of stop {k + 1} at {t:g} s", -history.contact_force(t)[k, 0], force, "N", 1e-10
            )
    (step,) = problem.forces.constant[-1].shape.points
    yield same("two beams: place of the load", step[0], lower + 0.7, "m", 10 * ROUNDING)


def run(level: Level, say: Say) -> CaseResult:
    """All comparisons with plain numbers."""
    say("file, arithmetic")
    problem = from_toml(FILE)
    items = [
        *read_as_written(problem, "read", FILE),
        *read_as_written(from_toml(to_toml(problem)), "written and read again", FILE),
        *overridden(FILE, OVERRIDES),
        *along_the_beam(problem),
        *loads(problem),
        *by_excitation(problem),
        *seen(problem),
        *of_two_beams(from_toml(TWO)),
    ]
    return as_given(
        "parts-as-given",
        "The ground: segments, masses, static loads and stops as given",
        "A beam of three segments of different sections and materials, with contents and added mass, two masses, "
        "gravity, uniform loads, a stop that presses and a stop fixed in space. Every value of its file is compared "
        "with what tomllib reads; stiffness, inertia, weight, resultants of all forces, what stops see, forces, "
        "moments and stresses with plain arithmetic; and what two beams take of the base's motion and of gravity, and "
        "what stops between them see.",
        items,
    )
