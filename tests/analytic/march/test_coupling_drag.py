"""Viscous damping that couples the modes, in the analytic solver: flows, motions, deviations and certificates."""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest
from random_joints import dragged_cantilever

from analytic.march import Joint
from analytic.march.coupled import oscillators
from analytic.solver import Solver
from lapjoint.answers.contact_state import FREE
from lapjoint.problem import BaseMotion, Mass, NoDamping, Problem, ViscousDamping
from tests.analytic.march.test_coupled import error_of_flow


def oscillators_flow(problem: Problem, count: int, t: float) -> float:
    """Error of the flow of the joint without contact over `t` seconds against scipy's expm."""
    joint = Joint(problem, count, count)
    it, omega = joint.coupled(FREE), joint.modal(FREE).modes.omega
    assert it is not None
    return error_of_flow((it.roots, it.to, it.back), it.D, np.diag(omega**2), omega, t)


@pytest.mark.parametrize("seed", range(8))
def test_modes_flow_as_the_matrix_exponential(seed: int) -> None:
    rng = np.random.default_rng(seed)
    problem = dragged_cantilever(rng)
    assert oscillators_flow(problem, int(rng.integers(3, 12)), 10 ** rng.uniform(-2, 0)) < 1e-9


@cache
def critical() -> tuple[Problem, float]:
    """A joint, and the viscous coefficient at which one of five complex modes becomes critical, by halving, N s/m2."""
    problem, count = dragged_cantilever(np.random.default_rng(3)), 5
    joint = Joint(problem.replace(damping=ViscousDamping(coefficient=1.0)), count, count)
    omega, it = joint.modal(FREE).modes.omega, joint.coupled(FREE)
    assert it is not None

    def all_oscillate(C: float) -> bool:
        roots = oscillators(C * it.D, np.diag(omega**2), omega)[0]
        return bool((roots.imag[:, 0] > 0).all())

    low, high = 0.1, 100.0
    assert all_oscillate(low)
    assert not all_oscillate(high)
    while low < (low + high) / 2 < high:
        low, high = ((low + high) / 2, high) if all_oscillate((low + high) / 2) else (low, (low + high) / 2)
    return problem, high


@pytest.mark.parametrize("apart", [0.0, 1e-15, -1e-15, 1e-12, -1e-12, 1e-9, 1e-6, -1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    problem, C = critical()
    assert oscillators_flow(problem.replace(damping=ViscousDamping(coefficient=C * (1 + apart))), 5, 0.5) < 1e-9


@pytest.mark.parametrize("mass", [1e-12, 1e-9, 1e-6])
def test_a_mass_that_vanishes_leaves_the_uncoupled_motion(mass: float) -> None:
    problem = dragged_cantilever(np.random.default_rng(1)).replace(
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
    problem = dragged_cantilever(np.random.default_rng(4))
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


def test_the_lowest_damping_rate_is_that_of_the_slowest_complex_mode() -> None:
    problem = dragged_cantilever(np.random.default_rng(0)).replace(damping=ViscousDamping(coefficient=0.2))
    solver, joint = Solver(n_modes=8), Joint(dragged_cantilever(np.random.default_rng(0)), 8, 8)
    omega, it = joint.modal(FREE).modes.omega, Joint(problem, 8, 8).coupled(FREE)
    assert it is not None
    roots = np.linalg.eigvals(np.block([[np.zeros((8, 8)), np.eye(8)], [-np.diag(omega**2), -it.D]]))
    assert (roots.imag != 0).all()
    assert solver.period_map(problem).lowest_damping_rate == pytest.approx(float(-roots.real.max()), rel=1e-9)


def test_undamped_modes_keep_away_from_a_load_of_their_frequency() -> None:
    problem = dragged_cantilever(np.random.default_rng(2)).replace(stops=())
    omega = float(Solver().modes(problem, count=1).angular_frequencies[0])
    problem = problem.replace(base_motion=BaseMotion(amplitude=0.01, angular_frequency=omega))
    dampings = (NoDamping(), ViscousDamping(coefficient=1e-30), ViscousDamping(coefficient=1e-13))
    z = [
        Solver(n_modes=8).simulate(problem.replace(damping=it), 20.0, errors=False).displacement(1.0, 19.7).item()
        for it in dampings
    ]
    assert z[1] == pytest.approx(z[0], rel=1e-6)
    assert z[2] == pytest.approx(z[0], rel=1e-6)
