"""Static equilibria of the finite element solver against closed forms."""

from __future__ import annotations

import math

import numpy as np
import pytest

from fe_lapjoint import Solver
from lapjoint import Beam, InputError, Problem, StepLoad, Stop, Support
from lapjoint.problem.static_loads import UniformLoad
from lapjoint.solver import Rests

SOLVER = Solver()
CLAMP = Support(x=0.0, translational=math.inf, torsional=math.inf)
L, EI, Q, K = 2.0, 3.0e3, 500.0, 1e6
BEAM = Beam(length=L, bending_stiffness=EI, mass_per_length=4.0)
DOWN = (UniformLoad(force_per_length=-Q),)


def test_the_tip_of_a_cantilever_presses_its_stop_by_the_textbook_force() -> None:
    gap = 0.01
    stop = Stop(x=L, side="bottom", gap=gap, stiffness=K)
    found = SOLVER.equilibrium(Problem(beam=BEAM, supports=[CLAMP], stops=[stop], uniform_loads=DOWN))
    force = (Q * L**4 / 8 / EI - gap) / (L**3 / 3 / EI + 1 / K)
    assert abs(found.contact_forces[0] - force) <= found.errors.contact_forces[0] + 1e-15 * force
    assert found.errors.contact_forces[0] < 1e-11 * force
    x = np.linspace(0, L, 41)
    moment = force * (L - x) - Q * (L - x) ** 2 / 2
    assert np.abs(found.moment(x) - moment).max() <= found.errors.moment
    assert np.abs(found.shear(x) - (Q * (L - x) - force)).max() <= found.errors.shear


def test_the_solver_rests() -> None:
    assert isinstance(SOLVER, Rests)


def test_stops_nearer_to_each_other_than_any_element_of_a_march_share_a_force() -> None:
    """Two stops 1e-11 of the length apart are as one of twice the stiffness, within errors that grow as 1 / h."""
    load = StepLoad(x=L, force=-100.0)
    near = [Stop(name=f"{x}", x=x, side="bottom", gap=0.0, stiffness=K) for x in (1.0, 1.0 + 2e-11)]
    found = SOLVER.equilibrium(Problem(beam=BEAM, supports=[CLAMP], stops=near, point_loads=[load]))
    one = Stop(x=1.0, side="bottom", gap=0.0, stiffness=2 * K)
    force = SOLVER.equilibrium(Problem(beam=BEAM, supports=[CLAMP], stops=[one], point_loads=[load])).contact_forces[0]
    error = found.errors.contact_forces.sum()
    assert abs(found.contact_forces.sum() - force) <= error < 1e-3 * force


def test_a_load_within_rounding_of_the_edge_of_a_free_beams_stops_is_taken() -> None:
    stops = [Stop(name=f"{x}", x=x, side="bottom", gap=0.0, stiffness=K) for x in (0.3, 1.1)]
    found = SOLVER.equilibrium(Problem(beam=BEAM, stops=stops, point_loads=[StepLoad(x=0.3, force=-1.0)]))
    assert found.contact_forces == pytest.approx([1.0, 0.0], abs=1e-12)


def test_a_load_beyond_the_stops_of_a_free_beam_is_refused() -> None:
    stops = [Stop(name=f"{x}", x=x, side="bottom", gap=0.0, stiffness=K) for x in (0.3, 1.1)]
    with pytest.raises(InputError, match="equilibrium: there is none: the static loads drive a turn anticlockwise"):
        SOLVER.equilibrium(Problem(beam=BEAM, stops=stops, point_loads=[StepLoad(x=0.299, force=-1.0)]))
