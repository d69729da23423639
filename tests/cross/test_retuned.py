"""A map with another frequency or amplitude of the base is to the bit the one that is made anew; no other is known."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from population import harmonic_joint, joint
from refining import AnySolver

import analytic
import fe_lapjoint
from analytic.period_map import PeriodMap as PeriodMapOfModes
from lapjoint import FREE, BaseMotion, InputError, NoDamping, Problem, SineLoad, paper_joint
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits import PeriodMap
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY

SOLVERS = {"analytic": (analytic.Solver(n_modes=9), 24), "fe": (fe_lapjoint.Solver(elements=5), 8)}
"""Each solver, and how many random joints it is tried on."""
solvers = pytest.mark.parametrize("solver", [solver for solver, _ in SOLVERS.values()], ids=SOLVERS)


def other(problem: Problem, field: str, value: float) -> Problem:
    return problem.with_base_numbers(**{field.split(".")[1]: value})


def never() -> Problem:
    raise AssertionError("the problem is asked for")


def assert_the_same(one: PeriodMap, anew: PeriodMap, field: str) -> None:
    """Name, period, marches, impulses and derivatives are the same to the bit."""
    assert (one.period, one.name) == (anew.period, anew.name)
    for point in [anew.march(anew.initial(), count).end for count in (5, 14)]:
        assert np.array_equal(one.adopted(point).coordinates, point.coordinates)
        passages = [it.march(point, 3) for it in (one, anew)]
        assert passages[0].end.state == passages[1].end.state
        assert np.array_equal(passages[0].end.coordinates, passages[1].end.coordinates)
        assert np.array_equal(passages[0].impulses, passages[1].impulses)
        assert np.array_equal(one.linearised(point, 3).matrix, anew.linearised(point, 3).matrix)
        sequence, start = ContactSequence(point.state), anew.arcs.coordinates(point)
        mine, its = (it.arcs.chain(sequence, start, 0.0, np.array([it.period]), number=field) for it in (one, anew))
        assert np.array_equal(mine.end, its.end)
        if isinstance(anew, PeriodMapOfModes):
            assert its.by_number is not None
            assert np.array_equal(mine.by_number, its.by_number)


@pytest.mark.parametrize("field", [FREQUENCY, AMPLITUDE])
@pytest.mark.parametrize(
    ("solver", "index"),
    [
        pytest.param(solver, i, id=f"{name}-{i}", marks=() if i < 4 else pytest.mark.thorough)
        for name, (solver, count) in SOLVERS.items()
        for i in range(count)
    ],
)
def test_a_retuned_map_is_the_one_that_is_made_anew(solver: AnySolver, index: int, field: str) -> None:
    rng = np.random.default_rng((71, index))
    problem = joint(71, index)
    if index % 4 == 3:  # undamped modes are moved away from a resonance
        problem = problem.replace(damping=NoDamping())
    assert isinstance(problem.base_motion, BaseMotion)
    own = getattr(problem.base_motion, field.split(".")[1])
    first = solver.period_map(problem)
    first.march(first.initial(), 20)  # it has met some states
    value = own * rng.uniform(0.8, 1.25)
    if index % 4 == 3 and field == FREQUENCY:
        value = float(solver.modes(problem, FREE, 3).angular_frequencies[1])
    there = other(problem, field, value)
    found = first.retuned(field, value, lambda: there)
    assert found is not None
    assert found.problem == there
    assert_the_same(found, solver.period_map(there), field)
    back = found.retuned(field, own, lambda: problem)
    assert back is not None
    assert_the_same(back, solver.period_map(problem), field)


def test_its_problem_is_made_when_it_is_asked_for() -> None:
    problem, solver = paper_joint(), SOLVERS["analytic"][0]
    wanted = other(problem, FREQUENCY, 321.0)
    assert solver.period_map(problem).retuned(FREQUENCY, 321.0, never) is not None
    found = solver.period_map(problem).retuned(FREQUENCY, 321.0, lambda: wanted)
    assert found is not None
    there = pickle.loads(pickle.dumps(found))  # before it is asked for
    assert there.problem == wanted
    assert np.array_equal(
        there.march(there.initial(), 4).end.coordinates, found.march(found.initial(), 4).end.coordinates
    )
    assert found.problem is wanted


@solvers
def test_a_map_does_not_know_what_it_cannot(solver: AnySolver) -> None:
    asked = [(paper_joint(), field) for field in ("stops[0].gap", "damping.ratio", "point_loads.0.force")]
    asked.append((harmonic_joint(72, 0), AMPLITUDE))
    for problem, field in asked:
        assert solver.period_map(problem).retuned(field, 1.5, never) is None


def test_the_analytic_map_knows_a_sine_of_the_base_alone() -> None:
    solver, load = SOLVERS["analytic"][0], SineLoad(x=1.0, force=1.0, angular_frequency=515.0)
    for problem in (paper_joint().replace(point_loads=(load,)), harmonic_joint(72, 0)):
        assert solver.period_map(problem).retuned(FREQUENCY, 1.5, never) is None
    for value in (0.0, -1.0):
        assert solver.period_map(paper_joint()).retuned(FREQUENCY, value, never) is None


def test_a_range_has_the_maps_that_are_made_anew_in_all_its_zones_and_none_where_there_is_no_problem() -> None:
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (50.0, 4000.0)),))
    of = ParameterRange(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, 50.0, 4000.0)
    assert len(of.zones) > 1
    for value in np.random.default_rng(73).uniform(50.0, 4000.0, 12).tolist():
        own = of.resolution(value)
        anew, found = own.solver.period_map(grid.with_values((value,))), own.map(value)
        assert found.problem == anew.problem
        assert_the_same(found, anew, FREQUENCY)
    for value in (0.0, -3.0, 1e200):
        with pytest.raises(InputError):
            of.resolution(1e3).map(value)
