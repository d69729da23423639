"""No certificate of a random joint is false: a march from where it was accepted ends on the motion that it names."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from functools import partial

import pytest
from few_and_many import in_processes
from population import harmonic_joint, joint, response_of
from random_joints import DAMPED, PRELOADED, SPATIAL, real_joint
from refining import AnySolver
from witness import Judgement, reached_from_rest, testify

import analytic
import fe_lapjoint
from lapjoint import Problem

pytestmark = pytest.mark.long_march

ANALYTIC = analytic.Solver()
FINITE_ELEMENTS = fe_lapjoint.Solver(elements=8)  # a coarse beam is a beam, too, and ten times as fast to march

COUNT, SEED = 600, 31415  # problems that decide; nothing was ever chosen by how this seed goes
QUICK_SEED, QUICK = 2, (6, 11, 27, 28, 33, 43)  # free vibration dies away soon in these
QUICK_HARMONICS = (5, 11, 27, 43)  # of the same seed, driven by harmonics, and so in these
QUICK_REAL = (11, 35)  # of the same seed, with masses, steps, static loads, preload, stops in space
QUICK_OTHERS = ((PRELOADED, (1, 5)), (SPATIAL, (2,)), (DAMPED, (11,)))
HARMONICS = 120  # problems driven by harmonics
OTHERS, DAMPED_STOPS = 60, 100  # with preload, or stops in space besides; with damped stops
REAL = 200  # with masses, steps, static loads, preload, stops in space
MOST_UNDECIDED = 0.05
MOST_ELSEWHERE = 0.02

Judged = tuple[int, Judgement, str, bool]


Drawn = Callable[[int, int], Problem]


def judged(solver: AnySolver, drawn: Drawn, seed: int, index: int) -> Judged:
    """One problem: its index, what the witness says, how the march from rest ends elsewhere, and if that was said."""
    problem = drawn(seed, index)
    steady, period_map = solver.steady_state(problem), solver.period_map(problem)
    decay_time = response_of(problem).decay_time
    assert steady.acceptance is not None
    elsewhere = reached_from_rest(period_map, steady, decay_time)
    return index, testify(period_map, steady, decay_time), elsewhere, bool(steady.acceptance.sensitive)


def check(found: Iterable[Judged]) -> None:
    """Fail unless all certificates are true, few are withheld, and few marches from rest end elsewhere."""
    results = sorted(found, key=lambda one: one[0])
    false = [f"{i}: {said.why}" for i, said, _, _ in results if said.verdict == "false"]
    assert not false, "\n".join(false)
    undecided = [i for i, said, _, _ in results if said.verdict == "undecided"]
    assert len(undecided) <= MOST_UNDECIDED * len(results), undecided
    elsewhere = [(i, sensitive, why) for i, _, why, sensitive in results if why]
    assert all(sensitive for _, sensitive, _ in elsewhere), elsewhere
    assert len(elsewhere) <= MOST_ELSEWHERE * len(results), elsewhere


@pytest.mark.parametrize("solver", [ANALYTIC, FINITE_ELEMENTS])
def test_no_certificate_of_a_few_random_joints_is_false(solver: AnySolver) -> None:
    check(judged(solver, joint, QUICK_SEED, i) for i in QUICK[:: 1 + (solver is FINITE_ELEMENTS)])


@pytest.mark.parametrize("solver", [ANALYTIC, pytest.param(FINITE_ELEMENTS, marks=pytest.mark.thorough)])
def test_no_certificate_of_a_few_real_joints_is_false(solver: AnySolver) -> None:
    check(judged(solver, real_joint, QUICK_SEED, i) for i in QUICK_REAL)


@pytest.mark.parametrize("solver", [ANALYTIC, pytest.param(FINITE_ELEMENTS, marks=pytest.mark.thorough)])
@pytest.mark.parametrize(("drawn", "indices"), QUICK_OTHERS)
def test_no_certificate_of_a_few_joints_of_one_feature_is_false(
    solver: AnySolver, drawn: Drawn, indices: tuple[int, ...]
) -> None:
    check(judged(solver, drawn, QUICK_SEED, i) for i in indices)


@pytest.mark.thorough
@pytest.mark.parametrize("solver", [ANALYTIC, FINITE_ELEMENTS])
def test_no_certificate_of_a_few_random_joints_under_harmonics_is_false(solver: AnySolver) -> None:
    check(judged(solver, harmonic_joint, QUICK_SEED, i) for i in QUICK_HARMONICS)


@pytest.mark.slow
@pytest.mark.parametrize("solver", [ANALYTIC, FINITE_ELEMENTS])
@pytest.mark.parametrize(
    ("drawn", "count"),
    [
        (joint, COUNT),
        (harmonic_joint, HARMONICS),
        (real_joint, REAL),
        *((it, OTHERS) for it in (PRELOADED, SPATIAL)),
        (DAMPED, DAMPED_STOPS),
    ],
)
def test_no_certificate_of_random_joints_is_false(solver: AnySolver, drawn: Drawn, count: int) -> None:
    check(in_processes(partial(judged, solver, drawn, SEED), range(count)))
