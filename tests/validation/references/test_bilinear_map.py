"""The closed form of motions of one contact against marches of the rigid bar that it describes."""

from __future__ import annotations

import numpy as np
import pytest
from contact_bars import draw

from validation.references.bilinear_map import BilinearMap
from validation.references.rigid_bar_orbits import linearised

CLOSES = 1e-10  # of the motion: the closed form is as exact as the march
DIFFERENCES = 1e-5  # of the matrix: what its differences are off by


@pytest.mark.parametrize(("seed", "kind"), [(1, "symmetry breaking"), (4, "symmetry breaking"), (5, "neimark-sacker")])
def test_a_motion_of_one_contact_closes_and_has_its_multipliers(seed: int, kind: str) -> None:
    drawn = draw(seed, kind)
    for motion in (drawn.low, drawn.at, drawn.high):
        bar, y = drawn.bar(motion), drawn.map.start(motion)
        end, matrix = linearised(bar, y)
        assert end.y == pytest.approx(y, rel=0, abs=CLOSES * np.abs(y).max())
        assert len(end.contacts) == len(bar.stops)
        over = 2 if drawn.map.mirrored else 1  # those of half a period, squared
        known = sorted(abs(one) ** over for one in motion.multipliers)
        assert sorted(np.abs(np.linalg.eigvals(matrix))) == pytest.approx(known, rel=DIFFERENCES)


def test_bifurcations_lie_where_multipliers_pass_the_circle() -> None:
    for seed, kind in ((1, "symmetry breaking"), (5, "neimark-sacker")):
        drawn = draw(seed, kind)
        assert abs(drawn.at.multipliers[0]) == pytest.approx(1.0, abs=1e-10)
        assert abs(drawn.stable.multipliers[0]) < 1 < abs(drawn.unstable.multipliers[0])


def test_the_reader_of_a_bar_takes_one_stop_or_two_equal_ones() -> None:
    maps = [BilinearMap.of_bar(one.bar(one.at)) for one in (draw(1, "symmetry breaking"), draw(5, "neimark-sacker"))]
    assert [one.mirrored for one in maps] == [True, False]
    assert [one.free.count for one in maps] == [1, 2]
