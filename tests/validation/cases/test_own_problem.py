"""A problem of one's own is judged whatever drives it, and what the solvers agree on is not called different."""

from __future__ import annotations

import warnings

import pytest
from few_and_many import in_processes
from population import driven_joint

from lapjoint.errors import RecordWarning
from validation.cases import own_problem
from validation.verdict import Verdict

SEED, COUNT = 271, 200
FEW = (10, 22, 121)  # a record; a random excitation; one that balances
MORE = (3, 29)  # harmonics and twins; a record that touches nothing
FAR = 10.0  # times what is allowed: so far off is none
MOST_MISSED = 0.01  # of all numbers


def judged(index: int) -> tuple[str, int, list[tuple[str, float]], list[str]]:
    """The problem's title, the number of its checks, those that disagree and by how much, and failed criteria."""
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RecordWarning)
        problem, _ = driven_joint(SEED, index)
        parts = [own_problem.frequencies, own_problem.transient]
        if problem.excitation_frequency is not None:
            parts.append(own_problem.steady)
        results = [part(problem, "quick", lambda text: None) for part in parts]
    checks = [check for result in results for check in result.checks]
    missed = [(it.name, abs(it.difference) / it.allowed) for it in checks if it.verdict is Verdict.DISAGREE]
    failed = [it.line for result in results for it in result.criteria if it.verdict is Verdict.DISAGREE]
    return problem.title, len(checks), missed, failed


@pytest.mark.parametrize("index", [*FEW, *(pytest.param(it, marks=pytest.mark.thorough) for it in MORE)])
def test_a_few_problems_of_ones_own_are_judged_and_agree(index: int) -> None:
    _, count, missed, failed = judged(index)
    assert count
    assert not missed
    assert not failed


@pytest.mark.thorough
def test_the_witness_of_energy_is_not_misled_by_two_quadratures_that_agree_by_chance() -> None:
    *_, failed = judged(31)
    assert not failed


@pytest.mark.slow
def test_many_problems_of_ones_own_are_judged_and_agree() -> None:
    found = list(in_processes(judged, range(COUNT)))
    missed = [(title, *one) for title, _, several, _ in found for one in several]
    assert not [(title, failed) for title, _, _, failed in found if failed]
    assert all(ratio <= FAR for _, _, ratio in missed), missed
    assert len(missed) <= MOST_MISSED * sum(count for _, count, _, _ in found), missed
