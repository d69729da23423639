"""Curves of random joints are followed through all changes of their contact sequences, and their motions are true."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
import pytest
from galerkin_arcs import GalerkinArcs, before_first_graze, marched, towards_graze

from lapjoint.orbits.branches.bifurcations import Stretch
from lapjoint.orbits.branches.continuation import End, follow
from lapjoint.orbits.branches.sequence_changes import SequenceChange

SEED, FEW, MANY, MOST = 46, 12, 100, 600
FARTHEST = 2.0
"""Amplitude up to which a curve is followed, over that of the first graze."""
MARCHED, GROWING = 2, 30.0
"""Number of motions of a curve that are marched, and the largest multiplier of those: a march leaves others."""


@dataclass
class Followed:
    """A curve from the motion without contact on."""

    graze: float
    """The first graze in closed form."""
    stretches: list[Stretch] = field(default_factory=list)
    changes: list[SequenceChange] = field(default_factory=list)
    end: str = "points"


def followed(seed: int, index: int) -> Followed:
    """The curve of a random joint with one to four stops."""
    graze, resolution, free = before_first_graze(seed, index, FARTHEST)
    found = Followed(graze)
    for step in follow(towards_graze(resolution, free)):
        if isinstance(step, End):
            found.end = step.reason
            break
        if isinstance(step, SequenceChange):
            found.changes.append(step)
        else:
            found.stretches.append(step)
        if len(found.stretches) > MOST:
            break
    return found


def check(found: Followed, rng: np.random.Generator) -> None:
    """Fail unless the first graze is that of the closed form, and marches from motions of the curve come back."""
    first = found.changes[0]
    assert first.kind == "birth"
    assert first.value == pytest.approx(found.graze, rel=1e-9)
    assert all(change.offset <= 1e-8 * found.graze for change in found.changes if change.after is not None)
    steady = [one.end for one in found.stretches if np.abs(one.end.multipliers).max() < GROWING]
    for i in rng.permutation(len(steady))[:MARCHED].tolist():
        point = steady[i]
        arcs, n = point.problem.resolution.arcs(point.value), point.coordinates
        assert isinstance(arcs, GalerkinArcs)
        apart = (marched(arcs, point) - point.u[:n]) / point.scale[:n]
        assert float(np.linalg.norm(apart)) < 1e-4


@pytest.mark.parametrize(
    ("seed", "count"),
    [
        pytest.param(SEED, FEW, marks=pytest.mark.thorough),
        pytest.param(SEED + 1, MANY, marks=pytest.mark.slow),
    ],
)
def test_random_joints_are_followed_through_all_their_contacts(seed: int, count: int) -> None:
    ends = []
    for index in range(count):
        found = followed(seed, index)
        check(found, np.random.default_rng(index))
        ends.append(found.end)
    assert sum(end in ("boundary", "points") for end in ends) >= 0.97 * count, ends
