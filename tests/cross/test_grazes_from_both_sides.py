"""A graze lies where it lies, whichever side a branch comes to it from."""

from __future__ import annotations

from collections.abc import Iterable

import pytest
from amplitude_ranges import from_below
from few_and_many import few_and_many
from population import joint

import analytic
import fe_lapjoint
from lapjoint.machine.one_thread import in_one_thread
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.sequence_changes import SequenceChange

SEED, FEW, MANY = 53, range(6), range(6, 60)
POINTS = 25  # of a branch
SOLVERS = {"analytic": analytic.Solver(n_modes=6), "fe": fe_lapjoint.Solver(elements=6)}
LOCATED = 2e-9  # of the value: on either side Newton's method leaves 1e-9
FOUND = 0.97  # of all changes of contacts along the branches; two at one place may come in the other order


@in_one_thread
def from_beyond(solver: object, indices: Iterable[int]) -> tuple[int, int]:
    """How many changes of contacts a branch comes to from beyond them, too, and how many there are."""
    found = total = 0
    for index in indices:
        _, traced = from_below(joint(SEED, index), solver, POINTS)
        assert traced is not None
        for one in (each.what for each in traced.found):
            if not isinstance(one, SequenceChange) or one.after is None:
                continue
            back = next((step for step in follow(one.after.turned()) if isinstance(step, SequenceChange)), None)
            total += 1
            found += back is not None and back.stops == one.stops and is_near(back, one)
    return found, total


def is_near(one: SequenceChange, other: SequenceChange) -> bool:
    """Whether two are at one value of the number."""
    return abs(one.value - other.value) <= LOCATED * abs(other.value)


@pytest.mark.parametrize("indices", few_and_many(FEW, MANY))
@pytest.mark.parametrize("name", ["analytic", pytest.param("fe", marks=pytest.mark.thorough)])
def test_a_graze_has_one_value_from_both_sides(name: str, indices: range) -> None:
    found, total = from_beyond(SOLVERS[name], indices)
    assert total >= len(indices)
    assert found >= FOUND * total
