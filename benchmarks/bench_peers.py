"""What a user would pick instead: a plain `solve_ivp` script, or OpenSeesPy (if it is installed).

One group, one motion: the first 20 ms of the paper's joint with viscous damping, by every program at settings that
give the impulses to about a percent.  The impulses' largest deviation from the certified answer is in the columns
that ``--benchmark-json`` writes.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from benchmarks.plain_script import plain_impulses
from lapjoint import Problem, ViscousDamping, paper_joint
from validation.peers import opensees_script
from validation.peers.opensees_motion import history_of

DURATION = 0.02
"""Duration of the motion, s."""
ELEMENTS = 40
USABLE = 0.03
"""Largest error of a usable answer, relative to the largest impulse."""
PROBLEM = paper_joint().replace(damping=ViscousDamping(coefficient=2000.0))


def lapjoint_impulses(solver: Any) -> Callable[[Problem], np.ndarray]:
    return lambda problem: np.asarray(solver.simulate(problem, DURATION, errors=False).impulses())


def opensees_impulses(problem: Problem) -> np.ndarray:
    """In this process: what is measured is OpenSees, and not the start of another process."""
    return history_of(problem, "OpenSees", opensees_script.motion(problem, ELEMENTS, DURATION, 4e-6)).impulses()


PROGRAMS: dict[str, Callable[[Problem], np.ndarray]] = {
    "analytic": lapjoint_impulses(analytic.Solver()),
    "fe_lapjoint": lapjoint_impulses(fe_lapjoint.Solver(elements=ELEMENTS)),
    "solve_ivp, Radau, 40 elements": lambda problem: plain_impulses(problem, ELEMENTS, DURATION, "Radau", 1e-4),
    "solve_ivp, LSODA, 40 elements": lambda problem: plain_impulses(problem, ELEMENTS, DURATION, "LSODA", 1e-4),
    "OpenSeesPy, dt 4e-6 s, 40 elements": opensees_impulses,
}


@pytest.mark.parametrize("program", PROGRAMS)
@pytest.mark.benchmark(group=f"{DURATION} s of motion")
def bench_program(benchmark: Any, program: str) -> None:
    if "OpenSees" in program:
        try:
            opensees_script.load_opensees()
        except ImportError as error:
            pytest.skip(f"OpenSeesPy cannot be imported: {error}")
    fast = program == "analytic"
    impulses = benchmark.pedantic(PROGRAMS[program], (PROBLEM,), rounds=50 if fast else 1, warmup_rounds=int(fast))
    certified = PROGRAMS["analytic"](PROBLEM)
    deviation = np.max(np.abs(impulses - certified)) / np.abs(certified).max()
    benchmark.extra_info["deviation"] = float(deviation)
    assert deviation < USABLE
