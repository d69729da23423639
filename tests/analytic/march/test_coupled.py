"""The flow of modes that damped stops couple, in the analytic solver, against the matrix exponential."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.linalg
from damped_stops import pinned_bar

from analytic.march import Joint
from analytic.march.coupled import kept_by_force, oscillators
from analytic.modes.beam_functions import ComplexArray
from lapjoint import Stop
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray


def matrices(rng: np.random.Generator) -> tuple[FloatArray, FloatArray, FloatArray]:
    """D, K and natural frequencies of modes that dampers couple, and from which some springs are taken."""
    n = int(rng.integers(1, 13))
    omega = np.sort(10 ** rng.uniform(0, 3.5, n))
    K, D = np.diag(omega**2), np.diag(2 * omega * rng.uniform(0, 0.1, n) * (rng.random() < 0.7))
    for _ in range(rng.integers(1, 4)):
        phi = rng.normal(size=n)
        if rng.random() < 0.3:
            without = K - rng.uniform(0.1, 0.9) / np.sum(phi**2 / np.diag(K)) * np.outer(phi, phi)
            K = without if np.linalg.eigvalsh(without)[0] > 1e-6 else K
        else:
            D = D + 10 ** rng.uniform(-3, 4) * np.outer(phi, phi)
    return D, K, omega


def flow_error(D: FloatArray, K: FloatArray, scale: FloatArray, t: float) -> float:
    """Largest error of the oscillators' flow over `t` seconds against scipy's expm of the first-order matrix."""
    return error_of_flow(oscillators(D, K, scale), D, K, scale, t)


def error_of_flow(
    found: tuple[ComplexArray, FloatArray, FloatArray], D: FloatArray, K: FloatArray, scale: FloatArray, t: float
) -> float:
    """The same of given roots, T and its inverse."""
    n, (roots, to, back) = scale.size, found
    inner = np.zeros((2 * n, 2 * n))
    for i, (a, b) in enumerate(roots):
        pair = np.array([[0, 1], [-(a * b).real, (a + b).real]])
        inner[np.ix_([i, n + i], [i, n + i])] = scipy.linalg.expm(pair * t)
    A, size = np.block([[np.zeros((n, n)), np.eye(n)], [-K, -D]]), np.concatenate([scale, np.ones(n)])
    exact = scipy.linalg.expm(A / size * t * size[:, None])
    return float(np.abs(exact - to @ inner @ back / size * size[:, None]).max())


def test_oscillators_flow_as_the_matrix_exponential() -> None:
    rng = np.random.default_rng(1)
    assert max(flow_error(*matrices(rng), 10 ** rng.uniform(-3, 0)) for _ in range(60)) < 1e-9


@pytest.mark.slow
def test_many_oscillators_flow_as_the_matrix_exponential() -> None:
    rng = np.random.default_rng(2)
    assert max(flow_error(*matrices(rng), 10 ** rng.uniform(-3, 0)) for _ in range(2000)) < 1e-9


@pytest.mark.parametrize("apart", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    problem = pinned_bar(20.0 * (1 + apart))  # 2 sqrt(k m) is 20 N s/m
    joint = Joint(problem, 1, 1)
    it, modal = joint.coupled(ContactState((0,))), joint.modal(ContactState((0,)))
    assert it is not None
    phi, omega, t = modal.at_stops[0], modal.modes.omega, 0.3
    A = np.block([[np.zeros((1, 1)), np.eye(1)], [-np.diag(omega**2), -problem.stops[0].damping * np.outer(phi, phi)]])
    (a, b) = it.roots[0]
    inner = scipy.linalg.expm(np.array([[0, 1], [-(a * b).real, (a + b).real]]) * t)
    assert np.abs(scipy.linalg.expm(A * t) - it.to @ inner @ it.back).max() < 1e-9 * omega[0]


@pytest.mark.parametrize(
    ("gap", "pulls", "expected"), [(2e-3, False, {0, 1}), (-2e-3, False, {0}), (2e-3, True, set())]
)
def test_only_gaps_that_cannot_switch_while_a_stop_presses_sleep(gap: float, pulls: bool, expected: set[int]) -> None:
    pressing = Stop(x=1.0, side="top", gap=1e-3, stiffness=10.0, damping=1.0, may_pull=pulls)
    others = (Stop(x=1.0, side="bottom", gap=gap, stiffness=10.0), Stop(x=1.0, side="top", gap=3e-3, stiffness=10.0))
    joint = pinned_bar(1.0).replace(stops=(pressing, *others))
    assert kept_by_force(joint, ContactState((0,))) == expected
    assert kept_by_force(joint, ContactState((0,), (0,))) == set()
