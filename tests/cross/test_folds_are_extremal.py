"""Where a branch is said to fold, its number is extremal: judged by motions beside the fold, not by their tangents.

A tangent comes from the derivative of a march.  Where that was a little off, a branch seemed to turn just beside where
it springs, and another solver, for which next to nothing is left of a fold there, agreed.
"""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr
from branch_witness import drawn

from lapjoint import branch, paper_joint
from lapjoint.campaigns import FREQUENCY
from lapjoint.campaigns.branch_dataset import KINDS
from lapjoint.campaigns.branch_parts import family_of
from lapjoint.campaigns.confirm_plan import confirm_plan
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_along import motion_at
from lapjoint.orbits.branches.restored import restored

AWAY = (1e-3, 1e-4, 1e-5, 1e-6)
"""Arc lengths from a fold at which the number is looked at, the nearest as far as rounding lets it be told."""
TOLD = 1e-13
"""Least change of the number over its scale that is told."""
SEED, JOINTS, MANY = 78, range(30), range(30, 400)
MODES = 6


def is_extremal(family: Family, fold: Place) -> bool | None:
    """Whether the number is on one side of a fold's at motions on both sides of it; None where none can be told."""
    told = None
    for length in AWAY:
        changes = []
        for step in (length, -length):
            value, guess = fold.moved(family, step * fold.tangent)
            there = corrected(family, value, guess, fold.count)
            if there is not None and there.closings == fold.closings:
                changes.append((there.value - fold.value) / family.scale(fold.value))
        if len(changes) == 2 and min(map(abs, changes)) > TOLD:
            told = changes[0] * changes[1] > 0
            if told:
                break
    return told


def folds(found: xr.Dataset) -> list[bool | None]:
    """Whether the number is extremal at each fold of a branch."""
    if not (found.bifurcation_kind.values == KINDS.index("fold")).any():
        return []
    plan, said = confirm_plan(found, "fe", {}), list[bool | None]()
    own = family_of(plan.branches.at(0))
    for row in plan.rows:
        one = restored(own, row.bifurcation) if row.kind == "fold" else None
        if one is not None and one.found is not None:
            said.append(is_extremal(one.family, motion_at(one.found)))
    return said


def judge(indices: range) -> int:
    """How many folds of random joints there are at which the number is extremal; none may be one where it is not."""
    count = 0
    for index in indices:
        one = drawn(SEED, index)
        found = branch(one.problem, one.path, one.low, one.high, options={"n_modes": MODES}, max_points=300, effort=300)
        said = folds(found)
        assert False not in said, index
        count += said.count(True)
    return count


@in_one_thread
def test_a_branch_does_not_fold_beside_where_it_springs() -> None:
    """The lightly damped joint's motion breaks its symmetry at 221.99618 rad/s, and the new one folds at 222.00058."""
    joint = paper_joint(angular_frequency=222.0, damping_ratio=0.02)
    found = branch(joint, FREQUENCY, 221.98, 222.02, starts=0)
    values = found.bifurcation_value.values[found.bifurcation_kind.values == KINDS.index("fold")]
    assert values == pytest.approx(np.array([222.0005778]), abs=1e-6)
    assert folds(found) == [True]


@in_one_thread
def test_numbers_are_extremal_at_folds_of_random_joints() -> None:
    assert judge(JOINTS)


@pytest.mark.slow
@in_one_thread
def test_numbers_are_extremal_at_folds_of_many_random_joints() -> None:
    assert judge(MANY)
