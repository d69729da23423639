"""Bifurcations within one step of a curve that undo each other's signs, of made multipliers whose course is known."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.branches import bifurcations
from lapjoint.orbits.branches.bifurcations import Kind, Stretch, within
from lapjoint.orbits.branches.boundary_problem import Linearisation
from lapjoint.problem import FloatArray

Course = Callable[[float], FloatArray]
"""The derivative over a motion's half periods, by the arclength from 0 to 1."""
ALIKE = 1e-6
"""Distance of two bifurcations up to which they are one: multipliers of a random basis are wrong by some 1e-13."""
SAMPLES = 201
PROBLEM = SimpleNamespace(
    sequence=SimpleNamespace(returning=()),
    resolution=SimpleNamespace(options=SimpleNamespace(newton_tolerance=1e-9)),
)


def point(course: Course, at: float) -> Any:
    """A point of a curve along which the parameter grows, and of which only the multipliers are asked."""
    monodromy = course(at)
    n = len(monodromy)
    jacobian = np.column_stack([monodromy - np.eye(n), np.zeros(n)])
    chain: Any = SimpleNamespace(end=np.zeros(n))
    linearisation = Linearisation(np.zeros(n), jacobian, chain)
    return SimpleNamespace(
        at=at,
        course=course,
        multipliers=linearisation.multipliers,
        linearisation=linearisation,
        tangent=np.ones(1),
        shares=np.ones(1),
        problem=PROBLEM,
    )


@pytest.fixture(autouse=True)
def made(monkeypatch: pytest.MonkeyPatch) -> None:
    """Points of the curve are made, and not solved for."""

    def beside(start: Any, length: float, near: Any = None, exact: bool = True) -> Any:
        return point(start.course, start.at + length)

    monkeypatch.setattr(bifurcations, "beside", beside)


def found_in(course: Course) -> list[tuple[Kind, float]]:
    """The bifurcations of a step, and where they lie."""
    stretch = Stretch(point(course, 0.0), point(course, 1.0), 1.0)
    return [(one.kind, one.point.at) for one in within(stretch)]  # type: ignore[attr-defined]  # they are made points


def meeting(rng: np.random.Generator) -> Course:
    """Two pairs that rotate towards each other, part in modulus where they meet, and go on as they came.

    Uncoupled, they have one modulus below 1, and angles that pass each other.
    """
    rate, at = rng.uniform(0.2, 0.9), rng.uniform(0.35, 0.65)
    coupling = rate * rng.uniform(0.01, 0.12)
    modulus, angle = 1 - coupling * rng.uniform(0.1, 0.8), rng.uniform(0.6, 2.5)
    phase, turn = rng.uniform(0, 2 * np.pi), rng.uniform(-0.3, 0.3)
    balance, basis = 10 ** rng.uniform(-0.5, 0.5), rng.normal(size=(4, 4))

    def course(s: float) -> FloatArray:
        apart = rate * (s - at) / 2
        pairs = np.array(
            [
                [modulus * np.exp(1j * apart), coupling * balance * np.exp(1j * phase)],
                [coupling / balance * np.exp(1j * (turn - phase)), modulus * np.exp(-1j * apart)],
            ]
        )
        return in_basis(basis, pairs * np.exp(1j * angle))

    return course


def in_basis(basis: FloatArray, pairs: ComplexArray) -> FloatArray:
    """The real matrix of two coupled complex pairs, in a basis."""
    real = np.block([[pairs.real, -pairs.imag], [pairs.imag, pairs.real]])
    return np.asarray(basis @ real @ np.linalg.inv(basis))


def passings_of(course: Course) -> FloatArray:
    """Where the largest multiplier passes the unit circle, on a grid: to half of its spacing."""
    grid = np.linspace(0.0, 1.0, SAMPLES)
    largest = np.array([np.abs(np.linalg.eigvals(course(s))).max() for s in grid])
    passings = np.flatnonzero((largest[:-1] - 1) * (largest[1:] - 1) < 0)
    return np.asarray((grid[passings] + grid[passings + 1]) / 2)


@pytest.mark.parametrize(
    "seed", [*range(20), *(pytest.param(seed, marks=pytest.mark.thorough) for seed in range(20, 300))]
)
def test_pairs_that_meet_and_part_pass_the_circle_twice(seed: int) -> None:
    course = meeting(np.random.default_rng((46, seed)))
    there = passings_of(course)
    assert there.size == 2  # the largest leaves the circle by a fifth of the way to it, or more
    found = found_in(course)
    assert [kind for kind, _ in found] == ["neimark-sacker"] * 2
    np.testing.assert_allclose([at for _, at in found], there, atol=0.5 / (SAMPLES - 1) + ALIKE)


@pytest.mark.parametrize("seed", range(20))
def test_pairs_that_pass_each_other_within_the_circle_are_no_bifurcations(seed: int) -> None:
    """Their derivative has no part that couples them."""
    rng = np.random.default_rng((47, seed))
    rate, at, modulus, angle = rng.uniform(0.2, 0.9), rng.uniform(0.35, 0.65), rng.uniform(0.9, 0.999), 1.5
    basis = rng.normal(size=(4, 4))

    def course(s: float) -> FloatArray:
        apart = rate * (s - at) / 2
        return in_basis(basis, modulus * np.diag(np.exp(1j * np.array([angle + apart, angle - apart]))))

    assert not found_in(course)


def leaving(rng: np.random.Generator) -> tuple[Course, list[tuple[Kind, float]]]:
    """Up to three real multipliers and up to three pairs, most of which leave the circle, and where they do."""
    reals, pairs = int(rng.integers(0, 4)), int(rng.integers(0, 4))
    ats = rng.permutation(np.linspace(0.1, 1.4, 14))[: reals + pairs] + rng.uniform(-0.03, 0.03, reals + pairs)
    rates, angles = rng.uniform(0.1, 0.3, ats.size), rng.uniform(0.5, 2.6, ats.size)
    size = reals + 2 * pairs
    basis = rng.normal(size=(size, size))

    def course(s: float) -> FloatArray:
        real = np.zeros((size, size))
        for k, (at, rate, angle) in enumerate(zip(ats, rates, angles, strict=True)):
            modulus = 1 + rate * (s - at)
            if k < reals:
                real[k, k] = -modulus
                continue
            i, turned = reals + 2 * (k - reals), modulus * np.exp(1j * angle)
            real[i : i + 2, i : i + 2] = [[turned.real, -turned.imag], [turned.imag, turned.real]]
        return np.asarray(basis @ real @ np.linalg.inv(basis))

    kinds: list[Kind] = ["flip" if k < reals else "neimark-sacker" for k in range(ats.size)]
    passed = [(float(at), kind) for at, kind in zip(ats, kinds, strict=True) if at < 1]
    return course, [(kind, at) for at, kind in sorted(passed)]


@pytest.mark.parametrize("seed", range(20))
def test_all_that_leave_the_circle_in_one_step_are_found_in_their_sequence(seed: int) -> None:
    """Two flips, or two Neimark-Sackers, leave the signs of their test functions as they were."""
    course, there = leaving(np.random.default_rng((48, seed)))
    found = found_in(course)
    assert [kind for kind, _ in found] == [kind for kind, _ in there]
    np.testing.assert_allclose([at for _, at in found], [at for _, at in there], atol=ALIKE)
