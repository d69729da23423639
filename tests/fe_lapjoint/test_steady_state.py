"""Periodic motions of the finite element model: Newton's orbit, its multipliers, and what is not an orbit."""

from __future__ import annotations

import math

import numpy as np
import pytest

import fe_lapjoint
from lapjoint import (
    BaseMotion,
    ModalDamping,
    Outcome,
    StepLoad,
    ViscousDamping,
    paper_joint,
)

pytestmark = pytest.mark.long_march


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
    assert steady.period_multiple == 1
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


@pytest.mark.parametrize(("omega", "amplitude"), [(515.0, 1e-5), (3000.0, 1e-4)])  # without contact, and with
def test_undamped_transients_never_settle_and_this_is_said(omega: float, amplitude: float) -> None:
    problem = paper_joint(angular_frequency=omega, damping_ratio=0.0, base_amplitude=amplitude)
    steady = fe_lapjoint.Solver(elements=1, max_periods=24, max_period_multiple=2).steady_state(problem)
    assert steady.outcome in (Outcome.UNDECIDED, Outcome.APERIODIC)
    assert (steady.period_multiple, steady.multipliers.size) == (0, 0)
    assert steady.exponent is not None
    assert steady.exponent.periods >= 400
    assert steady.exponent.positive or steady.outcome is Outcome.UNDECIDED
    assert bool(steady.history.contacts) == (omega == 3000.0)
    if not steady.history.contacts:
        assert steady.outcome is Outcome.UNDECIDED


@pytest.mark.parametrize(
    "damping", [pytest.param(ModalDamping(ratio=0.02), marks=pytest.mark.thorough), ViscousDamping(coefficient=1500.0)]
)
def test_chaos_is_certified_by_a_positive_exponent(damping: ModalDamping | ViscousDamping) -> None:
    problem = paper_joint(angular_frequency=380.0).replace(damping=damping)
    steady = fe_lapjoint.Solver(elements=2).steady_state(problem)
    assert steady.outcome is Outcome.APERIODIC
    assert steady.exponent is not None
    assert steady.exponent.positive
    assert steady.exponent.periods >= 400
    assert (steady.period_multiple, steady.symmetric, steady.multipliers.size) == (0, False, 0)
    assert steady.residual > 1e-3
    assert np.all(steady.impulses[:2] < 0)


def test_a_motion_of_period_three_is_found_and_repeats_after_three() -> None:
    period = 2 * math.pi / 240.0
    steady = fe_lapjoint.Solver(elements=2).steady_state(paper_joint(angular_frequency=240.0, damping_ratio=0.02))
    assert (steady.outcome, steady.period_multiple, steady.symmetric) == (Outcome.PERIODIC, 3, True)
    assert steady.stable
    assert steady.history.end == pytest.approx(3 * period)
    assert steady.residual <= 1e-9
    z = steady.history.displacement(2.5, np.array([0.0, 0.5, 1.0, 1.5, 3.0]) * period * (1 - 1e-15))[0]
    size = np.max(np.abs(z))
    assert z[3] == pytest.approx(-z[0], abs=1e-8 * size)
    assert z[4] == pytest.approx(z[0], abs=1e-8 * size)
    assert abs(z[2] - z[0]) > 1e-2 * size
    assert abs(z[1] + z[0]) > 1e-2 * size


def test_only_motions_that_half_a_period_mirrors_are_called_symmetric() -> None:
    joint, solver = paper_joint(angular_frequency=515.0), fe_lapjoint.Solver(elements=4)
    uneven = joint.replace(stops=(joint.stops[0].model_copy(update={"gap": 2e-3}), *joint.stops[1:]))
    assert solver.steady_state(joint).symmetric
    steady = solver.steady_state(uneven)
    assert steady.outcome is Outcome.PERIODIC
    assert not steady.symmetric
    assert abs(steady.impulses[0] + steady.impulses[2]) > 1e-4 * abs(steady.impulses[0])
    # what touches no stop is symmetric whatever the gaps, unless a constant force holds it aside
    gentle = uneven.replace(base_motion=BaseMotion(amplitude=1e-5, angular_frequency=515.0))
    assert solver.steady_state(gentle).symmetric
    assert not solver.steady_state(gentle.replace(point_loads=(StepLoad(x=2.5, force=1.0),))).symmetric


@pytest.mark.thorough
def test_of_two_orbits_that_mirror_each_other_the_one_marched_to_is_found() -> None:
    """They lie so near each other, 0.4 %, that the march is long undecided between them."""
    solver, period = fe_lapjoint.Solver(elements=4), 2 * math.pi / 1100.0
    problem = paper_joint(angular_frequency=1100.0, damping_ratio=0.02)
    steady = solver.steady_state(problem)
    assert (steady.outcome, steady.period_multiple, steady.symmetric) == (Outcome.PERIODIC, 1, False)
    assert steady.stable
    marched = solver.simulate(problem, 250 * period).displacement(2.5, np.linspace(249, 249.999, 40) * period)[0]
    z = steady.history.displacement(2.5, np.linspace(0, 0.999, 40) * period)[0]
    twin = -steady.history.displacement(2.5, (np.linspace(0, 0.999, 40) + 0.5) % 1.0 * period)[0]
    assert np.linalg.norm(marched - z) < 0.25 * np.linalg.norm(marched - twin)


def test_a_neighbours_section_leads_to_the_same_orbit_as_rest() -> None:
    solver = fe_lapjoint.Solver(elements=6)
    start = solver.steady_state(paper_joint(angular_frequency=515.0)).section_point
    for problem in (
        paper_joint(angular_frequency=520.0),
        paper_joint(angular_frequency=515.0, gap=1.2e-3, k_star=1000.0, damping_ratio=0.07),
    ):
        rest, near = solver.steady_state(problem), solver.steady_state(problem, start=start)
        assert near.outcome is rest.outcome is Outcome.PERIODIC
        assert near.impulses == pytest.approx(rest.impulses, rel=1e-8)
        again = solver.steady_state(problem, start=near.section_point)
        assert again.section_point.coordinates == pytest.approx(near.section_point.coordinates, rel=1e-6, abs=1e-12)


def test_a_section_point_of_another_mesh_is_interpolated() -> None:
    problem = paper_joint(angular_frequency=515.0)
    coarse = fe_lapjoint.Solver(elements=6).steady_state(problem)
    with_it, without = (
        fe_lapjoint.Solver(elements=12).steady_state(problem, start=s) for s in (coarse.section_point, None)
    )
    assert with_it.impulses == pytest.approx(without.impulses, rel=1e-8)
    assert with_it.acceptance is not None
    assert with_it.acceptance.periods <= 4


@pytest.mark.thorough
def test_a_motion_that_circles_an_unstable_orbit_is_certified_quasiperiodic() -> None:
    problem = paper_joint(angular_frequency=1100.0, damping_ratio=0.01)
    # The second stretch lasts for all periods allowed; 1700 tell the exponent 0 from the damping's -0.4 1/s.
    steady = fe_lapjoint.Solver(elements=8, max_periods=2500).steady_state(problem)
    assert steady.outcome is Outcome.QUASIPERIODIC
    assert steady.exponent is not None
    assert steady.exponent.vanishes(rate=0.01 * 41.5)  # the damping of the first mode
