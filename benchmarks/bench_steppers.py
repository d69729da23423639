"""The methods of `solve_ivp` on the finite element model: one and the same motion."""

from __future__ import annotations

from typing import Any

import pytest

import fe_lapjoint
from fe_lapjoint.solver import METHODS
from lapjoint import paper_joint

DURATION = 0.01
"""Duration of the motion, s."""


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.benchmark(group=f"{DURATION} s of motion, 4 elements")
def bench_method(benchmark: Any, method: str) -> None:
    solver = fe_lapjoint.Solver(elements=4, method=method)
    history = benchmark.pedantic(solver.simulate, (paper_joint(), DURATION), rounds=1, warmup_rounds=1)
    exact = fe_lapjoint.Solver(elements=4).simulate(paper_joint(), DURATION, errors=False)
    assert history.impulses() == pytest.approx(exact.impulses(), rel=1e-4)


@pytest.mark.parametrize("elements", [10, 20, 40, 80])
@pytest.mark.benchmark(group=f"{DURATION} s of motion, exact")
def bench_elements(benchmark: Any, elements: int) -> None:
    benchmark.pedantic(
        fe_lapjoint.Solver(elements=elements).simulate, (paper_joint(), DURATION), rounds=5, warmup_rounds=1
    )
