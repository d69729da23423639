"""Peaks, jumps and limits of curves of which these are known."""

from __future__ import annotations

import math
from itertools import pairwise

import numpy as np
import pytest
from made_sweeps import made_sweep

from lapjoint.figures.curve_features import STANDS_OUT, exceeding, jumps_of, motions_of, peaks_of
from lapjoint.figures.impulse_curve import in_pieces, motion_kinds

RNG = np.random.default_rng(5)


@pytest.mark.parametrize("uneven", [False, True])
def test_the_peak_of_a_smooth_curve_is_within_its_error(uneven: bool) -> None:
    for _ in range(200):
        x = np.sort(RNG.uniform(0.0, 1.0, 60)) if uneven else np.linspace(0.0, 1.0, 60)
        at, width = RNG.uniform(x[3], x[-4]), RNG.uniform(0.02, 0.3)
        (peak, *others) = peaks_of(x, -1.0 / (1.0 + ((x - at) / width) ** 2))
        assert abs(peak.place - at) <= peak.error
        assert peak.value < 0
        assert not others
        assert math.isnan(peak.value_error)


def test_only_what_stands_out_is_a_peak_and_the_largest_comes_first() -> None:
    x = np.linspace(0.0, 10.0, 101)
    heights = {2.0: 0.4, 5.0: 1.0, 8.0: 0.8 * STANDS_OUT}
    y = sum(height * np.exp(-(((x - at) / 0.3) ** 2)) for at, height in heights.items())
    assert [round(peak.place, 9) for peak in peaks_of(x, np.asarray(y))] == [5.0, 2.0]


def test_a_curve_that_rises_to_the_end_of_the_range_has_its_largest_value_there_without_an_error() -> None:
    x = np.linspace(1.0, 2.0, 11)
    (peak,) = peaks_of(x, x**2, 0.1 * x)
    assert (peak.place, peak.value, peak.value_error) == (2.0, 4.0, pytest.approx(0.2))
    assert math.isnan(peak.error)
    assert peaks_of(x, -(x**2))[0].value == -4.0
    assert peaks_of(x, 0.0 * x) == peaks_of(x[:1], x[:1]) == []


def test_missing_values_make_no_peak() -> None:
    x, y = np.arange(7.0), np.array([1.0, 2.0, np.nan, 3.0, 2.0, np.nan, np.nan])
    assert all(np.isfinite(peak.value) for peak in peaks_of(x, y))


def test_jumps_are_where_the_lines_of_the_figure_break_but_not_among_motions_that_do_not_repeat() -> None:
    x = np.arange(40.0)
    pad, wall = -1.0 - 0.01 * x, 2.0 + 0.01 * x
    wall[25:] += 5.0
    multiples = [1] * 10 + [2] * 5 + [0] * 5 + [1] * 20
    dataset = made_sweep(x, [pad, wall], multiples)
    found = jumps_of(dataset, [pad, wall])
    assert [(jump.before, jump.after) for jump in found] == [(9, 10), (14, 15), (19, 20), (24, 25)]
    assert found[0].motions == ("periodic, 1 period", "periodic, 2 periods")
    assert found[1].motions == ("periodic, 2 periods", "aperiodic")
    assert found[3].motions == ("periodic, 1 period",) * 2
    assert (found[3].curve, found[3].values) == (1, pytest.approx((2.24, 7.25)))
    breaks = {piece.start for y in (pad, wall) for piece in in_pieces(y, motion_kinds(dataset).values)} - {0}
    assert {int(jump.after) for jump in found} == breaks
    erratic = made_sweep(x, [np.where(x > 20, 9.0, pad), wall], [0] * 40)
    assert jumps_of(erratic, [np.where(x > 20, 9.0, pad), wall]) == []


def test_a_motion_without_contact_is_said_in_two_words() -> None:
    dataset = made_sweep(np.arange(3.0) + 1, [np.zeros(3)])
    dataset.outcome[:] = 0
    dataset.outcome[2] = -1
    assert motions_of(dataset)[:2] == ["no contact"] * 2
    assert motions_of(dataset)[2].startswith("failed")


def test_points_beyond_a_limit_are_counted_in_runs() -> None:
    for _ in range(100):
        x, y = np.arange(30.0), RNG.normal(size=30)
        count, runs = exceeding(x, y, 0.7)
        assert count == sum(abs(value) > 0.7 for value in y)
        covered = {i for a, b in runs for i in range(int(a), int(b) + 1)}
        assert covered == {i for i in range(30) if abs(y[i]) > 0.7}
        assert all(b + 1 < a for (_, b), (a, _) in pairwise(runs))
    assert exceeding(np.arange(3.0), np.array([np.nan, 0.1, -5.0]), 1.0) == (1, [(2.0, 2.0)])
