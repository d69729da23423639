"""A flip is located by the multiplier that passes -1, be another one beside it.

det(1 + M) is the product of both distances: where another multiplier is 3e-5 from -1, it is below 1e-9 while the one
that passes is still as far off.  A joint of the population had two flips 3e-5 of their number off so.
"""

from __future__ import annotations

import numpy as np
import pytest
from made_map import Made, made_problem

from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches.bifurcations import Located, between
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family

AMPLITUDE, LOW, HIGH = "base_motion.amplitude", 0.9, 1.1


@pytest.mark.parametrize("seed", range(25))
def test_it_is_where_that_one_passes(seed: int) -> None:
    rng = np.random.default_rng((101, seed))
    rate, at = rng.choice([-1, 1]) * 10 ** rng.uniform(-1, 1), 1 + rng.uniform(-0.002, 0.002)
    beside = rng.choice([-1, 1]) * 10 ** rng.uniform(-5, -3)

    def blocks(p: float) -> list[np.ndarray]:
        return [np.array([[-1 + rate * (p - at)]]), np.array([[-1 + beside]])]

    grid = Grid(made_problem(LOW), (Axis(AMPLITUDE, (LOW, HIGH)),))
    family = Family(Made(blocks), lambda value: grid.with_values((value,)), AMPLITUDE, LOW, HIGH)
    ends = [corrected(family, value, family.at(value).map.initial(), 2, fixed=True) for value in (0.99, 1.01)]
    first, last = (end if end is None or end.tangent[-1] > 0 else end.turned() for end in ends)
    assert first is not None
    assert last is not None
    (one,) = between(family, first, last, (None, None))
    assert isinstance(one, Located)
    assert one.kind == "flip"
    assert one.place.value == pytest.approx(at, abs=1e-8 / abs(rate) + 2e-9)
