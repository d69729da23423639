"""Steps of the march against exact arithmetic: none is longer than its bound allows, and none is much shorter."""

from __future__ import annotations

from fractions import Fraction

import numpy as np
import pytest

from analytic.march.step_bound import first_root_of_bound

MOST = 1e3  # s, longest step


def cubic(coefficients: tuple[float, ...], t: float) -> Fraction:
    """h + h1 t + h2 t^2/2 + b3 t^3/6, exactly."""
    h, h1, h2, b3 = map(Fraction, coefficients)
    x = Fraction(t)
    return h + x * (h1 + x * (h2 / 2 + x * b3 / 6))


def drawn(decades: float) -> list[tuple[float, ...]]:
    """Cubics whose coefficients spread over some decades around 1; some coefficients are 0."""
    rng = np.random.default_rng(11)
    size = 10 ** rng.uniform(-decades, decades, (150, 4)) * (rng.random((150, 4)) > [0.1, 0.1, 0.1, 0.0])
    size[:, 0] *= -1
    size[:, 1:3] *= rng.choice([-1.0, 1.0], (150, 2))
    return [tuple(row) for row in size.tolist()]


@pytest.mark.parametrize("decades", [1, 3, 10])
def test_a_step_ends_before_the_first_root_and_not_long_before(decades: float) -> None:
    for one in drawn(decades):
        found = first_root_of_bound(*one, MOST)
        assert 0 <= found <= MOST
        steps = found * np.linspace(0, 1, 41)[1:] if found > 0 else []
        assert all(cubic(one, t) < 0 for t in steps), one
        assert found == MOST or cubic(one, found * (1 + 1e-3) + 1e-300) >= 0, one


def test_a_step_ends_where_the_cubic_touches_zero_and_falls_again() -> None:
    """A maximum just below 0 is stepped over, one at 0 and one just above it are not."""
    root = 1.0  # (t - 1)^2 (t - 9), at most 0 up to 9, less a level
    for level, last in ((0.0, root), (1e-6, 9.0), (-1e-6, root)):
        found = first_root_of_bound(-9.0 - level, 19.0, -22.0, 6.0, MOST)
        assert last * (1 - 2e-3) <= found <= last * (1 + 1e-6), level


@pytest.mark.parametrize(
    "one", [(0.0, 0.0, 0.0, 1e-300), (0.0, 1.0, 0.0, 1.0), (0.0, 0.0, -1.0, 1.0), (0.0, -1.0, 0.0, 1.0)]
)
def test_a_cubic_that_starts_at_zero_steps_to_its_next_root(one: tuple[float, ...]) -> None:
    _, h1, h2, b3 = one
    falls = h1 < 0 or (h1 == 0 and h2 < 0)
    exact = (6 / b3) ** 0.5 * (-h1) ** 0.5 if h1 < 0 else 3 * -h2 / b3
    found = first_root_of_bound(*one, MOST)
    assert exact * (1 - 1e-3) <= found <= exact if falls else found <= 1e-12


@pytest.mark.parametrize("h", [0.0, -1e-320, -1e-200, -1e-30])
@pytest.mark.parametrize("rate", [0.0, 1e-250, -1e-250])
@pytest.mark.parametrize("b3", [1e-300, 1.0])
def test_numbers_whose_products_vanish_make_no_step_too_long(h: float, rate: float, b3: float) -> None:
    """A bar at rest at its gap, which a force begins to push: products of its derivatives are below all numbers."""
    for bend in (0.0, 1e-250, -1e-250):
        found = first_root_of_bound(h, rate, bend, b3, MOST)
        assert 0 <= found <= MOST
        assert cubic((h, rate, bend, b3), found * 0.999) <= 0
