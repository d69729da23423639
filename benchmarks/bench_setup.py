"""The cost of what comes before a motion: modes, and passages from state to state, for many modes and many stops.

Nothing is kept from round to round, as in a fresh process.
"""

from __future__ import annotations

import math
from typing import Any

import pytest

import analytic
from analytic import mode_count
from analytic.march import modal_state, tables, unit_tables
from analytic.modes import normal_modes
from lapjoint import BaseMotion, Beam, ModalDamping, Problem, Stop, Support, paper_joint

_STOPS = tuple(
    Stop(x=0.2 + 0.8 * ((i + 1) / 12), side=("top", "bottom")[i % 2], gap=5e-4 * (1 + i % 3), stiffness=100.0)
    for i in range(12)
)
TWELVE_STOPS = Problem(
    beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
    supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
    stops=_STOPS,
    damping=ModalDamping(ratio=0.05),
    base_motion=BaseMotion(amplitude=1e-3, angular_frequency=7.0),
)
CASES = {
    "paper's joint, 15 modes": (analytic.Solver(n_modes=15), paper_joint(), 0.05),
    "paper's joint, 500 modes": (analytic.Solver(n_modes=500), paper_joint(), 0.05),
    "12 stops, modes by criterion": (analytic.Solver(), TWELVE_STOPS, 5.0),
}


def _forget() -> None:
    ours = (modal_state._loaded_structure, modal_state._modal_state, modal_state.passage, modal_state._products)
    ours = (*ours, tables.flat_state, unit_tables.unit_tables)
    for known in (*ours, normal_modes._exact_modes, mode_count._modal_sums):
        known.cache_clear()


@pytest.mark.parametrize("case", CASES)
@pytest.mark.benchmark(group="set-up and a short motion")
def bench_set_up(benchmark: Any, case: str) -> None:
    solver, problem, duration = CASES[case]
    solver.simulate(problem, duration, errors=False)  # compiles
    benchmark.pedantic(solver.simulate, (problem, duration), setup=_forget, rounds=3)
