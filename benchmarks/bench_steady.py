"""The cost of a certified steady state, and of its parts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

import analytic
from analytic.march import Coordinates, Joint, march, march_linearised
from lapjoint import FREE, paper_joint


@pytest.mark.parametrize("omega", [100.0, 515.0, 2950.0, 4700.0])
@pytest.mark.benchmark(group="steady state, by frequency")
def bench_steady_state(benchmark: Any, omega: float) -> None:
    solver, problem = analytic.Solver(), paper_joint(angular_frequency=omega)
    assert benchmark(solver.steady_state, problem).period_multiple == 1


@pytest.mark.parametrize("part", ["march of a period, recorded", "with its monodromy", "its multipliers", "the model"])
@pytest.mark.benchmark(group="parts of a steady state at 515 rad/s, 20 modes")
def bench_part(benchmark: Any, part: str) -> None:
    problem, period = paper_joint(angular_frequency=515.0), 2 * math.pi / 515.0
    joint = Joint(problem, 20, 20)
    begin = march(joint, Coordinates(FREE, np.zeros(20), np.zeros(20)), 0.0, 20 * period, record=False).end
    _, matrix = march_linearised(joint, begin, period, np.eye(40))
    parts = {
        "march of a period, recorded": lambda: march(joint, begin, 0.0, period),
        "with its monodromy": lambda: march_linearised(joint, begin, period, np.eye(40)),
        "its multipliers": lambda: np.linalg.eigvals(matrix),
        "the model": lambda: Joint(problem, 20, 20),
    }
    benchmark(parts[part])
