"""Bifurcations in hairpins beside a graze are found by finer selves of the solver that have the graze elsewhere.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping: at a graze,
and beside it by the coarsest self, where no finer one has a bifurcation.  The witness is the curve of a finer self,
followed from its own motion at the graze.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest

import analytic
from lapjoint import paper_joint
from lapjoint.answers.branches import Bifurcation, MotionThere
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.listing import listed
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Limits

HAIRPINS = json.loads((Path(__file__).parent / "hairpins.json").read_text(encoding="utf-8"))
LOW, HIGH = 100.0, 5000.0  # rad/s
LENGTH = 2e-3  # arc length within which the hairpins turn
WITNESS = 3  # as many steps finer than the coarsest self
AIM = 1e-5  # error over the frequency


def family() -> Family:
    grid = Grid(paper_joint(damping_ratio=0.02), (Axis(FREQUENCY, (LOW, HIGH)),))
    return Family(analytic.Solver(), lambda value: grid.with_values((value,)), FREQUENCY, LOW, HIGH)


def by_the_curve(graze: MotionThere, kind: str) -> list[float]:
    """Where a finer self has bifurcations of a kind on its own curve, both ways from its motion at the graze."""
    own = family()
    for _ in range(WITNESS):
        finer = own.finer(graze.value)
        assert finer is not None
        own = finer[1]
    start = corrected(own, graze.value, own.adopted(graze.value, graze.point), graze.half_periods)
    assert start is not None
    runs = [follow(own, place, Limits(most=80, length=LENGTH)) for place in (start, start.turned())]
    found = [one.bifurcation for run in runs for one in listed(own, run, errors=False)]
    return [one.value for one in found if one.kind == kind]


@pytest.mark.parametrize(
    ("hairpin", "which"), [(i, k) for i, one in enumerate(HAIRPINS) for k in range(len(one["bifurcations"]))]
)
def test_a_bifurcation_in_a_hairpin_is_found_from_the_graze_beside_it(hairpin: int, which: int) -> None:
    graze = motion_from(HAIRPINS[hairpin]["beside_a_graze"])
    said: dict[str, Any] = HAIRPINS[hairpin]["bifurcations"][which]
    motion = motion_from(said["motion"])
    own = family()
    known = Bifurcation(said["kind"], motion.value, float("inf"), 0, motion=motion)
    one = restored(own, known)
    assert one is not None
    found = by_another(one, own, WITNESS - 1)
    truth = by_the_curve(graze, said["kind"])
    assert truth
    assert found is not None
    assert min(abs(found.value - value) for value in truth) <= found.error <= AIM * found.value
