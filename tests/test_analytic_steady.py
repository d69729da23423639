"""Steady states of the analytic solver: Newton, brute force and finite differences agree; truncation converges."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from analytic.default_modes import default_count, truncation_error
from analytic.march import Joint, march
from analytic.start import initial_coordinates, initial_state
from analytic.steady import Section, monodromy
from lapjoint import FREE, Outcome, paper_joint


@pytest.mark.parametrize("omega", [515.0, 2000.0])
def test_newton_finds_the_orbit_that_marching_leads_to(omega: float) -> None:
    problem = paper_joint(angular_frequency=omega)
    steady = analytic.Solver(n_modes=14).steady_state(problem)
    assert steady.outcome is Outcome.PERIODIC
    assert steady.order == 1
    assert steady.stable
    period, cycles = 2 * math.pi / omega, 200
    marched = analytic.Solver(n_modes=14).simulate(problem, (cycles + 1) * period)
    last = np.zeros(4)
    for contact in marched.contacts:  # contacts that straddle the end of the last cycle count where they begin
        if cycles * period - 0.5 * period <= contact.start < cycles * period + 0.5 * period:
            last[contact.stop] += contact.impulse
    # 200 cycles leave 0.88^200 = 1e-11 of the transient at 2000 rad/s.
    np.testing.assert_allclose(steady.impulses, last, rtol=1e-7)


def test_monodromy_agrees_with_finite_differences_and_with_the_damping() -> None:
    problem, n = paper_joint(), 6
    joint, period = Joint(problem, {}, n), 2 * math.pi / 515.0
    q, v = initial_coordinates(problem, joint.state(FREE).model.modes)
    settled = march(joint, initial_state(problem), 0.0, q, v, 60 * period)
    start = Section(settled.state, settled.q, settled.v)
    motion = march(joint, start.state, 0.0, start.q, start.v, period)
    M = monodromy(joint, motion)
    difference = np.zeros_like(M)
    steps = np.concatenate([np.full(n, 1e-8), np.full(n, 1e-5)])
    for i, h in enumerate(steps):
        ends = []
        for sign in (1, -1):
            y = start.y
            y[i] += sign * h
            moved = start.moved(y)
            end = march(joint, moved.state, 0.0, moved.q, moved.v, period)
            ends.append(np.concatenate([end.q, end.v]))
        difference[:, i] = (ends[0] - ends[1]) / (2 * h)
    np.testing.assert_allclose(M, difference, atol=2e-5 * np.abs(M).max())
    # Within a state the flow shrinks volume by exp(-2 sum of zeta omega t).
    segment = motion.segments[0]
    from analytic.steady import flow_matrix

    model, duration = joint.state(segment.state).model, segment.end - segment.start
    assert np.linalg.slogdet(flow_matrix(model, duration))[1] == pytest.approx(
        -2 * model.decay.sum() * duration, rel=1e-9
    )


@pytest.mark.parametrize("omega", [515.0, 2950.0, 5000.0])
def test_the_criterion_predicts_the_effect_of_more_modes(omega: float) -> None:
    problem = paper_joint(angular_frequency=omega)
    reference = analytic.Solver(n_modes=56).steady_state(problem).impulses
    predicted = truncation_error(problem, 80)
    for n_modes in (14, 28):
        impulses = analytic.Solver(n_modes=n_modes).steady_state(problem).impulses
        change = np.max(np.abs(impulses / reference - 1))
        assert 0.03 * predicted[n_modes - 1] < change < 3 * predicted[n_modes - 1]


@pytest.mark.parametrize("omega", [515.0, 2950.0, 5000.0])
def test_the_default_number_of_modes_holds_its_tolerance(omega: float) -> None:
    problem = paper_joint(angular_frequency=omega)
    assert default_count(problem, 1e-5) < 40
    default = analytic.Solver().steady_state(problem).impulses
    many = analytic.Solver(n_modes=70).steady_state(problem).impulses
    np.testing.assert_allclose(default, many, rtol=3e-5)  # the criterion holds within a factor of 3


def test_a_gap_that_is_never_reached_gives_no_contact() -> None:
    steady = analytic.Solver().steady_state(paper_joint(gap=1.0))
    assert steady.outcome is Outcome.NO_CONTACT
    assert not steady.impulses.any()
    assert steady.stable


def test_longer_periods_are_found() -> None:
    # With a damping ratio of 0.01, the motion from rest at 300 rad/s settles to one of three excitation periods.
    problem = paper_joint(angular_frequency=300.0, damping_ratio=0.01)
    steady = analytic.Solver(n_modes=14).steady_state(problem)
    assert steady.order == 3
    assert steady.history.end == pytest.approx(3 * 2 * math.pi / 300.0)
    thirds = [steady.history.displacement(2.5, n * steady.history.end / 3)[0, 0] for n in range(3)]
    assert np.ptp(thirds) > 1e-3 * np.abs(thirds).max()  # it does not repeat after one


def test_numbers_of_modes_may_differ_between_free_and_contact_states() -> None:
    problem = paper_joint()
    mixed = analytic.Solver(free_modes=30, contact_modes=18).steady_state(problem)
    both = analytic.Solver(n_modes=30).steady_state(problem)
    np.testing.assert_allclose(mixed.impulses, both.impulses, rtol=2e-5)
