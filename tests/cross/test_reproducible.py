"""An answer does not depend on what its process has computed before: sweeps may be cut into any parts."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterable
from pathlib import Path

import numpy as np
import pytest
from alone import forget, restless_threads

import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep
from lapjoint.solver import Solver, make_solver

OMEGAS = (181.0, 515.0, 2060.0, 3300.0)  # they meet the contact states in different orders
SOLVERS = {
    "analytic": make_solver("analytic"),
    "as published": make_solver("analytic-published"),
    "finite elements": fe_lapjoint.Solver(elements=4),
}


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


@pytest.mark.long_march
@pytest.mark.parametrize(
    "solver", [pytest.param(it, marks=pytest.mark.thorough if it == "as published" else ()) for it in SOLVERS]
)
def test_a_point_of_a_sweep_has_the_same_bits_whatever_was_computed_before(solver: str) -> None:
    forwards = answers(SOLVERS[solver], OMEGAS)
    assert answers(SOLVERS[solver], OMEGAS[::-1]) == forwards
    assert answers(SOLVERS[solver], OMEGAS[1:2])[OMEGAS[1]] == forwards[OMEGAS[1]]


IN_ANOTHER_PROCESS = """
import hashlib, fe_lapjoint, analytic
from lapjoint import paper_joint

joint = paper_joint(angular_frequency=515.0)
for solver in (analytic.Solver(n_modes=60), fe_lapjoint.Solver()):
    steady = solver.steady_state(joint, errors=False)
    bits = steady.section_point.coordinates.tobytes() + steady.multipliers.tobytes() + steady.impulses.tobytes()
    contacts = solver.simulate(joint, duration=0.05, errors=False).contacts
    print(hashlib.sha256(bits + repr([(c.start, c.impulse) for c in contacts]).encode()).hexdigest())
"""


def bits(**settings: str) -> str:
    """Digests of the answers of another process."""
    command, environment = [sys.executable, "-c", IN_ANOTHER_PROCESS], os.environ | settings
    return subprocess.run(command, env=environment, capture_output=True, text=True, check=True).stdout


@pytest.mark.long_march
@pytest.mark.thorough
def test_the_number_of_threads_of_the_linear_algebra_changes_no_bit() -> None:
    assert bits(OPENBLAS_NUM_THREADS="1") == bits(OPENBLAS_NUM_THREADS="4")


@pytest.mark.thorough
def test_what_the_compiler_makes_of_a_function_changes_no_bit(tmp_path: Path) -> None:
    """All that this processor can do faster, or nothing, as for any processor; the linear algebra is the same.

    So `.ci/run` imitates other processors in the linear algebra alone.
    """
    as_written = bits(NUMBA_OPT="0", NUMBA_CPU_NAME="generic", NUMBA_CACHE_DIR=str(tmp_path), PYTHONWARNINGS="ignore")
    assert as_written == bits()


@pytest.mark.long_march
@pytest.mark.parametrize("solver", ["analytic", "fe"])
def test_workers_with_several_threads_find_the_same_bits_as_one(solver: str) -> None:
    """As the workers of a cluster may have; without chaos, so that a difference is one of threads alone."""
    axes = [Axis(FREQUENCY, [float(omega) for omega in np.linspace(180.0, 3300.0, 6)])]
    options = {"elements": 40} if solver == "fe" else {}
    alone = sweep(paper_joint(), axes, solver=solver, options=options)
    forget()
    with restless_threads(4, interval=1e-5) as threads:
        together = sweep(paper_joint(), axes, solver=solver, options=options, workers=threads.map)
    assert together.identical(alone)
