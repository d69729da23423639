"""A motion over many periods is marched period by period, and ends when it was asked to."""

from __future__ import annotations

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.solver import Solver

SOLVERS: tuple[Solver, ...] = (analytic.Solver(n_modes=2), fe_lapjoint.Solver(elements=1))


@pytest.mark.parametrize("solver", SOLVERS, ids=lambda it: it.name)
@pytest.mark.parametrize("more", [0.0, 0.3])
def test_a_history_can_be_read_at_the_end_that_was_asked_for(solver: Solver, more: float) -> None:
    problem = paper_joint().replace(stops=())
    period = problem.require_excitation_period("march")
    for count in (10, 14, 19):  # of which n T is not (n - 1) T + T
        duration = (count + more) * period
        history = solver.simulate(problem, duration, errors=False)
        assert history.end == duration
        before, last = history.displacement(2.5, np.array([1 - 1e-12, 1.0]) * duration)[0]
        assert last == pytest.approx(before, rel=1e-6)
