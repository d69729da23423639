"""Where branches end: at their start, wherever in the motion it is met again, and at what they spring from."""

from __future__ import annotations

import tomllib
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
from made_map import MadeMap, Tongue, made_problem

import analytic
from lapjoint import BaseMotion, Problem, SolverError, paper_joint
from lapjoint.answers import FREE, SectionPoint
from lapjoint.campaigns import FREQUENCY, Axis, Grid
from lapjoint.orbits.branches import continuation
from lapjoint.orbits.branches.closing import Marks, Start, is_back_where_it_was
from lapjoint.orbits.branches.continuation import follow
from lapjoint.orbits.branches.corrector import Place, corrected
from lapjoint.orbits.branches.family import Family
from lapjoint.orbits.branches.run import Limits
from lapjoint.orbits.branches.seeds import seed_from, springs_where
from lapjoint.orbits.branches.tracing import Seed, Traced, trace
from lapjoint.orbits.period_map import Derivative, Linearised

AMPLITUDE = "base_motion.amplitude"
LOW, HIGH = 0.2, 1.8


def family_of(solver: object, problem: Problem, path: str, low: float, high: float) -> Family:
    """The period maps of a problem over one of its numbers."""
    grid = Grid(problem, (Axis(path, (low, high)),))
    return Family(solver, lambda value: grid.with_values((value,)), path, low, high)


@pytest.mark.parametrize("multiple", [1, 3, 4, 7])
def test_a_closed_curve_is_gone_round_once_wherever_in_the_motion_it_comes_back(multiple: int) -> None:
    family = family_of(Tongue(multiple), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    angle = np.pi / 2 / multiple
    start = SectionPoint(FREE, np.array([[np.cos(angle), np.sin(angle)]]))
    found = trace(family, Seed(1.0, start, 2 * multiple), most_multiple=multiple, errors=False)
    assert found is not None
    assert found.branch.ends == ("closed", "closed")
    assert [one.kind for one in found.branch.bifurcations if one.kind == "fold"] == ["fold", "fold"]
    assert sorted(one.value for one in found.branch.bifurcations) == pytest.approx(
        [0.5, 1.5], abs=1e-7
    )  # motions close to 1e-9, of which c is a hundredth
    first, last = (found.branch.points[i] for i in (0, -1))
    assert last.value == pytest.approx(first.value, abs=1e-5)


def test_a_curve_that_comes_to_a_ring_on_which_its_start_does_not_lie_ends(monkeypatch: pytest.MonkeyPatch) -> None:
    # Such a ring is come to across what cannot be resolved; here the start of a ring is not looked at.
    between, first = Start.between, 1.0
    monkeypatch.setattr(Start, "between", lambda self, *two: None if self.place.value == first else between(self, *two))
    family = family_of(Tongue(1), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, first, SectionPoint(FREE, np.array([[0.0, 1.0]])), 2, fixed=True)
    assert start is not None
    run = follow(family, start, Limits(1000))
    assert run.end == "closed"
    x, y = np.array([place.point.coordinates[0] for place in run.places]).T
    turned = np.unwrap(np.arctan2(y, x))
    assert abs(turned[-1] - turned[1]) == pytest.approx(2 * np.pi, abs=1e-4)  # the first place is hidden


@pytest.mark.parametrize("before", [0, 1, 37, 99, 100, 130, 250])
def test_a_ring_that_is_entered_anywhere_is_gone_round_once(before: int) -> None:
    """A branch of the lightly damped joint enters one beyond a part left out: it had each of its bifurcations twice."""
    family = family_of(Tongue(1), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[0.0, 1.0]])), 2, fixed=True)
    assert start is not None
    ring = follow(family, start, Limits(1000)).places[:-1]
    elsewhere = [replace(ring[0], value=0.3 + 1e-3 * k) for k in range(before)]
    places = [*elsewhere, *(before + 400) * ring]
    marks = Marks(family, places[0])
    found = next(
        there for i in range(len(places) - 1) if (there := marks.come_back(places, i, i + 1 != before)) is not None
    )
    k, there = found
    assert k == before + len(ring) - 1
    assert there.value == pytest.approx(ring[0].value, abs=1e-6)


def test_a_place_that_is_no_more_of_a_curve_is_no_mark() -> None:
    family = family_of(Tongue(1), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[0.0, 1.0]])), 2, fixed=True)
    assert start is not None
    places = follow(family, start, Limits(1000, first=1e-3)).places[:-1]
    places = [places[0], *(beside(family, places[0], 1e-4 * (k + 1)) for k in range(110)), *places[4:], *places[:4]]
    marks = Marks(family, start)
    for i in range(135):  # until a mark has been set at 100, and the curve has left it
        assert marks.come_back(places, i, True) is None
    marks.forget_from(60)
    places = places[:60] + places[115:]
    found = [marks.come_back(places, i, True) for i in range(59, len(places) - 1)]
    assert any(found)
    assert all(one is None or one[0] < len(places) for one in found)


def test_a_part_that_was_left_out_does_not_close_a_curve() -> None:
    """Beyond such a part, near where the curve had begun, it was taken for a ring; it goes on, and round once more."""
    family = family_of(Tongue(1), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[0.0, 1.0]])), 2, fixed=True)
    assert start is not None
    once = follow(family, start, Limits(1000)).places[:-1]  # its next place is the start again
    n = len(once)
    for left_out, last in (((), n - 1), ((n - 1, n), 2 * n - 1)):
        marks = Marks(family, start)
        found = [i for i in range(3 * n - 1) if marks.come_back(3 * once, i, i not in left_out) is not None]
        assert found[0] == last


@pytest.mark.parametrize("seed", range(4))
def test_a_place_of_a_ring_is_met_each_time_though_rounding_decides_where_places_are(seed: int) -> None:
    """A graze sets where some places of a ring are: each time at the same motion, as exactly as motions close."""
    family = family_of(Tongue(1), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[0.0, 1.0]])), 2, fixed=True)
    assert start is not None
    ring, rng = follow(family, start, Limits(1000)).places[:-1], np.random.default_rng((41, seed))
    shifts = 1e-9 * rng.standard_normal((3, len(ring)))
    places = [beside(family, place, shift) for own in shifts for place, shift in zip(ring, own, strict=True)]
    for place in places[len(ring) : 2 * len(ring)]:
        mark = Start(family, place)
        met = [k for k in range(len(places) - 1) if mark.between(places[k], places[k + 1]) is not None]
        assert sum(k - before > 1 for before, k in pairwise([-2, *met])) == 3


@dataclass(frozen=True)
class CurveMap(MadeMap):
    """A motion x of which a function vanishes: P(x) = x + f / 2, with the derivative of f by x."""

    f: Callable[[float], tuple[float, float]] = lambda _: (0.0, 0.0)

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        x, slope = start.coordinates, np.eye(1)
        for _ in range(half_periods // 2):
            value, by_x = self.f(float(x[0, 0]))
            x, slope = x + value / 2, slope * (1 + by_x / 2)
        return Linearised(SectionPoint(FREE, x), lambda: Derivative(slope), tuple)


@dataclass(frozen=True)
class Curve:
    """A solver with the motions x for which f(x, p) = 0; p is the amplitude of the base, m."""

    f: Callable[[float, float], tuple[float, float]]
    name = "curve"

    def period_map(self, problem: Problem) -> CurveMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return CurveMap(problem, np.eye(1), partial(self.f, p=problem.base_motion.amplitude))


def ring(x: float, p: float, radius: float) -> tuple[float, float]:
    """A circle about (1, 1), with its derivative by x."""
    return ((x - 1) ** 2 + (p - 1) ** 2 - radius**2) / radius, 2 * (x - 1) / radius


@pytest.mark.parametrize("radius", [1e-5, 2e-5, 5e-5, 1e-3])
def test_a_ring_is_gone_round_once_however_small_it_is(radius: float) -> None:
    """Beside a graze one of 7e-5 was gone round 332 times, and each of its bifurcations was listed as often."""
    family = family_of(Curve(partial(ring, radius=radius)), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[1.0 + radius]])), 2, fixed=True)
    assert start is not None
    run = follow(family, start, Limits(500, first=radius / 10))
    assert run.end == "closed"
    ways = [(place.point.coordinates[0, 0] - 1, place.value - 1) for place in run.places]
    turned = np.unwrap([np.arctan2(*way) for way in ways])
    assert abs(turned[-1] - turned[0]) == pytest.approx(2 * np.pi, abs=0.02)


def test_a_curve_ends_once_its_marches_are_spent() -> None:
    """What is looked for along a curve is given up after so many: at a graze nothing else ended some."""
    family = family_of(Tongue(1), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[0.0, 1.0]])), 2, fixed=True)
    assert start is not None
    whole, most = follow(family, start, Limits(1000)), 20
    before = family.marches
    run = follow(family, start, Limits(1000, marches=most))
    assert run.end == "effort"
    assert most <= family.marches - before <= 2 * most  # a step is not broken off
    assert 1 < len(run.places) < len(whole.places)
    assert [one.value for one in run.places] == [one.value for one in whole.places[: len(run.places)]]


def strands(x: float, p: float, apart: float, length: float) -> tuple[float, float]:
    """Strands side by side, which the curve goes along up and down, with the derivative by x."""
    angle = 2 * np.pi * (x - 1) / apart
    return (length * np.sin(angle) - (p - 1)) / length * apart, 2 * np.pi * np.cos(angle)


@pytest.mark.parametrize("length", [1e-4, 1e-3, 1e-2])
@pytest.mark.parametrize("share", [0.02, 0.05, 0.2])
def test_a_curve_that_comes_by_beside_where_it_was_has_not_come_back(length: float, share: float) -> None:
    """Its strands of one direction are nearer to each other than two motions that are one may be, or hardly farther."""
    apart = share * length
    family = family_of(Curve(partial(strands, apart=apart, length=length)), made_problem(1.0), AMPLITUDE, LOW, HIGH)
    places = list[Place]()
    for angle in np.linspace(0.02, 8 * np.pi + 0.02, 401):
        x, p = 1 + apart * angle / (2 * np.pi), 1 + length * np.sin(angle)
        place = corrected(family, p, SectionPoint(FREE, np.array([[x]])), 2)
        assert place is not None
        places.append(place.along(np.array([apart / (2 * np.pi), length * np.cos(angle)])))
    marks = Marks(family, places[0])
    assert [marks.come_back(places, i, True) for i in range(len(places) - 1)] == [None] * (len(places) - 1)


def beside(family: Family, place: Place, step: float) -> Place:
    """The place some arc length from another."""
    found = corrected(family, *place.moved(family, step * place.tangent), place.count)
    assert found is not None
    return found.along(place.tangent)


@dataclass(frozen=True)
class CliffMap(MadeMap):
    """An unstable motion c(p) = p that leaves this just below p = 1, as 0.01 exp((p - 1) / 1e-5), and has a gap there.

    Newton's method finds it from 3e-4 at most.
    """

    p: float = 0.0

    def linearised(self, start: SectionPoint, half_periods: int) -> Linearised:
        """See `MadeMap`."""
        if 1 < self.p < 1.002:
            raise SolverError("there is no motion")
        x, slope = start.coordinates[0, 0], np.eye(1)
        center = self.p + (0.01 * np.exp((self.p - 1) / 1e-5) if self.p <= 1 else 0.0)
        for _ in range(half_periods // 2):
            away = 5e3 * (x - center)
            x, slope = x + 1e-3 * np.arctan(away), slope * (1 + 5.0 / (1 + away**2))
        return Linearised(SectionPoint(FREE, np.array([[x]])), lambda: Derivative(slope), tuple)


@dataclass(frozen=True)
class Cliff:
    """A solver that gives such maps; p is the amplitude of the base, m."""

    name = "cliff"

    def period_map(self, problem: Problem) -> CliffMap:
        """The map at the amplitude of a problem."""
        assert isinstance(problem.base_motion, BaseMotion)
        return CliffMap(problem, np.eye(1), problem.base_motion.amplitude)


def test_a_curve_that_turns_where_it_cannot_be_followed_is_found_again_beyond() -> None:
    family = family_of(Cliff(), made_problem(1.0), AMPLITUDE, LOW, 1.02)
    start = corrected(family, 0.9984, SectionPoint(FREE, np.array([[0.9984]])), 2, fixed=True)
    assert start is not None
    run = follow(family, start.along(np.array([0.0, 1.0])), Limits(1000, first=1e-4))  # too short to step across it
    assert run.end == "boundary"
    (jump,) = run.jumps
    assert jump.first == pytest.approx(1.0, abs=1e-4)
    assert 1.002 <= jump.last < 1.005
    assert all(place.point.coordinates[0, 0] == pytest.approx(place.value) for place in run.places[jump.index :])


def line_to_an_end(x: float, p: float) -> tuple[float, float]:
    """The motions x < 1 at p = 1, with the derivative by x; beyond there is none."""
    return (p - 1, 0.0) if x < 1 else (1.0, 0.0)


@pytest.mark.parametrize("back", [3e-6, 1e-5, 1e-4, 1e-2])
def test_a_part_that_leads_back_to_before_it_is_left_out_once(back: float, monkeypatch: pytest.MonkeyPatch) -> None:
    """A ring of 6e-6 was gone round 600 times: it is smaller than what tells two motions apart."""
    family = family_of(Curve(line_to_an_end), made_problem(1.0), AMPLITUDE, LOW, HIGH)

    def led_back(family: Family, places: list[Place], _: int) -> tuple[Place, int]:
        return beside(family, places[-1], -back), 0

    monkeypatch.setattr(continuation, "jumped", led_back)
    start = corrected(family, 1.0, SectionPoint(FREE, np.array([[0.98]])), 2)
    assert start is not None
    run = follow(family, start.along(np.array([1.0, 0.0])), Limits(1000))
    assert run.end == "lost"
    assert not run.jumps
    assert run.places[-1].point.coordinates[0, 0] == pytest.approx(1.0, abs=1e-6)


@pytest.mark.parametrize("way", [3e-8, 1e-6, 1e-5, 1e-3])
def test_a_curve_that_has_gone_a_little_on_is_not_back(way: float) -> None:
    family = family_of(Curve(lambda x, p: (x - p, 1.0)), made_problem(1.0), AMPLITUDE, LOW, HIGH)

    def at(value: float) -> Place:
        place = corrected(family, value, SectionPoint(FREE, np.array([[value]])), 2, fixed=True)
        assert place is not None
        return place.along(np.array([0.0, 1.0]))

    places = [at(1 + by) for by in (-1e-2, -1e-5, -1e-7, 0.3 * way, 0.8 * way, way)]
    assert not is_back_where_it_was(family, places, 3)
    assert is_back_where_it_was(family, [*places, at(1 - 2e-7)], 3)


@pytest.fixture(scope="module")
def tube() -> tuple[Family, Traced]:
    """The tutorial's tube from the motion of four half periods at 115.72 rad/s."""
    page = (Path(__file__).parents[2] / "docs/tutorial.md").read_text(encoding="utf-8")
    problem = Problem.model_validate(tomllib.loads(page.split("```toml")[1].split("```")[0]))
    family = family_of(analytic.Solver(), problem, FREQUENCY, 60.0, 300.0)
    seed = seed_from(family, 115.72, family.at(115.72).map.initial(), 4)
    assert seed is not None
    assert seed.count == 4
    found = trace(family, seed, most_multiple=2, errors=False)
    assert found is not None
    return family, found


def test_a_branch_between_two_flips_knows_both(tube: tuple[Family, Traced]) -> None:
    family, found = tube
    assert found.branch.ends == ("bifurcation", "bifurcation")
    assert len(found.springs) == 2
    for value, point in found.springs:
        half = family.at(value)
        assert half.apart(half.marched(point, 2), point) < 1e-7
        multipliers = np.linalg.eigvals(half.linearised(point, 2).matrix)
        assert np.min(np.abs(multipliers + 1)) < 1e-6
        assert springs_where(family, Seed(value, point, 4, (value, half.marched(point, 2))), found.springs, 4)
        away = (value * (1 + 1e-4), point)
        assert not springs_where(family, Seed(value, point, 4, away), found.springs, 4)


def test_no_motion_of_a_branch_repeats_in_half_its_time(tube: tuple[Family, Traced]) -> None:
    family, found = tube
    for one in found.branch.points:
        half, point = family.at(one.value), one.motion.section_point
        assert half.apart(half.marched(point, 2), point) > 1e-6


def test_a_finer_solver_finds_each_bifurcation_again_and_not_its_neighbour() -> None:
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    family = family_of(analytic.Solver(n_modes=27), joint, FREQUENCY, 679.0, 682.0)
    seed = seed_from(family, 679.0, family.at(679.0).map.initial(), 1)
    assert seed is not None
    rough, fine = (trace(family, seed, most_multiple=1, errors=errors) for errors in (False, True))
    assert rough is not None
    assert fine is not None
    pairs = list(zip(rough.branch.bifurcations, fine.branch.bifurcations, strict=True))
    assert pairs
    for a, b in pairs:
        assert a.kind == b.kind
        assert abs(a.value - b.value) <= 1e-5 * b.value  # the nearest two are ten times as far apart
        assert b.error <= 1e-5 * b.value


def test_a_branch_goes_on_behind_a_fold_at_which_truncated_modes_make_the_map_jump() -> None:
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    low, high = 189.5, 192.0
    family = family_of(analytic.Solver(), joint, FREQUENCY, low, high)
    seed = seed_from(family, 191.5, family.at(191.5).map.initial(), 1)
    assert seed is not None
    found = trace(family, seed, most_multiple=1, errors=False)
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")
    assert {found.branch.points[i].value for i in (0, -1)} == {low, high}


def like_the_joint(low: float, high: float, *, ratio: float = 0.08, gaps: float = 1.0) -> tuple[Family, Seed]:
    """The paper's joint with another damping ratio, and gaps so many times as wide, and its motion from rest at `high`.

    Frequencies are in rad/s.
    """
    joint = paper_joint()
    stops = tuple(stop.model_copy(update={"gap": gaps * stop.gap}) for stop in joint.stops)
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": ratio}), stops=stops)
    family = family_of(analytic.Solver(), joint, FREQUENCY, low, high)
    seed = seed_from(family, high, family.at(high).map.initial(), 1)
    assert seed is not None
    return family, seed


@pytest.mark.parametrize("first", [1e-7, 1e-6, 1e-5])
@pytest.mark.parametrize("ratio", [0.02, 0.06, 0.12])
def test_steps_shorter_than_what_tells_motions_apart_close_no_curve(ratio: float, first: float) -> None:
    family, seed = like_the_joint(2900.0, 3000.0, ratio=ratio)
    start = corrected(family, seed.value, seed.point, seed.count, fixed=True)
    assert start is not None
    run = follow(family, start.along(np.append(np.zeros(start.tangent.size - 1), -1.0)), Limits(200, first=first))
    assert run.end == "boundary"


def test_a_curve_is_gone_across_a_graze_in_its_own_direction() -> None:
    # At 3.8993 rad/s a seventh contact is made so lightly that what lies beyond seems to come to the graze from there.
    family, seed = like_the_joint(3.88, 3.92, gaps=0.8)
    found = trace(family, seed, most_multiple=1, errors=False)
    assert found is not None
    assert found.branch.ends == ("boundary", "boundary")


def random_joint(number: int) -> Problem:
    """A joint like the paper's, with other damping, gaps and stiffnesses; some are not their own mirror images."""
    rng, joint = np.random.default_rng((7, number)), paper_joint()
    ratio, gaps, stiffness = (float(np.exp(rng.uniform(*np.log(span)))) for span in SPANS)
    uneven = rng.random() < 0.4
    stops = tuple(
        stop.model_copy(
            update={
                "gap": gaps * stop.gap * (float(np.exp(rng.uniform(-0.3, 0.3))) if uneven else 1.0),
                "stiffness": stiffness * stop.stiffness,
            }
        )
        for stop in joint.stops
    )
    return joint.replace(damping=joint.damping.model_copy(update={"ratio": ratio}), stops=stops)


SPANS = (0.04, 0.2), (np.exp(-1.0), np.exp(1.0)), (np.exp(-1.5), np.exp(1.5))
"""Damping ratios, and factors of the paper's gaps and stiffnesses, of random joints."""


def from_the_upper_end(number: int, low: float, high: float, most: int = 1500) -> tuple[str, str] | None:
    """The ends of the branch of a random joint that comes from the upper end of a range; None if none is found."""
    family = family_of(analytic.Solver(), random_joint(number), FREQUENCY, low, high)
    seed = seed_from(family, high, family.at(high).map.initial(), 2)
    found = None if seed is None else trace(family, seed, most_multiple=1, errors=False, limits=Limits(most))
    return None if found is None else found.branch.ends


def test_a_curve_goes_on_where_an_extremum_that_has_just_arisen_vanishes_first() -> None:
    assert from_the_upper_end(2, 103.85, 104.0) == ("boundary", "boundary")


def test_a_curve_does_not_go_round_between_two_stops_that_are_hardly_touched() -> None:
    assert from_the_upper_end(9, 97.75, 97.9) == ("boundary", "boundary")


def test_a_curve_that_is_led_back_by_a_part_left_out_has_not_closed() -> None:
    assert from_the_upper_end(7, 1350.0, 5000.0) == ("lost", "boundary")


@pytest.mark.thorough
def test_no_branch_of_random_joints_that_comes_from_an_end_of_the_range_is_closed() -> None:
    ends = [from_the_upper_end(number, 100.0, 5000.0, 600) for number in range(24)]
    found = [pair[0] for pair in ends if pair is not None]
    assert len(found) >= 12  # half of the joints have a branch from there
    assert "closed" not in found
    assert found.count("lost") <= 3  # which of them are is chance, where truncation makes the map jump


ENDS = {0.09: (4370.0, 4420.0, 4386.7267), 0.11: (1400.0, 5000.0, 1453.5668), 0.12: (1400.0, 5000.0, 1465.8998)}
"""Ranges, rad/s, in which the branch of such damping ratios from the upper end ends at a graze, and where it does;
regression."""


@pytest.mark.parametrize("ratio", ENDS)
def test_a_branch_ends_where_a_motion_comes_to_a_switch_so_slowly_that_it_vanishes(ratio: float) -> None:
    low, high, value = ENDS[ratio]
    family, seed = like_the_joint(low, high, ratio=ratio)
    found = trace(family, seed, most_multiple=1)
    assert found is not None
    assert found.branch.ends == ("graze", "boundary")
    graze = found.branch.bifurcations[0]
    assert (graze.kind, graze.after) == ("grazing", "ends")
    assert graze.value == pytest.approx(value, abs=1e-3)
    assert 0 < graze.error < 2e-6 * graze.value
    # The speed at that switch, as the contacts of a march have it, falls to zero there along a line.
    points = [one for one in found.branch.points[1:] if 1e-7 < abs(one.value / graze.value - 1) < 1e-4]
    values = np.array([one.value for one in points])
    speeds = np.array([least_speed(family, graze.stop, one.value, one.motion.section_point) for one in points])
    slope, at_zero = np.polyfit(speeds, values, 1)
    assert len(points) >= 3  # fewer do not show a line
    assert np.ptp(speeds) > 10 * speeds.min() > 0
    assert slope
    assert at_zero == pytest.approx(graze.value, abs=graze.error + 0.02 * np.ptp(values))


def least_speed(family: Family, stop: int, value: float, point: SectionPoint) -> float:
    """The least speed with which a motion comes to a switch of a stop, or of its twin, m/s."""
    half = family.at(value)
    assert half.twins is not None
    motion = half.map.history(point, 1)
    ends = [t for one in motion.contacts if one.stop in (stop, half.twins[stop]) for t in (one.start, one.end)]
    inside = [t for t in ends if 0 < t < motion.end]
    return min(abs(motion.velocity(family.problem_at(value).stops[stop].x, np.array([t])).item()) for t in inside)


def lightly_damped(low: float, high: float, start: float) -> tuple[Family, Traced]:
    """The joint with a damping ratio of 0.02, and the branch of the motion from rest at a frequency, rad/s."""
    joint = paper_joint()
    joint = joint.replace(damping=joint.damping.model_copy(update={"ratio": 0.02}))
    family = family_of(analytic.Solver(), joint, FREQUENCY, low, high)
    seed = seed_from(family, start, family.at(start).map.initial(), 1)
    assert seed is not None
    found = trace(family, seed, most_multiple=1, errors=False)
    assert found is not None
    return family, found


def test_branches_that_spring_close_to_grazes_are_found() -> None:
    # At two of three broken symmetries a graze is so near that no motion 1e-3 away belongs to the branch that springs.
    family, found = lightly_damped(153.0, 156.3, 153.0)
    broken = [one.value for one in found.branch.bifurcations if one.kind == "symmetry breaking"]
    assert len(broken) == 3
    for value, one in zip(broken, found.seeds, strict=True):
        away = one.away_from
        assert away is not None
        assert away[0] == pytest.approx(value, rel=1e-9)
        half = family.at(one.value)
        assert half.apart(half.marched(one.point, one.count), one.point) < 1e-9
        assert half.apart(half.marched(one.point, one.count // 2), one.point) > 1e-5


@pytest.mark.thorough
def test_a_branch_that_few_modes_lose_goes_on_to_the_other_end_of_it() -> None:
    # From the flip at 183.163 rad/s to that at 183.266; with 16 modes there is no motion beyond 183.1735.  From rest,
    # rounding decides which of several motions is reached there; at 240 rad/s there is one.
    family, symmetric = lightly_damped(183.0, 240.0, 240.0)
    broken = trace(family, sprung(symmetric, 183.149), most_multiple=2, errors=False, limits=Limits(60))
    assert broken is not None
    doubled = trace(family, sprung(broken, 183.163), most_multiple=2, errors=False)
    assert doubled is not None
    assert doubled.branch.ends == ("bifurcation", "bifurcation")
    assert [value for value, _ in doubled.springs] == pytest.approx([183.1631, 183.2661], abs=1e-4)


def sprung(found: Traced, value: float) -> Seed:
    """The motion that springs from a bifurcation near a value."""
    (seed,) = [one for one in found.seeds if one.away_from is not None and abs(one.away_from[0] - value) < 1e-3]
    return seed
