"""How far a graze may be from where the tangent at the nearest motion has it, on its smooth side.

The value of the extremum is a quadratic function of the arc length, of which the search knows the values and the rates
at two places; the witness solves it.
"""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from lapjoint.orbits.branches.extremum_search import OnExtremum, _Search
from lapjoint.orbits.refinement import SAFETY


def bent(value: float, rate: float, bend: float, back: float) -> float:
    """What the search says at a value, having begun some arc length before."""
    search = object.__new__(_Search)
    there, before = value - rate * back + bend * back**2, rate - 2 * bend * back
    search._towards, search._first = True, (there, 1 / abs(before))
    return search._bent(SimpleNamespace(extremum=SimpleNamespace(value=value)), 1 / abs(rate))  # type: ignore[arg-type]


@pytest.mark.parametrize("seed", range(200))
def test_the_way_to_a_graze_is_as_much_longer_as_its_curve_bends(seed: int) -> None:
    """The tangent has it `way` ahead; from where the search began, the value has come nearer all the time."""
    rng = np.random.default_rng((91, seed))
    side, way, rate = rng.choice([-1, 1]), 10 ** rng.uniform(-7, -5), 10 ** rng.uniform(-5, 0)
    back = way * 10 ** rng.uniform(-1, 3)
    bend = rate * rng.uniform(-0.24 / way, 0.4 / max(way, back))
    true = min(root.real for root in np.roots([bend, rate, -rate * way]) if root.real > 0)
    found = bent(-side * rate * way, side * rate, side * bend, back)
    assert found == pytest.approx(abs(true / way - 1), rel=1e-6, abs=1e-9)


@pytest.mark.parametrize("seed", range(50))
def test_a_curve_that_turns_before_it_touches_has_no_graze(seed: int) -> None:
    rng = np.random.default_rng((92, seed))
    side, way, rate = rng.choice([-1, 1]), 10 ** rng.uniform(-7, -5), 10 ** rng.uniform(-5, 0)
    bend = -rate / way * rng.uniform(0.26, 5.0)  # the quadratic has no root from 1/4 on
    assert bent(-side * rate * way, side * rate, side * bend, way * 10 ** rng.uniform(-1, 3)) == np.inf


def test_what_is_left_is_all_of_the_way_where_it_touches_and_what_it_bends_where_not() -> None:
    touched, smooth = (SimpleNamespace(value=value, highest=True, stop=0) for value in (1e-9, -1e-9))
    assert OnExtremum(None, touched, 10.0, bent=0.5).left == pytest.approx(SAFETY * 1e-8)  # type: ignore[arg-type]
    for share in (0.0, 1e-3, np.inf):
        assert OnExtremum(None, smooth, 10.0, bent=share).left == pytest.approx(SAFETY * 1e-8 * share)  # type: ignore[arg-type]
