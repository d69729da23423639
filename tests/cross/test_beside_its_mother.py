"""Another solver finds what lies on a branch that is nearer to the one from which it springs than solvers are.

The motion is one of a file of `lapjoint branch` for the paper's joint with a quarter of its damping, at a graze of a
branch of two periods: it misses to repeat in one by 1.5e-4 of its size, and finite elements differ by 2.5e-3.
"""

from __future__ import annotations

import json
from pathlib import Path

import numpy as np
import pytest
from finer_curve import HIGH, LOW, family

import fe_lapjoint
from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns import FREQUENCY
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches.by_another_solver import by_another
from lapjoint.orbits.branches.carrier import Carrier
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_along import motion_at
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.springing import spring_of, springing

SAID = json.loads((Path(__file__).parent / "beside_its_mother.json").read_text(encoding="utf-8"))
VALUE, ERROR = 110.0301795394, 2.64e-4  # rad/s; regression: by analytic selves, as the file has it
FINER = 3  # selves of the finite elements, up to 137 elements


@pytest.mark.thorough
@in_one_thread
def test_a_graze_beside_where_the_branch_springs_is_found_by_finite_elements() -> None:
    own, motion = family(), motion_from(SAID["motion"])
    one = restored(own, Bifurcation(SAID["kind"], VALUE, ERROR, 0, SAID["stop"], motion=motion))
    assert one is not None
    place = motion_at(one.found)
    other = Family(fe_lapjoint.Solver(), own.problem_at, FREQUENCY, LOW, HIGH)
    spring, carrier = spring_of(one.family, place), Carrier(one.family, place)
    assert spring is not None
    (there,) = springing(carrier, spring, other)
    assert not there.new.repeats_in_half
    from_there = float(np.linalg.norm(there.its.chord(other, there.expected(carrier))))
    carried = float(np.linalg.norm(there.its.chord(other, spring[1].seen_by(other))))
    assert from_there < 0.1 * carried  # distances from where it springs tell what those between solvers do not
    found = by_another(one, other, FINER)
    assert found is not None
    assert abs(found.value - VALUE) <= found.error + ERROR
    assert found.error <= 1e-5 * VALUE
