"""A branch that springs from another ends there, and is not followed along the other, whose motions repeat sooner.

The motion is one of the paper's joint with a quarter of its damping, of four periods, so near to the branch from which
its own springs that one step leads to motions told from that one's by less than a ten-thousandth of their size.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from finer_curve import family

from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.switching import switched

BESIDE = motion_from(json.loads((Path(__file__).parent / "beside_its_mother.json").read_text(encoding="utf-8")))
AROUND = Limits(most=30)
CLOSE = json.loads((Path(__file__).parent / "springs_beside_a_graze.json").read_text(encoding="utf-8"))
SOONER = 1e-6  # of its size: what a motion that repeats sooner misses at most, by far


def missed(place: Place) -> float:
    """By how much a motion misses to repeat in half the time, over its size."""
    assert place.missed is not None
    return float(np.linalg.norm(place.missed))


def test_a_branch_ends_at_the_one_from_which_it_springs() -> None:
    own = family()
    start = corrected(own, BESIDE.value, own.adopted(BESIDE.value, BESIDE.point), BESIDE.half_periods)
    assert start is not None
    for place in (start, start.turned()):  # both of its ends are near
        run = follow(own, place, AROUND)
        assert run.end == "bifurcation"
        assert all(missed(one) > SOONER for one in run.places)
        assert abs(run.places[-1].value - BESIDE.value) < 1e-3


@pytest.mark.parametrize("said", CLOSE)
def test_a_branch_that_soon_ends_where_its_mother_grazes_is_found(said: dict[str, Any]) -> None:
    """Two flips of a diagram were told of as followed by nothing; both branches end at grazes that elements confirm."""
    motion = motion_from(said["motion"])
    assert motion is not None
    flip = restored(family(), Bifurcation("flip", motion.value, np.inf, 0, motion=motion))
    assert flip is not None
    assert flip.springing is not None
    found = [switched(flip.family, flip.springing, sign=sign) for sign in (1, -1)]  # one way at least leads to it
    runs = [follow(flip.family, new, AROUND) for new in found if new is not None]
    ends = [run.grazes[-1].value for run in runs if run.end == "bifurcation" and run.grazes]
    assert ends
    assert ends == pytest.approx([said["graze_of_its_mother"]] * len(ends), rel=1e-7)
