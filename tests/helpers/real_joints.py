"""Random joints of `population` with what real ones have: steps, masses, fluids, static loads, preload, stops in space.

Four indices of ten have several of `FEATURES`, each as likely as not; the others have one, in turn.  Base, gaps and
stops are drawn as for uniform beams, from the amplitude of the joint with its masses and steps, without contact.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import partial

import numpy as np
from population import random_cantilever, random_joint, response_of
from preloaded import in_space, pressed

from lapjoint import Beam, Problem
from lapjoint.problem import BeamSegment, Mass
from lapjoint.problem.static_loads import Gravity, UniformLoad

FEATURES = ("masses", "steps", "fluids", "gravity", "uniform load", "preload", "in space")
PERIODS = 4  # of the base, that a motion from rest is marched for
_STEPS, _INERTIA = 10.0, 3.0  # EI and m of a segment are up to so many times more or less than those of a uniform beam
_MASS = 0.01, 3.0  # of the mass of a uniform beam
_RADIUS = 0.01, 0.3  # of gyration of a mass, over the length
_FLUID = 0.1, 2.0  # mass per length of contents, and of the fluid around, over that of the beam
_SAG = 0.1, 1.5  # deflection under a static load, over the amplitude without contact, at the largest of each


def real_joint(seed: int, index: int) -> Problem:
    """One problem of a seed: a cantilever with a stop at its tip if the index is even, else any joint."""
    rng = np.random.default_rng((seed, index, 9))
    features = _features(rng, index // 2)
    draw = random_joint if index % 2 else random_cantilever
    problem = draw(np.random.default_rng((seed, index)), partial(_dressed, rng, features))
    problem = _laden(rng, features, problem)
    for name, change in (("preload", pressed), ("in space", in_space)):
        if name in features:
            problem = _changed(change, rng, problem)
    return problem.replace(title=f"seed {seed}, index {index}: {problem.title}, {', '.join(features)}")


def real_march(seed: int, index: int) -> tuple[Problem, float]:
    """The same problem, and some periods of its base, s."""
    problem = real_joint(seed, index)
    return problem, PERIODS * problem.require_excitation_period("test")


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
                bending_stiffness=_between(rng, 1 / _STEPS, _STEPS),
                mass_per_length=_between(rng, 1 / _INERTIA, _INERTIA),
            )
            for to in (*cuts.tolist(), 1.0)
        )
    if "fluids" in features:
        fluids = {name: _between(rng, *_FLUID) for name in fluids}
    uniform = {} if segments else {"bending_stiffness": 1.0, "mass_per_length": 1.0}
    beam = Beam(length=1.0, segments=segments, **uniform, **fluids)
    masses = []
    for _ in range(int(rng.integers(1, 4)) if "masses" in features else 0):
        mass, turns = _between(rng, *_MASS), rng.random() < 0.5
        radius = _between(rng, *_RADIUS) if turns else 0.0
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
        return sign * _between(rng, *_SAG) * sag / float(np.abs(q @ response.shapes).max())

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


def _between(rng: np.random.Generator, least: float, most: float) -> float:
    """A number between two others, evenly by its logarithm."""
    return float(math.exp(rng.uniform(math.log(least), math.log(most))))
