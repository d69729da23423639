"""Options of the benchmarks, and ratios between those of a group at the end."""

from __future__ import annotations

import pytest


def pytest_addoption(parser: pytest.Parser) -> None:
    parser.addoption("--curve-points", type=int, default=250, help="Points of the curve, up to 5000 rad/s.")
    parser.addoption("--fe-points", type=int, default=20, help="Points of the finite element curve.")
    parser.addoption("--play-minutes", type=float, default=4.0, help="Duration of random play with a page.")


@pytest.fixture
def curve_points(request: pytest.FixtureRequest) -> int:
    return int(request.config.getoption("--curve-points"))


@pytest.fixture
def fe_points(request: pytest.FixtureRequest) -> int:
    return int(request.config.getoption("--fe-points"))
