"""The paper's joint as branches of motions, beside a sweep of the same range at points one after the other.

Each benchmark times a branch and a sweep in one run, as processor time, which other programs on the machine disturb
less than the time on the clock; `branch_over_sweep` is their ratio.  `milliseconds_per_point` is the time of a kept
motion: it includes the rejected steps, and the search for bifurcations and grazes.  The whole diagram of the joint with
a quarter of its damping, by one process, takes some minutes.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, sweep

WHOLE = 5000
"""Number of points of the sweep that branches are compared with, evenly spread up to 5000 rad/s."""
ELEMENTS = 30
"""Number of finite elements."""
AIM = 1e-5
"""Largest relative error of a bifurcation that counts as exact."""
RANGES: dict[str, tuple[str, float, float, bool]] = {
    "analytic, 1 to 5000": ("analytic", 1.0, 5000.0, False),
    "analytic, 1 to 5000, with errors": ("analytic", 1.0, 5000.0, True),
    "finite elements, 100 to 5000": ("fe", 100.0, 5000.0, False),
}
"""Solver, range, rad/s, and whether errors are stated; below 100 rad/s there are ten times as many grazes as above."""


def branch(solver: str, low: float, high: float, errors: bool) -> Any:
    options = {"elements": ELEMENTS} if solver == "fe" else {}
    return lapjoint.branch(paper_joint(), FREQUENCY, high, low, solver=solver, options=options, errors=errors)


def of_sweep(points: int) -> None:
    step = 5000.0 / points
    sweep(paper_joint(), [Axis(FREQUENCY, tuple((np.arange(1, points + 1) * step).tolist()))])


def processor_time(function: Callable[..., Any], *args: Any) -> tuple[float, Any]:
    begin = time.process_time()
    found = function(*args)
    return time.process_time() - begin, found


def counts_of(found: Any) -> dict[str, int]:
    exact = found.bifurcation_error.values <= AIM * found.bifurcation_value.values
    return {
        "branches": int(found.sizes["branch_number"]),
        "points": int(found.sizes["point"]),
        "bifurcations": int(found.sizes["bifurcation"]),
        "with an error of 1e-5 at most": int(exact.sum()),
        "motions left out": int(found.left_out),
        "parts on no branch": int(found.sizes.get("uncovered", 0)),
        "lost ends": int((found.branch_first_end == "lost").sum() + (found.branch_last_end == "lost").sum()),
    }


def said(counts: dict[str, int]) -> str:
    return ", ".join(f"{name} {count}" for name, count in counts.items())


@pytest.mark.parametrize("name", RANGES)
@pytest.mark.benchmark(group="branches, 1 worker")
def bench_branch_beside_sweep(benchmark: Any, curve_points: int, name: str) -> None:
    solver, _, high, errors = RANGES[name]
    branch(solver, 0.98 * high, high, errors)  # compiles, or loads, the functions that both call
    of_sweep(2)
    swept, _ = processor_time(of_sweep, curve_points)
    spent, found = benchmark.pedantic(processor_time, (branch, *RANGES[name]), rounds=1)
    ratio, each = spent / (swept * WHOLE / curve_points), 1e3 * spent / found.sizes["point"]
    counts = counts_of(found)
    benchmark.extra_info.update({"branch_over_sweep": ratio, "milliseconds_per_point": each, **counts})
    print(
        f"\n{name} rad/s: {spent:.1f} s of processor time, {each:.2f} ms a point, {ratio:.3f} of an analytic sweep of "
        f"{WHOLE} points; {said(counts)}"
    )
    assert counts["bifurcations"] > 0


def diagram() -> Any:
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    return lapjoint.branch(joint, FREQUENCY, 100.0, 5000.0, max_period_multiple=4, starts=50)


@pytest.mark.benchmark(group="all branches, ratio 0.02, 1 worker")
def bench_diagram_of_lightly_damped_joint(benchmark: Any) -> None:
    branch("analytic", 4900.0, 5000.0, True)  # compiles, if nothing has before
    spent, found = benchmark.pedantic(processor_time, (diagram,), rounds=1)
    counts = counts_of(found)
    benchmark.extra_info.update(counts)
    print(f"\n{spent:.0f} s of processor time: {said(counts)}")
    assert counts["bifurcations"] > 0
