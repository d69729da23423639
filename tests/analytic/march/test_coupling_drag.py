"""Viscous damping that couples the modes, in the analytic solver: flows, motions, deviations and certificates."""

from __future__ import annotations

import math

import numpy as np
import pytest

from analytic.march import Joint
from analytic.solver import Solver
from lapjoint.answers.contact_state import FREE
from lapjoint.errors import InputError
from lapjoint.problem import Mass, Problem, StepLoad, ViscousDamping
from tests.analytic.march.test_coupled import check_motion, check_steady, check_tangent, flow_error
from tests.helpers.damped_stops import random_dragged_joint


def oscillators_flow(problem: Problem, count: int, t: float) -> float:
    """Error of the flow of the joint without contact over `t` seconds against scipy's expm."""
    joint = Joint(problem, count, count)
    it, omega = joint.coupled(FREE), joint.modal(FREE).modes.omega
    assert it is not None
    return flow_error(it.D, np.diag(omega**2), omega, t)


@pytest.mark.parametrize("seed", range(8))
def test_modes_flow_as_the_matrix_exponential(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = random_dragged_joint(rng)
    assert oscillators_flow(problem, int(rng.integers(3, 12)), 10 ** rng.uniform(-2, 0)) < 1e-9


def critical_of(problem: Problem, count: int) -> float:
    """The viscous coefficient at which one complex mode becomes critical, by halving, N s/m2."""

    def oscillating(C: float) -> int:
        it = Joint(problem.replace(damping=ViscousDamping(coefficient=C)), count, count).coupled(FREE)
        assert it is not None
        return int(np.count_nonzero(it.roots.imag[:, 0] > 0))

    low, high = 0.1, 100.0
    assert oscillating(low) == count > oscillating(high)
    while high - low > 1e-15 * high and low < (low + high) / 2 < high:
        middle = (low + high) / 2
        low, high = (middle, high) if oscillating(middle) == count else (low, middle)
    return high


@pytest.mark.parametrize("apart", [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, 1e-6, -1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    problem = random_dragged_joint(np.random.default_rng(3))
    C = critical_of(problem, 5) * (1 + apart)
    assert oscillators_flow(problem.replace(damping=ViscousDamping(coefficient=C)), 5, 0.5) < 1e-9


def test_motions_switch_where_brute_force_finds_it() -> None:
    for seed in range(3):
        check_motion(seed, random_dragged_joint)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(3, 110))
def test_many_motions_switch_where_brute_force_finds_it(seed: int) -> None:
    check_motion(seed, random_dragged_joint)


@pytest.mark.parametrize("seed", [0, 1])
def test_deviations_travel_as_finite_differences(seed: int) -> None:
    check_tangent(seed, random_dragged_joint)


@pytest.mark.slow
@pytest.mark.parametrize("seed", range(2, 60))
def test_many_deviations_travel_as_finite_differences(seed: int) -> None:
    check_tangent(seed, random_dragged_joint)


def test_a_certified_motion_stays() -> None:
    assert sum(check_steady(seed, random_dragged_joint) for seed in range(2)) >= 1


@pytest.mark.slow
def test_certified_motions_stay() -> None:
    assert sum(check_steady(seed, random_dragged_joint) for seed in range(2, 82)) >= 60


@pytest.mark.parametrize("mass", [1e-12, 1e-9, 1e-6])
def test_a_mass_that_vanishes_leaves_the_uncoupled_motion(mass: float) -> None:
    problem = random_dragged_joint(np.random.default_rng(1)).replace(
        beam=Problem.model_validate(PLAIN).beam, damping=ViscousDamping(coefficient=0.7), masses=()
    )
    problem = problem.replace(stops=tuple(s.model_copy(update={"damping": 0.0}) for s in problem.stops))
    laden = problem.replace(masses=(Mass(x=1.0, mass=mass),))
    plain, coupled = (Solver(n_modes=8).simulate(it, 3.0, errors=False) for it in (problem, laden))
    assert len(plain.contacts) >= 2
    for one, other in zip(plain.contacts, coupled.contacts, strict=True):
        assert other.start == pytest.approx(one.start, abs=100 * mass + 1e-10)
        assert other.impulse == pytest.approx(one.impulse, abs=100 * mass + 1e-10)


PLAIN = {"beam": {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}}


def test_a_section_point_of_more_modes_keeps_the_motion_of_the_fewer() -> None:
    problem = random_dragged_joint(np.random.default_rng(4))
    many, few = (Solver(n_modes=n).period_map(problem) for n in (9, 6))
    point = many.initial()
    taken = few.adopted(point)
    assert taken.state == point.state
    (q, v), (own_q, own_v) = (
        it.joint.in_modes(here.state, *here.coordinates, 0.0) for it, here in ((many, point), (few, taken))
    )
    assert own_q == pytest.approx(q[:6], rel=1e-12)
    assert own_v == pytest.approx(v[:6], rel=1e-12)


def test_a_free_bar_with_a_heavy_end_drifts_at_the_speed_that_drag_allows() -> None:
    # the middle of mass does not move as the middle of drag: force over C L alone, in the long run
    bar = Problem.model_validate(
        {
            "beam": {"length": 1.0, "bending_stiffness": 1e3, "mass_per_length": 1.0},
            "masses": [{"x": 1.0, "mass": 3.0}],
            "stops": [],
            "supports": [],
            "damping": {"kind": "viscous", "coefficient": 8.0},
            "point_loads": [{"kind": "step", "x": 0.5, "force": 2.0}],
        }
    )
    motion = Solver(n_modes=6).simulate(bar, 60.0, errors=False)
    assert motion.velocity(np.array([0.0, 0.5, 1.0]), 60.0).ravel() == pytest.approx(np.full(3, 2.0 / 8.0), rel=1e-9)


def test_what_coupling_drag_does_not_reach_is_refused() -> None:
    problem = random_dragged_joint(np.random.default_rng(0))
    with pytest.raises(InputError, match=r'damping\.kind = "viscous": branches need beams without masses'):
        _ = Solver(n_modes=3).period_map(problem).arcs
    assert math.isfinite(Solver(n_modes=3).period_map(problem).lowest_damping_rate)
    assert StepLoad in {type(load) for load in problem.point_loads}
