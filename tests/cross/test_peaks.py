"""The peak force of a contact is its largest force, not the largest of samples."""

from __future__ import annotations

import math

import numpy as np
import pytest
from few_and_many import few_and_many
from population import joint, stiff_joint
from refining import AnySolver

import analytic
import fe_lapjoint
from lapjoint import History, paper_joint

SOLVERS: dict[str, AnySolver] = {"analytic": analytic.Solver(n_modes=16), "fe": fe_lapjoint.Solver(elements=10)}
solvers = pytest.mark.parametrize("solver", SOLVERS.values(), ids=SOLVERS)


def check_peaks(history: History) -> int:
    """Compare each contact's peak with dense samples of its force; gives how many contacts there were."""
    for contact in history.contacts:
        stop = history.problem.stops[contact.stop]
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


@solvers
@pytest.mark.parametrize("drawn", few_and_many([(7, i) for i in range(6)], [(8, i) for i in range(60)]))
def test_peaks_of_random_contacts_agree_with_dense_samples(solver: AnySolver, drawn: list[tuple[int, int]]) -> None:
    contacts = 0
    for one in drawn:
        for problem, periods in ((stiff_joint(*one), 0.7), (joint(*one), 1.5)):
            contacts += check_peaks(solver.simulate(problem, periods * problem.require_excitation_period("test")))
    assert contacts > len(drawn)


@solvers
def test_a_contact_has_several_maxima_and_the_largest_counts(solver: AnySolver) -> None:
    """Long contacts at 60 rad/s, in which higher modes ring."""
    assert check_peaks(solver.simulate(paper_joint(angular_frequency=60.0), 4 * math.pi / 60.0))


@solvers
def test_a_contact_cut_by_a_section_has_the_peak_of_both_parts(solver: AnySolver) -> None:
    joint = paper_joint(angular_frequency=820.0)
    assert check_peaks(solver.period_map(joint).history(solver.steady_state(joint).section_point, 3))
