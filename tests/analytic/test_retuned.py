"""A map with another frequency or amplitude of the base is to the bit the one that is made anew; no other is known."""

from __future__ import annotations

import pickle

import numpy as np
import pytest
from population import harmonic_joint, joint

import analytic
from analytic.march import Joint
from analytic.period_map import PeriodMap
from lapjoint import BaseMotion, InputError, NoDamping, Problem, SineLoad, paper_joint
from lapjoint.campaigns.grid import Axis, Grid
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.resolution import ParameterRange
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY

MODES = 9


def other(problem: Problem, field: str, value: float) -> Problem:
    return problem.with_base_numbers(**{field.split(".")[1]: value})


def never() -> Problem:
    raise AssertionError("the problem is asked for")


def assert_the_same(one: PeriodMap, anew: PeriodMap, field: str) -> None:
    """Tables, period, marches and derivatives are the same to the bit."""
    for name, mine, its in zip(anew.joint.tables._fields, one.joint.tables, anew.joint.tables, strict=True):
        assert np.array_equal(mine, its), name
    assert (one.period, one.name) == (anew.period, anew.name)
    assert np.array_equal(one.joint.sizes, anew.joint.sizes)
    points = [anew.march(anew.initial(), count).end for count in (5, 14)]
    for point in points:
        assert np.array_equal(one.adopted(point).coordinates, point.coordinates)
        passages = [it.march(point, 3) for it in (one, anew)]
        assert passages[0].end.state == passages[1].end.state
        assert np.array_equal(passages[0].end.coordinates, passages[1].end.coordinates)
        assert np.array_equal(passages[0].impulses, passages[1].impulses)
        assert np.array_equal(one.linearised(point, 3).matrix, anew.linearised(point, 3).matrix)
        sequence, start = ContactSequence(point.state), anew.arcs.coordinates(point)
        mine, its = (it.arcs.chain(sequence, start, 0.0, np.array([it.period]), number=field) for it in (one, anew))
        assert its.by_number is not None
        assert np.array_equal(mine.by_number, its.by_number)


@pytest.mark.parametrize("field", [FREQUENCY, AMPLITUDE])
@pytest.mark.parametrize("index", range(24))
def test_a_retuned_map_is_the_one_that_is_made_anew(index: int, field: str) -> None:
    rng = np.random.default_rng((71, index))
    problem = joint(71, index)
    if index % 4 == 3:  # undamped modes are moved away from a resonance
        problem = problem.replace(damping=NoDamping())
    assert isinstance(problem.base_motion, BaseMotion)
    solver = analytic.Solver(n_modes=MODES)
    first = solver.period_map(problem)
    first.march(first.initial(), 20)  # it has met some states
    value = getattr(problem.base_motion, field.split(".")[1]) * rng.uniform(0.8, 1.25)
    if index % 4 == 3 and field == FREQUENCY:
        value = float(Joint(problem, MODES, MODES).modal(first.initial().state).modes.omega[1])
    found = first.retuned(field, value, never)
    assert found is not None
    there = other(problem, field, value)
    assert_the_same(found, solver.period_map(there), field)
    beyond = first.retuned(field, value, lambda: there)
    assert beyond is not None
    back = beyond.retuned(field, problem.base_motion.model_dump()[field.split(".")[1]], never)
    assert back is not None
    assert_the_same(back, solver.period_map(problem), field)


def test_its_problem_is_made_when_it_is_asked_for() -> None:
    problem = paper_joint()
    wanted = other(problem, FREQUENCY, 321.0)
    found = analytic.Solver(n_modes=MODES).period_map(problem).retuned(FREQUENCY, 321.0, lambda: wanted)
    assert found is not None
    there = pickle.loads(pickle.dumps(found))  # before it is asked for
    assert there.problem == wanted
    assert np.array_equal(
        there.march(there.initial(), 4).end.coordinates, found.march(found.initial(), 4).end.coordinates
    )
    assert found.problem is wanted


def test_a_map_does_not_know_what_it_cannot() -> None:
    solver = analytic.Solver(n_modes=MODES)
    driven = paper_joint().replace(point_loads=(SineLoad(x=1.0, force=1.0, angular_frequency=515.0),))
    for problem, field in ((driven, FREQUENCY), (harmonic_joint(72, 0), FREQUENCY), (paper_joint(), "stops[0].gap")):
        assert solver.period_map(problem).retuned(field, 1.5, never) is None
    for value in (0.0, -1.0):
        assert solver.period_map(paper_joint()).retuned(FREQUENCY, value, never) is None


def test_a_range_has_the_maps_that_are_made_anew_in_all_its_zones_and_none_where_there_is_no_problem() -> None:
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (50.0, 4000.0)),))
    of = ParameterRange(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, 50.0, 4000.0)
    assert len(of.zones) > 1
    for value in np.random.default_rng(73).uniform(50.0, 4000.0, 12).tolist():
        own = of.resolution(value)
        anew = own.solver.period_map(grid.with_values((value,)))
        found = own.map(value)
        assert isinstance(found, PeriodMap)
        assert isinstance(anew, PeriodMap)
        assert found.problem == anew.problem
        assert_the_same(found, anew, FREQUENCY)
    for value in (0.0, -3.0, 1e200):
        with pytest.raises(InputError):
            of.resolution(1e3).map(value)
