"""The shared package: is a problem read as it is written, and is the arithmetic of answers right?

Both solvers share the problem and the types of answers, so their comparison reveals no mistake in these.  The
references here are plain numbers: the values of the file by `tomllib`, the values of the paper's tables, and closed
forms.
"""

from __future__ import annotations

import itertools
import math
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from scipy.integrate import solve_ivp

import analytic
import fe_lapjoint
from fe_lapjoint import ExactPropagator
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes, refined_nodes
from lapjoint import FREE, BaseMotion, ContactState, History, Problem, paper_joint, paper_state_number, sdnl104
from lapjoint.answers import Contact
from lapjoint.answers.steady_state import chatters, impulses_per_period
from lapjoint.orbits.exponent import exponent_of
from lapjoint.problem import FloatArray, PolynomialShape
from lapjoint.problem.files import from_toml, problem_from_tables, to_toml
from lapjoint.problem.load_shape import LoadShape
from lapjoint.problem.override import override
from validation.case import CaseResult, Level, Say, table
from validation.cases.textbook_equations import BEAMS, roots
from validation.references.reading import Printed, group
from validation.verdict import Check, Criterion, Estimate, Kind

ROUNDING = 1e-14  # Relative rounding of a few operations
PHASES = 1e-10  # Rounding of phases of some hundred turns, divided by the displacement at the start
SHORT_STRETCH = 1e-3  # Distance to another stop, m: so short that elements between the two need not be cut again
STEP = 0.1  # Step of a range, m: rounding makes 25 of them more than 2.5 m
EIGENVALUES = 1e-5  # Relative error of the first frequency with 16 elements
FILE = """
title = "Every kind of part"
[beam]
length = 2.25
[beam.material]
youngs_modulus = 7.1e10
density = 2713.0
[beam.section]
shape = "tube"
outer_diameter = 0.061
inner_diameter = 0.047
[[supports]]
x = 0.0
translational = inf
torsional = 8.1e4
[[supports]]
x = 1.75
translational = 3.3e5
torsional = 410.0
[[stops]]
name = "tip"
x = 2.25
side = "bottom"
gap = 1.3e-3
stiffness = 5.7e5
[[stops]]
name = "inner"
x = 0.9
side = "top"
gap = 0.7e-3
stiffness = 2.9e5
[damping]
kind = "modal"
ratio = [0.013, 0.027, 0.041]
[base_motion]
amplitude = 2.7e-3
angular_frequency = 143.0
phase = 0.37
[[point_loads]]
kind = "step"
x = 1.1
force = -17.0
[[point_loads]]
kind = "sine"
x = 0.45
force = 23.0
angular_frequency = 143.0
phase = -1.21
[[point_loads]]
kind = "harmonics"
x = 1.6
angular_frequency = 71.5
harmonics = [{multiple = 1, force = 5.0, phase = 0.8}, {multiple = 3, force = -7.0, phase = -0.3}]
[initial]
kind = "polynomial"
displacement = [0.0, 0.0, 1.9e-4, -3.1e-5]
velocity = [0.0, 0.07, 0.011]
"""
SECTIONS = {
    'shape = "rectangle"\nbreadth = 0.3\nheight = 0.05': (0.3 * 0.05, 0.3 * 0.05**3 / 12),
    'shape = "circle"\ndiameter = 0.2': (math.pi * 0.2**2 / 4, math.pi * 0.2**4 / 64),
    'shape = "tube"\nouter_diameter = 0.061\ninner_diameter = 0.047': (
        math.pi * (0.061**2 - 0.047**2) / 4,
        math.pi * (0.061**4 - 0.047**4) / 64,
    ),
}
"""Area, m2, and second moment, m4, of each section by arithmetic."""


def same(name: str, found: float, reference: float, unit: str = "SI", rounding: float = 0.0) -> Check:
    """A number against its exact value, to relative rounding."""
    a = Estimate(float(found), rounding * abs(reference), "as the project has it")
    return Check(name, unit, a, Estimate(float(reference), 0.0, "plain arithmetic", Kind.ANALYTICAL))


def leaves(tables: Any, path: str = "") -> Iterator[tuple[str, Any]]:
    """All values of nested tables and lists, with their paths."""
    if isinstance(tables, Mapping):
        for key, value in tables.items():
            yield from leaves(value, f"{path}.{key}" if path else key)
    elif isinstance(tables, Sequence) and not isinstance(tables, str):
        for i, value in enumerate(tables):
            yield from leaves(value, f"{path}[{i}]")
    else:
        yield path, tables


def field(part: Any, path: str) -> Any:
    """The value at a path of a problem; ``from``, a word of Python, is called `start`."""
    for key in path.replace("[", ".").replace("]", "").split("."):
        part = part[int(key)] if key.isdigit() else getattr(part, "start" if key == "from" else key)
    return part


def read_as_written(problem: Problem, how: str, text: str = FILE) -> Iterator[Check | Criterion]:
    """Every value of a file's text against the problem."""
    words = []
    for path, value in leaves(tomllib.loads(text)):
        found = field(problem, path)
        if isinstance(value, str) or math.isinf(value):
            words.append(found == value)
        else:
            yield same(f"{how}: {path}", found, value)
    yield Criterion(f"{how}: words and infinities", "1", float(sum(words)), len(words), len(words), "as written")


OVERRIDES = {
    "beam.length=2.5": ("beam.length", 2.5),
    "base_motion.phase=-0.25": ("base_motion.phase", -0.25),
    "stops.inner.gap=0.9e-3": ("stops[1].gap", 0.9e-3),
    "stops[0].stiffness=6.1e5": ("stops[0].stiffness", 6.1e5),
    "supports.1.torsional=77.0": ("supports[1].torsional", 77.0),
    "damping.ratio.2=0.05": ("damping.ratio[2]", 0.05),
    "initial.displacement[3]=1e-5": ("initial.displacement[3]", 1e-5),
    "beam.section.inner_diameter=0.04": ("beam.section.inner_diameter", 0.04),
}
"""Arguments of ``--set``, and the one value that each changes."""


def overridden(text: str, assignments: Mapping[str, tuple[str, float]]) -> Iterator[Check | Criterion]:
    """Single values of a file's text are set, and all other values are unchanged."""
    given = dict(leaves(tomllib.loads(text)))
    for assignment, (path, value) in assignments.items():
        tables = tomllib.loads(text)
        override(tables, assignment)
        problem = problem_from_tables(tables)
        yield same(f"--set {assignment}", field(problem, path), value)
        others = sum(field(problem, key) == known for key, known in given.items() if key != path)
        name = f"--set {assignment}: values left as they were"
        yield Criterion(name, "1", float(others), len(given) - 1, len(given) - 1, "all others")


def overridden_at_once() -> Iterator[Check]:
    """One value of every stop of `FILE` is set."""
    tables = tomllib.loads(FILE)
    override(tables, "stops.*.gap=5e-4")
    for k, stop in enumerate(problem_from_tables(tables).stops):
        yield same(f"--set stops.*.gap=5e-4: stop {k + 1}", stop.gap, 5e-4)


def meanings(problem: Problem) -> Iterator[Check]:
    """Quantities that the parts of `FILE` define, by arithmetic."""
    x, initial = np.array([0.3, 1.9]), problem.initial
    assert isinstance(initial, PolynomialShape)
    for i, at in enumerate(x):
        z = 1.9e-4 * at**2 - 3.1e-5 * at**3
        curvature = 2 * 1.9e-4 - 6 * 3.1e-5 * at
        yield same(f"initial displacement at {at:g} m", initial.displacement_at(x)[i], z, "m", ROUNDING)
        name = f"initial curvature at {at:g} m"
        yield same(name, initial.displacement_at(x, 2)[i], curvature, "1/m", ROUNDING)
        v = 0.07 * at + 0.011 * at**2
        yield same(f"initial velocity at {at:g} m", initial.velocity_at(x)[i], v, "m/s", ROUNDING)
    for i, ratio in enumerate((0.013, 0.027, 0.041, 0.041, 0.041)):
        found = problem.damping.ratios(5)[i]  # type: ignore[union-attr]
        yield same(f"damping ratio of mode {i + 1}", found, ratio, "1")
    for name, stop, sign in zip(problem.stop_names, problem.structure.stops, (-1, 1), strict=True):
        yield same(f"side of {name}", stop.sign, sign, "1")
    assert problem.excitation_frequency is not None
    yield same("common excitation frequency", problem.excitation_frequency, 71.5, "rad/s")
    yield from driving(problem)
    for text, (area, second) in SECTIONS.items():
        body = (
            f"[beam]\nlength = 1.0\nmaterial = {{youngs_modulus = 2.05e11, density = 7890.0}}\n[beam.section]\n{text}"
        )
        beam, shape = from_toml(body).line, text.split('"')[1]
        yield same(f"mass per length of a {shape}", beam.m, 7890.0 * area, "kg/m", ROUNDING)
        yield same(f"bending stiffness of a {shape}", beam.EI, 2.05e11 * second, "N m2", 10 * ROUNDING)


def driving(problem: Problem) -> Iterator[Check]:
    """The forces on the beam of `FILE` at one time, by arithmetic."""
    t = 0.0217
    by_place = {
        None: 2.7e-3 * 143.0**2 * math.sin(143.0 * t + 0.37),
        1.1: -17.0,
        0.45: 23.0 * math.sin(143.0 * t - 1.21),
        1.6: 5.0 * math.sin(71.5 * t + 0.8) - 7.0 * math.sin(214.5 * t - 0.3),
    }
    for x, force in by_place.items():
        shape = problem.structure.inertia if x is None else LoadShape.at(x)
        found = sum(float(one.at(np.array([t]))[0]) for one in problem.forces.every if one.shape == shape)
        name, unit = ("acceleration of the base", "m/s2") if x is None else (f"force at {x:g} m", "N")
        yield same(f"{name} at {t:g} s", found, force, unit, 100 * ROUNDING)


def presets() -> Iterator[Check]:
    """The two presets against the numbers of their sources."""

    def against(name: str, found: float, given: Printed, exact: bool = True) -> Check:
        reference = given.estimate()
        # A printed input is exact; a printed result is exact to its last digit.
        u = 0.0 if exact else given.half_unit
        b = Estimate(reference.value, u, reference.how, reference.kind)
        return Check(f"preset: {name}", given.unit, Estimate(found, ROUNDING * abs(given.value), "the preset"), b)

    joint, table_6 = paper_joint(), {key: row[0] for key, row in group("paper joint").items()}
    beam, base = joint.line.beams[0], joint.base_motion
    assert isinstance(base, BaseMotion)
    assert beam.material is not None
    E, L = table_6["youngs_modulus"].value, table_6["length"].value
    EI = E * table_6["breadth"].value * table_6["height"].value ** 3 / 12
    yield against("length", beam.length, table_6["length"])
    yield against("Young's modulus", beam.material.youngs_modulus, table_6["youngs_modulus"])
    yield against("density", beam.material.density, table_6["density"])
    yield same("preset: bending stiffness", beam.EI, EI, "N m2", 10 * ROUNDING)
    area = table_6["breadth"].value * table_6["height"].value
    yield same("preset: mass per length", beam.m, table_6["density"].value * area, "kg/m", 10 * ROUNDING)
    yield against("base amplitude", base.amplitude, table_6["base_amplitude"])
    yield same("preset: phase of the base", base.phase, 0.0, "rad")
    yield against("damping ratio", joint.damping.ratio, table_6["damping_ratio"])  # type: ignore[union-attr, arg-type]
    tip, middle = table_6["length"].value, table_6["contact_point"].value
    for stop, (name, x, sign) in zip(
        joint.structure.stops, (("P2", tip, -1), ("P3", middle, -1), ("P4", tip, 1), ("P5", middle, 1)), strict=True
    ):
        yield against(f"gap of {name}", stop.gap, table_6["gap"])
        yield same(f"preset: place of {name}", stop.x, x, "m")
        yield same(f"preset: side of {name}", stop.sign, sign, "1")
        k = table_6["k_star"].value * 3 * EI / L**3
        yield same(f"preset: stiffness of {name}", stop.stiffness, k, "N/m", 10 * ROUNDING)
    for k_star, (given,) in group("paper stiffness").items():
        stiffness = paper_joint(k_star=float(k_star)).stops[0].stiffness
        yield against(f"stiffness at k* = {k_star}", stiffness, given, exact=False)
    drop, of = sdnl104(), {key: row[0] for key, row in group("sdnl104 problem").items()}
    assert drop.line.beams[0].material is not None
    yield against("SDNL104: length", drop.line.beams[0].length, of["length"])
    yield against("SDNL104: diameter", drop.line.beams[0].section.diameter, of["diameter"])  # type: ignore[union-attr]
    yield against("SDNL104: Young's modulus", drop.line.beams[0].material.youngs_modulus, of["youngs_modulus"])
    yield against("SDNL104: density", drop.line.beams[0].material.density, of["density"])
    yield against("SDNL104: gap", drop.stops[0].gap, of["gap"])
    yield against("SDNL104: stiffness", drop.stops[0].stiffness, of["stiffness"])
    yield against("SDNL104: force", drop.point_loads[0].force, of["force"])  # type: ignore[union-attr, arg-type]
    yield same("SDNL104: side", drop.structure.stops[0].sign, -1, "1")


def written_down(problem: Problem) -> History:
    """A History of a motion in closed form, z = 2 mm sin(143 t) x^3, with three contacts."""

    def motion(x: FloatArray, t: FloatArray, dx: int = 0, dt: int = 0) -> FloatArray:
        shape = 2e-3 * (x**3, 3 * x**2, 6 * x, np.full_like(x, 6.0))[dx]
        return np.outer(shape, 143.0**dt * np.sin(143.0 * t + dt * math.pi / 2))

    contacts = (Contact(0, 0.01, 0.02, -3.0, 7.0), Contact(1, 0.03, 0.04, 2.0, 5.0), Contact(0, 0.05, 0.06, -4.0, 9.0))
    states = (FREE, ContactState((0,)), FREE, ContactState((1,)), FREE, ContactState((0,)), FREE)
    times = np.array([0.01, 0.02, 0.03, 0.04, 0.05, 0.06])
    return History(problem, "written down", 0.0, 0.08, times, states, contacts, motion)


def arithmetic(problem: Problem) -> Iterator[Check]:
    """Quantities, impulses and an exponent of a History in closed form."""
    history, t = written_down(problem), 0.0123
    wave = 2e-3 * math.sin(143.0 * t)
    EI = 7.1e10 * math.pi * (0.061**4 - 0.047**4) / 64
    x = 1.3
    yield same("displacement", history.displacement(x, t)[0, 0], wave * x**3, "m", ROUNDING)
    yield same("velocity", history.velocity(x, t)[0, 0], 2e-3 * 143 * math.cos(143 * t) * x**3, "m/s", 10 * ROUNDING)
    yield same("slope", history.slope(x, t)[0, 0], 3 * wave * x**2, "1", ROUNDING)
    yield same("bending moment", history.moment(x, t)[0, 0], EI * 6 * wave * x, "N m", 10 * ROUNDING)
    yield same("shear force", history.shear(x, t)[0, 0], EI * 6 * wave, "N", 10 * ROUNDING)
    for k, (place, sign, gap, stiffness) in enumerate(((2.25, -1, 1.3e-3, 5.7e5), (0.9, 1, 0.7e-3, 2.9e5))):
        for when in (t, t + math.pi / 143.0):
            z = 2e-3 * math.sin(143.0 * when) * place**3
            force = -sign * stiffness * max(sign * z - gap, 0.0)
            name = f"force of stop {k + 1} at {when:.4f} s"
            yield same(name, history.contact_force(when)[k, 0], force, "N", 1e4 * ROUNDING)
    for k, impulse in enumerate((-7.0 / 3, 2.0 / 3)):
        name = f"impulse of stop {k + 1} per period, of three"
        yield same(name, impulses_per_period(history, 3)[k], impulse, "N s", ROUNDING)
    yield same("impulses before 0.045 s", history.impulses(end=0.045)[0], -3.0, "N s", ROUNDING)
    series = correlated()
    found = exponent_of(series, 0.25)
    yield same("exponent of a series of growths", found.value, float(series.sum()) / (series.size * 0.25), "1/s", 1e-12)
    yield same("time of its measurement", found.time, series.size * 0.25, "s", ROUNDING)


BOUNCES: dict[str, tuple[bool, tuple[tuple[float, float], ...]]] = {
    "three ever shorter flights, and a rest": (True, ((0, 2), (10, 12), (16, 18), (19, 40))),
    "the same over the end of the period": (True, ((0, 10), (50, 52), (60, 62), (66, 68), (69, 80))),
    "two of them": (False, ((0, 2), (10, 12), (14, 40), (43, 60), (64, 76))),
    "three, and a rest shorter than the contact before": (False, ((0, 2), (10, 12), (16, 18), (19, 20.5))),
    "three, and a rest shorter than the flight before": (False, ((0, 2), (10, 12), (17, 18), (21, 23))),
}
"""Start and end, ms, of the contacts of one stop in a period of 80 ms, and whether they chatter: each of three
successive flights is shorter than the previous one, and the next contact is longer than the contact and the flight
before it."""


def chatter(problem: Problem) -> Iterator[Check]:
    """Whether the contacts of a period are chatter."""
    motion = written_down(problem)
    for what, (wanted, times) in BOUNCES.items():
        contacts = tuple(
            Contact(
                0, start / 1e3, end / 1e3, -1.0, 1.0, open_start=start == 0 and times[-1][1] == 80, open_end=end == 80
            )
            for start, end in times
        )
        found = chatters(replace(motion, contacts=contacts), 0)
        yield same(f"chatter (1: yes): {what}", float(found), float(wanted), "1")


PAPER_STATES = {1: "", 2: "P2", 3: "P3", 4: "P4", 5: "P5", 6: "P2 P3", 7: "P2 P5", 8: "P3 P4", 9: "P4 P5"}
"""Closed stops of the paper's states, by its Table 1: tip (P2, P4) and mid-span (P3, P5), bottom before top; states 6
to 9 are in the order of its Table 4."""


def states() -> Iterator[Check]:
    """The paper's numbers of the contact states."""
    joint = paper_joint()
    for number, closed in PAPER_STATES.items():
        state = ContactState(tuple(joint.stop_names.index(name) for name in closed.split()))
        yield same(f"number of the state {closed or 'free'}", paper_state_number(joint, state), number, "1")


CORRELATION, LENGTH = 0.8, 65_536  # Correlation of the growths of neighbouring periods, and the number of growths


def correlated() -> FloatArray:
    """An AR(1) series of unit scatter about 0.3."""
    noise = np.random.default_rng(11).standard_normal(LENGTH) * math.sqrt(1 - CORRELATION**2)
    series = np.empty(LENGTH)
    series[0] = noise[0]
    for i in range(1, LENGTH):
        series[i] = CORRELATION * series[i - 1] + noise[i]
    return np.asarray(0.3 + series)


def statistics() -> Iterator[Criterion]:
    """The standard error of a correlated mean against its closed form."""
    exact = math.sqrt((1 + CORRELATION) / (1 - CORRELATION) / LENGTH) / 0.25
    found = exponent_of(correlated(), 0.25).standard_error / exact
    reason = "fifteen degrees of freedom leave a factor of two"
    yield Criterion("standard error of correlated growths over its closed form", "1", found, 0.5, 2.0, reason)


def frequencies(problem: Problem) -> Iterator[Check]:
    """The lowest frequency of a cantilever of steel by both solvers, from the textbook's root and arithmetic."""
    joint = paper_joint().replace(stops=())
    root = roots(BEAMS["clamped-free"].equation, 1)[0]
    omega = (root / 2.5) ** 2 * math.sqrt(2.05e11 * 0.05**2 / 12 / 7890.0)
    summed = tuple(
        itertools.accumulate([STEP] * round(joint.line.length / STEP), initial=0.0)
    )  # rounded beyond its end
    solvers = (
        (analytic.Solver(), 100 * ROUNDING),
        (fe_lapjoint.Solver(elements=16), EIGENVALUES),
        (fe_lapjoint.Solver(nodes=summed), EIGENVALUES),
    )
    for solver, u in solvers:
        found = solver.modes(joint, FREE, 1).angular_frequencies[0]
        yield same(f"first frequency of the paper's beam: {solver.name}", found, omega, "rad/s", u)


def propagator() -> Iterator[Check]:
    """The exact flow as a method of `solve_ivp`, in several steps from a time that is not 0, against a closed form."""
    steps, begin, end = 3, 0.4, 1.9
    problem = paper_joint().replace(stops=(), base_motion=None)
    system = build_system(Assembly(problem, mesh_nodes(problem, 1, None)), FREE)
    a, w = system.damping_rate, system.omega
    rng = np.random.default_rng(3)
    q, v = rng.standard_normal(w.size), w * rng.standard_normal(w.size)
    options = {"method": ExactPropagator, "system": system, "max_step": (end - begin) / steps}
    found = solve_ivp(system.rates, (begin, end), np.concatenate([q, v]), **options).y[:, -1]
    wave, t = np.sqrt(w**2 - a**2), end - begin
    exact = np.exp(-a * t) * (q * np.cos(wave * t) + (v + a * q) / wave * np.sin(wave * t))
    for i in range(w.size):
        one = Estimate(float(found[i]), PHASES * abs(float(q[i])), "ExactPropagator")
        other = Estimate(float(exact[i]), 0.0, "free vibration", Kind.ANALYTICAL)
        yield Check(f"mode {i + 1} by solve_ivp", "kg^1/2 m", one, other)


def meshes() -> Iterator[Check]:
    """Number of elements in each stretch of a finer mesh, by which errors are estimated; a short stretch is
    unchanged."""
    joint = paper_joint()
    near = joint.stops[1].model_copy(update={"name": "near", "x": joint.structure.stops[1].x + SHORT_STRETCH})
    problem = joint.replace(stops=(*joint.stops, near))
    places = sorted({0.0, *(stop.x for stop in problem.structure.stops)})
    nodes = mesh_nodes(problem, 16, None)
    for ratio in (2.0, 1.5):
        finer = refined_nodes(problem, nodes, ratio)
        for a, b in itertools.pairwise(places):
            coarse, fine = (int(np.sum((mesh > a) & (mesh <= b))) for mesh in (nodes, finer))
            wanted = coarse if b - a <= SHORT_STRETCH * (1 + ROUNDING) else math.ceil(coarse * ratio)
            yield same(f"elements from {a:g} to {b:g} m of a mesh {ratio:g} times as fine", fine, wanted, "1")


def as_given(key: str, title: str, text: str, items: Sequence[Check | Criterion]) -> CaseResult:
    """A case of such comparisons, with a table of all numbers."""
    checks = tuple(item for item in items if isinstance(item, Check))
    rows = [(c.name, c.unit, c.b.value, c.a.value, c.b.how) for c in checks]
    return CaseResult(
        key,
        title,
        text,
        checks=checks,
        criteria=tuple(item for item in items if isinstance(item, Criterion)),
        tables=(table("As given", ("quantity", "unit", "given", "found", "from"), rows),),
    )


def run(level: Level, say: Say) -> CaseResult:
    """All comparisons of the shared package with plain numbers."""
    say("file, presets, arithmetic")
    problem = from_toml(FILE)
    items = [
        *read_as_written(problem, "read"),
        *read_as_written(from_toml(to_toml(problem)), "written and read again"),
        *overridden(FILE, OVERRIDES),
        *overridden_at_once(),
        *meanings(problem),
        *presets(),
        *states(),
        *arithmetic(problem),
        *chatter(problem),
        *statistics(),
        *frequencies(problem),
        *meshes(),
        *propagator(),
    ]
    return as_given(
        "as-given",
        "The ground: problems as given",
        "Both solvers share what is solved and what an answer is, so neither can tell when that is wrong. Every value "
        "of a problem file is compared with what tomllib reads, both presets with the tables that they are from, and "
        "sections, initial shapes, forces, moments, impulses per period and exponents with plain arithmetic, "
        "chatter with its definition.",
        items,
    )
