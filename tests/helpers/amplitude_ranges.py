"""Branches of random joints over the amplitude of the base from the motion without contact on, and first grazes."""

from __future__ import annotations

import numpy as np
from population import BASE, BEAM, response_of

from lapjoint import BaseMotion, Problem, Stop, Support, ViscousDamping
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.branches.starts import without_contact
from lapjoint.orbits.branches.tracing import Limits, Traced, trace

AMPLITUDE = "base_motion.amplitude"
BELOW, ABOVE = 0.9, 4.0
"""Ends of the range of amplitudes over that of the first graze."""


def docs_cantilever() -> Problem:
    """The cantilever of docs/branches.md, of which two motions lie between two folds."""
    return Problem(
        beam=BEAM,
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        damping=ViscousDamping(coefficient=0.8),
        base_motion=BaseMotion(amplitude=3e-4, angular_frequency=5.0),
    )


def first_graze(problem: Problem) -> float:
    """Amplitude, m, at which the motion without contact touches a stop: the least gap over |H|, by twelve modes."""
    assert problem.excitation_frequency is not None
    response = np.abs(response_of(problem).amplitude(problem.excitation_frequency)) / BASE
    x = np.linspace(0.0, problem.beam.length, response.size)
    return min(stop.gap / float(np.interp(stop.x, x, response)) for stop in problem.stops)


def range_of(problem: Problem, solver: object, low: float, high: float) -> ParameterRange:
    """A range of the amplitude of the base, m, by a solver."""
    grid = Grid(problem, (Axis(AMPLITUDE, (low, high)),))
    return ParameterRange(solver, lambda value: grid.with_values((value,)), AMPLITUDE, low, high)


def from_below(problem: Problem, solver: object, points: int) -> tuple[ParameterRange, Traced | None]:
    """The branch of the motion without contact, from before its first graze on."""
    assert isinstance(problem.base_motion, BaseMotion)
    first = first_graze(problem)
    of = range_of(problem, solver, BELOW * first, ABOVE * first)
    start = without_contact(of, BELOW * first)
    return of, None if start is None else trace(of, start, 1, Limits(points))
