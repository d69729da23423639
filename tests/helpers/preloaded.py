"""Random joints whose stops press the straight beam, or stand still in space, besides stops of the usual kind."""

from __future__ import annotations

import math

import numpy as np
from population import BASE, harmonic_joint, joint

from lapjoint import Problem

_SIZES = 0.05, 1.0  # of a gap that becomes an interference, evenly by the logarithm


def preloaded_joint(seed: int, index: int) -> Problem:
    """The problem of `population.joint`, with half of its stops closed by an interference of 0.05 to 1 of their gap.

    Where one of two twins is closed, so is the other in half of the cases; then both press the straight beam.
    """
    rng = np.random.default_rng((seed, index, 7))
    problem = joint(seed, index)
    stops, twin = [], rng.random() < 0.5
    pressed = {stop.x: bool(rng.random() < 0.5) for stop in problem.stops}
    for stop in problem.stops:
        size = math.exp(rng.uniform(*np.log(_SIZES)))
        presses = pressed[stop.x] if twin else bool(rng.random() < 0.5)
        gap = -size * stop.gap if presses else stop.gap
        stops.append(stop.model_copy(update={"gap": gap}))
    return problem.replace(title=f"{problem.title}, preloaded", stops=tuple(stops))


def spatial_joint(seed: int, index: int) -> Problem:
    """The problem of `preloaded_joint`, every second stop of it fixed in space, under a sine or under harmonics.

    The gap of a stop in space is that of the joint plus up to the amplitude of the base.
    """
    rng = np.random.default_rng((seed, index, 8))
    problem = preloaded_joint(seed, index)
    if index % 3 == 0:
        base = harmonic_joint(seed, index).base_motion
        problem = problem.replace(base_motion=base)
    stops = []
    for stop in problem.stops:
        if rng.random() < 0.6:
            gap = stop.gap + BASE * rng.uniform(-0.5, 1.0)
            stop = stop.model_copy(update={"fixed_to": "space", "gap": gap})
        stops.append(stop)
    return problem.replace(title=f"{problem.title}, in space", stops=tuple(stops))
