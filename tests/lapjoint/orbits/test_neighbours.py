"""A bifurcation is not taken for its neighbour by a finer solver, however close that is.

The motions are those of a file of `lapjoint branch` for the paper's joint with a quarter of its damping, of which each
bifurcation had the number of a neighbour, with a small error: finite elements had them elsewhere, or not.
"""

from __future__ import annotations

import json
from dataclasses import dataclass, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from finer_curve import family

from lapjoint.answers.branches import Bifurcation
from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.one_thread import in_one_thread
from lapjoint.orbits.branches import grazing
from lapjoint.orbits.branches.coinciding import doubted
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.found_along import directly, motion_at
from lapjoint.orbits.branches.listing import Listed, among
from lapjoint.orbits.branches.resolving import asked_again
from lapjoint.orbits.branches.restored import restored
from lapjoint.orbits.branches.run import Graze
from lapjoint.orbits.branches.value_errors import stated

MOTIONS = json.loads((Path(__file__).parent / "neighbours.json").read_text(encoding="utf-8"))

BESIDE_ITS_MOTHER = 682.930386768  # rad/s; regression: the self with 54 modes, along the curve of its own branch


def restored_from(own: Family, said: dict[str, Any]) -> Listed:
    """One of the file, before it has an error."""
    motion = motion_from(said["motion"])
    assert motion is not None
    one = restored(own, Bifurcation(said["kind"], motion.value, np.inf, 0, said["stop"], motion=motion))
    assert one is not None
    return one


@dataclass(frozen=True)
class On:
    """A motion at a graze, as far along a line."""

    at: float
    value: float = 0.0
    left: float = 1e-6

    @property
    def extremum(self) -> Any:
        """As deep as any."""
        return SimpleNamespace(value=1e-12)

    @property
    def place(self) -> Any:
        """What knows the way from another one."""
        return SimpleNamespace(at=self.at, chord=lambda _, other: np.array([self.at - other.at]))


@pytest.mark.parametrize(
    ("way", "apart", "back", "same"),
    [
        (5e-6, 1e-3, 5e-6, True),  # so near that it is not asked
        (1e-4, 1e-6, 1e-4, True),  # the numbers agree: several branches meet, and it leads to another one
        (9e-5, 2e-5, 0.0, True),  # the way across it leads back
        (9e-5, 2e-5, 9e-5, False),  # it leads to the neighbour's other side
        (3e-4, 2e-5, 1e-8, True),
        (9e-5, 2e-5, None, True),  # nothing is found there
        (3e-4, 2e-5, None, False),
    ],
)
def test_two_grazes_that_are_close_together_are_told_by_the_way_across(
    way: float, apart: float, back: float | None, same: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Two of a stop lay 9e-5 of arc length apart, and their numbers 5e-6: one had the other's, to 6e-11."""
    there = None if back is None else On(back)
    monkeypatch.setattr(grazing, "on_extremum", lambda *_, patiently: there if patiently else None)
    family: Any = None
    mine: Any = On(0.0)
    other: Any = On(way, apart)
    assert grazing._is_same(family, mine, other, 1.0) == same


@in_one_thread
def test_a_graze_has_the_contacts_of_one_of_its_sides() -> None:
    """A stop is touched seven times before it, and eight times beyond; at the next one it is six times."""
    one = restored_from(family(), MOTIONS["graze_of_other_contacts"])
    assert isinstance(one.found, Graze)
    stop, finer, closings = one.found.stop, one.family, motion_at(one.found).closings
    assert closings[stop] == 7
    for _ in range(3):
        known = finer.finer(one.found.value)
        assert known is not None
        finer = known[1]
        again = directly(one.found)(finer, motion_at(one.found))
        assert again is None or again.place.closings[stop] in (7, 8)


@in_one_thread
def test_a_graze_of_a_branch_near_the_one_from_which_it_springs_is_not_taken_for_that_ones() -> None:
    """Newton's method leads finer solvers from its motion to one that repeats sooner, which grazes 3e-6 beside it."""
    one = restored_from(family(), MOTIONS["graze_near_its_mother"])
    assert isinstance(one.found, Graze)
    assert not motion_at(one.found).repeats_in_half
    found = stated(one.family, motion_at(one.found), one.found.value, directly(one.found, one.family))
    assert abs(found.value - BESIDE_ITS_MOTHER) <= found.error


@pytest.mark.thorough
@in_one_thread
def test_what_two_bifurcations_would_be_is_the_nearer_one() -> None:
    """Of two flips of a branch a finer solver has one where it looks for both."""
    own = family()
    both = [restored_from(own, said) for said in MOTIONS["flips_that_become_one"]]
    found = [asked_again(among(one, both)).bifurcation for one in both]
    assert not np.isfinite(found[0].error)
    assert found[1].value == pytest.approx(167.6591961, rel=1e-7)
    assert found[1].error <= 1e-5 * found[1].value


@in_one_thread
@pytest.mark.parametrize(
    ("pair", "coincide"),
    [
        ("one_graze_from_either_side", True),
        ("two_grazes_of_a_short_branch", False),
        ("two_folding_grazes", False),
        ("two_grazes", False),
        ("two_flips", False),
    ],
)
def test_of_two_bifurcations_that_a_finer_solver_has_at_one_motion_one_has_no_error(pair: str, coincide: bool) -> None:
    """Some are nearer to each other than its errors, and stay apart."""
    own = family()
    both = [with_its_error(restored_from(own, said)) for said in MOTIONS[pair]]
    found = [np.isfinite(one.bifurcation.error) for one in doubted(both)]
    assert found.count(False) == coincide


def with_its_error(one: Listed) -> Listed:
    """The same as its branch has it."""
    assert one.found is not None
    known = stated(one.family, motion_at(one.found), one.found.value, directly(one.found, one.family))
    return replace(one, bifurcation=replace(one.bifurcation, value=known.value, error=known.error), sure=known.sure)
