"""The cost of numerical errors beside that of the answers: steady states and marches of random joints."""

from __future__ import annotations

import math
import sys
from pathlib import Path
from typing import Any

import pytest

import analytic
import fe_lapjoint

sys.path.append(str(Path(__file__).parents[1] / "tests" / "helpers"))
from population import stiffened_joint

JOINTS = [stiffened_joint(7, index) for index in (0, 6, 7, 8, 9, 14)]
"""Joints whose motion repeats, with contacts."""
MARCHED = 20
"""Duration of the marches, excitation periods."""
SOLVERS = {"analytic": analytic.Solver(), "FE": fe_lapjoint.Solver()}


@pytest.mark.parametrize("errors", [False, True], ids=["plain", "with errors"])
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.benchmark(group="six steady states, with and without errors")
def bench_steady_states(benchmark: Any, solver: str, errors: bool) -> None:
    benchmark(lambda: [SOLVERS[solver].steady_state(joint, errors=errors) for joint in JOINTS])


@pytest.mark.parametrize("errors", [False, True], ids=["plain", "with errors"])
@pytest.mark.parametrize("solver", SOLVERS)
@pytest.mark.benchmark(group="six marches of 20 periods, with and without errors")
def bench_marches(benchmark: Any, solver: str, errors: bool) -> None:
    def march() -> None:
        for joint in JOINTS:
            assert joint.excitation_frequency is not None
            SOLVERS[solver].simulate(joint, MARCHED * 2 * math.pi / joint.excitation_frequency, errors=errors)

    benchmark(march)
