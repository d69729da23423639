"""Cantilevers with damped stops: both solvers agree on first contacts within their stated errors."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint.answers import Contact
from tests.helpers.random_joints import damped_cantilever

SOLVERS: tuple[analytic.Solver | fe_lapjoint.Solver, ...] = (
    analytic.Solver(n_modes=14, max_periods=1500),
    fe_lapjoint.Solver(elements=12, max_periods=1500),
)
DURATION = 0.8  # s: a third of the period of the free beam's first mode, after which joints have touched
CONTACTS = 3  # of a motion
MARGIN = 3.0  # of both stated errors together, which are estimates
ROUNDING = 1e-9  # of the duration, and of the largest impulse: what errors of truncation do not count
GRAZE = 0.03  # of the largest impulse: whether a lighter contact is there, truncation decides
FAR = 10.0  # times what the errors allow: so far off is none
MOST_MISSED = 0.05  # of all numbers; stated errors are to cover 19 of 20


def differences(seed: int) -> list[float]:
    """Differences of the first contacts of a random joint, over what the stated errors allow."""
    problem = damped_cantilever(np.random.default_rng(seed))
    every = [solver.simulate(problem, DURATION).contacts for solver in SOLVERS]
    size = max((abs(c.impulse) for contacts in every for c in contacts), default=0.0)
    one, other = ([c for c in contacts if abs(c.impulse) > GRAZE * size][:CONTACTS] for contacts in every)
    found: list[float] = []
    for a, b in zip(one, other, strict=False):
        if a.stop != b.stop:
            break
        found += [_times(a, b, "start", ROUNDING * DURATION), _times(a, b, "impulse", ROUNDING * size)]
    return found


def _times(a: Contact, b: Contact, what: str, rounding: float) -> float:
    """A difference over what the errors allow."""
    errors = [getattr(c, f"{what}_error") for c in (a, b)]
    return float(abs(getattr(a, what) - getattr(b, what)) / (MARGIN * sum(errors) + rounding))


def check_contacts(seeds: range, least: int) -> None:
    """Fail unless nearly all numbers agree."""
    found = {seed: differences(seed) for seed in seeds}
    numbers = np.array([number for each in found.values() for number in each])
    missed = {seed: each for seed, each in found.items() if max(each, default=0.0) > 1}
    assert numbers.size >= least
    assert numbers.max() <= FAR, missed
    assert np.count_nonzero(numbers > 1) <= MOST_MISSED * numbers.size, missed


def test_first_contacts_of_a_few_joints() -> None:
    check_contacts(range(8, 10), 2)


@pytest.mark.slow
def test_first_contacts_of_many_joints() -> None:
    check_contacts(range(10, 50), 80)
