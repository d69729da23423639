"""Viscous damping that couples the modes, on a mesh: flows, motions, deviations, certificates against brute force."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from damped_stops import model_of
from random_joints import dragged_cantilever

from fe_lapjoint import Solver
from fe_lapjoint.march.coupled import Coupled
from fe_lapjoint.modes.assembly import Assembly
from lapjoint.answers.contact_state import FREE
from lapjoint.problem import FloatArray, Problem, ViscousDamping
from tests.fe_lapjoint.march.test_coupled import first_order


def coupled(problem: Problem, elements: int = 3) -> Coupled:
    """The state without contact."""
    system = model_of(problem, elements).system(FREE)
    assert isinstance(system, Coupled)
    return system


def flow_error(system: Coupled, t: float) -> float:
    """Error of the flow over `t` seconds against scipy's expm."""
    A, size = first_order(system)
    return float(np.abs(scipy.linalg.expm(A * t) - system.flown(t, np.diag(1 / size)) * size[:, None]).max())


@pytest.mark.parametrize("seed", range(8))
def test_modes_flow_as_the_matrix_exponential(seed: int) -> None:
    rng = np.random.default_rng(seed)
    assert flow_error(coupled(dragged_cantilever(rng)), 10 ** rng.uniform(-3, -1)) < 1e-9


@pytest.mark.parametrize("apart", [0.0, 1e-15, -1e-15, 1e-12, 1e-9, -1e-6, 1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    problem, low, high = dragged_cantilever(np.random.default_rng(3)), 0.1, 100.0

    def all_ring(C: float) -> bool:
        return bool((coupled(problem.replace(damping=ViscousDamping(coefficient=C)), 1).free.rates.imag > 0).all())

    assert all_ring(low)
    assert not all_ring(high)
    while low < (low + high) / 2 < high:
        low, high = ((low + high) / 2, high) if all_ring((low + high) / 2) else (low, (low + high) / 2)
    damping = ViscousDamping(coefficient=high * (1 + apart))
    assert flow_error(coupled(problem.replace(damping=damping), 1), 0.5) < 1e-9


def test_drag_of_a_rigid_motion_is_that_of_the_whole_beam() -> None:
    problem = dragged_cantilever(np.random.default_rng(0)).replace(supports=())
    assembly = Assembly(problem, np.array([0.0, 0.15, 0.3, 0.75, 1.0]))
    up, turned = np.zeros((2, 10))
    up[::2], turned[::2], turned[1::2] = 1.0, assembly.nodes, 1.0
    both: FloatArray = np.stack([up, turned])
    assert both @ assembly.drag @ both.T == pytest.approx(np.array([[1.0, 1 / 2], [1 / 2, 1 / 3]]), rel=1e-14)


def test_the_jacobian_that_library_methods_take_is_that_of_the_rates() -> None:
    system = coupled(dragged_cantilever(np.random.default_rng(1)))
    y = np.random.default_rng(2).normal(size=2 * system.omega.size)
    change = system.rates(0.3, y) - system.rates(0.3, 0.0 * y)
    assert system.jacobian(0.3, y) @ y == pytest.approx(change, rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("method", ["Radau", "DOP853"])
def test_library_methods_move_as_the_exact_flow(method: str) -> None:
    problem = dragged_cantilever(np.random.default_rng(1))
    problem = problem.replace(stops=tuple(stop.model_copy(update={"damping": 0.0}) for stop in problem.stops))
    exact, other = (Solver(elements=2, method=name).simulate(problem, 0.2, errors=False) for name in ("exact", method))
    assert exact.displacement(1.0, 0.2).item() == pytest.approx(other.displacement(1.0, 0.2).item(), abs=1e-8)
