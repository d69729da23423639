"""Beyond a graze of a strongly unstable motion the curve goes on, where Newton's method from one point finds no motion.

The grazes are those at which branches of the paper's joint with a quarter of its damping were lost: some go on since
motions are looked for from several section points, and from others that leads to the motions of another branch.
"""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from finer_curve import family as lightly_damped

from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches import grazing
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.extremum_search import OnExtremum, on_extremum
from lapjoint.orbits.branches.extremum_shooting import by_stretches
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extremum
from lapjoint.orbits.branches.grazing import beyond_graze
from lapjoint.orbits.branches.passings import rates_of
from lapjoint.orbits.branches.value_errors import AIM
from lapjoint.orbits.newton import RESIDUAL

HERE = Path(__file__).parent
GRAZES = json.loads((HERE / "lost_at_grazes.json").read_text(encoding="utf-8"))
UNSTABLE = json.loads((HERE / "strongly_unstable.json").read_text(encoding="utf-8"))


@pytest.fixture(scope="module")
def family() -> Family:
    return lightly_damped()


def at_graze(family: Family, one: dict[str, Any]) -> tuple[Family, OnExtremum, float]:
    """The motion just before a graze by the self of the solver that has it, and the rate there."""
    motion, own = motion_from(one["motion"]), family.self_at(one["level"])
    assert motion is not None
    place = corrected(own, motion.value, own.adopted(motion.value, motion.point), motion.half_periods, fixed=True)
    assert place is not None
    mine = place.matching(Extremum(**one["extremum"]), one["duration"])
    assert mine is not None
    return own, OnExtremum(place, mine, 0.0), one["rate"]


@pytest.mark.parametrize("one", GRAZES["leads_on"])
def test_the_curve_goes_on_beyond_grazes_at_which_it_was_lost(
    family: Family, one: dict[str, Any], monkeypatch: pytest.MonkeyPatch
) -> None:
    """A motion with one contact more or less; the way back leads to where it came from."""
    own, graze, rate = at_graze(family, one)
    there, place = beyond_graze(own, graze, rate), graze.place
    assert there is not None
    assert there.place.orbit.residual <= RESIDUAL
    assert (there.extremum.value > 0) != (graze.extremum.value > 0)
    changed = np.subtract(there.place.closings, place.closings)
    assert np.flatnonzero(changed).tolist() == [graze.extremum.stop]
    assert abs(changed[graze.extremum.stop]) == 1
    back = by_stretches(own, there.place, there.extremum, graze.extremum.value, abs(rate))
    assert back is not None
    assert np.linalg.norm(back.place.chord(own, place)) <= 0.1 * np.linalg.norm(there.place.chord(own, place))
    assert back.place.value == pytest.approx(place.value, rel=AIM)
    monkeypatch.setattr(grazing, "by_stretches", lambda *_: None)
    assert beyond_graze(own, graze, rate) is None


@pytest.mark.parametrize("one", GRAZES["astray"])
def test_a_motion_that_lies_beyond_the_graze_of_another_branch_does_not_count(
    family: Family, one: dict[str, Any]
) -> None:
    """From several section points one is found, but the way back from there leads to another motion just before."""
    own, graze, rate = at_graze(family, one)
    beyond = -float(np.copysign(3e-5 * abs(rate), graze.extremum.value))
    there = by_stretches(own, graze.place, graze.extremum, beyond, abs(rate))
    assert there is not None
    back = by_stretches(own, there.place, there.extremum, graze.extremum.value, abs(rate))
    assert back is not None
    way = np.linalg.norm(there.place.chord(own, graze.place))
    assert np.linalg.norm(back.place.chord(own, graze.place)) > 0.5 * way
    assert beyond_graze(own, graze, rate) is None


def nearest_to_a_graze(family: Family, place: Place) -> tuple[Extremum, float]:
    """The extremum of a motion that is the nearest to zero, and its rate."""
    rates, there = rates_of(family, place).value, place.extrema
    ways = np.abs(np.divide(there.value, rates, out=np.full(rates.size, np.inf), where=rates != 0))
    k = int(np.argmin(ways))
    return there[k], float(abs(rates[k]))


@pytest.mark.parametrize("number", range(len(UNSTABLE)))
def test_it_finds_what_newtons_method_finds_from_one_point(family: Family, number: int) -> None:
    """The extremum may lie in any stretch, and the motion go on mirrored there."""
    value, section, count = UNSTABLE[number]
    place = corrected(family, value, motion_from((value, section, count)).point, count, fixed=True)
    assert place is not None
    extremum, rate = nearest_to_a_graze(family, place)
    target = extremum.value + 1e-5 * rate * (1 if extremum.value > 0 else -1)
    found = by_stretches(family, place, extremum, target, rate)
    known = on_extremum(family, place, extremum, target, rate)
    assert known is not None
    assert found is not None
    assert found.extremum.value == pytest.approx(target, abs=0.5 * abs(target))
    apart = float(np.linalg.norm(found.place.chord(family, known.place)))
    assert apart <= 2 * abs(found.extremum.value - known.extremum.value) / rate + 1e-7
