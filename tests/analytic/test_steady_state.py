"""Steady states of the analytic solver: its monodromy is that of differences, and truncation converges."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from analytic.march import Coordinates, Joint, march, march_linearised
from analytic.march.initial_state import started
from analytic.mode_count import default_count, truncation_error
from lapjoint import ModalDamping, SineLoad, Support, ViscousDamping, paper_joint
from lapjoint.problem import FloatArray

pytestmark = pytest.mark.long_march


def settled(joint: Joint, period: float) -> Coordinates:
    return march(joint, started(joint), 0.0, 60 * period, record=False).end


def monodromy(joint: Joint, start: Coordinates, period: float) -> FloatArray:
    return march_linearised(joint, start, period, np.eye(start.y.size))[1]


DAMPINGS = {"modal": ModalDamping(ratio=0.08), "viscous": ViscousDamping(coefficient=2000.0)}


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


def test_numbers_of_modes_may_differ_between_free_and_contact_states() -> None:
    problem = paper_joint()
    mixed = analytic.Solver(free_modes=30, contact_modes=18).steady_state(problem)
    both = analytic.Solver(n_modes=30).steady_state(problem)
    np.testing.assert_allclose(mixed.impulses, both.impulses, rtol=2e-5)


def test_with_the_most_modes_there_are_no_error_is_stated() -> None:
    found = analytic.Solver(n_modes=480).simulate(paper_joint(), 1e-3)
    assert "500 modes are the most" in found.error_source
    assert all(contact.impulse_error == math.inf for contact in found.contacts)


def test_a_force_on_a_fixed_point_moves_nothing() -> None:
    held = paper_joint().replace(
        base_motion=None, supports=(*paper_joint().supports, Support(x=2.5, translational=math.inf))
    )
    pushed = held.replace(point_loads=(SineLoad(x=2.5, force=1e5, angular_frequency=500.0),))
    history = analytic.Solver(n_modes=10).simulate(pushed, 0.05, errors=False)
    assert not history.displacement(np.linspace(0, 2.5, 9), np.linspace(0, 0.05, 50)).any()
