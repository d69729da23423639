"""What a contact costs in a long motion under random excitation: marched, handed on in stretches, and looked at."""

from __future__ import annotations

import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from analytic import Solver
from analytic.march import Joint, march
from analytic.march.initial_state import started
from lapjoint import paper_joint
from lapjoint.problem import Problem, RandomBaseMotion

DURATION = 20.0
"""Duration of the motion, with some 5700 contacts, s."""
MODES = 20
PLACES = np.linspace(0.0, 2.5, 33)
LIMIT = 120e-6
"""Most processor time of a contact, s: 5e5 contacts a minute and core."""


def shaken() -> Problem:
    """The paper's joint on a base with a flat density from 5 to 500 Hz and 200 m/s2 RMS, at the default rate."""
    density = 200.0**2 / (500.0 - 5.0)
    return paper_joint().replace(base_motion=RandomBaseMotion(psd=((5.0, density), (500.0, density)), seed=1))


def marched() -> int:
    """The bare march, without a log."""
    joint = Joint(shaken(), MODES, MODES)
    march(joint, started(joint), 0.0, DURATION, record=False)
    return 0


def handed_on() -> int:
    """Stretches with all contacts and their peak forces."""
    return sum(len(stretch.contacts) for stretch in Solver(n_modes=MODES).stream(shaken(), DURATION))


def looked_at() -> int:
    """Besides, displacement and moment at 33 places, 128 times a second."""
    contacts = 0
    for stretch in Solver(n_modes=MODES).stream(shaken(), DURATION):
        t = np.linspace(stretch.start, stretch.end, int(128 * (stretch.end - stretch.start)) + 1)
        stretch.displacement(PLACES, t)
        stretch.moment(PLACES, t)
        contacts += len(stretch.contacts)
    return contacts


@pytest.mark.parametrize("part", [marched, handed_on, looked_at], ids=lambda part: str(part.__name__))
@pytest.mark.benchmark(group=f"{DURATION:g} s under random excitation, 20 modes", timer=time.process_time)
def bench_random(benchmark: Any, part: Callable[[], int]) -> None:
    contacts = benchmark.pedantic(part, warmup_rounds=1, rounds=3)
    if contacts:
        benchmark.extra_info["us of CPU a contact"] = 1e6 * benchmark.stats.stats.min / contacts
        assert benchmark.stats.stats.min < LIMIT * contacts
