"""The cost of an excitation cycle of the paper's joint at 515 rad/s, transient and certified switches included."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest

from analytic.march import Coordinates, Joint, march
from benchmarks.naive_march import naive_march
from lapjoint import FREE, paper_joint

CYCLES = 50
PERIOD = 2 * math.pi / 515.0


def settled(modes: int) -> tuple[Joint, Coordinates]:
    joint = Joint(paper_joint(angular_frequency=515.0), modes, modes)
    rest = Coordinates(FREE, np.zeros(modes), np.zeros(modes))
    return joint, march(joint, rest, 0.0, 20 * PERIOD, record=False).end


@pytest.mark.parametrize("modes", [5, 10, 20, 40, 80])
@pytest.mark.benchmark(group=f"{CYCLES} cycles at 515 rad/s")
def bench_certified_march(benchmark: Any, modes: int) -> None:
    joint, begin = settled(modes)
    benchmark.extra_info["us per cycle"] = "mean / 50"
    motion = benchmark(march, joint, begin, 0.0, CYCLES * PERIOD, record=False)
    assert motion.penetration.min() > 0


@pytest.mark.benchmark(group=f"{CYCLES} cycles at 515 rad/s")
def bench_naive_march_of_20_modes(benchmark: Any) -> None:
    joint, begin = settled(20)

    def run() -> int:
        slot, _, switches = naive_march(
            joint.tables, joint.slot(begin.state), 0.0, CYCLES * PERIOD, begin.q.copy(), begin.v.copy()
        )
        assert slot >= 0
        return int(switches)

    switches = benchmark.pedantic(run, warmup_rounds=1, rounds=5)
    assert switches == pytest.approx(8 * CYCLES, abs=2)
