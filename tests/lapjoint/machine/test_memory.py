"""Memory is spoken of where it is much, refused where it is too much, and bounded by size where results are kept."""

from __future__ import annotations

import logging
from itertools import pairwise

import numpy as np
import pytest
from beams import unit_cantilever

import analytic
import fe_lapjoint
from lapjoint import Beam, SolverError, Stop
from lapjoint.machine import memory
from lapjoint.machine.result_cache import bytes_in, cached
from lapjoint.problem import FloatArray
from lapjoint.solver import Solver

MACHINE = 4e9
"""Bytes of a machine of which a motion may take a gigabyte."""
JOINT = unit_cantilever(Stop(x=1.0, side="top", gap=1e-4, stiffness=1e4), omega=30.0).replace(
    beam=Beam(length=1.0, bending_stiffness=100.0, mass_per_length=1.0)
)


@pytest.fixture(autouse=True)
def small_machine(monkeypatch: pytest.MonkeyPatch) -> None:
    """The machine has `MACHINE` bytes."""
    monkeypatch.setattr(memory, "machine_bytes", lambda: MACHINE)


def test_memory_is_spoken_of_from_500_mb_and_whenever_it_has_doubled(caplog: pytest.LogCaptureFixture) -> None:
    caplog.set_level(logging.INFO, "lapjoint.machine.memory")
    sizes = [0.0, 4e8, 5e8, 6e8, 9.9e8, 1e9]
    for before, size in pairwise(sizes):
        memory.require(size, "tables", "take fewer", before)
    assert caplog.messages == [
        "tables take 500 MB of memory, of 1 GB that are allowed",
        "tables take 1 GB of memory, of 1 GB that are allowed",
    ]


def test_more_than_a_quarter_of_the_machine_is_refused_with_what_to_change() -> None:
    message = "tables take 1.1 GB of memory; allowed are 1 GB, 25% of what this machine has: take fewer"
    with pytest.raises(SolverError, match=f"^{message}$"):
        memory.require(1.1e9, "tables", "take fewer")


@pytest.mark.parametrize("solver", [analytic.Solver(n_modes=10), fe_lapjoint.Solver(elements=4)])
def test_a_motion_too_long_to_be_kept_is_refused_before_it_is_marched(solver: Solver) -> None:
    reports: list[float] = []
    with pytest.raises(SolverError, match=r"take .* GB of memory; .*: take a shorter motion, fewer .*, or statistics"):
        solver.simulate(JOINT, 1e9, progress=lambda done, total: reports.append(done))
    assert reports == []


@pytest.mark.parametrize(
    ("solver", "allowed"), [(analytic.Solver(n_modes=10), 500e3), (fe_lapjoint.Solver(elements=4), 700e3)]
)
def test_a_motion_that_turns_out_too_large_ends_in_a_sentence(
    solver: Solver, allowed: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    # Without contacts forty seconds are 191 periods of 2.4 kB, or 573 windows of 1.1 kB: contacts take the rest.
    monkeypatch.setattr(memory, "SHARE", allowed / MACHINE)
    solver.simulate(JOINT.replace(stops=()), 40.0, errors=False)
    with pytest.raises(SolverError, match=r"take .* of memory; allowed are 0.[57] MB"):
        solver.simulate(JOINT.with_base_numbers(amplitude=5e-2), 40.0)


def test_what_is_kept_is_bounded_in_number_and_in_size() -> None:
    made: list[int] = []

    @cached(3, 8 * 100)
    def numbers(count: int) -> tuple[FloatArray, str]:
        made.append(count)
        return np.zeros(count), "numbers"

    assert numbers(1) is numbers(1)
    for count in (2, 3, 4, 2):
        numbers(count)
    assert made == [1, 2, 3, 4]
    numbers(1)  # was left out for the fourth
    numbers(98)  # leaves room for a result of two numbers at most: the last ones that were asked for have 2 and 1
    numbers(1)
    assert made == [1, 2, 3, 4, 1, 98]
    numbers(200)  # is larger than all that may be kept, and the last one is kept nevertheless
    numbers(200)
    numbers(1)
    assert made == [1, 2, 3, 4, 1, 98, 200, 1]
    numbers.cache_clear()
    numbers(1)
    assert made[-2:] == [1, 1]


def test_the_size_of_a_value_is_that_of_the_arrays_in_it() -> None:
    assert bytes_in((np.zeros(3), "text", (np.zeros((2, 2), dtype=complex), 7.0))) == 3 * 8 + 4 * 16
