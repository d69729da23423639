"""What happens to contacts between two motions of a branch: grazes are seen, those too that come and go in a step."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

import analytic
from lapjoint import BaseMotion, Beam, ModalDamping, Problem, Stop, Support, paper_joint
from lapjoint.campaigns import Axis, Grid
from lapjoint.orbits.branches import passings
from lapjoint.orbits.branches.compiled_passings import nearest
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.gap_extrema import Extrema, stops_of
from lapjoint.orbits.branches.passings import Rates, change_along, coming, passed, rates_of
from lapjoint.orbits.branches.seeds import seed_from
from lapjoint.orbits.branches.tracing import trace

FREQUENCY = "base_motion.angular_frequency"
LOW, HIGH, MODES = 3.2, 3.8, 6


def cantilever(gap: float) -> Problem:
    """A cantilever of EI = m = L = 1 near its first resonance, 3.516 rad/s, with a stop at the tip."""
    return Problem(
        beam=Beam(length=1.0, bending_stiffness=1.0, mass_per_length=1.0),
        supports=(Support(x=0.0, translational=np.inf, torsional=np.inf),),
        stops=(Stop(x=1.0, side="top", gap=gap, stiffness=50.0),),
        damping=ModalDamping(ratio=0.02),
        base_motion=BaseMotion(amplitude=1e-3, angular_frequency=LOW),
    )


def family_of(problem: Problem) -> Family:
    grid = Grid(problem, (Axis(FREQUENCY, (LOW, HIGH)),))
    return Family(analytic.Solver(n_modes=MODES), lambda value: grid.with_values((value,)), FREQUENCY, LOW, HIGH)


def place_at(family: Family, value: float) -> Place:
    """The motion at a frequency, with its tangent upwards."""
    seed = seed_from(family, value, family.at(value).map.initial(), 1)
    assert seed is not None
    found = corrected(family, value, seed.point, seed.count)
    assert found is not None
    return found.along(np.append(np.zeros(found.tangent.size - 1), 1.0))


def tip_amplitude(value: float) -> float:
    """Amplitude of the tip without contact, m: the stop is far away."""
    family = family_of(cantilever(1.0))
    extrema = place_at(family, value).extrema
    return float(extrema.value[extrema.highest].max()) + 1.0


@pytest.fixture(scope="module")
def peak() -> tuple[float, float]:
    """Where the tip's amplitude is largest, rad/s, and how large, m, by three parabolas."""
    at, width = 3.515, 0.01
    for _ in range(3):
        y = [tip_amplitude(at + k * width) for k in (-1, 0, 1)]
        at, width = at - 0.5 * width * (y[2] - y[0]) / (y[2] - 2 * y[1] + y[0]), width / 5
    return at, tip_amplitude(at)


@pytest.mark.parametrize("share", [*(pytest.param(it, marks=pytest.mark.thorough) for it in (1e-2, 1e-3)), 1e-4])
def test_a_stop_that_is_touched_at_the_very_peak_only_is_not_passed_unseen(
    share: float, peak: tuple[float, float]
) -> None:
    family = family_of(cantilever(peak[1] * (1 - share)))
    seed = seed_from(family, LOW, family.at(LOW).map.initial(), 1)
    assert seed is not None
    found = trace(family, seed, most_multiple=1, errors=False)
    assert found is not None
    branch = found.branch
    assert branch.ends == ("boundary", "boundary")
    grazes = [one.value for one in branch.bifurcations if one.kind == "grazing"]
    assert len(grazes) == 2
    assert grazes[0] < peak[0]
    touched = [point.value for point in branch.points if point.motion.history.contacts]
    assert touched
    assert grazes[0] <= min(touched)
    # Both grazes are where the response without contact is as large as the gap; between them the branch may harden.
    assert tip_amplitude(grazes[1]) == pytest.approx(peak[1] * (1 - share), rel=1e-6)
    assert tip_amplitude(grazes[0]) == pytest.approx(peak[1] * (1 - share), rel=1e-6)


def test_one_step_over_the_peak_shows_the_graze_on_the_way(peak: tuple[float, float]) -> None:
    family = family_of(cantilever(peak[1] * (1 - 1e-3)))
    before, after = (place_at(family, peak[0] + sign * 0.01) for sign in (-1, 1))
    assert before.closings == after.closings == (0,)
    length = float(np.linalg.norm(after.chord(family, before)))
    rates = [rates_of(family, place) for place in (before, after)]
    seen = passed(before, rates[0], after, rates[1], length)
    assert not seen.nothing
    assert [graze.extremum.stop for graze in seen.grazes] == [0]


def test_rates_are_what_neighbours_differ_by(peak: tuple[float, float]) -> None:
    family = family_of(cantilever(peak[1] * 1.5))
    here = place_at(family, peak[0] - 0.05)
    rates, soon = rates_of(family, here), coming(here, rates_of(family, here))
    assert soon is not None
    value, guess = here.moved(family, 1e-4 * here.tangent)
    there = corrected(family, value, guess, here.count)
    assert there is not None
    change = (there.extrema.value - here.extrema.value) / 1e-4
    assert rates.value == pytest.approx(change, rel=1e-2, abs=1e-2 * np.abs(change).max())


def test_the_nearest_event_is_found_around_the_end_of_the_period() -> None:
    kind, other = np.array([0, 1, 2]), np.array([1, 0, 0])
    found = nearest(kind, np.array([0.98, 0.5, 0.1]), other, np.array([0.5, 0.01, 0.9]))
    assert found.tolist() == [1, 0, -1]


def bumps(time: list[float], value: list[float], highest: list[bool]) -> Any:
    """A motion of one second with these extrema at one stop, and one contact from 0.2 to 0.4 s."""
    stop = np.zeros(len(time), dtype=np.intp)
    switches = (np.zeros(2, dtype=np.intp), np.array([0.2, 0.4]), np.array([True, False]))
    return SimpleNamespace(
        closings=(1,),
        extrema=Extrema(stop, stop, np.array(time), np.array(value), np.array(highest), (1,), 1.0, *switches),
    )


@pytest.mark.parametrize(("rise", "nothing"), [(0.5, True), (5.0, False)])
def test_a_bump_that_arises_and_passes_the_gap_on_the_way_is_not_overlooked(rise: float, nothing: bool) -> None:
    # The contact from 0.2 to 0.4 s gains a highest and a lowest point, both of which are above the gap at the end.
    step = 0.1
    here = bumps([0.3, 0.8], [1.0, -1.0], [True, False])
    new = bumps([0.25, 0.30, 0.35, 0.8], [1.0, 0.2, 0.3, -1.0], [True, False, True, False])
    still, grown = np.zeros(2), np.array([0.0, rise, rise, 0.0])
    ahead = passed(here, Rates(still, still, still), new, Rates(0 * grown, grown, still), step)
    back = passed(new, Rates(0 * grown, -grown, still), here, Rates(still, still, still), step)
    assert ahead.nothing == back.nothing == nothing


def place_of_the_joint() -> tuple[Family, Place]:
    """The paper's joint at 300 rad/s, where it meets its stops."""
    grid = Grid(paper_joint(), (Axis(FREQUENCY, (200.0, 400.0)),))
    family = Family(analytic.Solver(n_modes=6), lambda value: grid.with_values((value,)), FREQUENCY, 200.0, 400.0)
    seed = seed_from(family, 300.0, family.at(300.0).map.initial(), 1)
    assert seed is not None
    place = corrected(family, seed.value, seed.point, seed.count)
    assert place is not None
    return family, place


def test_a_light_place_makes_its_march_again_to_the_bit() -> None:
    _, whole = place_of_the_joint()
    light = whole.light()
    assert light.extrema is whole.extrema
    pairs = zip(whole.orbit.last.linearised.segments, light.orbit.last.linearised.segments, strict=True)
    for one, other in pairs:
        assert np.array_equal(one.amplitudes, other.amplitudes)
        assert one.switched == other.switched


def test_a_branch_may_be_followed_from_a_light_place_as_from_the_whole() -> None:
    family, whole = place_of_the_joint()
    light, known = rates_of(family, whole.light()), rates_of(family, whole)
    for name in ("phase", "value", "switch"):
        a, b = getattr(light, name), getattr(known, name)
        assert a.size
        assert a == pytest.approx(b, rel=1e-9, abs=1e-12 * np.abs(b).max())


def test_a_change_is_laid_out_the_same_way_whatever_the_number_of_switches() -> None:
    """Else what is compiled for it is compiled once more, or loaded, for a quarter of a second."""
    free = family_of(cantilever(1.0))
    places = place_at(free, LOW), place_of_the_joint()[1]
    for place in places:
        first = stops_of(place.half_periods.map.problem.structure)[1]
        parts = change_along(place.orbit.last, first, place.tangent[:-1] / place.weights, 1.0)
        assert [part.flags.c_contiguous for part in parts] == [True] * 3
    assert len(places[0].orbit.last.linearised.motion) == 1 < len(places[1].orbit.last.linearised.motion)


def test_rates_in_closed_form_are_those_of_the_motion_just_beside() -> None:
    family, place = place_of_the_joint()
    exact, beside = rates_of(family, place), passings._by_difference(family, place)
    for name in ("phase", "value", "switch"):
        a, b = getattr(exact, name), getattr(beside, name)
        assert a.size
        # The motion beside is 3e-8 of the number away: seven digits are left.
        assert a == pytest.approx(b, rel=1e-4, abs=1e-5 * np.abs(b).max())


def test_an_extremum_of_no_known_rate_that_comes_back_shows_no_way_to_a_graze() -> None:
    # By its rate at the end it has been above the gap on the way; at the start its rate is not known, and so is 0.
    here, new = (bumps([0.3, 0.8], [1.0, -1e-3], [True, True]) for _ in range(2))
    still = np.zeros(2)
    seen = passed(here, Rates(still, still, still), new, Rates(still, np.array([0.0, -1.0]), still), 0.1)
    assert not seen.nothing
    assert seen.grazes == ()
