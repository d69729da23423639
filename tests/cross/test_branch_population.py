"""Branches of random joints against marches: no stop is passed unseen, and no motion is called stable that is not."""

from __future__ import annotations

import multiprocessing
import os
from collections.abc import Iterable
from concurrent.futures import ProcessPoolExecutor

import pytest
from branch_witness import AnySolver, Witnessed, witnessed

import analytic
import fe_lapjoint

SEED, COUNT = 2013, 200  # problems that decide; nothing was ever chosen by how this seed goes
QUICK_SEED, FEW, MORE = 77, (1, 8, 20), (5, 15)  # quickly traced; they have grazes, symmetric motions and unstable ones
MOST_WITHOUT = 0.1  # of the problems have no motion from rest that repeats after two periods at most
LEAST_PUSHED = 2.0  # motions a problem, on average, that are not at a graze, nor have a multiplier near one
SOLVERS = [analytic.Solver(n_modes=6), fe_lapjoint.Solver(elements=3)]


def check(found: Iterable[tuple[int, Witnessed]]) -> None:
    """Fail unless nothing is wrong, most problems have a branch, and enough motions were pushed."""
    results = list(found)
    faults = [f"{index}: {what}" for index, one in results for what in one.faults]
    assert not faults, "\n".join(faults)
    assert sum(not one.points for _, one in results) <= MOST_WITHOUT * len(results)
    assert sum(one.pushed for _, one in results) >= LEAST_PUSHED * len(results)


@pytest.mark.parametrize(
    ("solver", "errors", "indices"),
    [
        (SOLVERS[0], False, FEW),
        *(pytest.param(solver, False, FEW + MORE, marks=pytest.mark.thorough) for solver in SOLVERS),
        pytest.param(SOLVERS[0], True, FEW + MORE, marks=pytest.mark.thorough),
    ],
)
def test_no_branch_of_a_few_random_joints_is_false(solver: AnySolver, errors: bool, indices: tuple[int, ...]) -> None:
    check((index, witnessed(solver, QUICK_SEED, index, errors)) for index in indices)


@pytest.mark.thorough
def test_a_motion_beyond_two_places_is_not_halfway_between_them() -> None:
    """Two tori were listed twice, as what lies beyond was looked through again; the population below found it."""
    assert not witnessed(SOLVERS[1], SEED, 31).faults


@pytest.mark.slow
@pytest.mark.parametrize(("solver", "errors"), [(SOLVERS[0], False), (SOLVERS[0], True), (SOLVERS[1], False)])
def test_no_branch_of_random_joints_is_false(solver: AnySolver, errors: bool) -> None:
    with ProcessPoolExecutor(os.cpu_count(), multiprocessing.get_context("spawn")) as pool:
        tasks = [pool.submit(witnessed, solver, SEED, index, errors) for index in range(COUNT)]
        check(list(enumerate(task.result() for task in tasks)))
