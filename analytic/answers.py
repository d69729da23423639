"""From a problem and numbers of modes to a motion, and to the motion that remains."""

from __future__ import annotations

import math

import numpy as np

from analytic.march import Coordinates, Joint, march
from analytic.motion import history_of
from analytic.start import initial_coordinates, initial_state, resumed
from analytic.steady import Orbit, Search, Wandering, find_steady
from lapjoint.answers import History
from lapjoint.answers.steady_state import Section, SteadyState, periodic_outcome, steady_impulses
from lapjoint.problem import Problem
from lapjoint.solver import Progress

__all__ = ["Search", "simulate", "steady_state"]


def simulate(
    problem: Problem, name: str, counts: tuple[int, int], duration: float, progress: Progress | None
) -> History:
    """The motion from the initial state; `counts` are the modes in the free state and in every other."""
    joint = Joint(problem, *counts)
    motion = march(joint, _begin(joint, None), 0.0, duration, depth=True, progress=progress)
    return history_of(problem, name, joint, motion)


def steady_state(
    problem: Problem,
    name: str,
    counts: tuple[int, int],
    search: Search,
    start: Section | None,
    progress: Progress | None,
) -> SteadyState:
    """The motion that remains; the excitation of `problem` has one frequency."""
    assert problem.excitation_frequency is not None
    period, joint = 2 * math.pi / problem.excitation_frequency, Joint(problem, *counts)
    found = find_steady(joint, _begin(joint, start), period, search, progress)
    return _answer(joint, name, found, period, search.max_order)


def _begin(joint: Joint, start: Section | None) -> Coordinates:
    if start is not None:
        return resumed(joint, start)
    state = initial_state(joint.problem)
    return Coordinates(state, *initial_coordinates(joint.problem, joint.model(state).modes))


def _answer(joint: Joint, name: str, found: Orbit | Wandering, period: float, longest: int) -> SteadyState:
    """What was found, with the motion over its period, or over the longest one looked for."""
    problem, periods = joint.problem, found.order if isinstance(found, Orbit) else longest
    motion = march(joint, found.begin, 0.0, periods * period, depth=True)
    history = history_of(problem, name, joint, motion)
    if isinstance(found, Orbit):
        outcome, impulses, exponent = periodic_outcome(history), steady_impulses(history, periods), None
    else:
        outcome, exponent = found.outcome, found.exponent
        impulses = np.array([stop.sign * stop.stiffness for stop in problem.stops]) * found.penetration
    return SteadyState(
        problem=problem,
        solver=name,
        outcome=outcome,
        order=found.order if isinstance(found, Orbit) else 0,
        symmetric=isinstance(found, Orbit) and found.symmetric,
        residual=found.residual,
        multipliers=found.multipliers if isinstance(found, Orbit) else np.zeros(0),
        exponent=exponent,
        section=Section(found.begin.state, np.stack([found.begin.q, found.begin.v])),
        history=history,
        impulses=impulses,
    )
