"""A bifurcation is restored from the motion in a file, whatever processor the file is from.

What closes to 1e-9 on one processor may miss by a little more on another where it has multipliers of thousands, and
then Newton's method moves it: it is the motion in the file all the same.  The motion is that at a fold of the paper's
joint with a quarter of its damping, 1e-5 of arc length from a graze, as `lapjoint branch` has it.
"""

from __future__ import annotations

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from finer_curve import family

from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.bifurcations import Located
from lapjoint.orbits.branches.restored import restored

FOLD = json.loads((Path(__file__).parent / "hardly_closes.json").read_text(encoding="utf-8"))
ROUNDED = 1e-12  # over the size of the motion: its multiplier makes 4e-9 of that


@pytest.mark.parametrize("seed", range(10))
@in_one_thread
def test_a_motion_that_hardly_closes_is_restored_as_it_is(seed: int) -> None:
    own, motion = family(), motion_from(FOLD["motion"])
    assert motion is not None
    rng = np.random.default_rng((33, seed))
    coordinates = motion.point.coordinates
    moved = coordinates + ROUNDED * np.abs(coordinates).max(axis=1, keepdims=True) * rng.normal(size=coordinates.shape)
    motion = motion._replace(point=replace(motion.point, coordinates=moved))
    one = restored(own, Bifurcation("fold", motion.value, np.inf, 0, motion=motion))
    assert one is not None
    assert isinstance(one.found, Located)
    assert one.found.place.value == pytest.approx(motion.value, rel=1e-9)
    assert abs(one.found.place.tangent[-1]) < 1e-5
