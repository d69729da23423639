"""Random joints whose stops press the straight beam, or stand still in space, besides stops of the usual kind.

What both solvers say of them is compared with marches in tiny steps (`witnessed`), and their certificates with marches
over 20 decay times (`judged`).
"""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from brute_joint import BruteJoint, BruteMotion
from population import BASE, harmonic_joint, joint, response_of
from refining import AnySolver
from witness import testify

import analytic
import fe_lapjoint
from lapjoint import Problem
from lapjoint.answers import History

ANALYTIC = analytic.Solver()
FINE = fe_lapjoint.Solver(elements=20)
SOLVERS = (ANALYTIC, FINE)
COARSE = fe_lapjoint.Solver(elements=8)  # a coarse beam is a beam, too, and ten times as fast to march
SEED, COUNT = 77, 120
PERIODS = 2.5  # marched from rest
LIGHT = 0.01  # of the largest impulse: whether so light a contact is there, the elements of the witness decide
FIRST = 4  # contacts that are compared
FINE_WITNESS = 22  # elements of the witness of many joints, of which some are damped little and ring
OFF = 0.05  # of the largest displacement at a stop: high modes that a sudden release excites, on 14 elements
OFF_CONTACT = 0.02  # of the largest impulse, of the duration, and of the force, for the same reason
CERTIFIED, CERTIFICATES = 99, 60
MOST_UNDECIDED = 0.05
_SIZES = 0.05, 1.0  # of a gap that becomes an interference, evenly by the logarithm


def preloaded_joint(seed: int, index: int) -> Problem:
    """The problem of `population.joint`, pressed as `pressed` says."""
    problem = pressed(joint(seed, index), np.random.default_rng((seed, index, 7)))
    return problem.replace(title=f"{problem.title}, preloaded")


def pressed(problem: Problem, rng: np.random.Generator) -> Problem:
    """A problem with half of its stops closed by an interference of 0.05 to 1 of their gap.

    Where one of two twins is closed, so is the other in half of the cases; then both press the straight beam.
    """
    stops, twin = [], rng.random() < 0.5
    closed = {stop.x: bool(rng.random() < 0.5) for stop in problem.stops}
    for stop in problem.stops:
        size = math.exp(rng.uniform(*np.log(_SIZES)))
        presses = closed[stop.x] if twin else bool(rng.random() < 0.5)
        gap = -size * stop.gap if presses else stop.gap
        stops.append(stop.model_copy(update={"gap": gap}))
    return problem.replace(stops=tuple(stops))


def spatial_joint(seed: int, index: int) -> Problem:
    """The problem of `preloaded_joint`, its stops as `in_space` says, under a sine or under harmonics."""
    rng = np.random.default_rng((seed, index, 8))
    problem = preloaded_joint(seed, index)
    if index % 3 == 0:
        base = harmonic_joint(seed, index).base_motion
        problem = problem.replace(base_motion=base)
    return in_space(problem, rng).replace(title=f"{problem.title}, in space")


def in_space(problem: Problem, rng: np.random.Generator) -> Problem:
    """A problem with 0.6 of its stops fixed in space, whose gaps grow by -0.5 to 1 of the amplitude of the base."""
    stops = []
    for stop in problem.stops:
        if rng.random() < 0.6:
            gap = stop.gap + BASE * rng.uniform(-0.5, 1.0)
            stop = stop.model_copy(update={"fixed_to": "space", "gap": gap})
        stops.append(stop)
    return problem.replace(stops=tuple(stops))


def off_by(history: History, seen: BruteMotion) -> tuple[float, float]:
    """How far a motion is from the witness: its displacement at the stops, and its first contacts, infinite if others.

    Displacements are compared up to the end of these contacts, and are over the largest; starts are over the duration;
    impulses and peaks over the largest of each.
    """
    size = max((abs(c.impulse) for c in seen.contacts), default=0.0)
    both = history.contacts, seen.contacts
    one, other = ([c for c in them if abs(c.impulse) > LIGHT * size][:FIRST] for them in both)
    until = max((c.end for c in other), default=math.inf)
    problem, t = history.problem, np.linspace(0.0, min(seen.t[-1], history.end, until), 60)
    marched = np.array([np.interp(t, seen.t, z) for z in seen.z])
    x = np.array([stop.x for stop in problem.stops])
    apart = float(np.abs(history.displacement(x, t) - marched).max() / np.abs(marched).max())
    if [c.stop for c in one] != [c.stop for c in other]:
        return apart, math.inf
    worst, peak = 0.0, max((c.peak for c in other), default=1.0)
    for a, b in zip(one, other, strict=True):
        numbers = (a.start - b.start) / seen.t[-1], (a.impulse - b.impulse) / size, (a.peak_force - b.peak) / peak
        worst = max(worst, *(abs(number) for number in numbers))
    return apart, worst


def witnessed(drawn: Callable[[int, int], Problem], index: int, elements: int = 14) -> list[str]:
    """What both solvers say of a motion from rest that its march in tiny steps, on so many elements, denies."""
    problem = drawn(SEED, index)
    duration = PERIODS * problem.require_excitation_period("test")
    seen, found = BruteJoint(problem, elements).march(duration), []
    for solver in SOLVERS:
        apart, contacts = off_by(solver.simulate(problem, duration, errors=False), seen)
        if not (apart <= OFF and contacts <= OFF_CONTACT):
            found.append(f"{problem.title}, {solver.name}: {apart:.1e} of z, {contacts:.1e} of contacts")
    return found


def judged(drawn: Callable[[int, int], Problem], solver: AnySolver, index: int) -> tuple[str, str]:
    """The verdict on one steady state, of which a march over 20 decay times is the witness; and why."""
    problem = drawn(CERTIFIED, index)
    said = testify(solver.period_map(problem), solver.steady_state(problem, errors=False), decay_time_of(problem))
    return said.verdict, f"{problem.title}, {solver.name}: {said.why}"


def decay_time_of(problem: Problem) -> float:
    """The longest decay time of a mode of the free beam, s."""
    return response_of(problem.replace(stops=())).decay_time


def check(found: list[tuple[str, str]]) -> None:
    """Fail unless no certificate is false, and few are withheld."""
    assert not [why for verdict, why in found if verdict == "false"]
    undecided = [why for verdict, why in found if verdict == "undecided"]
    assert len(undecided) <= MOST_UNDECIDED * len(found), undecided
