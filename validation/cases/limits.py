"""Masses, steps, static loads and preload in limits, in which the problem is a simpler one that is known.

- A mass that vanishes leaves the beam as it was; one that outweighs the beam fixes its point: the frequencies are those
  of the beam pinned there, and over a moving base the point stands still, z = -y.
- Segments of one kind are one beam; a segment that gets shorter changes frequencies by as much as Rayleigh's quotient
  says, which is proportional to its length.
- Gravity is a uniform load of as much force, also on contents and on a mass, but not on added mass; and it is the limit
  of step loads at ever more points.
- Stops that press from the start and never let go are springs: two of equal interference in balance, one with a force.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence

import numpy as np

import analytic
import fe_lapjoint
from lapjoint import FREE, BaseMotion, Beam, ModalDamping, Problem, StepLoad, Stop, Support
from lapjoint.problem import BeamSegment, FloatArray, Gravity, Mass, UniformLoad
from lapjoint.solver import Solver
from validation.case import CaseResult, Level, Say, table
from validation.cases.textbook_equations import BEAMS, roots
from validation.uncertainty import Refined, refined_vector
from validation.verdict import Check, ErrorSource, Estimate, Kind

ELEMENTS = 12
SOLVERS: dict[str, Solver] = {"analytic": analytic.Solver(n_modes=12), "FE": fe_lapjoint.Solver(elements=ELEMENTS)}
LENGTH, EI, M = 1.3, 220.0, 1.7  # m, N m2, kg/m
UNIT = math.sqrt(EI / M) / LENGTH**2  # rad/s: a frequency is b^2 of these
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
PLAIN = Problem(beam=Beam(length=LENGTH, bending_stiffness=EI, mass_per_length=M), supports=(CLAMP,))
MODES = 4  # Frequencies compared
TINY = 1e-9  # A mass that vanishes, and the inverse of one that does not move, divided by the beam's
SLIGHT = 4.0
"""Largest relative change of omega^2 by a vanishing mass, over the mass by the beam's: z^2 / mean z^2 at the tip."""
HELD = 30.0
"""Largest relative effect of a mass that does not move, times its mass over the beam's: the spring that the beam is to
the mass, or the beam's share in its motion."""
ROUNDING = 1e-11  # Relative rounding of frequencies, and of motions over the largest displacement
SHARES = (0.004, 0.002, 0.001)  # Lengths of a segment that vanishes, divided by the length of the beam
SPLIT = (0.31, 0.77)  # Ends of segments of one kind, divided by the length of the beam
POINTS = (4, 8, 16)  # Numbers of step loads in the place of gravity
DURATION = 0.21  # s
TIMES, PLACES = np.linspace(0.0, DURATION, 7)[1:], np.array([0.4, 0.9, 1.3])  # s, and m
BASE = BaseMotion(amplitude=2e-3, angular_frequency=37.0, phase=math.pi / 2)
"""Its velocity is zero at t = 0, so that a body at rest in space has z = -(y - y(0))."""
INTERFERENCE = 3e-3  # m, more than any displacement here


def frequencies(solver: Solver, problem: Problem) -> FloatArray:
    """The lowest natural frequencies, rad/s, ``(MODES,)``."""
    return np.array(solver.modes(problem, FREE, MODES).angular_frequencies)


def motion(solver: Solver, problem: Problem) -> FloatArray:
    """Displacements at `PLACES` and `TIMES`, m, one after another."""
    return np.asarray(solver.simulate(problem, DURATION, errors=False).displacement(PLACES, TIMES).ravel())


def fe_error(b: float) -> float:
    """Relative error of the frequency b^2 by `ELEMENTS` cubic elements: half of (b h)^4 / 720, twice for safety."""
    return (b / ELEMENTS) ** 4 / 720


def alike(what: str, unit: str, one: FloatArray, other: FloatArray, u: float, how: str) -> Iterator[Check]:
    """Numbers that must be equal to a relative error of the largest."""
    size = float(np.abs(other).max())
    for i, (a, b) in enumerate(zip(one.tolist(), other.tolist(), strict=True)):
        yield Check(f"{what}, number {i + 1}", unit, Estimate(a, u * size, "found"), Estimate(b, 0.0, how))


def of_masses() -> Iterator[Check]:
    """A mass that vanishes, and a mass that does not move."""
    heavy = M * LENGTH / TINY
    light = PLAIN.replace(masses=(Mass(x=LENGTH, mass=TINY * M * LENGTH),))
    still = PLAIN.replace(masses=(Mass(x=LENGTH, mass=heavy),))
    pinned = roots(BEAMS["clamped-pinned"].equation)[: MODES - 1]
    for name, solver in SOLVERS.items():
        w = frequencies(solver, PLAIN)
        yield from alike(f"mass that vanishes: {name}", "rad/s", frequencies(solver, light), w, SLIGHT * TINY, "none")
        found = frequencies(solver, still)
        slow = math.sqrt(3 * EI / LENGTH**3 / heavy)
        rest = Estimate(slow, HELD * TINY * slow, "spring of the beam on its tip", Kind.ANALYTICAL)
        mine = Estimate(float(found[0]), 10 * ROUNDING * UNIT, name)
        yield Check(f"immovable mass, slowest frequency: {name}", "rad/s", mine, rest)
        for i, b in enumerate(pinned):
            exact, own = b**2 * UNIT, fe_error(b) if name == "FE" else 0.0
            closed = Estimate(exact, HELD * TINY * exact, "clamped-pinned beam of the textbook", Kind.ANALYTICAL)
            mine = Estimate(float(found[i + 1]), own * exact, name)
            yield Check(f"immovable mass, frequency {i + 2}: {name}", "rad/s", mine, closed)
        moved = still.replace(base_motion=BASE)
        tip = solver.simulate(moved, DURATION, errors=False).displacement(LENGTH, TIMES)[0]
        y = BASE.amplitude * (np.sin(BASE.angular_frequency * TIMES + BASE.phase) - 1)
        yield from alike(f"immovable mass, z against -y: {name}", "m", tip, -y, HELD * TINY, "it stands still")


def beam_of(*segments: tuple[float, float, float]) -> Problem:
    """The plain cantilever in segments: end, m, and factors of stiffness and mass."""
    made = tuple(BeamSegment(to=to, bending_stiffness=k * EI, mass_per_length=m * M) for to, k, m in segments)
    return PLAIN.replace(beam=Beam(length=LENGTH, segments=made))


def of_segments() -> Iterator[Check]:
    """Segments of one kind, and a segment that vanishes."""
    split = beam_of(*((x * LENGTH, 1.0, 1.0) for x in (*SPLIT, 1.0)))
    middle, stiff, heavy = 0.6, 2.0, 1.5
    for name, solver in SOLVERS.items():
        w = frequencies(solver, PLAIN)
        yield from alike(f"equal segments: {name}", "rad/s", frequencies(solver, split), w, ROUNDING, "one beam")
        ends = ((middle * LENGTH, 1.0, 1.0), (LENGTH, 1.0, 1.0))
        levels = []
        for share in SHARES:
            parts = (ends[0], ((middle + share) * LENGTH, stiff, heavy), ends[1])
            levels.append((frequencies(solver, beam_of(*parts)) - w) / share)
        # omega^2 changes by the energy in the segment, through which the moment goes on, less by its inertia
        of_modes = solver.modes(PLAIN, FREE, MODES)
        x = np.array([middle * LENGTH])
        bent, moved = (of_modes.shapes(x, dx)[:, 0] ** 2 for dx in (2, 0))
        first = LENGTH * ((1 - 1 / stiff) * EI * bent - (heavy - 1) * M * w**2 * moved) / (2 * w)
        refined = Refined(ErrorSource.REFINEMENT, f"a segment of {SHARES[-1]:g} of the length")
        values = refined_vector(np.array(levels), 2.0, 1.0, refined, 1e-6)
        for i, (a, b) in enumerate(zip(values, first.tolist(), strict=True)):
            exact = Estimate(b, 0.0, "Rayleigh's quotient", Kind.ANALYTICAL)
            yield Check(f"segment that vanishes, change of frequency {i + 1} by its share: {name}", "rad/s", a, exact)


def of_gravity() -> Iterator[Check]:
    """Gravity against uniform loads, and against step loads at points."""
    g, contents, added, carried = -9.4, 0.8, 0.6, Mass(x=0.9, mass=0.7)
    fluid = {"contents_per_length": contents, "added_mass_per_length": added}
    wet = PLAIN.replace(beam=PLAIN.line.beams[0].model_copy(update=fluid), masses=(carried,))
    falls = wet.replace(gravity=Gravity(acceleration=g))
    weight = StepLoad(x=carried.x, force=g * carried.mass)
    loaded = wet.replace(
        uniform_loads=(UniformLoad(to=0.9, force_per_length=g * M), UniformLoad(start=0.9, force_per_length=g * M)),
        point_loads=(weight,),
    )
    loaded = loaded.replace(uniform_loads=(*loaded.uniform_loads, UniformLoad(force_per_length=g * contents)))
    for name, solver in SOLVERS.items():
        found = motion(solver, falls)
        yield from alike(f"gravity as uniform loads: {name}", "m", found, motion(solver, loaded), ROUNDING, "loads")
        levels = []
        for count in POINTS:
            each = g * (M + contents) * LENGTH / count
            steps = tuple(StepLoad(x=(i + 0.5) * LENGTH / count, force=each) for i in range(count))
            levels.append(motion(solver, wet.replace(point_loads=(weight, *steps))))
        refined = Refined(ErrorSource.REFINEMENT, f"{POINTS[-1]} step loads")
        for i, at in enumerate(refined_vector(np.array(levels), 2.0, 2.0, refined)):
            own = Estimate(float(found[i]), 0.0, name)
            yield Check(f"gravity as ever more step loads, number {i + 1}: {name}", "m", at, own)


def of_preload() -> Iterator[Check]:
    """Stops that never let go, as springs, without damping and with modal damping."""
    at, k = 0.9, 900.0
    both = tuple(Stop(x=at, side=side, gap=-INTERFERENCE, stiffness=k) for side in ("top", "bottom"))
    shaken = PLAIN.replace(base_motion=BASE.model_copy(update={"amplitude": 2e-4}))
    held = shaken.replace(supports=(CLAMP, Support(x=at, translational=2 * k)))
    alone = both[0].model_copy(update={"gap": -1e3 * INTERFERENCE})
    pushed = shaken.replace(
        supports=(CLAMP, Support(x=at, translational=k)),
        point_loads=(StepLoad(x=at, force=k * alone.gap),),
    )
    pairs: Sequence[tuple[str, Problem, Problem]] = (
        ("two pressing stops", shaken.replace(stops=both), held),
        ("a stop that presses far", shaken.replace(stops=(alone,)), pushed),
    )
    for damping in (PLAIN.damping, ModalDamping(ratio=0.03)):
        for what, loose, linear in pairs:
            for name, solver in SOLVERS.items():
                label = f"{what} as springs, {damping.kind} damping: {name}"
                one, other = (motion(solver, it.replace(damping=damping)) for it in (loose, linear))
                yield from alike(label, "m", one, other, ROUNDING, "springs")


def run(level: Level, say: Say) -> CaseResult:
    """All limits by both solvers."""
    checks: list[Check] = []
    for part in (of_masses, of_segments, of_gravity, of_preload):
        say((part.__doc__ or "").rstrip("."))
        checks += part()
    rows = [(c.name, c.unit, c.b.value, c.a.value, f"{c.difference:.1e}", f"{c.allowed:.1e}") for c in checks]
    return CaseResult(
        "limits",
        "Masses, steps, static loads and preload in their limits",
        "A mass that vanishes or does not move, segments that are equal or vanish, gravity as uniform loads and as "
        "ever more step loads, stops that press and never let go: in each limit the problem is a simpler one, "
        "whose answer is known or found by the same solver without the new part.",
        checks=tuple(checks),
        tables=(table("Limits", ("quantity", "unit", "simpler", "found", "difference", "allowed"), rows),),
    )
