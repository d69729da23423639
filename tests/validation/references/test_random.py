"""The closed forms of random vibration: limits that anyone can check, other sums, and a march by tiny steps."""

from __future__ import annotations

import math

import numpy as np
import pytest

import analytic
from lapjoint import FREE, Beam, Problem, Support, ViscousDamping
from validation.references.gibbs import Gibbs
from validation.references.log_log_density import LogLogDensity
from validation.references.shaken_cantilever import ShakenCantilever
from validation.references.summed_up import Touch, of_counts, shared, student

BEAM = ShakenCantilever(1.3, 210.0, 1.7, 4.0)
SOFT = Gibbs(20.0, 4.0, 0.3, (0.05, 3000.0), (0.03, 900.0))


def test_slow_shaking_bends_the_beam_as_its_own_weight_would() -> None:
    static = -BEAM.mass * BEAM.length**4 / (8 * BEAM.stiffness)
    found = BEAM.answer(np.array([1e-4]), BEAM.length, 0)[0]
    assert found == pytest.approx(static, rel=1e-5, abs=1e-5 * abs(static))
    root = BEAM.answer(np.array([1e-4]), 0.0, 2)[0] * BEAM.stiffness
    assert root.real == pytest.approx(-BEAM.mass * BEAM.length**2 / 2, rel=1e-5)


def test_answer_is_the_sum_over_modes() -> None:
    problem = Problem(
        beam=Beam(length=BEAM.length, bending_stiffness=BEAM.stiffness, mass_per_length=BEAM.mass),
        supports=(Support(x=0.0, translational=math.inf, torsional=math.inf),),
        damping=ViscousDamping(coefficient=BEAM.damping),
    )
    modes = analytic.Solver().modes(problem, FREE, 60)
    x, w = np.polynomial.legendre.leggauss(400)
    share = BEAM.mass * modes.shapes((x + 1) * BEAM.length / 2) @ w * BEAM.length / 2
    place = 0.7 * BEAM.length
    for hertz in (0.5, 3.2, 19.0, 55.0):
        omega = 2 * math.pi * hertz
        below = modes.angular_frequencies**2 - omega**2 + 1j * omega * BEAM.damping / BEAM.mass
        summed = -(modes.shapes(np.array([place]))[:, 0] * share / below).sum()
        assert BEAM.answer(np.array([hertz]), place, 0)[0] == pytest.approx(summed, rel=1e-6)


def test_root_is_clamped_and_tip_is_free() -> None:
    f = np.array([2.0, 31.0])
    scale = np.abs(BEAM.answer(f, BEAM.length, 0))
    for x, derivative in ((0.0, 0), (0.0, 1), (BEAM.length, 2), (BEAM.length, 3)):
        assert np.all(np.abs(BEAM.answer(f, x, derivative)) < 1e-9 * scale * (100 / BEAM.length) ** derivative)


def test_without_stops_the_density_is_gaussian() -> None:
    free = Gibbs(SOFT.omega, SOFT.gamma, SOFT.density, (math.inf, 0.0), (math.inf, 0.0))
    sigma = free.speed / free.omega
    assert free.mean(2) == pytest.approx(sigma**2, rel=1e-12)
    assert free.mean(4) == pytest.approx(3 * sigma**4, rel=1e-9)
    assert free.probability(sigma, math.inf) == pytest.approx(math.erfc(1 / math.sqrt(2)) / 2, rel=1e-8)
    assert free.upcrossings(0.0) == pytest.approx(free.omega / (2 * math.pi), rel=1e-12)


def test_parts_of_the_time_add_up_and_density_is_where_the_potential_says() -> None:
    parts = [SOFT.probability(a, b) for a, b in ((-math.inf, -0.03), (-0.03, 0.02), (0.02, math.inf))]
    assert sum(parts) == pytest.approx(1.0, rel=1e-10)
    around = 1e-6
    at = [SOFT.probability(u - around, u + around) for u in (0.0, 0.08)]
    u = np.array([0.0, 0.08])
    assert at[1] / at[0] == pytest.approx(math.exp(-np.diff(SOFT.potential(u))[0] / SOFT.speed**2), rel=1e-5)


def test_a_march_by_tiny_steps_has_this_density() -> None:
    """Symplectic steps of 400 oscillators under white noise, by no formula of the module."""
    rng = np.random.default_rng(5)
    n, dt, steps = 400, 1e-3, 6000
    u, v = np.zeros(n), np.zeros(n)
    second, beyond, ups, before = 0.0, 0.0, 0, u
    for i in range(steps):
        force = -(SOFT.omega**2) * u - SOFT.top[1] * np.maximum(u - SOFT.top[0], 0.0)
        force += SOFT.bottom[1] * np.maximum(-u - SOFT.bottom[0], 0.0)
        kick = math.sqrt(2 * math.pi * SOFT.density * dt) * rng.standard_normal(n)
        v = v + dt * (force - SOFT.gamma * v) + kick
        before, u = u, u + dt * v
        if i >= 2000:
            second, beyond = second + float(np.mean(u**2)), beyond + float(np.mean(u > SOFT.top[0]))
            ups += int(np.sum((before <= 0.02) & (u > 0.02)))
    counted = steps - 2000
    assert second / counted == pytest.approx(SOFT.mean(2), rel=0.03)
    assert beyond / counted == pytest.approx(SOFT.probability(SOFT.top[0], math.inf), rel=0.06)
    assert ups / (counted * dt * n) == pytest.approx(SOFT.upcrossings(0.02), rel=0.03)


def test_integrals_of_a_log_log_density_are_those_in_closed_form() -> None:
    flat, steep = LogLogDensity(((2.0, 3.0), (50.0, 3.0))), LogLogDensity(((2.0, 3.0), (8.0, 48.0)))
    assert flat.integral(0) == pytest.approx(3.0 * 48.0, rel=1e-12)
    assert flat.integral(1) == pytest.approx(3.0 * (2 * np.pi) ** 2 * (50.0**3 - 8.0) / 3, rel=1e-12)
    assert steep.integral(0) == pytest.approx(3.0 / 4 * (8.0**3 - 8.0) / 3, rel=1e-12)  # 3 (f / 2)^2
    assert steep.integral(-1) == pytest.approx(3.0 / 4 * 6.0 / (2 * np.pi) ** 2, rel=1e-12)
    assert steep.integral(0, 2) == pytest.approx((3.0 / 4) ** 2 * (8.0**5 - 32.0) / 5, rel=1e-12)
    np.testing.assert_allclose(steep.at(np.array([1.0, 4.0, 9.0])), [0.0, 12.0, 0.0])


def test_intervals_are_those_of_the_tables() -> None:
    # E. S. Pearson, H. O. Hartley, Biometrika Tables for Statisticians I, 1966, table 40, and Student's t of 4
    np.testing.assert_allclose(of_counts(np.zeros(20)), [0.0, 3.69 / 20], atol=3e-4)
    np.testing.assert_allclose(of_counts(np.repeat([1, 0], [10, 10])), np.array([4.80, 18.39]) / 20, atol=3e-4)
    batches = np.array([1.0, 2.0, 3.0, 4.0, 5.0])
    np.testing.assert_allclose(student(batches), 3 + 2.776 * np.sqrt(2.5 / 5) * np.array([-1, 1]), atol=1e-3)


def test_time_that_two_batches_share_is_parted() -> None:
    touches = [Touch(0, 0.9, 1.2, 1.0, 1.0, 1.0), Touch(1, 0.0, 2.0, 1.0, 1.0, 1.0), Touch(0, 1.5, 1.6, 1.0, 1.0, 1.0)]
    np.testing.assert_allclose(shared(touches, np.array([0.0, 1.0, 2.0]), 0), [0.1, 0.3])
