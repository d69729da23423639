"""Random joints whose beams have steps and masses, under gravity, a uniform load and a moving base, with two stops."""

from __future__ import annotations

import math

import numpy as np

import analytic
from lapjoint import BaseMotion, NoDamping, Problem, Stop
from lapjoint.problem import ModalDamping
from lapjoint.problem.static_loads import Gravity, UniformLoad
from tests.helpers.stepped_beams import random_problem

BASE = 1e-3  # m, amplitude of the base
PERIODS = 2  # of the base, that a motion is marched for
_MOVES = 0.05  # of the largest amplitude along the beam: a stop where it moves by less is placed elsewhere


def laden_joint(
    seed: int, damping: NoDamping | ModalDamping, *, stiffest: float = 1e4, static: bool = True, heaviest: float = 10.0
) -> tuple[Problem, float]:
    """A joint, and `PERIODS` of its base, s; stops of 1 to `stiffest` EI / L^3 at the tip or anywhere, at gaps of 0.1
    to 0.6 of the amplitude without contact."""
    rng = np.random.default_rng(seed)
    while True:
        laden = random_problem(rng, ratio=100.0, heaviest=heaviest)
        if not laden.supports:
            continue
        omega = analytic.Solver().modes(laden, count=4).angular_frequencies
        driven, L = float(omega[omega > 0][0] * rng.uniform(0.5, 3.0)), laden.beam.length
        acceleration = BASE * driven**2
        free = laden.replace(damping=damping, base_motion=BaseMotion(amplitude=BASE, angular_frequency=driven))
        if static:
            load = float(rng.uniform(-1.0, 1.0)) * acceleration * laden.beam.m
            free = free.replace(
                gravity=Gravity(acceleration=-float(rng.uniform(0.1, 2.0)) * acceleration),
                uniform_loads=(UniformLoad(start=0.2 * L, to=0.7 * L, force_per_length=load),),
            )
        duration = PERIODS * 2 * math.pi / driven
        x = L * np.append(np.linspace(0.0, 1.0, 41), rng.uniform(0.3, 1.0))
        motion = analytic.Solver(n_modes=15).simulate(free, duration, errors=False)
        amplitude = np.abs(motion.displacement(x, np.linspace(0.0, duration, 400))).max(axis=1)
        if amplitude[-2:].min() < _MOVES * amplitude.max():
            continue
        stops = tuple(
            Stop(
                x=float(x[at]),
                side="top" if at == -1 else "bottom",
                gap=float(amplitude[at] * rng.uniform(0.1, 0.6)),
                stiffness=float(10 ** rng.uniform(0.0, math.log10(stiffest))) * laden.beam.EI / L**3,
            )
            for at in (-1, -2)
        )
        return free.replace(stops=stops), duration
