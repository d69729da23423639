"""The energy of motions with damped stops, as the solver-blind witness has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analytic.solver import Solver
from lapjoint.answers import History
from tests.helpers.random_joints import damped_cantilever
from validation.invariants import energy_balance, stated_impulses


def motion(seed: int) -> History:
    return Solver(n_modes=20).simulate(damped_cantilever(np.random.default_rng(seed)), 2.0, errors=False)


@pytest.mark.parametrize("seed", [0, 3])  # viscous damping, so that all of the energy is accounted for
def test_damped_stops_take_the_energy_that_is_missing(seed: int) -> None:
    found = motion(seed)
    assert abs(energy_balance(found, 1e-5).value) < 1e-5  # 20 modes leave 1e-6
    assert stated_impulses(found, 1e-4).value < 1e-4
    taken = found.dissipated().sum()
    stiff = found.problem.replace(stops=tuple(stop.model_copy(update={"damping": 0.0}) for stop in found.problem.stops))
    assert abs(energy_balance(replace(found, problem=stiff), 1e-5).value) > 1e-3  # the springs' energy alone
    assert taken > 0
