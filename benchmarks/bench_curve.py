"""The impulse curve up to 5000 rad/s, every point certified: points per worker and second."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from lapjoint import Outcome, paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep


def curve(solver: str, points: int, workers: int) -> Any:
    omega = np.linspace(5000.0 / points, 5000.0, points)
    return sweep(paper_joint(), [Axis(FREQUENCY, omega)], solver=solver, workers=workers)


def certified(found: Any) -> bool:
    names = found.outcome.attrs["flag_meanings"].split()
    return not (found.outcome.values == names.index(Outcome.UNDECIDED.name.lower()) - 1).any()


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.benchmark(group="analytic curve")
def bench_analytic_curve(benchmark: Any, curve_points: int, workers: int) -> None:
    curve("analytic", 2, 1)  # compiles, if nothing has before
    benchmark.extra_info["points"] = curve_points
    found = benchmark.pedantic(curve, ("analytic", curve_points, workers), rounds=1)
    assert certified(found)


@pytest.mark.parametrize("part", [4, 2, 1])
@pytest.mark.benchmark(group="analytic curve, 1 worker: a quarter, a half, all of the points")
def bench_points(benchmark: Any, curve_points: int, part: int) -> None:
    curve("analytic", 2, 1)
    benchmark.pedantic(curve, ("analytic", curve_points // part, 1), rounds=1)


@pytest.mark.parametrize("workers", [1, 2])
@pytest.mark.benchmark(group="finite element curve, 40 elements")
def bench_finite_element_curve(benchmark: Any, fe_points: int, workers: int) -> None:
    benchmark.extra_info["points"] = fe_points
    found = benchmark.pedantic(curve, ("fe", fe_points, workers), rounds=1)
    assert certified(found)
