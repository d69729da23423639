"""What a contact costs under a record: noise of 5 to 500 Hz at 4 kHz, of 200 m/s2, on the paper's joint."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

import analytic
import fe_lapjoint
from lapjoint import Problem, paper_joint
from lapjoint.problem import RecordBaseMotion
from lapjoint.solver import Solver, Streams

RATE = 4000.0
"""Sampling rate of the record, Hz."""
DURATION = 2.0
"""Duration of the record, s."""
SOLVERS: dict[str, Solver] = {"analytic": analytic.Solver(n_modes=20), "fe": fe_lapjoint.Solver()}


@pytest.fixture(scope="module")
def problem() -> Problem:
    noise = np.random.default_rng(1).standard_normal(int(RATE * DURATION) + 1)
    spectrum, f = np.fft.rfft(noise), np.fft.rfftfreq(noise.size, 1 / RATE)
    values = np.fft.irfft(np.where((f >= 5) & (f <= 500), spectrum, 0.0), noise.size)
    record = RecordBaseMotion(quantity="acceleration", rate=RATE, values=200.0 / values.std() * values)
    return paper_joint().replace(base_motion=record)


@pytest.mark.parametrize("name", SOLVERS)
@pytest.mark.benchmark(group=f"{DURATION:g} s of noise")
def bench_march(benchmark: Any, name: str, problem: Problem) -> None:
    history = benchmark(SOLVERS[name].simulate, problem, DURATION, errors=False)
    benchmark.extra_info["contacts"] = len(history.contacts)
    assert len(history.contacts) > 400


@pytest.mark.parametrize("name", [name for name, solver in SOLVERS.items() if isinstance(solver, Streams)])
@pytest.mark.benchmark(group=f"{DURATION:g} s of noise")
def bench_stretches_with_the_field_at_every_knot(benchmark: Any, name: str, problem: Problem) -> None:
    solver, x = SOLVERS[name], np.linspace(0.0, problem.beam.length, 33)
    assert isinstance(solver, Streams)

    def run() -> float:
        largest = 0.0
        for stretch in solver.stream(problem, DURATION):
            t = np.linspace(stretch.start, stretch.end, int((stretch.end - stretch.start) * RATE) + 1)
            largest = max(largest, *(float(np.abs(stretch.evaluate(x, t, dt=dt)).max()) for dt in (0, 1, 2)))
        return largest

    assert benchmark(run) > 0
