"""Where two solvers end on different motions, it is said which of them exist side by side."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest
from shaken_beams import shaken_beams

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Beam, ModalDamping, Outcome, Problem, Stop, Support
from lapjoint.problem import SampledShape
from validation.coexistence import Motion, same_motion, started_from, why_they_differ

pytestmark = pytest.mark.long_march

ANALYTIC, FE = analytic.Solver(), fe_lapjoint.Solver(elements=10)
# A cantilever well above its first frequency: from rest it comes to strike its stop, yet it need not touch it.
CANTILEVER = Problem(
    beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
    supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
    stops=(Stop(x=1.0, side="top", gap=3e-3, stiffness=100.0),),
    damping=ModalDamping(ratio=0.01),
    base_motion=BaseMotion(amplitude=1e-3, angular_frequency=4.5 * 3.5160152685),
)


@pytest.fixture(scope="module")
def two() -> tuple[Motion, Motion]:
    """From rest, three periods with contact; and from the motion of the beam without its stop, that motion."""
    first = ANALYTIC.steady_state(CANTILEVER)
    bare = ANALYTIC.steady_state(CANTILEVER.replace(stops=()))
    other = ANALYTIC.steady_state(started_from(CANTILEVER, bare))
    assert (first.period_multiple, other.outcome) == (3, Outcome.NO_CONTACT)
    return Motion(ANALYTIC, first), Motion(FE, replace(other, problem=CANTILEVER))


def test_motions_side_by_side_are_told(two: tuple[Motion, Motion]) -> None:
    sentence = why_they_differ(CANTILEVER, *two)
    assert "exist" in sentence
    assert ANALYTIC.name in sentence
    assert FE.name in sentence


@pytest.mark.thorough
def test_a_motion_that_is_handed_over_is_kept(two: tuple[Motion, Motion]) -> None:
    for motion in two:
        for solver in (ANALYTIC, FE):
            assert same_motion(solver.steady_state(started_from(CANTILEVER, motion.found)), motion.found)


def test_what_is_no_motion_of_the_problem_is_not_explained_away(two: tuple[Motion, Motion]) -> None:
    first, second = two
    false = replace(second.found, impulses=3.0 * second.found.impulses + 1.0, multipliers=np.array([0.1 + 0j]))
    calm = replace(first.found, multipliers=np.array([0.1 + 0j]))
    sentence = why_they_differ(CANTILEVER, Motion(ANALYTIC, calm), Motion(FE, false))
    assert "side by side" not in sentence
    assert FE.name not in sentence.split(" exists beside ")[0]


def test_class_and_period_tell_motions_apart(two: tuple[Motion, Motion]) -> None:
    found = two[0].found
    assert same_motion(found, found)
    assert not same_motion(found, replace(found, period_multiple=found.period_multiple + 1))
    other = Outcome.PERIODIC if found.outcome is Outcome.NO_CONTACT else Outcome.NO_CONTACT
    assert not same_motion(found, replace(found, outcome=other))


def test_a_motion_of_several_beams_is_handed_over_beam_by_beam() -> None:
    problem, solver = shaken_beams(49, 1), fe_lapjoint.Solver(elements=8)
    found = solver.steady_state(problem, errors=False)
    handed, x = started_from(problem, found).start, problem.line.grid(7)
    for given, motion in (
        (handed.displacement_at(x), found.history.displacement(x, found.history.start)),
        (handed.velocity_at(x), found.history.velocity(x, found.history.start)),
    ):
        assert given == pytest.approx(motion[:, 0], abs=1e-6 * np.abs(motion).max())


def test_a_motion_is_handed_over_where_a_support_lies_between_equidistant_positions() -> None:
    place = 0.789372
    problem = CANTILEVER.replace(supports=(*CANTILEVER.supports, Support(x=place, translational=math.inf)))
    found = ANALYTIC.steady_state(problem, sensitivity=False, errors=False)
    start = started_from(problem, found).initial
    assert isinstance(start, SampledShape)
    assert place in start.x
