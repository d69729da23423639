"""An answer does not depend on what its process has computed before: sweeps may be cut into any parts."""

from __future__ import annotations

from collections.abc import Iterable

import pytest

import fe_lapjoint
from analytic.march import known_states, modal_state, tables
from analytic.modes.normal_modes import _exact_modes
from analytic.published import joint
from fe_lapjoint.modes.eigenmodes import _eigenmodes
from lapjoint import paper_joint
from lapjoint.solver import Solver, make_solver

OMEGAS = (181.0, 515.0, 2060.0, 3300.0)  # they meet the contact states in different orders
SOLVERS = {
    "analytic": make_solver("analytic"),
    "as published": make_solver("analytic-published"),
    "finite elements": fe_lapjoint.Solver(elements=4),
}


def forget() -> None:
    """What a fresh process does not know."""
    ours = (modal_state._family, modal_state._modal_state, modal_state.passage, modal_state._products)
    ours += (tables.flat_state, tables.unit_tables, known_states.memory_of, joint._products, _exact_modes)
    for known in (*ours, _eigenmodes):
        known.cache_clear()


def answers(solver: Solver, omegas: Iterable[float]) -> dict[float, list[object]]:
    """Every bit of the answers, computed one after the other in a process that knows nothing."""
    forget()
    found = {}
    for omega in omegas:
        steady = solver.steady_state(paper_joint(angular_frequency=omega))
        numbers = (steady.impulses, steady.multipliers, steady.section_point.coordinates)
        contacts = [(c.stop, c.start, c.end, c.impulse, c.peak_force) for c in steady.history.contacts]
        found[omega] = [
            steady.outcome,
            steady.period_multiple,
            steady.residual,
            *(n.tobytes() for n in numbers),
            *contacts,
        ]
    return found


@pytest.mark.parametrize("solver", SOLVERS)
def test_a_point_of_a_sweep_has_the_same_bits_whatever_was_computed_before(solver: str) -> None:
    forwards = answers(SOLVERS[solver], OMEGAS)
    assert answers(SOLVERS[solver], OMEGAS[::-1]) == forwards
    assert answers(SOLVERS[solver], OMEGAS[1:2])[OMEGAS[1]] == forwards[OMEGAS[1]]
