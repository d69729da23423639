"""No mode bends a beam more slowly than the bound that messages about slow excitation state."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from lapjoint import Problem
from lapjoint.problem.problem import _slowest_bending


def laden(rng: np.random.Generator) -> Problem:
    """A cantilever of one to three segments with up to three masses."""
    ends = [*np.sort(rng.uniform(0.1, 0.9, int(rng.integers(0, 3)))).tolist(), 1.0]
    masses = [
        {"x": float(rng.uniform(0.1, 1)), "mass": 10 ** rng.uniform(-2, 2), "rotary_inertia": 10 ** rng.uniform(-4, 1)}
        for _ in range(int(rng.integers(0, 4)))
    ]
    segments = [
        {"to": end, "bending_stiffness": 10 ** rng.uniform(-1, 1), "mass_per_length": 10 ** rng.uniform(-1, 1)}
        for end in ends
    ]
    clamp = {"x": 0.0, "translational": math.inf, "torsional": math.inf}
    return Problem.model_validate(
        {"beam": {"length": 1.0, "segments": segments}, "supports": [clamp], "masses": masses}
    )


def test_the_bound_is_below_the_first_frequency_of_random_cantilevers() -> None:
    rng = np.random.default_rng(0)
    for problem in (laden(rng) for _ in range(30)):
        first = analytic.Solver().modes(problem, count=1).angular_frequencies[0]
        assert _slowest_bending(problem) <= first * (1 + 1e-9)


def test_a_uniform_cantilever_with_a_heavy_tip_comes_near_the_bound() -> None:
    beam = {"length": 1.0, "bending_stiffness": 1.0, "mass_per_length": 1.0}
    clamp = {"x": 0.0, "translational": math.inf, "torsional": math.inf}
    problem = Problem.model_validate(
        {"beam": beam, "supports": [clamp], "masses": [{"x": 1.0, "mass": 1e3, "rotary_inertia": 0.0}]}
    )
    assert _slowest_bending(problem) == pytest.approx(math.sqrt(3 / 1e3), rel=1e-3)
    first = analytic.Solver().modes(problem, count=1).angular_frequencies[0]
    assert first == pytest.approx(_slowest_bending(problem), rel=1e-3)
