"""The equations of periodic motions with a given contact sequence, and their derivatives."""

from __future__ import annotations

import numpy as np
import pytest
from galerkin_arcs import GalerkinResolution, base_of, random_joint
from scipy.linalg import expm

from lapjoint.answers.contact_state import FREE
from lapjoint.orbits.arcs import ContactSequence
from lapjoint.orbits.branches.boundary_problem import BoundaryProblem

AMPLITUDE, FREQUENCY = "base_motion.amplitude", "base_motion.angular_frequency"


@pytest.mark.parametrize("index", range(12))
def test_the_derivative_is_that_of_differences(index: int) -> None:
    rng = np.random.default_rng((46, index))
    problem, modes, zeta, viscous = random_joint(rng, 3)
    path, value = ((AMPLITUDE, 1e-4), (FREQUENCY, base_of(problem).angular_frequency))[index % 2]
    resolution = GalerkinResolution(problem, path, 0.1 * value, 10 * value, modes, zeta, viscous)
    sequence, tied = ContactSequence(FREE, (0, 0, 1, 2, 2, 1)), frozenset({3} if index % 3 == 0 else ())
    equations = BoundaryProblem(resolution, sequence, 2, float(rng.uniform()), tied)
    shares = np.array([0.1, 10.0 ** -rng.integers(2, 12), 0.2, 0.1, -0.1, 0.2])
    u = equations.packed(1e-3 * rng.normal(size=2 * modes), shares, value)
    scale = np.concatenate([np.full(2 * modes, 1e-3), np.ones(equations.free.size), [value]])
    exact = equations.linearised(u).jacobian * scale
    columns = []
    for unit in np.eye(u.size) * scale * 1e-6:
        columns.append((equations.residual(u + unit) - equations.residual(u - unit)) / 2e-6)
    rows = np.abs(exact).max(axis=1)[:, None]
    by_unknowns, exact = np.transpose(columns) / rows, exact / rows
    np.testing.assert_allclose(by_unknowns[:, :-1], exact[:, :-1], atol=1e-6)
    np.testing.assert_allclose(by_unknowns[:, -1], exact[:, -1], atol=1e-4)  # from a difference to one side


def test_without_contact_the_monodromy_matrix_is_the_exponential_of_the_beam() -> None:
    problem, modes, zeta, viscous = random_joint(np.random.default_rng(3), 1)
    resolution = GalerkinResolution(problem, AMPLITUDE, 1e-5, 1e-3, modes, zeta, viscous)
    arcs = resolution.arcs(1e-4)
    equations = BoundaryProblem(resolution, ContactSequence(FREE), 2, 0.0)
    found = equations.linearised(np.append(arcs.without_contact, 1e-4))
    np.testing.assert_allclose(found.residual, 0.0, atol=1e-16)
    np.testing.assert_allclose(found.monodromy, expm(arcs.state(FREE).A * arcs.period), atol=1e-9)
