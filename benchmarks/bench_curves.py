"""The paper's joint as a curve of periodic motions with a known contact sequence, beside a sweep of the same range.

Each benchmark times one curve, from rest at the upper end of a range, and a sweep of points one after the other in one
run, as processor time; `curve_over_sweep` is their ratio.  `milliseconds_per_point` is that of a solved motion that is
kept: it includes the steps that are not taken, and the search for bifurcations and grazes.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, Grid, sweep
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.curves.resolution import ParameterRange
from lapjoint.orbits.curves.starts import start_from
from lapjoint.orbits.curves.tracing import Traced, trace

WHOLE = 5000
"""Number of points of the sweep that a curve is compared with, evenly spread up to 5000 rad/s."""
ELEMENTS = 30
"""Number of finite elements."""
SOLVERS: dict[str, Callable[[], Any]] = {
    "analytic": analytic.Solver,
    "fe": lambda: fe_lapjoint.Solver(elements=ELEMENTS),
}
RANGES = {"analytic 1 to 5000": ("analytic", 1.0, 5000.0), "fe 100 to 5000": ("fe", 100.0, 5000.0)}
"""Solver, and range, rad/s; below 100 there are ten times as many grazes as above."""


@in_one_thread
def curve(solver: str, low: float, high: float) -> Traced:
    """The curve from rest at the upper end of a range."""
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (low, high)),))
    of = ParameterRange(SOLVERS[solver](), lambda value: grid.with_values((value,)), FREQUENCY, low, high)
    start = start_from(of, high, of.resolution(high).map(high).initial(), 1)
    assert start is not None
    found = trace(of, start, 1)
    assert found is not None
    return found


def of_sweep(points: int) -> None:
    step = 5000.0 / points
    sweep(paper_joint(), [Axis(FREQUENCY, tuple((np.arange(1, points + 1) * step).tolist()))])


def processor_time(function: Callable[..., Any], *args: Any) -> tuple[float, Any]:
    begin = time.process_time()
    found = function(*args)
    return time.process_time() - begin, found


@pytest.mark.parametrize("name", RANGES)
@pytest.mark.benchmark(group="one curve, 1 worker")
def bench_curve_beside_sweep(benchmark: Any, curve_points: int, name: str) -> None:
    solver, low, high = RANGES[name]
    curve(solver, 0.8 * high, high)  # compiles, or loads, what all of it calls
    of_sweep(2)
    swept, _ = processor_time(of_sweep, curve_points)
    spent, found = benchmark.pedantic(processor_time, (curve, solver, low, high), rounds=1)
    ratio, each = spent / (swept * WHOLE / curve_points), 1e3 * spent / len(found.points)
    benchmark.extra_info["points"], benchmark.extra_info["found"] = len(found.points), len(found.found)
    benchmark.extra_info["curve_over_sweep"], benchmark.extra_info["milliseconds_per_point"] = ratio, each
    print(
        f"\n{name} rad/s: {len(found.points)} points, {len(found.found)} bifurcations and grazes, {spent:.1f} s of "
        f"processor time, {each:.2f} ms a point; over an analytic sweep of {WHOLE} points {ratio:.3f}"
    )
    assert not {*found.ends} & {"lost", "effort"}
