"""Branches of random joints against marches: no stop is passed unseen, and no motion is called stable that is not."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

import pytest
from branch_witness import AnySolver, Witnessed, witnessed
from few_and_many import in_processes

import analytic
import fe_lapjoint

SEED, COUNT = 2013, 200  # problems that decide; nothing was ever chosen by how this seed goes
QUICK_SEED, FEW, MORE = 77, (1, 8, 20), (5, 15)  # quickly traced; they have grazes, symmetric motions and unstable ones
MOST_WITHOUT = 0.1  # of the problems have no motion from rest that repeats after two periods at most
LEAST_PUSHED = 2.0  # motions a problem, on average, that are not at a graze, nor have a multiplier near one
SOLVERS: list[AnySolver] = [analytic.Solver(n_modes=6), fe_lapjoint.Solver(elements=3)]


def check(found: Iterable[tuple[int, Witnessed]]) -> None:
    """Fail unless nothing is wrong, most problems have a branch, and enough motions were pushed."""
    results = list(found)
    faults = [f"{index}: {what}" for index, one in results for what in one.faults]
    assert not faults, "\n".join(faults)
    assert sum(not one.points for _, one in results) <= MOST_WITHOUT * len(results)
    assert sum(one.pushed for _, one in results) >= LEAST_PUSHED * len(results)


@pytest.mark.parametrize(
    ("solver", "indices"),
    [(SOLVERS[0], FEW), *(pytest.param(solver, FEW + MORE, marks=pytest.mark.thorough) for solver in SOLVERS)],
)
def test_no_branch_of_a_few_random_joints_is_false(solver: AnySolver, indices: tuple[int, ...]) -> None:
    check((index, witnessed(solver, QUICK_SEED, index)) for index in indices)


@pytest.mark.slow
@pytest.mark.parametrize("solver", SOLVERS)
def test_no_branch_of_random_joints_is_false(solver: AnySolver) -> None:
    check(enumerate(in_processes(partial(witnessed, solver, SEED), range(COUNT))))
