"""Steady states of both solvers: Newton's orbit, its symmetry and period, where it starts from, what is no orbit."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import BaseMotion, ModalDamping, Outcome, StepLoad, ViscousDamping, paper_joint

pytestmark = pytest.mark.long_march

SOLVERS: dict[str, AnySolver] = {"analytic": analytic.Solver(n_modes=12), "fe": fe_lapjoint.Solver(elements=6)}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)
thorough = pytest.mark.thorough


@pytest.mark.parametrize(
    ("solver", "omega", "periods"),
    [
        (analytic.Solver(n_modes=14), 515.0, 80),  # the largest multiplier is about 0.6: 0.6^80 is 1e-18
        (analytic.Solver(n_modes=14), 2000.0, 200),  # 0.88^200 is 1e-11
        pytest.param(fe_lapjoint.Solver(elements=8), 515.0, 80, marks=thorough),
    ],
)
def test_newtons_orbit_is_where_the_march_ends(solver: AnySolver, omega: float, periods: int) -> None:
    problem, period = paper_joint(angular_frequency=omega), 2 * math.pi / omega
    steady = solver.steady_state(problem)
    assert (steady.outcome, steady.period_multiple) == (Outcome.PERIODIC, 1)
    assert steady.stable
    assert steady.residual <= 1e-9
    history = solver.simulate(problem, (periods + 1) * period)
    x, t = np.linspace(0, 2.5, 6), np.linspace(0, period * (1 - 1e-9), 20)
    expected = steady.history.displacement(x, t)
    # Newton's tolerance
    assert history.displacement(x, t + periods * period) == pytest.approx(expected, abs=1e-8 * np.abs(expected).max())
    last = np.zeros(4)
    for contact in history.contacts:  # contacts that straddle the end of the last cycle count where they begin
        if (periods - 0.5) * period <= contact.start < (periods + 0.5) * period:
            last[contact.stop] += contact.impulse
    np.testing.assert_allclose(steady.impulses, last, rtol=1e-7)


@pytest.mark.parametrize("solver", [analytic.Solver(), fe_lapjoint.Solver(elements=10)])
def test_small_excitation_touches_no_stop_and_gives_the_linear_response(solver: AnySolver) -> None:
    omega, problem = 100.0, paper_joint(angular_frequency=100.0, base_amplitude=1e-5, damping_ratio=0.08)
    steady = solver.steady_state(problem)
    assert (steady.outcome, steady.period_multiple) == (Outcome.NO_CONTACT, 1)
    assert not steady.impulses.any()
    assert steady.stable
    modes, x = solver.modes(problem, steady.history.states[0], 20), np.linspace(0, 2.5, 4001)
    shapes, w = modes.shapes(x), modes.angular_frequencies
    load = problem.beam.m * 1e-5 * omega**2 * np.trapezoid(shapes, x, axis=1)
    amplitude = (load / (w**2 - omega**2 + 2j * 0.08 * w * omega)) @ shapes[:, -1]
    t = np.linspace(0, 2 * math.pi / omega, 9)
    expected = (amplitude * np.exp(1j * omega * t)).imag
    # the trapezoidal rule
    assert steady.history.displacement(2.5, t)[0] == pytest.approx(expected, abs=1e-6 * abs(amplitude))


@pytest.mark.parametrize(
    ("solver", "omega", "ratio"),
    [(analytic.Solver(n_modes=14), 300.0, 0.01), (fe_lapjoint.Solver(elements=2), 240.0, 0.02)],
)
def test_a_motion_of_period_three_is_found_and_repeats_after_three(
    solver: AnySolver, omega: float, ratio: float
) -> None:
    period = 2 * math.pi / omega
    steady = solver.steady_state(paper_joint(angular_frequency=omega, damping_ratio=ratio))
    assert (steady.outcome, steady.period_multiple) == (Outcome.PERIODIC, 3)
    assert steady.stable
    assert steady.residual <= 1e-9
    assert steady.history.end == pytest.approx(3 * period)
    z = steady.history.displacement(2.5, np.array([0.0, 0.5, 1.0, 1.5, 2.0, 3.0]) * period * (1 - 1e-15))[0]
    size = np.max(np.abs(z))
    assert z[5] == pytest.approx(z[0], abs=1e-8 * size)
    assert np.ptp(z[[0, 2, 4]]) > 1e-3 * size  # it does not repeat after one
    if steady.symmetric:
        assert z[3] == pytest.approx(-z[0], abs=1e-8 * size)
        assert abs(z[1] + z[0]) > 1e-2 * size


@solvers
@pytest.mark.parametrize("omega", [515.0, 4500.0])
def test_motions_that_half_a_period_mirrors_are_symmetric(solver: AnySolver, omega: float) -> None:
    steady = solver.steady_state(paper_joint(angular_frequency=omega))
    assert steady.outcome is Outcome.PERIODIC
    assert steady.symmetric
    # The orbit repeats to 1e-9; its impulses are that much amplified by the stiff stops.
    scale = np.max(np.abs(steady.impulses))
    np.testing.assert_allclose(steady.impulses[2:], -steady.impulses[:2], atol=1e-6 * scale)
    half = steady.history.end / 2
    tip = steady.history.displacement(2.5, [0.1 * half, 1.1 * half])[0]
    assert tip[0] == pytest.approx(-tip[1], rel=1e-6)


@solvers
def test_other_motions_are_not_called_symmetric(solver: AnySolver) -> None:
    joint = paper_joint(angular_frequency=515.0)
    uneven = joint.replace(stops=(joint.stops[0].model_copy(update={"gap": 2e-3}), *joint.stops[1:]))
    steady = solver.steady_state(uneven)
    assert steady.outcome is Outcome.PERIODIC
    assert not steady.symmetric
    assert abs(steady.impulses[0] + steady.impulses[2]) > 1e-4 * abs(steady.impulses[0])
    # what touches no stop is symmetric whatever the gaps, unless a constant force holds it aside
    gentle = uneven.replace(base_motion=BaseMotion(amplitude=1e-5, angular_frequency=515.0))
    assert solver.steady_state(gentle).symmetric
    assert not solver.steady_state(gentle.replace(point_loads=(StepLoad(x=2.5, force=1.0),))).symmetric


@thorough
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


@solvers
def test_a_neighbours_section_leads_to_the_same_orbit_as_rest(solver: AnySolver) -> None:
    start = solver.steady_state(paper_joint(angular_frequency=515.0)).section_point
    for problem in (
        paper_joint(angular_frequency=520.0),
        paper_joint(angular_frequency=515.0, gap=1.2e-3, k_star=1000.0, damping_ratio=0.07),
    ):
        rest, near = solver.steady_state(problem), solver.steady_state(problem, start=start)
        assert near.outcome is rest.outcome is Outcome.PERIODIC
        assert near.impulses == pytest.approx(rest.impulses, rel=1e-7)
        again = solver.steady_state(problem, start=near.section_point)
        assert again.section_point.coordinates == pytest.approx(near.section_point.coordinates, rel=1e-6, abs=1e-12)


@pytest.mark.parametrize(
    ("coarse", "fine"),
    [
        (analytic.Solver(n_modes=8), analytic.Solver(n_modes=12)),
        (analytic.Solver(n_modes=16), analytic.Solver(n_modes=12)),
        (fe_lapjoint.Solver(elements=6), fe_lapjoint.Solver(elements=12)),
    ],
)
def test_a_section_point_of_another_resolution_leads_there_soon(coarse: AnySolver, fine: AnySolver) -> None:
    problem = paper_joint(angular_frequency=515.0)
    start = coarse.steady_state(problem).section_point
    with_it, without = (fine.steady_state(problem, start=s) for s in (start, None))
    assert with_it.impulses == pytest.approx(without.impulses, rel=1e-7)
    assert with_it.acceptance is not None
    assert with_it.acceptance.periods <= 4


@pytest.mark.parametrize(
    ("solver", "omega", "damping"),
    [
        (analytic.Solver(n_modes=12), 1100.0, ViscousDamping(coefficient=100.0)),
        pytest.param(analytic.Solver(n_modes=12), 700.0, ModalDamping(ratio=0.002), marks=thorough),
        pytest.param(fe_lapjoint.Solver(elements=2), 380.0, ViscousDamping(coefficient=1500.0), marks=thorough),
        pytest.param(fe_lapjoint.Solver(elements=2), 380.0, ModalDamping(ratio=0.02), marks=pytest.mark.slow),
    ],
)
def test_chaos_is_certified_by_a_positive_exponent(solver: AnySolver, omega: float, damping: Any) -> None:
    steady = solver.steady_state(paper_joint(angular_frequency=omega).replace(damping=damping))
    assert steady.outcome is Outcome.APERIODIC
    assert steady.exponent is not None
    assert steady.exponent.positive
    assert steady.exponent.periods >= 400
    assert (steady.period_multiple, steady.symmetric, steady.multipliers.size) == (0, False, 0)
    assert steady.residual > 1e-3
    assert np.all(steady.impulses[:2] < 0)


@pytest.mark.parametrize(
    # The second stretch lasts for all periods allowed; 1700 tell the exponent 0 from the damping's -0.4 1/s.
    "solver",
    [analytic.Solver(n_modes=12), pytest.param(fe_lapjoint.Solver(elements=8, max_periods=2500), marks=thorough)],
)
def test_a_motion_that_circles_an_unstable_orbit_is_certified_quasiperiodic(solver: AnySolver) -> None:
    steady = solver.steady_state(paper_joint(angular_frequency=1100.0, damping_ratio=0.01))
    assert steady.outcome is Outcome.QUASIPERIODIC
    assert steady.exponent is not None
    assert steady.exponent.vanishes(rate=0.01 * 41.5)  # the damping of the first mode


@pytest.mark.parametrize(
    ("solver", "omega", "amplitude"),
    [
        (analytic.Solver(n_modes=6, max_periods=600), 515.0, 1e-5),
        (fe_lapjoint.Solver(elements=1, max_periods=24, max_period_multiple=2), 515.0, 1e-5),
        (fe_lapjoint.Solver(elements=1, max_periods=24, max_period_multiple=2), 3000.0, 1e-4),  # with contacts
    ],
)
def test_undamped_transients_never_settle_and_this_is_said(solver: AnySolver, omega: float, amplitude: float) -> None:
    steady = solver.steady_state(paper_joint(angular_frequency=omega, damping_ratio=0.0, base_amplitude=amplitude))
    assert (steady.period_multiple, steady.multipliers.size) == (0, 0)
    assert steady.exponent is not None
    assert steady.exponent.periods >= 400
    struck = bool(np.any(steady.impulses))  # means over all the periods: a single one may pass without a contact
    assert struck == (omega == 3000.0)
    if steady.outcome is not Outcome.UNDECIDED:
        assert steady.outcome is Outcome.APERIODIC
        assert steady.exponent.positive
    if not struck:
        assert steady.outcome is Outcome.UNDECIDED
        assert abs(steady.exponent.value) < 1.0  # 1/s: nearby motions stay near, to the rounding of the logarithms
