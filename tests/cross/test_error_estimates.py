"""The errors that answers state of themselves are not less than their true errors, and not far more.

The truth is the same solver refined until another doubling moves it by less than a twentieth of the stated error.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import islice
from typing import Any

import numpy as np
import pytest
from few_and_many import in_processes
from population import stiffened_joint
from random_joints import real_joint
from refining import AnySolver, doubled, refined, touches

import analytic
import fe_lapjoint
from lapjoint import Problem, SteadyState
from lapjoint.answers import Contact
from lapjoint.problem import FloatArray

FEW = 300  # excitation periods, after which a motion that has not been found to repeat is not waited for
SOLVERS: tuple[AnySolver, ...] = (analytic.Solver(max_periods=FEW), fe_lapjoint.Solver(max_periods=FEW))

SEED, DRAWN, COUNT = 2718, 640, 200  # joints drawn, and how many of those that repeat with contacts are judged
COVERED, MOST_TIMES = 0.95, 10.0  # share of stated errors that hold; median of stated over true ones
NOT_STATED, NO_TRUTH = 0.1, 0.15  # most joints whose errors are infinite, or whose truth rounding hides (fine meshes)
SHARE = 1 / 20  # of the stated error, by which another doubling may move the truth
DOUBLINGS = 3
MARCHED = 10  # excitation periods from rest
CONTACT_ERRORS = ("start_error", "impulse_error", "peak_force_error")


@dataclass(frozen=True)
class Judged:
    """Stated and true errors of numbers of one kind of an answer; no true ones if they are out of reach."""

    stated: FloatArray
    true: FloatArray

    @property
    def covered(self) -> bool:
        """Whether no true error is larger than the stated one."""
        return bool(np.all(self.true <= self.stated))

    @property
    def times(self) -> float:
        """The largest stated error over the largest true one."""
        return float(self.stated.max() / max(self.true.max(), 1e-300))


Drawn = Callable[[int, int], Problem]


def judged_steady(solver: AnySolver, drawn: Drawn, index: int) -> tuple[Judged, ...] | None:
    """Impulses, and `CONTACT_ERRORS` of the contacts, of one steady state; None if it makes none."""
    problem = drawn(SEED, index)
    if not isinstance(solver, analytic.Solver) and not touches(
        SOLVERS[0].steady_state(problem, sensitivity=False, errors=False)
    ):
        return None  # finite elements take long over what does not repeat
    steady = solver.steady_state(problem, sensitivity=False)
    if not touches(steady):
        return None
    stated = steady.impulse_errors
    assert stated is not None
    last: SteadyState | None = steady
    for times in range(1, DOUBLINGS + 1):
        before = last
        assert before is not None
        last = refined(doubled(solver, problem, times), problem, before)
        if last is None:
            break
        if times > 1 and np.all(np.abs(last.impulses - before.impulses) <= SHARE * stated):
            period = steady.history.end - steady.history.start
            contacts = judged_contacts(steady.history.contacts, last.history.contacts, before.history.contacts, period)
            return Judged(stated, np.abs(steady.impulses - last.impulses)), *contacts
    return Judged(stated, np.zeros(0)), *[Judged(np.zeros(0), np.zeros(0))] * len(CONTACT_ERRORS)


def judged_march(solver: AnySolver, drawn: Drawn, index: int) -> tuple[Judged, ...]:
    """`CONTACT_ERRORS` of the contacts from rest."""
    problem = drawn(SEED, index)
    assert problem.excitation_frequency is not None
    duration = MARCHED * 2 * math.pi / problem.excitation_frequency
    own = solver.simulate(problem, duration).contacts
    before, truth = (doubled(solver, problem, n).simulate(problem, duration, errors=False).contacts for n in (1, 2))
    return judged_contacts(own, truth, before, math.inf)


def judged_contacts(
    own: Sequence[Contact], truth: Sequence[Contact], before: Sequence[Contact], period: float
) -> tuple[Judged, ...]:
    """`CONTACT_ERRORS` of those contacts whose errors are stated, and whose truth is certain.

    `before` has half the resolution of the truth.  Contacts that a section point cuts are left out.
    """
    found = []
    for contact in own:
        stated = np.array([getattr(contact, name) for name in CONTACT_ERRORS], dtype=float)
        if contact.open_start or contact.open_end or not math.isfinite(stated[0]):
            continue
        true, other = (apart(contact, these, period) for these in (truth, before))
        if np.all(np.abs(true - other) <= SHARE * stated):
            found.append((stated, np.abs(true)))
    return tuple(Judged(*pairs) for pairs in np.array(found).reshape(-1, 2, len(CONTACT_ERRORS)).transpose(2, 1, 0))


def apart(contact: Contact, others: Sequence[Contact], period: float) -> FloatArray:
    """How far the nearest contact of the same stop is in start (modulo a period), impulse and peak force."""
    mine = [one for one in others if one.stop == contact.stop]
    if not mine:
        return np.full(len(CONTACT_ERRORS), np.inf)
    times = [abs(math.remainder(one.start - contact.start, period)) for one in mine]
    one = mine[int(np.argmin(times))]
    return np.array([min(times), one.impulse - contact.impulse, one.peak_force - contact.peak_force])


def check_joints(found: Sequence[Judged]) -> None:
    """Fail unless errors are stated, hold, and are not far more than the true ones."""
    judged = [one for one in found if one.true.size]
    finite = [one for one in judged if np.all(np.isfinite(one.stated))]
    print(
        f"{len(found)} joints: {len(found) - len(judged)} without a truth, {len(judged) - len(finite)} not stated; "
        f"{sum(one.covered for one in finite)} of {len(finite)} hold; stated over true "
        f"{np.percentile([one.times for one in finite], (5, 50, 95)).round(2)}"
    )
    assert len(judged) >= (1 - NO_TRUTH) * len(found)
    assert len(finite) >= (1 - NOT_STATED) * len(judged)
    assert sum(one.covered for one in judged) >= COVERED * len(judged)
    assert np.median([one.times for one in judged]) <= MOST_TIMES


def check_contacts(found: Sequence[Judged]) -> None:
    """The same of contacts, all together."""
    stated, true = (np.concatenate([getattr(one, name) for one in found]) for name in ("stated", "true"))
    share, times = np.mean(true <= stated), np.median(stated / np.maximum(true, 1e-300))
    print(f"{stated.size} contacts: {share:.3f} hold; stated over true in the median {times:.2f}")
    assert share >= COVERED
    assert times <= MOST_TIMES


QUICK = (4, 8)
SOME = 10  # real joints in a thorough run: a median over two says little
Run = Callable[[Callable[[int], Any], Iterable[int]], Iterable[Any]]
"""How members of a population are judged: one after the other, or by several processes."""
DRAWN_BY = (stiffened_joint, real_joint)


@pytest.mark.parametrize(
    ("drawn", "run", "members", "count"),
    [
        (stiffened_joint, map, QUICK, 2),
        pytest.param(real_joint, map, range(DRAWN), SOME, marks=pytest.mark.thorough),
        *(pytest.param(each, in_processes, range(DRAWN), COUNT, marks=pytest.mark.slow) for each in DRAWN_BY),
    ],
)
@pytest.mark.parametrize("solver", SOLVERS)
def test_errors_of_steady_states_hold(
    solver: AnySolver, drawn: Drawn, run: Run, members: Iterable[int], count: int
) -> None:
    results = run(partial(judged_steady, solver, drawn), members)
    found = list(islice((one for one in results if one is not None), count))
    assert len(found) == count
    check_joints([one[0] for one in found])
    for i in range(len(CONTACT_ERRORS)):
        check_contacts([one[1 + i] for one in found])


@pytest.mark.parametrize(
    ("run", "members"), [(map, QUICK), pytest.param(in_processes, range(COUNT), marks=pytest.mark.slow)]
)
@pytest.mark.parametrize("drawn", DRAWN_BY)
@pytest.mark.parametrize("solver", SOLVERS)
def test_errors_of_marches_hold(solver: AnySolver, drawn: Drawn, run: Run, members: Iterable[int]) -> None:
    found = list(run(partial(judged_march, solver, drawn), members))
    for i in range(len(CONTACT_ERRORS)):
        check_contacts([one[i] for one in found])
