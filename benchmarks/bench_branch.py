"""The paper's joint as one branch of motions, beside a sweep of the same range at points one after the other."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep

RANGES = {"100 to 5000": (100.0, 5000.0), "1 to 5000": (1.0, 5000.0)}  # rad/s; below 20 most contacts are light


def branch(low: float, high: float) -> Any:
    return lapjoint.branch(paper_joint(), FREQUENCY, high, low, errors=False)


@pytest.mark.parametrize("name", RANGES)
@pytest.mark.benchmark(group="one branch, 1 worker")
def bench_branch(benchmark: Any, name: str) -> None:
    branch(4900.0, 5000.0)  # compiles, if nothing has before
    found = benchmark.pedantic(branch, RANGES[name], rounds=1)
    benchmark.extra_info["points"] = int(found.sizes["point"])
    ends = {*found.branch_first_end.values, *found.branch_last_end.values}
    assert not ends & {"lost", "effort"}


@pytest.mark.benchmark(group="one branch, 1 worker")
def bench_sweep_beside(benchmark: Any, curve_points: int) -> None:
    omega = np.linspace(5000.0 / curve_points, 5000.0, curve_points)
    sweep(paper_joint(), [Axis(FREQUENCY, omega[-2:])])
    benchmark.extra_info["points"] = curve_points
    benchmark.pedantic(sweep, (paper_joint(), [Axis(FREQUENCY, omega)]), rounds=1)
