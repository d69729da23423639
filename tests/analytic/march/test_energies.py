"""Energies lost in damped stops: the closed form against quadrature of the force law along the motion."""

from __future__ import annotations

import numpy as np
import pytest
from damped_stops import pinned_bar
from random_joints import damped_cantilever

from analytic.march import Joint, march
from analytic.march.contacts import contacts_of
from analytic.march.field import history_of
from analytic.march.initial_state import started
from lapjoint import Problem
from lapjoint.answers.dissipation import Span, energies_lost


def energies(problem: Problem, modes: int, end: float) -> tuple[np.ndarray, np.ndarray]:
    """The energy of each contact of a damped stop, J, in closed form and by quadrature, shape ``(C,)``."""
    joint = Joint(problem, modes, modes)
    log = march(joint, started(joint), 0.0, end, depth=True).log
    history, found = history_of("", joint, log), contacts_of(joint, log)
    closed, summed = [], []
    for k in (k for k, stop in enumerate(problem.stops) if stop.damping > 0):
        own = [it for it in found if it.stop == k]
        spans = [Span(it.start, it.end, it.open_start, it.open_end) for it in own]
        fastest = 4 * float(joint.tables.fastest.max())
        summed += energies_lost(history, k, spans, fastest) if own else []
        closed += [it.dissipated for it in own]
    return np.array(closed), np.array(summed)


@pytest.mark.parametrize("seed", [*range(3), *(pytest.param(seed, marks=pytest.mark.slow) for seed in range(3, 60))])
def test_energies_in_closed_form_are_those_of_the_force_law(seed: int) -> None:
    closed, summed = energies(damped_cantilever(np.random.default_rng(seed)), 8, 1.0)
    assert closed == pytest.approx(summed, rel=1e-9, abs=1e-9 * np.abs(summed).max(initial=0.0))


@pytest.mark.parametrize("off", [0.0, 1e-9, 1e-6, 1e-3])
def test_energies_near_a_double_root_are_right_or_not_a_number(off: float) -> None:
    (closed,), (summed,) = energies(pinned_bar(30.0 * (1 + off), force=0.0), 1, 8.0)
    assert np.isnan(closed) or closed == pytest.approx(summed, rel=1e-9)
    assert off < 1e-3 or not np.isnan(closed)
