"""Bifurcations of the joint with a damping ratio of 0.02, each by both solvers, within the errors that they state.

The finite element solver starts from the analytic solver's motion, as a sampled shape, and then finds the bifurcation
by its own marches, derivatives and multipliers.
"""

from __future__ import annotations

import numpy as np
import pytest
from by_another_solver import by_another

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.resolving import resolved
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.value_errors import AIM


@in_one_thread
def judged(low: float, high: float, start: float, elements: int) -> list[tuple[str, float, float, float]]:
    """Kind and number of each bifurcation upwards of a start, how far the solvers are apart, and their larger error.

    Both are over the number; the former is over the sum of both errors.
    """
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    grid = Grid(joint, (Axis(FREQUENCY, (low, high)),))
    families = [
        Family(solver, lambda value: grid.with_values((value,)), FREQUENCY, low, high)
        for solver in (analytic.Solver(n_modes=27), fe_lapjoint.Solver(elements=elements))
    ]
    own, other = families
    seed = seed_from(own, start, own.at(start).map.initial(), 1)
    assert seed is not None
    place = corrected(own, seed.value, seed.point, seed.count)
    assert place is not None
    up = np.append(np.zeros(place.tangent.size - 1), 1.0)
    run = follow(own, place.along(up), Limits())
    rows = []
    for one in resolved(own, run).bifurcations:
        if one.found is not None:
            a, b = one.bifurcation, by_another(one, other)
            assert b is not None, f"{a.kind} at {a.value} rad/s: not found by the finite element solver"
            apart = abs(a.value - b.value) / (a.error + b.error)
            rows.append((a.kind, a.value, apart, max(a.error, b.error) / a.value))
    return rows


def judge(rows: list[tuple[str, float, float, float]]) -> None:
    """All agree, and are as exact as is aimed at."""
    for kind, value, apart, error in rows:
        assert apart <= 1, (kind, value)
        assert error <= AIM, (kind, value)


@pytest.mark.thorough
def test_both_solvers_find_bifurcations_of_the_joint_within_their_errors() -> None:
    rows = judged(681.0, 683.0, 681.0, 40)
    assert {"symmetry breaking", "neimark-sacker"} <= {kind for kind, *_ in rows}
    judge(rows)


@pytest.mark.slow
def test_both_solvers_find_all_bifurcations_of_the_joint_upwards_of_670() -> None:
    rows = judged(670.0, 5000.0, 670.0, 60)  # with 40, one error is 1.2e-5
    assert len(rows) >= 15
    judge(rows)
