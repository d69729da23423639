"""The finite element march against methods of a library, and its continuity at switches."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import solve_ivp

import fe_lapjoint
from fe_lapjoint.march.system import build_system
from fe_lapjoint.modes.assembly import Assembly
from fe_lapjoint.modes.mesh import mesh_nodes
from lapjoint import (
    FREE,
    paper_joint,
)


def test_the_exact_propagator_agrees_with_a_library_method_of_tight_tolerance() -> None:
    problem = paper_joint()
    system = build_system(Assembly(problem, mesh_nodes(problem, 4, None)), FREE)
    y0 = np.concatenate([np.full(8, 1e-3), np.full(8, 0.1)])
    times = np.linspace(0, 0.02, 50)
    exact = solve_ivp(
        system.rates,
        (0, 0.02),
        y0,
        method=fe_lapjoint.ExactPropagator,
        system=system,
        dense_output=True,
        max_step=3e-3,
    )
    other = solve_ivp(system.rates, (0, 0.02), y0, method="DOP853", rtol=1e-11, atol=1e-14, t_eval=times)
    scale = np.max(np.abs(other.y), axis=1)
    # Fifty times the tolerance, for the error gathered over some hundred steps.
    assert np.all(np.abs(exact.sol(times) - other.y).max(axis=1) <= 1e-8 * scale + 1e-12)


@pytest.mark.parametrize(
    "method", [*(pytest.param(it, marks=pytest.mark.thorough) for it in ("Radau", "BDF")), "LSODA", "DOP853"]
)
def test_library_methods_give_the_same_contacts(method: str) -> None:
    problem = paper_joint()
    duration = 2 * math.pi / 515
    exact = fe_lapjoint.Solver(elements=2).simulate(problem, duration).contacts
    assert len(exact) > 3
    found = fe_lapjoint.Solver(elements=2, method=method, rtol=1e-8, atol=1e-11).simulate(problem, duration).contacts
    assert [c.stop for c in found] == [c.stop for c in exact]
    # Errors of 1e-8 a step grow over the steps and switches of the period, those of BDF most.
    assert [c.start for c in found] == pytest.approx([c.start for c in exact], rel=1e-5)
    largest = max(abs(c.impulse) for c in exact)
    assert [c.impulse for c in found] == pytest.approx([c.impulse for c in exact], abs=1e-4 * largest)


def test_displacement_and_velocity_are_continuous_and_gaps_vanish_at_switches() -> None:
    history = fe_lapjoint.Solver(elements=10).simulate(paper_joint(), 0.05)
    assert history.switch_times.size > 10
    x = np.linspace(0, 2.5, 7)
    before, after = history.switch_times - 1e-11, history.switch_times
    speed = np.max(np.abs(history.velocity(x, after)))
    assert history.displacement(x, before) == pytest.approx(history.displacement(x, after), abs=1e-10 * speed)
    jump = np.abs(history.velocity(x, before) - history.velocity(x, after))
    assert np.max(jump) < 1e-5 * speed  # acceleration over 1e-11 s
    for contact in history.contacts:
        stop = history.problem.stops[contact.stop]
        z = stop.sign * history.displacement(stop.x, contact.start)[0, 0]
        assert z - stop.gap == pytest.approx(0, abs=2.2e-11 * speed)  # events to 2.2e-11 s
