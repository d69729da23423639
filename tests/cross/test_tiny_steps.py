"""Marches in tiny steps of joints with preload and stops in space meet the same contacts as both solvers."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import pytest
from brute_joint import BruteJoint, off_by
from few_and_many import in_processes
from random_joints import PRELOADED, SPATIAL
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import Problem

SOLVERS: tuple[AnySolver, ...] = (analytic.Solver(), fe_lapjoint.Solver(elements=20))
SEED, COUNT, FEW = 77, 120, 3
PERIODS = 2.5  # marched from rest
FINE_WITNESS = 22  # elements of the witness of many joints, of which some are damped little and ring
OFF = 0.05  # of the largest displacement at a stop: high modes that a sudden release excites, on 14 elements
OFF_CONTACT = 0.02  # of the largest impulse, of the duration, and of the force, for the same reason


def denied(drawn: Callable[[int, int], Problem], index: int, elements: int = 14) -> list[str]:
    """What both solvers say of a motion from rest that its march in tiny steps, on so many elements, denies."""
    problem = drawn(SEED, index)
    duration = PERIODS * problem.require_excitation_period("test")
    seen, found = BruteJoint(problem, elements).march(duration), []
    for solver in SOLVERS:
        apart, contacts = off_by(solver.simulate(problem, duration, errors=False), seen)
        if not (apart <= OFF and contacts <= OFF_CONTACT):
            found.append(f"{problem.title}, {solver.name}: {apart:.1e} of z, {contacts:.1e} of contacts")
    return found


@pytest.mark.parametrize("drawn", [PRELOADED, SPATIAL])
def test_a_march_in_tiny_steps_meets_the_same_contacts(drawn: Callable[[int, int], Problem]) -> None:
    assert not [line for index in range(FEW) for line in denied(drawn, index)]


@pytest.mark.slow
@pytest.mark.parametrize("drawn", [PRELOADED, SPATIAL])
def test_marches_in_tiny_steps_of_many_joints_meet_the_same_contacts(drawn: Callable[[int, int], Problem]) -> None:
    every = in_processes(partial(denied, drawn, elements=FINE_WITNESS), range(COUNT))
    assert not [line for found in every for line in found]
