"""The scheme as published: it converges to the certified solver; with its few modes it gives the paper's findings."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from analytic.march.field import ModalField, TimesInState
from analytic.published.field import PublishedField
from analytic.published.loss import frozen_part
from lapjoint import FREE, ContactState, History, Outcome, ViscousDamping, paper_joint
from lapjoint.problem.presets import PAPER_DENSITY, TABLE_4_DENSITY
from lapjoint.solver import Solver

pytestmark = pytest.mark.long_march

PERIOD = 2 * math.pi / 515.0


def first_contacts(history: History, count: int) -> np.ndarray:
    return np.array([(c.stop, c.start, c.end, c.impulse) for c in history.contacts[:count]])


def test_is_a_solver() -> None:
    scheme = analytic.PublishedScheme()
    assert isinstance(scheme, Solver)
    assert scheme.name == "analytic as published (free modes 8, contact modes 5)"
    assert scheme.refined(2.0) == analytic.PublishedScheme(16, 10)
    assert scheme.modes(paper_joint(), FREE, 3).angular_frequencies.size == 3


@pytest.mark.parametrize("omega", [515.0, 2060.0])
def test_with_many_modes_it_is_the_certified_solver(omega: float) -> None:
    problem, duration = paper_joint(angular_frequency=omega), 4 * 2 * math.pi / omega
    published = analytic.PublishedScheme(40, 40).simulate(problem, duration)
    certified = analytic.Solver(n_modes=40).simulate(problem, duration)
    one, other = first_contacts(published, 6), first_contacts(certified, 6)
    np.testing.assert_array_equal(one[:, 0], other[:, 0])
    np.testing.assert_allclose(one, other, rtol=1e-3)
    x, t = np.linspace(0.1, 2.5, 9), np.linspace(0, duration, 50)
    z = certified.displacement(x, t)
    np.testing.assert_allclose(published.displacement(x, t), z, atol=1e-3 * np.abs(z).max())


def test_the_error_falls_with_the_number_of_modes() -> None:
    problem = paper_joint()
    exact = analytic.Solver(n_modes=60).simulate(problem, 2 * PERIOD).contacts[0].impulse
    errors = [
        abs(analytic.PublishedScheme(n, n).simulate(problem, 2 * PERIOD).contacts[0].impulse / exact - 1)
        for n in (8, 16, 32)
    ]
    assert errors[0] > 5 * errors[1] > 25 * errors[2]


def test_without_a_switch_it_is_the_certified_solver_without_its_residual() -> None:
    problem = paper_joint(base_amplitude=1e-5)
    published = analytic.PublishedScheme(8, 5).simulate(problem, 3 * PERIOD)
    certified = analytic.Solver(free_modes=8, contact_modes=5).simulate(problem, 3 * PERIOD)
    assert not published.contacts
    field = certified.field
    assert isinstance(field, ModalField)
    x, t = np.linspace(0, 2.5, 7), np.linspace(0, 3 * PERIOD, 40)
    every, none = np.arange(t.size), np.zeros(t.size, dtype=np.int64)
    part = TimesInState(FREE, every, none, np.zeros((8, t.size)), np.zeros((0, t.size)))
    for dx, dt in ((0, 0), (2, 0), (0, 1)):
        expected = certified.evaluate(x, t, dx, dt) - field.rest(part, x, t, dx, dt)
        np.testing.assert_allclose(published.evaluate(x, t, dx, dt), expected, atol=1e-9 * np.abs(expected).max())
    assert field.joint.state_in(int(field.log.slot[0])) == FREE


def test_displacement_is_continuous_and_velocity_is_projected() -> None:
    history = analytic.PublishedScheme().simulate(paper_joint(), 3 * PERIOD)
    x = np.linspace(0.05, 2.5, 30)
    T = history.switch_times[5]
    just = 1e-9 * PERIOD
    z = history.displacement(x, np.array([T - just, T]))
    np.testing.assert_allclose(z[:, 0], z[:, 1], atol=1e-8)
    assert isinstance(history.field, PublishedField)
    log, joint = history.field.motion.log, history.field.motion.joint
    S = joint.cross[log.slot[6], log.slot[5]]  # type: ignore[attr-defined]
    np.testing.assert_allclose(log.v[6], S @ log.v_end[5], rtol=1e-12)
    lost = frozen_part(history)
    assert np.all(lost.kinetic > -1e-12)
    assert np.all(np.diff(lost.kinetic_lost) >= -1e-9)


def test_a_stop_closes_and_opens_at_its_gap() -> None:
    problem = paper_joint()
    history = analytic.PublishedScheme().simulate(problem, 6 * PERIOD)
    for contact in history.contacts:
        stop = problem.stops[contact.stop]
        if not contact.open_end:
            z = history.displacement(stop.x, np.array([contact.start, contact.end]))[0]
            np.testing.assert_allclose(stop.sign * z, stop.gap, atol=1e-10)


def test_the_force_of_the_deflected_shape_is_that_of_equation_30() -> None:
    """-EI integral of Phi_i G'''' = -omega_i^2 (Phi_i, G) + forces of the gaps of the closed stops."""
    history = analytic.PublishedScheme().simulate(paper_joint(), 6 * PERIOD)
    assert isinstance(history.field, PublishedField)
    motion = history.field.motion
    joint, log = motion.joint, motion.log
    for segment in (3, 11, 20):
        slot = int(log.slot[segment])
        modal, G = joint.modal(joint.state_in(slot)), motion.rest[segment].copy()
        G[slot] += log.q[segment]
        published = np.zeros(modal.size)
        for other in range(len(joint.states)):
            omega = joint.modal(joint.state_in(other)).modes.omega
            S = joint.cross[slot, other, : modal.size, : omega.size]  # type: ignore[attr-defined]
            published -= S @ (omega**2 * G[other, : omega.size])
        expected = modal.force[0] - modal.modes.omega**2 * log.q[segment, : modal.size]
        np.testing.assert_allclose(published, expected, atol=1e-8 * np.abs(expected).max())


def test_what_is_left_behind_shrinks_with_more_modes() -> None:
    def left(*modes: int) -> float:
        return float(frozen_part(analytic.PublishedScheme(*modes).simulate(paper_joint(), 6 * PERIOD)).energy.max())

    assert left(8, 5) > 20 * left(24, 24)
    with pytest.raises(TypeError, match="PublishedScheme"):
        frozen_part(analytic.Solver(n_modes=5).simulate(paper_joint(), PERIOD))


@pytest.mark.parametrize("density", [PAPER_DENSITY, pytest.param(TABLE_4_DENSITY, marks=pytest.mark.thorough)])
def test_the_three_peaks_of_figure_4(density: float) -> None:
    scheme = analytic.PublishedScheme()

    def tip(omega: float) -> float:
        found = scheme.steady_state(paper_joint(angular_frequency=omega, density=density))
        assert found.outcome is Outcome.PERIODIC
        return float(np.abs(found.impulses[[0, 2]]).mean())

    first, second, third = (tip(omega) for omega in (515.0, 820.0, 2950.0))
    assert first == pytest.approx(1.53e4, rel=0.01)  # the axis of Figure 4 ends at 1.5e4 N s
    assert second / first == pytest.approx(0.5, abs=0.02)
    assert third / second == pytest.approx(1.5, abs=0.06)
    for omega, peak in ((500.0, first), (530.0, first), (780.0, second), (860.0, second), (2800.0, third)):
        assert tip(omega) < peak


def test_one_side_of_the_tip_falls_silent_near_2060_as_published_only() -> None:
    problem = paper_joint(angular_frequency=2060.0)
    published = analytic.PublishedScheme().steady_state(problem)
    assert published.impulses[0] == 0.0
    assert published.impulses[2] > 3e4
    assert not published.symmetric
    certified = analytic.Solver().steady_state(problem)
    assert certified.symmetric
    assert certified.impulses[2] == pytest.approx(-certified.impulses[0])
    assert certified.impulses[2] < 6e3


def test_a_motion_that_does_not_settle_is_undecided_with_mean_impulses() -> None:
    scheme = analytic.PublishedScheme(tolerance=1e-9, patience=100)
    found = scheme.steady_state(paper_joint())
    assert found.outcome is Outcome.UNDECIDED
    assert found.period_multiple == 0
    settled = analytic.PublishedScheme().steady_state(paper_joint())
    assert settled.outcome is Outcome.PERIODIC
    assert settled.period_multiple == 1
    assert settled.multipliers.size == 0
    np.testing.assert_allclose(found.impulses, settled.impulses, rtol=5e-3)


def test_a_section_starts_the_motion_again_with_its_frozen_shape() -> None:
    scheme, problem = analytic.PublishedScheme(), paper_joint(angular_frequency=820.0)
    first = scheme.steady_state(problem)
    again = scheme.steady_state(problem, start=first.section_point)
    np.testing.assert_allclose(again.impulses, first.impulses, rtol=5e-3)  # it creeps on
    assert first.history.field(np.array([2.5]), np.array([0.0])) == pytest.approx(
        first.history.field(np.array([2.5]), np.array([first.history.end])), rel=1e-3
    )
    wider = scheme.steady_state(problem.replace(stops=paper_joint(gap=2e-3).stops), start=first.section_point)
    assert wider.outcome is Outcome.PERIODIC


def test_quiet_and_viscous_joints() -> None:
    scheme = analytic.PublishedScheme()
    quiet = scheme.steady_state(paper_joint(base_amplitude=1e-6))
    assert quiet.outcome is Outcome.NO_CONTACT
    np.testing.assert_array_equal(quiet.impulses, 0.0)
    viscous = paper_joint().replace(damping=ViscousDamping(coefficient=2000.0))
    history = scheme.simulate(viscous, 2 * PERIOD)
    assert ContactState((2, 3)) in history.states


def test_the_frozen_shape_grows_where_the_published_curve_is_an_artefact() -> None:
    def share(omega: float, cycles: int) -> float:
        period = 2 * math.pi / omega
        history = analytic.PublishedScheme().simulate(paper_joint(angular_frequency=omega), cycles * period)
        left = frozen_part(history)
        return float(left.displacement[left.time > (cycles - 5) * period].mean())

    assert share(515.0, 300) < share(515.0, 50) < 3e-3
    assert share(1000.0, 300) > 1.5 * share(1000.0, 50) > 0.1
    assert share(2060.0, 600) > 10 * share(2060.0, 50) > 0.1


@pytest.mark.parametrize("omega", [1000.0, 2060.0, 2950.0])
def test_eight_modes_in_every_state_are_enough_to_lose_the_artefacts(omega: float) -> None:
    problem = paper_joint(angular_frequency=omega)
    found = analytic.PublishedScheme(8, 8).steady_state(problem).impulses
    np.testing.assert_allclose(found, analytic.Solver().steady_state(problem).impulses, rtol=0.03)


def test_the_curve_steps_just_below_1000() -> None:
    before, after = (
        analytic.PublishedScheme().steady_state(paper_joint(angular_frequency=omega)).impulses
        for omega in (998.0, 999.0)
    )
    assert before[2] == pytest.approx(-before[0], rel=0.01)
    assert abs(after[2] + after[0]) > 0.15 * after[2]


@pytest.mark.parametrize(("omega", "third"), [(1000.0, False), (2060.0, False), (2950.0, True)])
def test_the_frozen_shape_makes_the_asymmetry_and_five_modes_the_low_third_peak(omega: float, third: bool) -> None:
    problem = paper_joint(angular_frequency=omega)
    same_modes = analytic.Solver(free_modes=8, contact_modes=5).steady_state(problem)
    assert same_modes.symmetric
    if third:
        published = analytic.PublishedScheme().steady_state(problem)
        assert same_modes.impulses[2] == pytest.approx(published.impulses[2], rel=0.05)
        assert same_modes.impulses[2] < 0.6 * analytic.Solver().steady_state(problem).impulses[2]
