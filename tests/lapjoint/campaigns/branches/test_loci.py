"""Bifurcations that go on over values of a second parameter are one locus; doubtful ones are joined to nothing."""

from __future__ import annotations

import numpy as np

from lapjoint.campaigns.branches.loci import loci_of
from lapjoint.problem import FloatArray

VALUES = tuple(np.linspace(1.0, 2.0, 11).tolist())


LARGEST = 2.0
"""The largest impulse of all motions."""


def rows(*curves: tuple[str, FloatArray, FloatArray]) -> tuple[list[str], FloatArray, FloatArray, FloatArray]:
    """Labels, second numbers, numbers and impulses of bifurcations along curves, value by value, NaN where none is."""
    found = [
        (label, second, value[i], (impulse[i],))
        for i, second in enumerate(VALUES)
        for label, value, impulse in curves
        if np.isfinite(value[i])
    ]
    labels, second, value, impulses = zip(*found, strict=True)
    return list(labels), np.array(second), np.array(value), np.array(impulses)


B = np.array(VALUES)


def test_bifurcations_of_two_names_are_two_loci() -> None:
    given = rows(("fold", 3 * B, B), ("flip", 3 * B, B))
    found = loci_of(VALUES, *given, LARGEST)
    assert set(zip(given[0], found.tolist(), strict=True)) == {("fold", 0), ("flip", 1)}


def test_folds_whose_numbers_cross_go_on_as_their_impulses_do() -> None:
    given = rows(("fold", 3 + B, 0.1 * B), ("fold", 6 - B, B))
    found = loci_of(VALUES, *given, LARGEST)
    soft = given[3][:, 0] < 0.5
    assert set(found[soft]) == {0}
    assert set(found[~soft]) == {1}


def test_a_fold_that_ends_is_not_joined_to_one_that_begins_far_away() -> None:
    first, last = np.where(B < 1.45, B, np.nan), np.where(B > 1.45, 4 * B, np.nan)
    found = loci_of(VALUES, *rows(("fold", first, B), ("fold", last, B)), LARGEST)
    assert found.tolist() == [0] * 5 + [1] * 6


def test_two_that_are_hardly_apart_are_joined_to_neither() -> None:
    found = loci_of(VALUES, *rows(("fold", B, B), ("fold", 1.0001 * B**1.2, B)), LARGEST)
    assert len(set(found[:4])) == 4


def test_a_value_without_bifurcations_parts_a_locus() -> None:
    found = loci_of(VALUES, *rows(("fold", np.where(np.abs(B - 1.5) < 0.01, np.nan, 1.1 * B), B)), LARGEST)
    assert found.tolist() == [0] * 5 + [1] * 5


def test_what_has_no_name_is_joined_to_nothing() -> None:
    _, *given = rows(("fold", B, B))
    assert loci_of(VALUES, [None] * len(VALUES), *given, LARGEST).tolist() == list(range(11))


def test_first_grazes_whose_impulses_are_rounding_are_one_locus() -> None:
    """Without another bifurcation nothing but the impulses of motions says that theirs are none."""
    rounding = 1e-17 * np.random.default_rng(0).normal(size=B.size)
    assert set(loci_of(VALUES, *rows(("first grazing", B, rounding)), LARGEST).tolist()) == {0}


def test_nothing_makes_no_loci() -> None:
    assert loci_of(VALUES, [], np.zeros(0), np.zeros(0), np.zeros((0, 2)), 0.0).size == 0
