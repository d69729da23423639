"""Beams that several harmonics drive: closed forms without stops, both solvers with them, one harmonic as a sine."""

from __future__ import annotations

import numpy as np
import pytest
from closed_form import answer
from population import harmonic_joint, joint
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, HarmonicsBaseMotion, Problem, paper_joint
from lapjoint.answers.steady_state import Outcome
from lapjoint.problem import BaseHarmonic
from lapjoint.problem.files import problem_from_tables, problem_tables
from lapjoint.problem.override import assign
from lapjoint.problem.symmetry import mirror_twins

SEED = 5
WITHOUT_STOPS = range(12)
WITH_STOPS = (0, 4, 8, 10)  # cantilevers with one stop, whose motions repeat soon, the last one last
LEAST = 16  # numbers compared, of all four
CONTACTS = 3  # from rest, compared one by one
PERIODS = 4  # of the fundamental, marched for them
FEW: tuple[AnySolver, ...] = (analytic.Solver(n_modes=6), fe_lapjoint.Solver(elements=4))


def harmonics(omega: float, *sizes: tuple[int, float]) -> HarmonicsBaseMotion:
    """A base that moves by harmonics of some multiples and amplitudes, m."""
    parts = tuple(BaseHarmonic(multiple=n, amplitude=amplitude, phase=0.3 * n) for n, amplitude in sizes)
    return HarmonicsBaseMotion(angular_frequency=omega, harmonics=parts)


@pytest.mark.parametrize(
    "index", [pytest.param(it, marks=pytest.mark.thorough if it % 2 else ()) for it in WITHOUT_STOPS]
)
def test_without_stops_the_motion_is_the_closed_form(index: int) -> None:
    problem = harmonic_joint(SEED, index).replace(stops=())
    x = np.array([0.31, 0.77, 1.0])
    t = np.linspace(0.0, problem.require_excitation_period("test"), 13)
    exact = answer(problem, x, t)

    def error(solver: AnySolver) -> float:
        found = solver.steady_state(problem, errors=False, sensitivity=False)
        assert found.symmetric == problem.forces.change_sign
        return float(np.abs(found.history.displacement(x, t) - exact).max() / np.abs(exact).max())

    assert error(analytic.Solver(n_modes=40)) < 1e-8  # of 24 joints the largest is 3e-8, of these twelve 4e-10
    coarse, fine = (error(fe_lapjoint.Solver(elements=n)) for n in (20, 40))
    assert fine < 1e-4
    assert fine < coarse / 6 or fine < 2e-7  # the fourth order makes sixteen, until rounding is left


@pytest.mark.parametrize(
    ("indices", "least"), [(WITH_STOPS[:3], 11), pytest.param(WITH_STOPS, LEAST, marks=pytest.mark.thorough)]
)
def test_both_solvers_agree_on_first_contacts_and_on_steady_states(indices: tuple[int, ...], least: int) -> None:
    solvers: tuple[AnySolver, ...] = (analytic.Solver(), fe_lapjoint.Solver(elements=24))
    times = []  # differences over both stated errors
    for index in indices:
        problem = harmonic_joint(SEED, index)
        duration = PERIODS * problem.require_excitation_period("test")
        one, other = (solver.simulate(problem, duration).contacts[:CONTACTS] for solver in solvers)
        assert [contact.stop for contact in one] == [contact.stop for contact in other]
        for a, b in zip(one, other, strict=True):
            times.append(abs(a.start - b.start) / (a.start_error + b.start_error))
            times.append(abs(a.impulse - b.impulse) / (a.impulse_error + b.impulse_error))
        mine, theirs = (solver.steady_state(problem, sensitivity=False) for solver in solvers)
        assert mine.outcome is theirs.outcome
        assert (mine.period_multiple, mine.symmetric) == (theirs.period_multiple, theirs.symmetric)
        if mine.outcome is not Outcome.NO_CONTACT:
            times.append(
                float(abs(mine.impulses - theirs.impulses)[0] / (mine.impulse_errors + theirs.impulse_errors)[0])
            )
    assert len(times) >= least
    assert max(times) <= 1.0


@pytest.mark.parametrize("solver", FEW)
@pytest.mark.parametrize("index", [1, 2])
def test_one_harmonic_gives_the_bits_of_a_sine(solver: AnySolver, index: int) -> None:
    problem = paper_joint() if index == 1 else joint(SEED, index)
    base = problem.base_motion
    assert isinstance(base, BaseMotion)
    one = harmonics(base.angular_frequency, (1, base.amplitude))
    sine = base.model_copy(update={"phase": one.harmonics[0].phase})
    a, b = (solver.steady_state(problem.replace(base_motion=it)) for it in (sine, one))
    assert np.array_equal(a.impulses, b.impulses)
    assert np.array_equal(a.impulse_errors, b.impulse_errors)
    assert np.array_equal(a.multipliers, b.multipliers)
    assert a.history.contacts == b.history.contacts


@pytest.mark.parametrize("solver", FEW)
def test_even_multiples_break_the_symmetry_and_odd_ones_do_not(solver: AnySolver) -> None:
    def steady(*sizes: tuple[int, float]) -> tuple[Problem, bool, np.ndarray]:
        problem = paper_joint().replace(base_motion=harmonics(515.0, *sizes))
        found = solver.steady_state(problem, errors=False, sensitivity=False)
        assert found.outcome is Outcome.PERIODIC
        return problem, found.symmetric, found.impulses

    odd, symmetric, impulses = steady((1, 0.06), (3, 0.005))
    assert mirror_twins(odd) == (2, 3, 0, 1)
    assert symmetric
    assert impulses[:2] == pytest.approx(-impulses[2:], rel=1e-7)
    even, symmetric, impulses = steady((1, 0.06), (2, 0.01))
    assert mirror_twins(even) is None
    assert not symmetric
    assert abs(impulses[1] + impulses[3]) > 1e-5 * impulses[3]
    silent, symmetric, _ = steady((1, 0.06), (2, 0.0))
    assert mirror_twins(silent) == (2, 3, 0, 1)
    assert symmetric


@pytest.mark.parametrize("solver", FEW)
@pytest.mark.parametrize("field", ["base_motion.angular_frequency", "base_motion.harmonics.1.amplitude"])
def test_derivatives_by_the_fundamental_and_by_amplitudes_are_those_of_the_steady_motion(
    solver: AnySolver, field: str
) -> None:
    """Without stops the section point y of the steady motion obeys y = P(y), so (1 - DP) dy = dP, both by the map."""
    problem = harmonic_joint(SEED, 2).replace(stops=())
    tables = problem_tables(problem)
    value = {"base_motion.angular_frequency": problem.excitation_frequency}.get(field) or float(
        tables["base_motion"]["harmonics"][1]["amplitude"]
    )

    def at(number: float) -> Problem:
        there = problem_tables(problem)
        assign(there, field, number, "test")
        if field == "base_motion.angular_frequency":
            for i in range(len(problem.point_loads)):
                assign(there, f"point_loads.{i}.angular_frequency", number, "test")
        return problem_from_tables(there)

    map_ = solver.period_map(problem)
    y = solver.steady_state(problem, errors=False, sensitivity=False).section_point
    DP = map_.linearised(y, 2).matrix
    step = 1e-4 * value
    beside = (solver.period_map(at(value + s)) for s in (step, -step))
    dP = np.subtract(*(map_.difference(it.march(it.adopted(y), 2).end, y) for it in beside)) / (2 * step)
    after, before = (
        map_.difference(solver.steady_state(at(value + s), errors=False, sensitivity=False).section_point, y)
        for s in (step, -step)
    )
    dy = (after - before) / (2 * step)
    assert dy - DP @ dy == pytest.approx(dP, rel=1e-4, abs=1e-5 * np.abs(dP).max())
