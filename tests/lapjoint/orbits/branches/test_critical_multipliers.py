"""Test functions of multipliers: their signs, their sizes, and what they say where a multiplier passes infinity."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, get_args

import numpy as np
import pytest

from lapjoint.answers.steady_state import ComplexArray
from lapjoint.orbits.branches.bifurcations import Kind, Stretch, flip_test, is_critical, torus_test, within

MANY = 400  # pairs: products of pairs are 3e5, and two to that power overflows


def point(*multipliers: complex, forwards: bool = True) -> Any:
    """A point of a curve of which only the multipliers are asked, and whether the parameter grows along the curve."""
    return SimpleNamespace(multipliers=np.array(multipliers, dtype=complex), tangent=[1.0 if forwards else -1.0])


def pairs(moduli: ComplexArray, seed: int) -> list[complex]:
    """Complex pairs of multipliers of some moduli and any angle."""
    mu = moduli * np.exp(1j * np.random.default_rng(seed).uniform(0.1, 3.0, moduli.size))
    return [*mu.tolist(), *mu.conj().tolist()]


@pytest.mark.parametrize("seed", range(3))
def test_one_of_many_pairs_that_passes_the_circle_changes_the_sign(seed: int) -> None:
    others = pairs(np.full(MANY, 0.3), seed)
    inside, outside = (torus_test(point(*others, *pairs(np.array([r]), 9))) for r in (0.999, 1.001))
    assert inside * outside < 0
    assert abs(inside) == pytest.approx(1 - 0.999**2)


@pytest.mark.parametrize("forwards", [True, False])
def test_a_real_multiplier_that_passes_minus_one_changes_the_sign(forwards: bool) -> None:
    others = pairs(np.full(2000, 1.5), 1)
    inside, outside = (flip_test(point(*others, mu, forwards=forwards)) for mu in (-0.999, -1.001))
    assert inside * outside < 0
    assert (abs(inside), abs(outside)) == pytest.approx((0.001, 0.001))


def test_neither_a_fold_nor_a_pair_that_passes_the_circle_changes_the_sign_of_flips() -> None:
    """At a fold a multiplier passes 1, and the parameter turns."""
    others = pairs(np.array([0.5, 1.5]), 2)
    for sides in (
        (point(*others, 0.999), point(*others, 1.001, forwards=False)),
        (point(*others, *pairs(np.array([0.999]), 3)), point(*others, *pairs(np.array([1.001]), 3))),
    ):
        assert flip_test(sides[0]) * flip_test(sides[1]) > 0


def test_a_multiplier_that_passes_infinity_changes_the_sign_of_no_flip_and_is_no_neimark_sacker() -> None:
    others = 0.4 + 0.3j, 0.4 - 0.3j, 0.2
    sides = [point(*others, mu) for mu in (-1e12, 1e12)]
    assert flip_test(sides[0]) * flip_test(sides[1]) > 0
    assert torus_test(sides[0]) * torus_test(sides[1]) < 0
    assert not any(is_critical(kind, side) for kind in get_args(Kind) if kind != "fold" for side in sides)


def test_a_real_saddle_is_no_neimark_sacker() -> None:
    assert not is_critical("neimark-sacker", point(2.0, 0.5, 0.1))
    assert is_critical("neimark-sacker", point(0.6 + 0.8j, 0.6 - 0.8j, 0.1))


def test_motions_without_multipliers_hide_no_bifurcations() -> None:
    """All multipliers may be faint; a warning of numpy would fail this test."""
    problem = SimpleNamespace(sequence=SimpleNamespace(returning=()))
    first, middle, last = (point(*[rate * 1e-5] * 4) for rate in (1.0, 2.0, 1.0))
    for one in (first, middle, last):
        one.shares, one.problem = np.ones(1), problem
    assert not [*within(Stretch(first, middle, 0.1)), *within(Stretch(middle, last, 0.1))]
