"""Bifurcations and grazes of branches by the analytic solver, confirmed by finite elements within both errors."""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Iterable
from dataclasses import replace

import pytest
from amplitude_ranges import docs_cantilever, from_below, range_of
from branch_witness import drawn
from few_and_many import few_and_many
from population import joint

import analytic
import fe_lapjoint
from lapjoint import FREQUENCY, Problem, branch, confirm, paper_joint
from lapjoint.campaigns.branches.table import KINDS
from lapjoint.campaigns.confirm.table import VERDICTS
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.branches.confirmation import confirmed
from lapjoint.orbits.branches.errors import stated

SEED, DRAWN = 47, 77
QUICK = (3, 6, 16, 20, 22)  # of the drawn: they are quick, and have a bifurcation each
MODES, ELEMENTS = 8, 24
AGREE = 0.97  # of what has an error by the analytic solver
BY_FEW = 0.9
"""The same of joints whose high modes are hardly damped: few elements have the multipliers of these elsewhere."""


def check(said: Counter[str], agree: float = AGREE) -> None:
    """Nearly all agree, and none is apart."""
    assert said
    assert said["agrees"] >= agree * said.total(), said
    assert not said["apart"], said


@in_one_thread
def from_first_graze(problem: Problem, points: int) -> Counter[str]:
    """What finite elements say of those from the first graze on for which the analytic solver has an error."""
    said = Counter[str]()
    of, traced = from_below(problem, analytic.Solver(n_modes=MODES), points)
    assert traced is not None
    other = range_of(problem, fe_lapjoint.Solver(elements=ELEMENTS), of.low, of.high)
    for found in traced.found:
        one = stated(found.what)
        if math.isfinite(one.error):
            said[confirmed(one, other).verdict] += 1
    return said


def over_their_ranges(indices: Iterable[int]) -> Counter[str]:
    """The same of joints over a range of any of their fields, as the commands have it."""
    said = Counter[str]()
    for index in indices:
        one = drawn(DRAWN, index)
        found = branch(one.problem, one.path, one.low, one.high, options={"n_modes": MODES}, max_points=200, effort=200)
        if found.sizes["bifurcation"]:
            its = confirm(found, options={"elements": ELEMENTS})
            known = its.verdict.values[its.error.values < math.inf]
            said.update(VERDICTS[verdict] for verdict in known.tolist())
    return said


def of_the_joint(low: float, high: float, share: float, points: int, effort: int) -> tuple[Counter[str], set[str]]:
    """The same of the paper's joint with a damping ratio of 0.02, between two frequencies; and the kinds there."""
    found = branch(paper_joint(damping_ratio=0.02), FREQUENCY, low, high, max_points=points, effort=effort)
    its = confirm(found, options={"elements": 40}, share=share)
    known = its.verdict.values[its.error.values < math.inf]
    return Counter(VERDICTS[verdict] for verdict in known.tolist()), {KINDS[kind] for kind in its.kind.values}


def test_finite_elements_confirm_the_graze_and_the_folds_of_a_cantilever() -> None:
    assert from_first_graze(docs_cantilever(), 40) == {"agrees": 3}


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


@pytest.mark.thorough
@pytest.mark.parametrize("indices", few_and_many(QUICK, range(60)))
def test_finite_elements_confirm_bifurcations_of_random_joints(indices: Iterable[int]) -> None:
    check(over_their_ranges(indices))


@pytest.mark.slow
def test_finite_elements_confirm_bifurcations_of_random_joints_far_beyond_their_first_graze() -> None:
    check(sum((from_first_graze(joint(SEED, index), 25) for index in range(20)), Counter[str]()), BY_FEW)


@pytest.mark.thorough
def test_finite_elements_confirm_a_broken_symmetry_and_a_torus_of_the_lightly_damped_joint() -> None:
    said, kinds = of_the_joint(681.0, 683.0, 1.0, 60, 60)
    assert {"symmetry breaking", "neimark-sacker"} <= kinds
    check(said)


@pytest.mark.slow
def test_finite_elements_confirm_bifurcations_of_the_lightly_damped_joint() -> None:
    check(of_the_joint(100.0, 700.0, 0.1, 400, 1200)[0])
