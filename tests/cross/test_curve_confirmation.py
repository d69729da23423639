"""Bifurcations and grazes of curves by the analytic solver, confirmed by finite elements within both errors."""

from __future__ import annotations

import math
from collections import Counter
from dataclasses import replace

import pytest
from curves import from_below, range_of
from population import joint

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, Problem, Stop, ViscousDamping, paper_joint
from lapjoint.campaigns import Axis, Grid
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.curves.confirmation import Verdict, confirmed
from lapjoint.orbits.curves.errors import stated
from lapjoint.orbits.curves.resolution import ParameterRange
from lapjoint.orbits.curves.starts import start_from
from lapjoint.orbits.curves.tracing import Limits, trace

SEED = 47
MODES, ELEMENTS = 8, 24
AGREE = 0.97  # of what has an error by the analytic solver
FREQUENCY = "base_motion.angular_frequency"


def docs_cantilever() -> Problem:
    """The cantilever of docs/branches.md, of which two motions lie between two folds."""
    return joint(SEED, 0).replace(
        stops=(Stop(x=1.0, side="top", gap=1e-3, stiffness=50.0),),
        damping=ViscousDamping(coefficient=0.8),
        base_motion=BaseMotion(amplitude=3e-4, angular_frequency=5.0),
    )


def verdicts(problem: Problem, points: int, every: int = 1) -> Counter[Verdict]:
    """What finite elements say of those from the first graze on for which the analytic solver has an error."""
    said = Counter[Verdict]()
    of, traced = from_below(problem, analytic.Solver(n_modes=MODES), points)
    assert traced is not None
    other = range_of(problem, fe_lapjoint.Solver(elements=ELEMENTS), of.low, of.high)
    for found in traced.found[::every]:
        one = stated(found.what)
        if math.isfinite(one.error):
            said[confirmed(one, other).verdict] += 1
    return said


@in_one_thread
def test_finite_elements_confirm_the_graze_and_the_folds_of_a_cantilever() -> None:
    assert verdicts(docs_cantilever(), 40) == {"agrees": 3}


@in_one_thread
def test_what_another_motion_has_is_not_confirmed() -> None:
    problem = docs_cantilever()
    of, traced = from_below(problem, analytic.Solver(n_modes=MODES), 20)
    assert traced is not None
    one = stated(traced.found[0].what)
    softer = problem.replace(stops=(problem.stops[0].model_copy(update={"gap": 1.01e-3}),))
    other = range_of(softer, fe_lapjoint.Solver(elements=ELEMENTS), of.low, of.high)
    assert confirmed(one, other).verdict == "apart"
    assert confirmed(replace(one, error=math.inf), other).verdict == "no error stated"


@in_one_thread
def confirm_joints(indices: range, points: int, every: int) -> None:
    """Nearly all of random joints agree, and none is apart."""
    said = sum((verdicts(joint(SEED, index), points, every) for index in indices), Counter[Verdict]())
    assert said["agrees"] >= AGREE * said.total(), said
    assert not said["apart"], said


def test_finite_elements_confirm_bifurcations_of_random_cantilevers() -> None:
    confirm_joints(range(0, 12, 2), 15, 2)


@pytest.mark.thorough
def test_finite_elements_confirm_bifurcations_of_random_joints() -> None:
    confirm_joints(range(12), 25, 2)


@pytest.mark.slow
def test_finite_elements_confirm_all_bifurcations_of_twenty_random_joints() -> None:
    confirm_joints(range(20), 40, 1)


@pytest.mark.slow
@in_one_thread
def test_finite_elements_confirm_bifurcations_of_the_lightly_damped_joint() -> None:
    grid = Grid(paper_joint(damping_ratio=0.02), (Axis(FREQUENCY, (100.0, 700.0)),))
    of, other = (
        ParameterRange(solver, lambda value: grid.with_values((value,)), FREQUENCY, 100.0, 700.0)
        for solver in (analytic.Solver(), fe_lapjoint.Solver(elements=40))
    )
    start = start_from(of, 700.0, of.resolution(700.0).map(700.0).initial(), 1)
    assert start is not None
    traced = trace(of, start, 1, Limits(400))
    assert traced is not None
    all_ = [stated(found.what) for found in traced.found]
    said = Counter(confirmed(one, other).verdict for one in all_ if math.isfinite(one.error))
    assert said["agrees"] >= AGREE * said.total(), said
