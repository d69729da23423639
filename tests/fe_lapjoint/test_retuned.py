"""A map with another frequency or amplitude of the base is to the bit the one that is made anew; no other is known."""

from __future__ import annotations

import numpy as np
import pytest
from population import harmonic_joint, joint

import fe_lapjoint
from lapjoint import NoDamping, Problem, paper_joint
from lapjoint.orbits.parameters import AMPLITUDE, FREQUENCY

SOLVER = fe_lapjoint.Solver(elements=5)


def never() -> Problem:
    raise AssertionError("the problem is asked for")


@pytest.mark.parametrize("field", [FREQUENCY, AMPLITUDE])
@pytest.mark.parametrize("index", range(8))
def test_a_retuned_map_is_the_one_that_is_made_anew(index: int, field: str) -> None:
    problem, name = joint(71, index), field.split(".")[1]
    first = SOLVER.period_map(problem)
    first.march(first.initial(), 6)  # it has met some states
    value = problem.base_motion.model_dump()[name] * np.random.default_rng((71, index)).uniform(0.8, 1.25)
    if index % 4 == 3:  # undamped modes are moved away from a resonance
        problem = problem.replace(damping=NoDamping())
        first = SOLVER.period_map(problem)
        value = float(first.model.system(first.initial().state).omega[1]) if field == FREQUENCY else value
    there = problem.with_base_numbers(**{name: value})
    found, anew = first.retuned(field, value, lambda: there), SOLVER.period_map(there)
    assert found is not None
    assert (found.problem, found.period, found.name) == (there, anew.period, anew.name)
    mine, its = (one.march(one.initial(), 5) for one in (found, anew))
    assert mine.end.state == its.end.state
    assert np.array_equal(mine.end.coordinates, its.end.coordinates)
    assert np.array_equal(mine.impulses, its.impulses)


def test_a_map_is_retuned_by_the_excitation_alone() -> None:
    first = SOLVER.period_map(paper_joint())
    for field in ("stops.0.gap", "damping.ratio", "point_loads.0.force"):
        assert first.retuned(field, 1e-3, never) is None
    assert SOLVER.period_map(harmonic_joint(1, 0)).retuned(AMPLITUDE, 1e-3, never) is None
