"""The convergence figure recovers the order of made-up answers."""

from __future__ import annotations

import math

import numpy as np
import pytest

from lapjoint.answers.observed_order import fitted_order
from lapjoint.figures import plot_convergence

MESHES = (8, 16, 32, 64, 128)


def numbers(order: float, size: float = 0.1) -> dict[int, float]:
    return {n: 2.0 * (1 + size * (n / 8) ** -order) for n in MESHES}


@pytest.mark.parametrize("order", [2, 4])
def test_the_order_of_made_up_answers_is_found(order: int) -> None:
    line = plot_convergence(numbers(order), reference=2.0, label="made up").lines[0]
    np.testing.assert_array_equal(line.get_xdata(), MESHES)
    np.testing.assert_allclose(line.get_ydata(), [0.1 * (n / 8) ** -order for n in MESHES], rtol=1e-7)
    assert line.get_label() == f"made up, order {order:.2f}"


def test_errors_of_rounding_are_drawn_and_not_fitted() -> None:
    answers = {n: 1 + max(1e-6 * (n / 8) ** -4, 1e-10) for n in MESHES}
    line = plot_convergence(answers, reference=1.0, floor=2e-10).lines[0]
    assert len(line.get_xdata()) == len(MESHES)
    assert line.get_label() == "order 4.00"


def test_without_a_reference_the_finest_is_the_reference_and_not_drawn() -> None:
    line = plot_convergence(numbers(4)).lines[0]
    np.testing.assert_array_equal(line.get_xdata(), MESHES[:-1])
    finest = numbers(4)[128]
    np.testing.assert_array_equal(line.get_ydata(), [abs(numbers(4)[n] / finest - 1) for n in MESHES[:-1]])
    assert str(line.get_label()).startswith("against 128, order 4.0")


def test_answers_are_reduced_to_a_number() -> None:
    answers = {n: [value] for n, value in numbers(2).items()}
    by_object = plot_convergence(answers, quantity=lambda answer: answer[0], reference=2.0).lines[0]
    by_number = plot_convergence(numbers(2), reference=2.0).lines[0]
    np.testing.assert_array_equal(by_object.get_ydata(), by_number.get_ydata())


def test_several_studies_differ_and_share_a_slope() -> None:
    axes = plot_convergence(numbers(2), reference=2.0, order=2, label="one")
    plot_convergence(numbers(4), axes, reference=2.0, order=2, label="other")
    studies = [line for line in axes.lines if str(line.get_label()).startswith(("one", "other"))]
    assert len({(line.get_color(), line.get_linestyle(), str(line.get_marker())) for line in studies}) == 2
    slopes = [line for line in axes.lines if line.get_label() == "reference, order 2"]
    assert len(slopes) == 1
    assert fitted_order(*map(np.asarray, slopes[0].get_data())) == pytest.approx(2.0)


def test_an_answer_without_error_is_no_point_of_the_line() -> None:
    line = plot_convergence({8: 1.1, 16: 1.0, 32: 1.01}, reference=1.0, order=1).lines[0]
    assert np.isnan(np.asarray(line.get_ydata())[1])
    assert math.isnan(fitted_order(np.array([8.0]), np.array([0.1])))
