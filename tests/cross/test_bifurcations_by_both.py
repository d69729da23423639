"""Bifurcations of the joint with a damping ratio of 0.02, each by both solvers, within the errors that they state.

The finite element solver starts from the analytic solver's motions, as sampled shapes, and then finds the bifurcation
by its own marches, derivatives and multipliers: at the motion there, or along its own curve from one before.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator

import pytest

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.listing import Listed
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import trace
from lapjoint.orbits.branches.value_errors import AIM


def families(low: float, high: float, elements: int) -> tuple[Family, Family]:
    """The period maps of both solvers over a range of frequencies, rad/s."""
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    grid = Grid(joint, (Axis(FREQUENCY, (low, high)),))
    own, other = (
        Family(solver, lambda value: grid.with_values((value,)), FREQUENCY, low, high)
        for solver in (analytic.Solver(), fe_lapjoint.Solver(elements=elements))
    )
    return own, other


def bifurcations(family: Family, start: float, branches: int, multiple: int) -> Iterator[Listed]:
    """Those of the branch of the motion from rest, and of some that spring from it, by the analytic solver."""
    seed = seed_from(family, start, family.at(start).map.initial(), 1)
    assert seed is not None
    waiting = deque([seed])
    for _ in range(branches):
        found = trace(family, waiting.popleft(), most_multiple=multiple)
        assert found is not None
        waiting += found.seeds[::2]  # neighbours are often the two ends of one branch
        yield from (one for one in found.bifurcations if one.found is not None)


@in_one_thread
def judge(found: list[Listed], other: Family) -> None:
    """Both solvers agree within their errors, and are as exact as is aimed at."""
    for one in found:
        a, b = one.bifurcation, by_another(one, other)
        where = f"{a.kind} at {a.value} rad/s"
        assert b is not None, f"{where}: not found by the finite element solver"
        assert abs(a.value - b.value) <= a.error + b.error, where
        assert max(a.error, b.error) <= AIM * a.value, where


@pytest.mark.thorough
def test_both_solvers_find_bifurcations_of_the_joint_within_their_errors() -> None:
    own, other = families(681.0, 683.0, 40)
    found = list(bifurcations(own, 681.0, 1, 1))
    assert {"symmetry breaking", "neimark-sacker"} <= {one.bifurcation.kind for one in found}
    judge(found, other)


@pytest.mark.slow
def test_both_solvers_find_all_bifurcations_of_the_joint_upwards_of_670() -> None:
    own, other = families(670.0, 5000.0, 60)  # with 40, one error is 1.2e-5
    found = list(bifurcations(own, 670.0, 1, 1))
    assert found
    judge(found, other)


@pytest.mark.slow
def test_both_solvers_find_every_twentieth_bifurcation_of_ten_branches_of_the_joint() -> None:
    own, other = families(100.0, 5000.0, 40)
    found = list(bifurcations(own, 496.0, 10, 4))
    assert len(found) > 20  # so that one of twenty is more than the first
    judge(found[::20], other)
