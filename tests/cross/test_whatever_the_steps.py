"""What lies within one step of a branch is seen wherever the step begins and ends.

The symmetric motion of the paper's joint with a quarter of its damping, as few modes have it, has a torus at 174.2295
rad/s, and between 174.3747 and 174.3877 rad/s another one, two breakings of its symmetry, and a third one, which leave
the numbers of its multipliers outside the circle as they were.  Two branches spring there, with forty bifurcations.
The witness is the curve in steps that are ever shorter.
"""

from __future__ import annotations

import json
from functools import cache
from pathlib import Path

import numpy as np
import pytest
from finer_curve import family

from lapjoint.campaigns.branch_parts import motion_from
from lapjoint.orbits.branches.bifurcations import NotLocated, between
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.locating import Kind

BEFORE = motion_from(json.loads((Path(__file__).parent / "before_two_tori.json").read_text(encoding="utf-8")))
FIRST, LAST = (173.8, 174.34), (174.3878, 174.3887)
"""rad/s, where a step begins and ends; a graze is at 174.3890."""
CAME, GONE = (0.1, 0.7), (1e-4, 2.5e-4)
"""rad/s from where the step before came, and to where the next one leads."""
SHORT = np.concatenate([np.linspace(173.0, 174.36, 60), np.linspace(174.361, 174.38895, 150)])
"""rad/s, the numbers at short steps."""
AGAIN = 1e-7
"""rad/s, between a bifurcation by long steps and by short ones."""


@cache
def maps() -> Family:
    """The period maps of the joint."""
    return family()


@cache
def by_short_steps() -> list[Place]:
    """The curve, from far below the tori to beyond them."""
    start = corrected(maps(), BEFORE.value, maps().adopted(BEFORE.value, BEFORE.point), BEFORE.half_periods, fixed=True)
    assert start is not None
    down, up = [start], [start]
    for way, values in ((down, SHORT[SHORT < start.value][::-1]), (up, SHORT[SHORT > start.value])):
        for value in values:
            way.append(place_from(way[-1], float(value)))
    return [*down[:0:-1], *up]


def place_from(near: Place, value: float) -> Place:
    """The motion at a number, from one near it, with its tangent up the range."""
    found = corrected(maps(), value, maps().adopted(value, near.point), near.count, fixed=True)
    assert found is not None
    return found if found.tangent[-1] > 0 else found.turned()


def place_at(value: float) -> Place:
    """The motion at any number."""
    return place_from(min(by_short_steps(), key=lambda place: abs(place.value - value)), value)


@cache
def truth() -> tuple[tuple[Kind, float], ...]:
    """The bifurcations by short steps."""
    places = [place for place in by_short_steps() if FIRST[0] <= place.value <= LAST[1]]
    found = list[tuple[Kind, float]]()
    for i in range(len(places) - 1):
        around = places[i - 1] if i else None, places[i + 2] if i + 2 < len(places) else None
        for one in between(maps(), places[i], places[i + 1], around):
            assert not isinstance(one, NotLocated)
            found.append((one.kind, one.place.value))
    return tuple(found)


def test_short_steps_see_five() -> None:
    kinds = [kind for kind, _ in truth()]
    assert kinds == ["neimark-sacker", "neimark-sacker", "symmetry breaking", "symmetry breaking", "neimark-sacker"]


@pytest.mark.parametrize("seed", range(40))
def test_none_is_overlooked_wherever_a_step_begins_and_ends(seed: int) -> None:
    """Each is found, or lies in a part of which it is told that it is not resolved: a finer solver follows that."""
    rng = np.random.default_rng((99, seed))
    first, last = rng.uniform(*FIRST), rng.uniform(*LAST)
    around = place_at(first - rng.uniform(*CAME)), place_at(last + rng.uniform(*GONE))
    found = list(between(maps(), place_at(first), place_at(last), around))
    parts = [sorted((one.first, one.last)) for one in found if isinstance(one, NotLocated)]
    located = [one for one in found if not isinstance(one, NotLocated)]
    for kind, value in truth():
        if first < value < last:
            same = any(one.kind == kind and abs(one.place.value - value) <= AGAIN for one in located)
            assert same or any(low <= value <= high for low, high in parts), (kind, value)
    values = np.array([value for _, value in truth()])
    assert all(np.abs(values - one.place.value).min() <= AGAIN for one in located)
