"""A motion halfway between two of a branch that does not close yet tells what the one on the curve tells.

Both are made wherever one is asked for: on branches of random joints, and on one of the paper's joint with light
damping that turns sharply beside grazes, with multipliers of a thousand.
"""

from __future__ import annotations

from collections import Counter

import pytest
from branch_witness import drawn, first_branch

import analytic
from lapjoint import Problem, paper_joint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches import bifurcations
from lapjoint.orbits.branches.bifurcations import signature
from lapjoint.orbits.branches.corrector import Place
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.locating import Criterion
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import trace
from lapjoint.orbits.newton import RESIDUAL
from lapjoint.orbits.parameters import FREQUENCY


def both_made(monkeypatch: pytest.MonkeyPatch) -> Counter[str]:
    """Have each motion halfway made twice; how many there are, and how many of them do not close.

    Between such a one and another no bifurcation is located: it is brought to the curve before.
    """
    made, locate, seen = bifurcations._middle, bifurcations.located, Counter[str]()

    def located(family: Family, first: Place, last: Place, criterion: Criterion) -> Place | None:
        assert max(first.orbit.residual, last.orbit.residual) <= RESIDUAL
        return locate(family, first, last, criterion)

    def middle(family: Family, first: Place, last: Place) -> Place | None:
        found = made(family, first, last)
        with monkeypatch.context() as now:
            now.setattr(bifurcations, "_ROUGH", 0.0)
            closed = made(family, first, last)
        assert (found is None) == (closed is None)
        if found is not None and closed is not None:
            assert closed.orbit.residual <= RESIDUAL
            assert found.closings == closed.closings
            assert signature(found) == signature(closed)
            seen["all"] += 1
            seen["rough"] += found.orbit.residual > RESIDUAL
        return found

    monkeypatch.setattr(bifurcations, "_middle", middle)
    monkeypatch.setattr(bifurcations, "located", located)
    return seen


def family_of(problem: Problem, path: str, low: float, high: float) -> Family:
    grid = Grid(problem, (Axis(path, (low, high)),))
    return Family(analytic.Solver(), lambda value: grid.with_values((value,)), path, low, high)


def test_they_tell_the_same_on_branches_of_random_joints(monkeypatch: pytest.MonkeyPatch) -> None:
    seen = both_made(monkeypatch)
    for index in range(12):
        one = drawn(74, index)
        first_branch(family_of(one.problem, one.path, one.low, one.high), errors=False)
    assert seen["rough"]


def test_they_tell_the_same_where_multipliers_are_large_and_motions_turn_sharply(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    problem = paper_joint()
    problem = problem.replace(damping=problem.damping.model_copy(update={"ratio": 0.02}))
    family = family_of(problem, FREQUENCY, 100.0, 200.0)
    seed = seed_from(family, 165.0, family.at(165.0).map.initial(), 4)
    assert seed is not None
    seen = both_made(monkeypatch)
    found = trace(family, seed, most_multiple=2, errors=False, limits=Limits(300))
    assert found is not None
    assert found.branch.bifurcations
    assert seen["rough"]
