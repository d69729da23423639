"""What the search knows of an orbit is right, and the case tells when it is not."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from lapjoint.orbits import approach, compiled_watch
from lapjoint.orbits.watch import SegmentWatch
from lapjoint.problem import FloatArray
from validation.cases import orbit_watch
from validation.verdict import Check, Criterion, Verdict


@pytest.fixture(scope="module")
def uneven() -> orbit_watch.Known:
    found = orbit_watch.known(*orbit_watch.ORBITS[3])
    assert found is not None
    return found


def disagree(items: Iterable[Check | Criterion]) -> list[str]:
    return [item.name for item in items if item.verdict is Verdict.DISAGREE]


def test_the_watch_over_an_orbit_agrees_with_the_motion(uneven: orbit_watch.Known) -> None:
    for question in (orbit_watch.derivative, orbit_watch.switches, orbit_watch.distances, orbit_watch.rule):
        assert disagree(question(uneven)) == []


def test_distances_that_are_too_large_are_noticed(uneven: orbit_watch.Known, monkeypatch: pytest.MonkeyPatch) -> None:
    watch = uneven.orbit.watch
    assert isinstance(watch, SegmentWatch)
    larger = replace(watch.intervals, distance=1.001 * watch.intervals.distance)
    monkeypatch.setattr(watch, "intervals", larger)
    assert disagree(orbit_watch.distances(uneven))


def test_an_orbit_out_of_reach_is_kept_from_its_stops_by_the_rule(monkeypatch: pytest.MonkeyPatch) -> None:
    it = orbit_watch.known(*orbit_watch.ORBITS[6])
    assert it is not None
    assert disagree(orbit_watch.out_of_reach(it)) == []
    monkeypatch.setattr(approach, "LINEAR", 1.1)
    assert disagree(orbit_watch.out_of_reach(it))


def test_a_chord_that_is_taken_for_exact_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    assert disagree(orbit_watch.chords()) == []
    sound = compiled_watch.terms_at_points

    def last_one_missed(*arguments: Any) -> tuple[FloatArray, FloatArray]:
        terms, misses = sound(*arguments)
        misses[:, -1] = 0.0
        return terms, misses

    monkeypatch.setattr(orbit_watch, "terms_at_points", last_one_missed)
    assert disagree(orbit_watch.chords())


def test_intervals_follow_each_other(uneven: orbit_watch.Known) -> None:
    start, end = np.nanmin(orbit_watch.edges(uneven), axis=1)
    np.testing.assert_allclose(start[1:], end[:-1], rtol=0, atol=1e-9 * uneven.length)


def test_a_motion_that_is_no_fixed_point_of_the_map_is_noticed(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(orbit_watch, "find_orbit", lambda *_: None)
    result = orbit_watch.run("quick", lambda _: None)
    *orbits, few = sorted(disagree(result.criteria), key=lambda name: "motions that repeat" in name)
    assert len(orbits) == len(orbit_watch.ORBITS)
    assert all("a fixed point" in name for name in orbits)
    assert "motions that repeat" in few
