"""Periodic motions of the finite element model: Newton's orbit, its multipliers, and what is not an orbit."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fe_lapjoint
from fe_lapjoint.assembly import Assembly
from fe_lapjoint.march import Model, march
from fe_lapjoint.mesh import mesh_nodes
from fe_lapjoint.tangent import monodromy
from lapjoint import InputError, Outcome, Problem, Support, paper_joint, sdnl104


def small_model(problem: Problem, elements: int) -> Model:
    return Model(problem, Assembly(problem, mesh_nodes(problem, elements, None)), "exact", 1e-9, 1e-12)


def test_newtons_orbit_is_where_the_march_ends() -> None:
    omega, problem = 515.0, paper_joint(angular_frequency=515.0)
    steady = fe_lapjoint.Solver(elements=8).steady_state(problem)
    assert steady.outcome is Outcome.PERIODIC
    assert steady.stable
    assert steady.residual <= 1e-9
    period = 2 * math.pi / omega
    periods = 80  # the largest multiplier is about 0.6: 0.6^80 is 1e-18
    history = fe_lapjoint.Solver(elements=8).simulate(problem, (periods + 1) * period)
    x = np.linspace(0, 2.5, 6)
    t = np.linspace(0, period * (1 - 1e-9), 20)
    size = np.max(np.abs(steady.history.displacement(x, t)))
    marched = history.displacement(x, t + periods * period)
    assert marched == pytest.approx(steady.history.displacement(x, t), abs=1e-8 * size)  # Newton's tolerance


def test_monodromy_agrees_with_finite_differences() -> None:
    omega, problem = 515.0, paper_joint(angular_frequency=515.0)
    orbit = fe_lapjoint.Solver(elements=8).steady_state(problem)
    model = small_model(problem, 8)
    state = orbit.history.states[0]
    system = model.system(state)
    nodal = np.array(
        [orbit.history.field(model.assembly.nodes, np.zeros(1), dx, dt)[:, 0] for dt in (0, 1) for dx in (0, 1)]
    )
    scaled = nodal * np.array([[1.0], [2.5], [1.0], [2.5]])  # degrees of freedom are (z, L z_x)
    mass, free = model.assembly.mass, model.assembly.free
    y = np.concatenate([system.vectors.T @ mass @ np.stack(scaled[i : i + 2], axis=1).ravel()[free] for i in (0, 2)])
    period = 2 * math.pi / omega
    M = monodromy(model, march(model, state, y, 0.0, period))
    for column in (0, 2, y.size // 2, y.size // 2 + 3):
        step = 1e-6 * np.linalg.norm(np.split(y, 2)[column // (y.size // 2)])
        d = np.zeros(y.size)
        d[column] = step
        plus, minus = (march(model, state, y + sign * d, 0.0, period).y for sign in (1, -1))
        difference = (plus - minus) / (2 * step)
        # Second order in the step, which moves event times; and rounding over it.
        assert M[:, column] == pytest.approx(difference, abs=1e-4 * np.max(np.abs(difference)))


@pytest.mark.parametrize("omega", [820.0, 4500.0])
def test_symmetric_joint_has_opposite_impulses_at_top_and_bottom(omega: float) -> None:
    steady = fe_lapjoint.Solver(elements=10).steady_state(paper_joint(angular_frequency=omega))
    assert steady.outcome is Outcome.PERIODIC
    tip_bottom, mid_bottom, tip_top, mid_top = steady.impulses
    scale = np.max(np.abs(steady.impulses))
    # The orbit repeats to 1e-9; its impulses are that much amplified by the stiff stops.
    assert tip_top == pytest.approx(-tip_bottom, abs=1e-6 * scale)
    assert mid_top == pytest.approx(-mid_bottom, abs=1e-6 * scale)


def test_small_excitation_touches_no_stop_and_gives_the_linear_response() -> None:
    omega, problem = 100.0, paper_joint(angular_frequency=100.0, base_amplitude=1e-5, damping_ratio=0.08)
    solver = fe_lapjoint.Solver(elements=10)
    steady = solver.steady_state(problem)
    assert steady.outcome is Outcome.NO_CONTACT
    assert steady.order == 1
    modes = solver.modes(problem, steady.history.states[0], 20)
    x = np.linspace(0, 2.5, 4001)
    shapes = modes.shapes(x)
    load = problem.beam.m * 1e-5 * omega**2 * np.trapezoid(shapes, x, axis=1)
    w = modes.angular_frequencies
    amplitude = (load / (w**2 - omega**2 + 2j * 0.08 * w * omega)) @ shapes[:, -1]
    t = np.linspace(0, 2 * math.pi / omega, 9)
    expected = (amplitude * np.exp(1j * omega * t)).imag
    z = steady.history.displacement(2.5, t)[0]
    assert z == pytest.approx(expected, abs=1e-6 * abs(amplitude))  # the trapezoidal rule


def test_a_problem_without_one_frequency_has_no_steady_state() -> None:
    with pytest.raises(InputError, match="frequency"):
        fe_lapjoint.Solver(elements=4).steady_state(sdnl104())


def test_undamped_transients_never_settle_and_this_is_said() -> None:
    problem = paper_joint(angular_frequency=515.0, damping_ratio=0.0)
    steady = fe_lapjoint.Solver(elements=2, max_periods=24, max_order=2).steady_state(problem)
    assert steady.outcome is Outcome.UNDECIDED
    assert steady.order == 0


def test_a_stop_on_a_fixed_point_is_never_touched() -> None:
    problem = paper_joint(angular_frequency=515.0)
    held = problem.replace(
        supports=(*problem.supports, Support(x=2.5, translational=math.inf), Support(x=1.25, translational=math.inf))
    )
    assert fe_lapjoint.Solver(elements=8).steady_state(held).outcome is Outcome.NO_CONTACT
