"""The flow of a mesh that damped stops couple, against the matrix exponential."""

from __future__ import annotations

from itertools import product

import numpy as np
import pytest
import scipy.linalg
from damped_stops import model_of, pinned_bar
from mpmath import mp
from random_joints import damped_cantilever

from fe_lapjoint.march.compiled import integral_of_product
from fe_lapjoint.march.coupled import Coupled, flow_from
from fe_lapjoint.march.exponentials import exponentials
from lapjoint.answers.contact_state import ContactState
from lapjoint.problem import FloatArray


def random_state(seed: int) -> Coupled | None:
    """A state of a random joint on a mesh in which all damped stops are closed, and some of them released."""
    rng = np.random.default_rng(seed)
    problem = damped_cantilever(rng)
    model = model_of(problem, int(rng.integers(2, 8)))
    closed = tuple(k for k in range(len(problem.stops)) if k in model.damped or rng.random() < 0.5)
    may = [k for k in model.damped if not problem.stops[k].may_pull]
    system = model.system(ContactState(closed, tuple(k for k in may if rng.random() < 0.4)))
    return system if isinstance(system, Coupled) else None


def first_order(system: Coupled) -> tuple[FloatArray, FloatArray]:
    """The matrix of (omega q, q'), 1/s, ``(2 n, 2 n)``, and the factors of (q, q')."""
    n, omega = system.omega.size, system.omega
    A = np.block([[np.zeros((n, n)), np.diag(omega)], [-np.diag(omega), -system.D]])
    return A, np.concatenate([omega, np.ones(n)])


def check_flow(seed: int) -> None:
    system = random_state(seed)
    if system is None:
        return
    rng = np.random.default_rng([seed, 1])
    (A, size), t = first_order(system), 10 ** rng.uniform(-3, -1)
    here = system.flown(t, np.diag(1 / size)) * size[:, None]
    assert np.abs(scipy.linalg.expm(A * t) - here).max() < 1e-9
    y = rng.normal(size=size.size) / size
    flow = flow_from(system, 0.3, y)
    later, at = flow.at(0.3 + t), np.array([0.3 + t])
    n, acceleration = system.omega.size, system.rates(0.3 + t, later)[system.omega.size :]
    amount = 1.0 + float(np.abs(system.motion_by_loads[1] * size).max())  # what free and forced motion cancel from
    spread = float(system.omega.max() / system.omega.min())  # eigenvalues are known to rounding of the fastest
    assert np.abs((flow.at(0.3) - y) * size).max() < (1e-9 + 4 * np.finfo(float).eps * spread) * amount
    assert flow(at, 1)[:, 0] == pytest.approx(later[n:], abs=1e-12)
    rounding = 4 * np.finfo(float).eps * amount * system.omega.max()  # of `later`, from which `rates` takes forces
    assert np.abs(flow(at, 2)[:, 0] - acceleration).max() < 1e-9 * np.abs(acceleration).max() + rounding
    P = system.stops.shape[0]
    seen = system.stops @ later[:n] + system.seen_motion(at)[:P, 0]
    assert flow.at_stops(at)[:P, 0] == pytest.approx(seen, abs=1e-9)


def test_flows_are_the_matrix_exponential() -> None:
    for seed in range(20):
        check_flow(seed)


@pytest.mark.slow
def test_many_flows_are_the_matrix_exponential() -> None:
    for seed in range(20, 300):
        check_flow(seed)


@pytest.mark.parametrize("apart", [0.0, 1e-15, 1e-12, 1e-9, 1e-6, 1e-3])
def test_flow_at_and_near_a_double_root(apart: float) -> None:
    omega, t = np.array([3.0]), 0.7
    D = np.array([[6.0 * (1 + apart)]])  # critical damping is 2 omega
    it = exponentials(omega, np.zeros((1, 1)), D)
    exact = scipy.linalg.expm(np.array([[0.0, 1.0], [-9.0, -D[0, 0]]]) * t)
    here = np.concatenate([it.modes, it.modes * it.rates]) * np.exp(it.rates * t) @ it.back
    assert np.abs(here.real - exact).max() < 1e-9


def check_forced_motion(seed: int) -> None:
    """The forced motion against a dense solution, each mode to the digits that it has there."""
    system = random_state(seed)
    if system is None:
        return
    for h, w in enumerate(system.driven.tolist()):
        dense = np.diag(system.omega**2 - w**2) + 1j * w * system.D
        exact, found = np.linalg.solve(dense, system.push[:, h]), system.amplitudes[:, h]
        condition = float(np.linalg.cond(dense / np.abs(dense).max(axis=0)))
        lost = 1e-12 * condition  # by the dense solution, which leaves up to 1e-13 of the forces
        assert np.abs(found - exact).max() <= lost * np.abs(exact).max(), seed
        left = np.abs(dense @ found - system.push[:, h])
        assert (left <= 1e-14 * (np.abs(dense) @ np.abs(found) + np.abs(system.push[:, h]))).all(), seed


def test_forced_motions_are_dense_solutions() -> None:
    for seed in range(20):
        check_forced_motion(seed)


@pytest.mark.slow
def test_many_forced_motions_are_dense_solutions() -> None:
    for seed in range(20, 300):
        check_forced_motion(seed)


@pytest.mark.parametrize("damping", [1e-14, 1e-9, 1e-4])
def test_forced_motion_at_resonance_with_hardly_any_damping(damping: float) -> None:
    """Where a rate is not known well enough to be beside the load's, the forced motion is solved for."""
    problem = damped_cantilever(np.random.default_rng(4)).replace(damping={"kind": "none"})
    stop = problem.stops[0]
    stop = type(stop)(**{**dict(stop), "damping": damping})
    tuned = model_of(problem.replace(stops=(stop,)), 4).system(ContactState((0,)))
    assert isinstance(tuned, Coupled)
    w = float(np.abs(tuned.free.rates.imag).min())
    dense = np.diag(tuned.omega**2 - w**2) + 1j * w * tuned.D
    push = np.ones(tuned.omega.size, dtype=complex)
    found = tuned._driven(push, w)
    left = np.abs(dense @ found - push)
    assert (left <= 1e-13 * (np.abs(dense) @ np.abs(found) + 1.0)).all()


def test_flow_of_a_rigid_body_beside_a_damped_stop() -> None:
    """Modal damping stays that of the closed stop when its force has ended; the bar then turns freely, with drag."""
    problem = pinned_bar(5.0, EI=1e7).replace(damping={"kind": "modal", "ratio": 0.05})
    for state in (ContactState((0,)), ContactState((0,), (0,))):
        system = model_of(problem, 1).system(state)
        assert isinstance(system, Coupled)
        n, t = system.omega.size, 0.2
        A = np.block([[np.zeros((n, n)), np.eye(n)], [-np.diag(system.omega**2), -system.D]])
        load = np.zeros((2 * n + 1, 2 * n + 1))
        load[: 2 * n, : 2 * n], load[n : 2 * n, 2 * n] = A, system.constant
        y = np.array([0.3, *np.zeros(n - 1), -0.7, *np.zeros(n - 1)])
        slow = np.concatenate([[0], [n]])
        exact = (scipy.linalg.expm(load * t) @ np.append(y, 1.0))[: 2 * n]
        flow = flow_from(system, 0.0, y)
        assert flow.at(t)[slow] == pytest.approx(exact[slow], rel=1e-8)
        times, weights = np.polynomial.legendre.leggauss(40)
        inside = (times + 1) * t / 2
        reads = flow.at_stops(inside)
        if not state.released:
            reads = reads + 0.05 * flow.at_stops(inside, 1)
            assert flow.integral_at_stops(t)[0] == pytest.approx(float(reads[0] @ weights) * t / 2, rel=1e-6)


def test_integrals_of_products_keep_their_digits_however_slow_the_sums() -> None:
    rng = np.random.default_rng(48)
    size, T = 10.0 ** rng.uniform(-12, 3, 12), 0.7
    rates = np.concatenate([-size * np.exp(1j * rng.uniform(-1.5, 1.5, 12)), [0.0, 3j, -3j, 300j, -300j]])
    with mp.workdps(60):
        for i, j in product(range(rates.size), repeat=2):
            one, other = np.zeros((2, rates.size), dtype=complex)
            one[i], other[j] = np.exp(1j * rng.uniform(-np.pi, np.pi, 2))
            r, p, a, b = (mp.mpmathify(complex(x)) for x in (rates[i], rates[j], one[i], other[j]))
            exact, most = mp.mpf(0), 0.0
            for z, amplitude in (((r + p) * T, a * b), ((r + mp.conj(p)) * T, a * mp.conj(b))):
                exact += mp.re(amplitude * T * (mp.expm1(z) / z if z else 1)) / 2
                most += T * min(1.0, 2 / max(float(abs(z)), 1e-300))
            lost = 1 + (abs(rates[i]) + abs(rates[j])) * T  # digits of the angles, which the waves cannot keep
            assert abs(integral_of_product(one, other, rates, T) - float(exact)) <= 4e-16 * lost * most, (i, j)
