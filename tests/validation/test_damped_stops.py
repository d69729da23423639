"""The energy of motions with damped stops, as the solver-blind witness has it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
from random_joints import damped_cantilever

import fe_lapjoint
from analytic.solver import Solver
from lapjoint.answers import History
from lapjoint.problem.files import from_toml
from validation.invariants import energy_balance, stated_energies, stated_impulses, witness


def motion(seed: int) -> History:
    return Solver(n_modes=20).simulate(damped_cantilever(np.random.default_rng(seed)), 2.0, errors=False)


@pytest.mark.thorough
@pytest.mark.parametrize("seed", [0, 3])  # viscous damping, so that all of the energy is accounted for
def test_damped_stops_take_the_energy_that_is_missing(seed: int) -> None:
    found = motion(seed)
    assert abs(energy_balance(found, 1e-5).value) < 1e-5  # 20 modes leave 1e-6
    assert stated_impulses(found, 1e-4).value < 1e-4
    taken = found.dissipated().sum()
    stiff = found.problem.replace(stops=tuple(stop.model_copy(update={"damping": 0.0}) for stop in found.problem.stops))
    assert abs(energy_balance(replace(found, problem=stiff), 1e-5).value) > 1e-3  # the springs' energy alone
    assert taken > 0


@pytest.mark.parametrize(
    "solver", [Solver(n_modes=20), pytest.param(fe_lapjoint.Solver(elements=8), marks=pytest.mark.thorough)]
)
@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.thorough), 2])  # seed 2 ends within a contact
def test_stated_energies_are_those_of_the_force_law(solver: Solver | fe_lapjoint.Solver, seed: int) -> None:
    found = solver.simulate(damped_cantilever(np.random.default_rng(seed)), 1.0, errors=False)
    assert found.dissipated().max() > 0
    assert stated_energies(found, 1e-6).value < 1e-4  # truncation moves the stop at a switch
    assert any("energy lost" in item.name for item in witness(found, 1e-3, "one"))
    for factor in (-1.0, 1.01):
        changed = tuple(replace(it, dissipated=factor * it.dissipated) for it in found.contacts)
        assert stated_energies(replace(found, contacts=changed), 1e-6).value > 5e-3


STRIP = """
supports = [{ x = 0.0, translational = inf, torsional = inf }]
masses = [{ x = 0.3, mass = 0.05 }]
[beam]
length = 0.3
material = { youngs_modulus = 2.1e11, density = 7850.0 }
section = { shape = "rectangle", breadth = 0.02, height = 0.002 }
[[stops]]
x = 0.24
side = "bottom"
gap = 4e-4
stiffness = 2e5
damping = 8.0
[damping]
kind = "viscous"
coefficient = 0.4
[base_motion]
amplitude = 2e-4
angular_frequency = 91.7
"""


@pytest.mark.thorough
def test_modes_of_a_fine_mesh_that_ring_in_a_contact_are_resolved() -> None:
    """A steel strip on a rubber pad: its fastest mode turns a thousand times in each contact."""
    found = fe_lapjoint.Solver(elements=60).simulate(from_toml(STRIP), 0.3, errors=False)
    assert len(found.contacts) > 2
    assert stated_energies(found, 2e-5).value < 2e-6
