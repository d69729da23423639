"""Random joints with what real ones have: steps, masses, fluids, static loads, preload, stops in space or damped.

`real_joint` is a joint of `population` with some of `FEATURES`.  Four indices of ten have several of them, each as
likely as not; the others have one, in turn.  Base, gaps and stops are drawn as for uniform beams, from the amplitude of
the joint with its masses and steps, without contact.  `random_beam`, `resting_joint` and `damped_cantilever` span wider
ranges for frequencies, for equilibria, and for single switches of damped stops.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from functools import partial

import numpy as np

from lapjoint import Beam, Problem, SineLoad, StepLoad, Stop, Support
from lapjoint.problem import BeamSegment, Mass, ViscousDamping
from lapjoint.problem.static_loads import Gravity, UniformLoad
from tests.helpers.population import BASE, between, random_cantilever, random_joint, response_of, with_harmonics

FEATURES = ("masses", "steps", "fluids", "gravity", "uniform load", "preload", "in space")
PERIODS = 4  # of the base, that a motion from rest is marched for
_STEPS, _INERTIA = 10.0, 3.0  # EI and m of a segment are up to so many times more or less than those of a uniform beam
_MASS = 0.01, 3.0  # of the mass of a uniform beam
_RADIUS = 0.01, 0.3  # of gyration of a mass, over the length
_FLUID = 0.1, 2.0  # mass per length of contents, and of the fluid around, over that of the beam
_SAG = 0.1, 1.5  # deflection under a static load, over the amplitude without contact, at the largest of each
_PRESS = 0.05, 1.0  # of a gap that becomes an interference
_DAMPER = 0.01, 10.0  # c / sqrt(k) of a damped stop, in the units of the beam


def real_joint(seed: int, index: int, *, features: Sequence[str] = (), also: Sequence[str] = ()) -> Problem:
    """One problem of a seed: a cantilever with a stop at its tip if the index is even, else any joint.

    It has those `features` and no others, if any are given, and has `also` others besides those of its index.
    "harmonics", "damped stops" and "viscous" damping are features, too, which no index has of its own.
    """
    rng = np.random.default_rng((seed, index, 9))
    features = (*(features or _features(rng, index // 2)), *also)
    draw = random_joint if index % 2 else random_cantilever
    problem = draw(np.random.default_rng((seed, index)), partial(_dressed, rng, features))
    problem = _laden(rng, features, problem)
    if "harmonics" in features:
        problem = with_harmonics(problem, np.random.default_rng((seed, index, 2)), 2 if index % 3 == 0 else 1)
    if "viscous" in features:
        problem = problem.replace(damping=viscous(problem, rng))
    for name, change in (("preload", pressed), ("in space", in_space), ("damped stops", damped)):
        if name in features:
            problem = _changed(change, rng, problem)
    return problem.replace(title=f"seed {seed}, index {index}: {problem.title}, {', '.join(features)}")


PRELOADED = partial(real_joint, features=("preload",))
SPATIAL = partial(real_joint, features=("preload", "in space", "harmonics"))
DAMPED = partial(real_joint, also=("damped stops",))
EVERY = ("masses", "steps", "fluids", "gravity", "uniform load", "preload", "in space", "damped stops", "viscous")


def any_joint(seed: int, index: int) -> Problem:
    """One problem with some of `EVERY`: nine indices of eighteen have one of them, in turn, the others have several."""
    if index % 18 < len(EVERY):
        return real_joint(seed, index, features=(EVERY[index % 18],))
    rng = np.random.default_rng((seed, index, 5))
    some = rng.choice(len(EVERY), int(rng.integers(2, 6)), replace=False)
    return real_joint(seed, index, features=[EVERY[i] for i in sorted(some.tolist())])


def real_march(seed: int, index: int) -> tuple[Problem, float]:
    """The same problem, and some periods of its base, s."""
    problem = real_joint(seed, index)
    return problem, PERIODS * problem.require_excitation_period("test")


def pressed(problem: Problem, rng: np.random.Generator) -> Problem:
    """A problem with half of its stops closed by an interference of 0.05 to 1 of their gap.

    Where one of two twins is closed, so is the other in half of the cases; then both press the straight beam.
    """
    stops, twin = [], rng.random() < 0.5
    closed = {stop.x: bool(rng.random() < 0.5) for stop in problem.stops}
    for stop in problem.stops:
        size = between(rng, *_PRESS)
        presses = closed[stop.x] if twin else bool(rng.random() < 0.5)
        gap = -size * stop.gap if presses else stop.gap
        stops.append(stop.model_copy(update={"gap": gap}))
    return problem.replace(stops=tuple(stops))


def in_space(problem: Problem, rng: np.random.Generator) -> Problem:
    """A problem with 0.6 of its stops fixed in space, whose gaps grow by -0.5 to 1 of the amplitude of the base."""
    stops = []
    for stop in problem.stops:
        if rng.random() < 0.6:
            gap = stop.gap + BASE * rng.uniform(-0.5, 1.0)
            stop = stop.model_copy(update={"fixed_to": "space", "gap": gap})
        stops.append(stop)
    return problem.replace(stops=tuple(stops))


def damped(problem: Problem, rng: np.random.Generator) -> Problem:
    """A problem with four of five stops damped, of which three of ten may pull."""
    stops = []
    for stop in problem.stops:
        c, pulls, has = between(rng, *_DAMPER) * math.sqrt(stop.stiffness), rng.random() < 0.3, rng.random() < 0.8
        stops.append(stop.model_copy(update={"damping": c, "may_pull": bool(pulls)}) if has else stop)
    return problem.replace(stops=tuple(stops))


def viscous(problem: Problem, rng: np.random.Generator) -> ViscousDamping:
    """Damping of 0.01 to 0.1 of the lowest mode of a uniform beam, which masses, steps and fluids couple."""
    return ViscousDamping(coefficient=2 * between(rng, 0.01, 0.1) * float(response_of(problem).omega[0]))


def _features(rng: np.random.Generator, number: int) -> tuple[str, ...]:
    """One of `FEATURES` by number, or several."""
    if number % 10 < len(FEATURES):
        return (FEATURES[number % 10],)
    while True:
        found = tuple(name for name in FEATURES if rng.random() < 0.5)
        if len(found) > 1:
            return found


def _dressed(rng: np.random.Generator, features: tuple[str, ...], problem: Problem) -> Problem:
    """A uniform beam of EI = m = L = 1 with steps, fluids and masses."""
    segments: tuple[BeamSegment, ...] = ()
    fluids = dict.fromkeys(("contents_per_length", "added_mass_per_length"), 0.0)
    if "steps" in features:
        cuts = np.sort(rng.choice(np.arange(1, 20), int(rng.integers(1, 4)), replace=False)) / 20
        segments = tuple(
            BeamSegment(
                to=to,
                bending_stiffness=between(rng, 1 / _STEPS, _STEPS),
                mass_per_length=between(rng, 1 / _INERTIA, _INERTIA),
            )
            for to in (*cuts.tolist(), 1.0)
        )
    if "fluids" in features:
        fluids = {name: between(rng, *_FLUID) for name in fluids}
    uniform = {} if segments else {"bending_stiffness": 1.0, "mass_per_length": 1.0}
    beam = Beam(length=1.0, segments=segments, **uniform, **fluids)
    masses = []
    for _ in range(int(rng.integers(1, 4)) if "masses" in features else 0):
        mass, turns = between(rng, *_MASS), rng.random() < 0.5
        radius = between(rng, *_RADIUS) if turns else 0.0
        place = 1.0 if rng.random() < 1 / 3 else rng.uniform(0.1, 1.0)
        masses.append(Mass(x=place, mass=mass, rotary_inertia=mass * radius**2))
    return problem.replace(beam=beam, masses=tuple(masses))


def _laden(rng: np.random.Generator, features: tuple[str, ...], problem: Problem) -> Problem:
    """A joint under gravity and a uniform load, which bend it by a part of its amplitude without contact."""
    response, period = response_of(problem), problem.require_excitation_period("test")
    sag = float(response.amplitude(2 * math.pi / period).max())
    x = np.linspace(0.0, 1.0, response.shapes.shape[1])

    def size(per_length: np.ndarray) -> float:
        """The size of a load of a shape, of either sign, that bends the joint so."""
        q = np.trapezoid(per_length * response.shapes, x, axis=1) / response.omega**2
        sign = -1.0 if rng.random() < 0.7 else 1.0
        return sign * between(rng, *_SAG) * sag / float(np.abs(q @ response.shapes).max())

    if "gravity" in features:
        problem = problem.replace(gravity=Gravity(acceleration=size(problem.line.inertia_at(x))))
    if "uniform load" in features:
        start = rng.uniform(0.0, 0.6)
        end = rng.uniform(start + 0.2, 1.0)
        load = UniformLoad(start=start, to=end, force_per_length=size(((x >= start) & (x <= end)).astype(float)))
        problem = problem.replace(uniform_loads=(load,))
    return problem


def _changed(
    change: Callable[[Problem, np.random.Generator], Problem], rng: np.random.Generator, problem: Problem
) -> Problem:
    """A problem after a random change of its stops, which may leave them as they are: the first that does not."""
    while True:
        found = change(problem, rng)
        if found.stops != problem.stops:
            return found


def random_beam(
    rng: np.random.Generator,
    *,
    decades: float = 2.0,
    heaviest: float = 1e6,
    springs: tuple[float, float] = (1e-6, 1e12),
    near: float = 0.0,
) -> Problem:
    """A beam of 0.1 to 10 m with up to four segments, three masses and four supports, and a stop at the tip.

    EI and m differ by up to twice `decades`; masses are 1e-6 to `heaviest` times that of the beam, half of them with a
    rotary inertia; supports are fixed or have `springs` times the stiffness of the beam.  Places are fortieths of the
    length, so that several parts often meet; with `near` half of the others lie by that to 0.1 of the length beyond.
    """
    L = float(10 ** rng.uniform(-1.0, 1.0))

    def places(numbers: np.ndarray) -> list[float]:
        moved = [between(rng, near, 0.1) if near and 0 < n < 36 and rng.random() < 0.5 else 0.0 for n in numbers]
        return [L if n == 40 else (n / 40 + d) * L for n, d in zip(numbers.tolist(), moved, strict=True)]

    def spring(unit: float) -> float:
        return float(rng.choice([0.0, math.inf, between(rng, *springs) * unit], p=[0.25, 0.25, 0.5]))

    ends = [*sorted(places(rng.choice(np.arange(1, 40), int(rng.integers(0, 4)), replace=False))), L]
    segments = tuple(
        BeamSegment(to=end, bending_stiffness=float(EI), mass_per_length=float(m))
        for end, EI, m in zip(ends, *10 ** rng.uniform(-decades, decades, (2, len(ends))), strict=True)
    )
    beam = Beam(length=L, segments=segments)
    masses = []
    for x in places(rng.integers(0, 41, int(rng.integers(0, 4)))):
        turns = rng.random() < 0.5
        mass, rotary = (between(rng, 1e-6, heaviest) * beam.m * L**power for power in (1, 3))
        masses.append(Mass(x=x, mass=mass, rotary_inertia=rotary if turns else 0.0))
    return Problem(
        beam=beam,
        masses=tuple(masses),
        supports=tuple(
            Support(x=x, translational=spring(beam.EI / L**3), torsional=spring(beam.EI / L))
            for x in places(rng.choice(41, int(rng.integers(0, 5)), replace=False))
        ),
        stops=(Stop(x=L, side="top", gap=1e-3, stiffness=between(rng, 1.0, 1e7) * beam.EI / L**3),),
    )


def resting_joint(rng: np.random.Generator, *, held: bool = True) -> Problem:
    """A beam of `random_beam` under static loads, with one to five stops, which supports hold, or perhaps stops alone.

    Of the stops one in three presses the straight beam; they have 0.1 to 1e9 times the stiffness of the beam.
    """
    while True:
        bare = random_beam(rng, decades=1.0, heaviest=2.0, springs=(1e-3, 1e12))
        springs = [(s.x, s.translational, s.torsional) for s in bare.supports]
        places = {x for x, k, _ in springs if k}
        if held == (len(places) > 1 or (any(kt for *_, kt in springs) and bool(places))):
            break
    beam, L, load = bare.beam, bare.beam.length, between(rng, 0.1, 1e3)
    shared = [0.0, L, *(L * rng.uniform(0.02, 0.98, 4)).tolist()]

    def place() -> float:
        return float(rng.choice(shared)) if rng.random() < 0.5 else float(L * rng.uniform(0.02, 0.98))

    loads: list[StepLoad | SineLoad] = [
        StepLoad(x=place(), force=load * rng.normal()) for _ in range(int(rng.integers(0, 3)))
    ]
    loads.append(SineLoad(x=place(), force=10 * load, angular_frequency=3.0))
    spans = [sorted((place(), place())) for _ in range(int(rng.integers(0, 3)))]
    stops: list[Stop] = []
    for i in range(int(rng.integers(1, 6))):
        x = stops[-1].x if stops and rng.random() < 0.25 else place()
        gap = load * L**3 / beam.EI * between(rng, 1e-3, 1.0) * (-1 if rng.random() < 0.35 else 1)
        k = beam.EI / L**3 * between(rng, 0.1, 1e9)
        stops.append(Stop(name=f"s{i}", x=x, side=("top", "bottom")[int(rng.integers(2))], gap=gap, stiffness=k))
    fluids = {"contents_per_length": 0.3 * beam.m, "added_mass_per_length": 0.5 * beam.m} if rng.random() < 0.5 else {}
    return bare.replace(
        beam=beam.model_copy(update=fluids),
        stops=tuple(stops),
        gravity=Gravity(acceleration=rng.normal() * load / (beam.m * L)) if rng.random() < 0.7 else None,
        uniform_loads=tuple(
            UniformLoad(start=a, to=b, force_per_length=load / L * rng.normal()) for a, b in spans if b - a > 1e-3 * L
        ),
        point_loads=tuple(loads),
    )


def damped_cantilever(rng: np.random.Generator, *, halves: bool = False) -> Problem:
    """A cantilever that moves at once, with one to four stops, of which most are damped and some may pull.

    Stops are anywhere beyond 0.3 of its length, or with `halves` at the middle and the tip alone.
    """

    def place(x: float) -> float:
        return (0.5 if x < 0.65 else 1.0) if halves else x

    stops = []
    for _ in range(int(rng.integers(1, 5))):
        k, ratio = float(10 ** rng.uniform(1, 3.5)), 10 ** rng.uniform(-2, 1)
        stops.append(
            {
                "damping": float(ratio * np.sqrt(k)) if rng.random() < 0.8 else 0.0,
                "stiffness": k,
                "x": place(float(rng.uniform(0.3, 1))),
                "side": str(rng.choice(["top", "bottom"])),
                "gap": float(rng.uniform(0.005, 0.05)),
                "may_pull": bool(rng.random() < 0.3),
                "fixed_to": "space" if rng.random() < 0.2 else "base",
            }
        )
    modal = {"kind": "modal", "ratio": float(rng.uniform(0, 0.1))}
    viscous = {"kind": "viscous", "coefficient": float(rng.uniform(0, 1))}
    return Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0},
            "supports": [{"x": 0.0, "translational": math.inf, "torsional": math.inf}],
            "stops": stops,
            "damping": modal if rng.random() < 0.5 else viscous,
            "base_motion": {
                "kind": "sine",
                "amplitude": float(10 ** rng.uniform(-1.5, -0.5)),
                "angular_frequency": float(rng.uniform(2, 12)),
            },
            "point_loads": [{"kind": "step", "x": 0.7, "force": float(rng.normal() * 0.05)}],
            "initial": {
                "kind": "polynomial",
                "displacement": [0, 0, float(rng.normal() * 0.02)],
                "velocity": [0, 0, float(rng.normal() * 0.3)],
            },
        }
    )


def dragged_cantilever(rng: np.random.Generator, *, halves: bool = False) -> Problem:
    """A `damped_cantilever` with masses, steps or both, under viscous damping, which couples its modes.

    The damping of the lowest modes is from light to above critical; every second joint has no damped stop.
    """
    joint, segments, masses, kind = damped_cantilever(rng, halves=halves), (), [], rng.integers(3)
    if kind != 1:
        places = np.sort(rng.choice(np.arange(2, 19), int(rng.integers(1, 3)), replace=False)) / 20
        cuts = [0.5, 1.0] if halves else [*places, 1.0]
        EI, m = 10 ** rng.uniform(-0.5, 0.5, len(cuts)), 10 ** rng.uniform(-0.5, 0.5, len(cuts))
        parts = zip(map(float, cuts), EI.tolist(), m.tolist(), strict=True)
        segments = tuple(BeamSegment(to=to, bending_stiffness=e, mass_per_length=d) for to, e, d in parts)
    if kind != 0:
        for _ in range(int(rng.integers(1, 3))):
            size = float(10 ** rng.uniform(-1.5, 0.5))
            place = 1.0 if rng.random() < 0.5 else 0.5 if halves else float(rng.uniform(0.2, 1))
            masses.append(Mass(x=place, mass=size, rotary_inertia=size * float(rng.uniform(0, 0.02))))
    stops = joint.stops
    if rng.random() < 0.5:
        stops = tuple(stop.model_copy(update={"damping": 0.0, "may_pull": False}) for stop in stops)
    beam = Beam(length=1.0, segments=segments) if segments else joint.beam
    damping = ViscousDamping(coefficient=float(10 ** rng.uniform(-1, 1)))
    return joint.replace(beam=beam, masses=tuple(masses), stops=stops, damping=damping)
