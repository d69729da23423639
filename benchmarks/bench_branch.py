"""The paper's joint as one branch of motions, beside a sweep of the same range at points one after the other.

Each benchmark times a branch and a sweep in one run, as processor time, which other programs on the machine disturb
less than the time on the clock; `branch_over_sweep` is their ratio, `curve_over_sweep` that of the branch from rest
alone, without those that spring from it.  The whole diagram of the joint with a quarter of its damping, by one process,
takes some minutes.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

import analytic
import lapjoint
from lapjoint import paper_joint
from lapjoint.campaigns import FREQUENCY, Axis, Grid, sweep
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import Traced, trace

WHOLE = 5000
"""Number of points of the sweep that a branch is compared with, evenly spread up to 5000 rad/s."""
RANGES = {"100 to 5000": (100.0, 5000.0), "1 to 5000": (1.0, 5000.0)}
"""rad/s; below 100 there are ten times as many grazes as above."""


def branch(low: float, high: float) -> Any:
    return lapjoint.branch(paper_joint(), FREQUENCY, high, low, errors=False)


def curve(low: float, high: float) -> Traced | None:
    """The branch from rest at the upper end of a range alone."""
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (low, high)),))
    family = Family(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, low, high)
    seed = seed_from(family, high, family.at(high).map.initial(), 1)
    return None if seed is None else trace(family, seed, most_multiple=1, errors=False)


def of_sweep(points: int) -> None:
    step = 5000.0 / points
    sweep(paper_joint(), [Axis(FREQUENCY, np.arange(1, points + 1) * step)])


def processor_time(function: Callable[..., Any], *args: Any) -> tuple[float, Any]:
    begin = time.process_time()
    found = function(*args)
    return time.process_time() - begin, found


@pytest.mark.parametrize("name", RANGES)
@pytest.mark.benchmark(group="one branch, 1 worker")
def bench_branch_beside_sweep(benchmark: Any, curve_points: int, name: str) -> None:
    branch(50.0, 56.0)  # compiles, or loads, what all of it calls: there are grazes, and symmetries break
    of_sweep(2)
    swept, _ = processor_time(of_sweep, curve_points)
    alone, _ = processor_time(curve, *RANGES[name])
    branched, found = benchmark.pedantic(processor_time, (branch, *RANGES[name]), rounds=1)
    benchmark.extra_info["points"] = int(found.sizes["point"])
    benchmark.extra_info["bifurcations"] = int(found.sizes["bifurcation"])
    ratio, of_curve = (spent / (swept * WHOLE / curve_points) for spent in (branched, alone))
    benchmark.extra_info["branch_over_sweep"], benchmark.extra_info["curve_over_sweep"] = ratio, of_curve
    print(
        f"\n{name} rad/s, processor time over that of a sweep of {WHOLE} points: the branch from rest {of_curve:.3f} "
        f"({alone:.1f} s), with all that spring from it {ratio:.3f} ({branched:.1f} s)"
    )
    ends = {*found.branch_first_end.values, *found.branch_last_end.values}
    assert not ends & {"lost", "effort"}


AIM = 1e-5
"""Error of a bifurcation over its number that is aimed at."""


def diagram() -> Any:
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    return lapjoint.branch(joint, FREQUENCY, 100.0, 5000.0, max_period_multiple=4, starts=50)


@pytest.mark.benchmark(group="all branches, ratio 0.02, 1 worker")
def bench_diagram_of_lightly_damped_joint(benchmark: Any) -> None:
    branch(4900.0, 5000.0)  # compiles, if nothing has before
    spent, found = benchmark.pedantic(processor_time, (diagram,), rounds=1)
    named = found.bifurcation_kind.values != found.bifurcation_kind.flag_meanings.split().index("unresolved")
    exact = found.bifurcation_error.values <= AIM * found.bifurcation_value.values
    counts = {
        "branches": int(found.sizes["branch_number"]),
        "points": int(found.sizes["point"]),
        "bifurcations": int(named.sum()),
        "with an error of 1e-5 at most": int((named & exact).sum()),
        "unresolved": int((~named).sum()),
        "motions left out": int(found.left_out),
        "lost": int((found.branch_first_end == "lost").sum() + (found.branch_last_end == "lost").sum()),
    }
    benchmark.extra_info.update(counts)
    print(f"\n{spent:.0f} s of processor time: " + ", ".join(f"{name} {count}" for name, count in counts.items()))
    assert counts["bifurcations"] > 0
