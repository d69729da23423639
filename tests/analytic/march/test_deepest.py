"""The peak force of a contact is its largest force, not the largest of samples."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from lapjoint import Problem, paper_joint
from tests.helpers.population import joint, stiff_joint


def check_peaks(problem: Problem, modes: int, periods: float) -> int:
    """Compare each contact's peak with dense samples of its force; gives how many contacts there were."""
    assert problem.base_motion is not None
    history = analytic.Solver(n_modes=modes).simulate(
        problem, periods * 2 * math.pi / problem.base_motion.angular_frequency
    )
    for contact in history.contacts:
        stop = problem.stops[contact.stop]
        times, best = np.linspace(contact.start, contact.end, 2001), 0.0
        if not contact.open_end:
            times = times[:-1]  # the end is in the next state already
        for _ in range(4):  # closer and closer around the highest sample
            force = stop.stiffness * (stop.sign * np.ravel(history.displacement(stop.x, times)) - stop.gap)
            top = int(np.argmax(force))
            best = max(best, float(force[top]))
            times = np.linspace(times[max(top - 1, 0)], times[min(top + 1, times.size - 1)], 101)
        assert contact.peak_force == pytest.approx(best, rel=1e-9, abs=1e-12 * stop.stiffness * stop.gap)
    return len(history.contacts)


def test_peaks_of_random_contacts_agree_with_dense_samples() -> None:
    contacts = sum(check_peaks(stiff_joint(7, i), modes=20, periods=0.7) for i in range(6))
    contacts += sum(check_peaks(joint(7, i), modes=12, periods=1.5) for i in range(6))
    assert contacts


@pytest.mark.slow
def test_peaks_of_many_random_contacts_agree_with_dense_samples() -> None:
    assert sum(check_peaks(stiff_joint(8, i), modes=30, periods=1.5) for i in range(60))


def test_a_contact_has_several_maxima_and_the_largest_counts() -> None:
    """Long contacts at 60 rad/s, in which higher modes ring."""
    assert check_peaks(paper_joint(angular_frequency=60.0), modes=16, periods=2.0)
