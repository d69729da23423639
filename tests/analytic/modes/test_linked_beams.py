"""Modes of several beams with links and stops between them, against a witness that counts in forty digits.

The witness, `linked_beams`, assembles members and counts by Wittrick and Williams; it shares nothing with the solver.
"""

from __future__ import annotations

import numpy as np
import pytest
from linked_beams import ExactBeams, random_beams, random_state

from analytic.modes.beam_functions import gram, inertia_of
from analytic.modes.normal_modes import exact_modes

COUNT = 8
NEAR = 1e-10  # of a frequency, or of that of a cantilever like the beams if that is more


def check_system(number: int, *, soft: float = -3.0, ratio: float = 30.0) -> None:
    """Each frequency lies where the count steps over its number, and modes are orthonormal."""
    rng = np.random.default_rng((490, number))
    problem = random_beams(rng, soft=soft, ratio=ratio)
    state = random_state(rng, problem)
    modes, witness = exact_modes(problem, state, COUNT), ExactBeams(problem, state)
    near = NEAR * np.maximum(modes.omega, np.sqrt(problem.line.EI / problem.line.m) / problem.line.length**2)
    for k in np.flatnonzero(modes.omega > 0):
        assert witness.exact_count(modes.omega[k] - near[k]) <= k < witness.exact_count(modes.omega[k] + near[k])
    if not state.closed:
        assert int(np.count_nonzero(modes.omega == 0)) == problem.structure.free_motions
    inertia = inertia_of(problem.line, problem.structure.masses)
    assert gram(modes.shapes, modes.shapes, inertia) == pytest.approx(np.eye(COUNT), abs=1e-8)


@pytest.mark.parametrize("number", range(8))
def test_frequencies_are_those_of_the_count(number: int) -> None:
    check_system(number)


@pytest.mark.slow
@pytest.mark.parametrize("number", range(100, 300))
def test_frequencies_of_many_systems_are_those_of_the_count(number: int) -> None:
    check_system(number, soft=-6.0 if number % 2 else -3.0, ratio=1e3 if number % 3 else 30.0)
