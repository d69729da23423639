"""Steady states of the analytic solver: Newton, brute force and finite differences agree; truncation converges."""

from __future__ import annotations

import math
from dataclasses import replace

import numpy as np
import pytest

import analytic
from analytic.march import Coordinates, Joint, march, march_linearised
from analytic.march.initial_state import started
from analytic.mode_count import default_count, truncation_error
from lapjoint import ModalDamping, Outcome, ViscousDamping, paper_joint
from lapjoint.problem import FloatArray

pytestmark = pytest.mark.long_march


@pytest.mark.parametrize("omega", [515.0, 2000.0])
def test_newton_finds_the_orbit_that_marching_leads_to(omega: float) -> None:
    problem = paper_joint(angular_frequency=omega)
    steady = analytic.Solver(n_modes=14).steady_state(problem)
    assert steady.outcome is Outcome.PERIODIC
    assert steady.period_multiple == 1
    assert steady.stable
    period, cycles = 2 * math.pi / omega, 200
    marched = analytic.Solver(n_modes=14).simulate(problem, (cycles + 1) * period)
    last = np.zeros(4)
    for contact in marched.contacts:  # contacts that straddle the end of the last cycle count where they begin
        if cycles * period - 0.5 * period <= contact.start < cycles * period + 0.5 * period:
            last[contact.stop] += contact.impulse
    # 200 cycles leave 0.88^200 = 1e-11 of the transient at 2000 rad/s.
    np.testing.assert_allclose(steady.impulses, last, rtol=1e-7)


def settled(joint: Joint, period: float) -> Coordinates:
    return march(joint, started(joint), 0.0, 60 * period, record=False).end


def monodromy(joint: Joint, start: Coordinates, period: float) -> FloatArray:
    return march_linearised(joint, start, period, np.eye(start.y.size))[1]


DAMPINGS = {"modal": ModalDamping(ratio=0.08), "viscous": ViscousDamping(coefficient=2000.0)}


@pytest.mark.parametrize("damping", DAMPINGS)
def test_monodromy_agrees_with_finite_differences(damping: str) -> None:
    problem, n = paper_joint().replace(damping=DAMPINGS[damping]), 6
    joint, period = Joint(problem, n, n), 2 * math.pi / 515.0
    start = settled(joint, period)
    M = monodromy(joint, start, period)
    difference = np.zeros_like(M)
    steps = np.concatenate([np.full(n, 1e-8), np.full(n, 1e-5)])
    for i, h in enumerate(steps):
        ends = []
        for sign in (1, -1):
            y = start.y
            y[i] += sign * h
            ends.append(march(joint, start.moved(y), 0.0, period).end.y)
        difference[:, i] = (ends[0] - ends[1]) / (2 * h)
    np.testing.assert_allclose(M, difference, atol=2e-5 * np.abs(M).max())
    vector = np.random.default_rng(1).standard_normal((2 * n, 1))
    end, along = march_linearised(joint, start, period, vector)
    np.testing.assert_allclose(along, M @ vector, atol=1e-9 * np.abs(M @ vector).max())
    assert end.y.tobytes() == march(joint, start, 0.0, period).end.y.tobytes()


@pytest.mark.parametrize("damping", DAMPINGS)
def test_the_monodromy_shrinks_volume_by_the_damping_and_the_truncation(damping: str) -> None:
    problem = paper_joint().replace(damping=DAMPINGS[damping])
    joint, period = Joint(problem, 20, 20), 2 * math.pi / 515.0
    start = settled(joint, period)
    motion = march(joint, start, 0.0, period)
    expected = 0.0
    segments = motion.segments
    for now, after in zip(segments, (*segments[1:], None), strict=True):
        expected -= 2 * joint.modal(now.state).damping_rate.sum() * (now.end - now.start)
        if after is not None:
            # A saltation matrix has the determinant of the map itself times h' after over h' before, which is 1
            # but for the velocity that 20 modes lose: 1e-5 a switch.
            expected += 2 * np.linalg.slogdet(joint.passage(now.state, after.state).S)[1]
    assert np.linalg.slogdet(monodromy(joint, start, period))[1] == pytest.approx(expected, abs=2e-3)


@pytest.mark.parametrize("omega", [515.0, 2950.0, 5000.0])
def test_the_criterion_predicts_the_effect_of_more_modes(omega: float) -> None:
    problem = paper_joint(angular_frequency=omega)
    reference = analytic.Solver(n_modes=56).steady_state(problem).impulses
    predicted = truncation_error(problem, 80)
    for n_modes in (14, 28):
        impulses = analytic.Solver(n_modes=n_modes).steady_state(problem).impulses
        change = np.max(np.abs(impulses / reference - 1))
        assert 0.03 * predicted[n_modes - 1] < change < 3 * predicted[n_modes - 1]


@pytest.mark.parametrize(("omega", "modes"), [(515.0, 70), (750.0, 60), (2950.0, 70), (5000.0, 70)])
def test_the_default_number_of_modes_holds_its_tolerance(omega: float, modes: int) -> None:
    """With 60 modes at 750 rad/s a step of Newton's method leads to a state whose switches crowd within 1e-12 s."""
    problem = paper_joint(angular_frequency=omega)
    assert default_count(problem, 1e-5) < 40
    default = analytic.Solver().steady_state(problem).impulses
    many = analytic.Solver(n_modes=modes).steady_state(problem).impulses
    np.testing.assert_allclose(default, many, rtol=3e-5)  # the criterion holds within a factor of 3


@pytest.mark.parametrize(
    "omegas",
    [
        pytest.param(np.linspace(7.0, 4983.0, 12), id="12 frequencies"),
        pytest.param(np.arange(5.0, 5001.0, 5.0), id="1000 frequencies", marks=pytest.mark.slow),
    ],
)
def test_doubling_the_default_number_of_modes_changes_the_curve_by_less_than_a_thousandth(omegas: np.ndarray) -> None:
    curves = []
    for factor in (1, 2):
        curve = []
        for omega in omegas:
            problem = paper_joint(angular_frequency=float(omega))
            count = factor * max(analytic.Solver().mode_counts(problem))
            curve.append(analytic.Solver(n_modes=count).steady_state(problem).impulses)
        curves.append(np.array(curve))
    change = np.abs(curves[1] - curves[0]).max(axis=0)
    assert np.all(change < 1e-3 * np.abs(curves[1]).max(axis=0))


def test_a_gap_that_is_never_reached_gives_no_contact() -> None:
    steady = analytic.Solver().steady_state(paper_joint(gap=1.0))
    assert steady.outcome is Outcome.NO_CONTACT
    assert not steady.impulses.any()
    assert steady.stable


def test_longer_periods_are_found() -> None:
    # With a damping ratio of 0.01, the motion from rest at 300 rad/s settles to one of three excitation periods.
    problem = paper_joint(angular_frequency=300.0, damping_ratio=0.01)
    steady = analytic.Solver(n_modes=14).steady_state(problem)
    assert steady.period_multiple == 3
    assert steady.history.end == pytest.approx(3 * 2 * math.pi / 300.0)
    thirds = [steady.history.displacement(2.5, n * steady.history.end / 3)[0, 0] for n in range(3)]
    assert np.ptp(thirds) > 1e-3 * np.abs(thirds).max()  # it does not repeat after one


def test_symmetric_motions_are_told_from_others() -> None:
    problem = paper_joint()
    steady = analytic.Solver(n_modes=12).steady_state(problem)
    assert steady.symmetric
    half = steady.history.end / 2
    tip = steady.history.displacement(2.5, [0.1 * half, 1.1 * half])[0]
    assert tip[0] == pytest.approx(-tip[1], rel=1e-7)
    uneven = tuple(stop.model_copy(update={"gap": 3e-3}) if stop.side == "top" else stop for stop in problem.stops)
    lopsided = analytic.Solver(n_modes=12).steady_state(problem.replace(stops=uneven))
    assert lopsided.outcome is Outcome.PERIODIC
    assert not lopsided.symmetric


def test_a_section_of_a_neighbour_leads_to_the_same_motion() -> None:
    solver = analytic.Solver()
    near = solver.steady_state(paper_joint(angular_frequency=780.0))
    here = paper_joint(angular_frequency=820.0, gap=1.05e-3)
    start = replace(near.section_point, coordinates=near.section_point.coordinates[:, :12])
    np.testing.assert_allclose(
        solver.steady_state(here, start=start).impulses, solver.steady_state(here).impulses, rtol=1e-7
    )


LIGHT = {
    "modal": (700.0, ModalDamping(ratio=0.002)),
    "viscous": (1100.0, ViscousDamping(coefficient=100.0)),
}


@pytest.mark.parametrize("damping", ["viscous", pytest.param("modal", marks=pytest.mark.thorough)])
def test_lightly_damped_motions_are_certified_aperiodic(damping: str) -> None:
    omega, kind = LIGHT[damping]
    problem = paper_joint(angular_frequency=omega).replace(damping=kind)
    steady = analytic.Solver(n_modes=12).steady_state(problem)
    assert steady.outcome is Outcome.APERIODIC
    assert steady.period_multiple == 0
    assert steady.exponent is not None
    assert steady.exponent.positive
    assert steady.exponent.periods >= 500


def test_a_motion_that_circles_an_unstable_orbit_is_certified_quasiperiodic() -> None:
    steady = analytic.Solver(n_modes=12).steady_state(paper_joint(angular_frequency=1100.0, damping_ratio=0.01))
    assert steady.outcome is Outcome.QUASIPERIODIC
    assert steady.exponent is not None
    assert steady.exponent.vanishes(rate=0.01 * 41.5)  # the damping of the first mode


def test_a_linear_motion_without_damping_is_undecided() -> None:
    problem = paper_joint(gap=10.0, damping_ratio=0.0)
    steady = analytic.Solver(n_modes=6, max_periods=600).steady_state(problem)
    assert steady.outcome is Outcome.UNDECIDED
    assert steady.exponent is not None
    assert abs(steady.exponent.value) < 1.0  # 1/s: nearby motions stay near, to the rounding of the logarithms


def test_numbers_of_modes_may_differ_between_free_and_contact_states() -> None:
    problem = paper_joint()
    mixed = analytic.Solver(free_modes=30, contact_modes=18).steady_state(problem)
    both = analytic.Solver(n_modes=30).steady_state(problem)
    np.testing.assert_allclose(mixed.impulses, both.impulses, rtol=2e-5)


def test_with_the_most_modes_there_are_no_error_is_stated() -> None:
    found = analytic.Solver(n_modes=480).simulate(paper_joint(), 1e-3)
    assert "500 modes are the most" in found.error_source
    assert all(contact.impulse_error == math.inf for contact in found.contacts)
